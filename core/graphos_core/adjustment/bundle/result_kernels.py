"""Compiled loops over the adjusted block: residuals, and the covariance of each object point."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.adjustment.bundle.kernels import (
    ROW,
    Image,
    Layout,
    Rules,
    Scene,
    in_camera,
    linearise,
    robust,
)
from graphos_core.adjustment.bundle.reduction_kernels import gather, invert, point_block
from graphos_core.cameras.kernels import MAX_VALUES, project
from graphos_core.data.record import Array


@njit(cache=True, nogil=True, error_model="numpy")
def residuals(scene: Scene, layout: Layout, rules: Rules, out: Array, weights: Array) -> None:
    """Write projected − measured of every observation into ``out`` (m, 2), NaN behind the camera, and its weight."""
    pixel = np.empty(2)
    slope = np.empty((2, 3))
    inner = np.empty((2, MAX_VALUES))
    for i in range(layout.start.shape[0] - 1):
        for o in range(layout.start[i], layout.start[i + 1]):
            n = layout.photo[o]
            c = layout.camera[n]
            px, py, pz = in_camera(scene, n, i)
            side = -1.0 if pz < 0.0 and not rules.guard else 1.0
            if project(
                layout.codes[c], scene.values[c], side * px, side * py, side * pz, pixel, slope, inner
            ):
                out[o, 0] = pixel[0] - layout.xy[o, 0]
                out[o, 1] = pixel[1] - layout.xy[o, 1]
                weights[o] = robust(rules.robust, rules.scale_px, out[o, 0] ** 2 + out[o, 1] ** 2)[1]
            else:
                out[o, 0] = np.nan
                out[o, 1] = np.nan
                weights[o] = 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def point_covariances(
    scene: Scene, layout: Layout, rules: Rules, span: tuple[int, int, int], reduced: Array, out: Array
) -> None:
    """Write ``V⁻¹ + V⁻¹ Wᵀ Q W V⁻¹`` of points ``span[0]`` to ``span[1]`` into ``out`` (p, 3, 3).

    ``reduced`` (u, u) is the full symmetric cofactor matrix Q of the reduced unknowns. A point that its rays do not
    fix gets infinity on its diagonal, a point held fixed zero.
    """
    rays = span[2]
    image = Image(np.empty(2), np.empty((2, 3)), np.empty((2, MAX_VALUES)))
    rows = np.empty((rays, 2, ROW))
    ground = np.empty((rays, 2, 3))
    misfit = np.empty((rays, 2))
    seen = np.empty(rays, dtype=np.bool_)
    coupling = np.empty((2 * rays, ROW, 3))
    column = np.empty(2 * rays, dtype=np.int64)
    width = np.empty(2 * rays, dtype=np.int64)
    v = np.empty(6)
    g = np.empty(3)
    inverse = np.empty((3, 3))
    middle = np.empty((3, 3))
    for i in range(span[0], span[1]):
        for a in range(3):
            for b in range(3):
                out[i, a, b] = 0.0
                middle[a, b] = 0.0
        if not layout.free_point[i]:
            continue
        linearise(scene, layout, rules, i, image, rows, ground, misfit, seen)
        point_block(ground, misfit, seen, layout.start[i + 1] - layout.start[i], v, g)
        if not invert(v, 0.0, inverse):
            for b in range(3):
                out[i, b, b] = np.inf
            continue
        blocks = gather(layout, i, rows, ground, seen, coupling, column, width)
        for s in range(blocks):
            for a in range(width[s]):
                h0 = 0.0
                h1 = 0.0
                h2 = 0.0
                for t in range(blocks):
                    for b in range(width[t]):
                        q = reduced[column[s] + a, column[t] + b]
                        h0 += q * coupling[t, b, 0]
                        h1 += q * coupling[t, b, 1]
                        h2 += q * coupling[t, b, 2]
                for b in range(3):
                    middle[b, 0] += coupling[s, a, b] * h0
                    middle[b, 1] += coupling[s, a, b] * h1
                    middle[b, 2] += coupling[s, a, b] * h2
        for a in range(3):
            for b in range(3):
                total = inverse[a, b]
                for c in range(3):
                    for d in range(3):
                        total += inverse[a, c] * middle[c, d] * inverse[d, b]
                out[i, a, b] = total
