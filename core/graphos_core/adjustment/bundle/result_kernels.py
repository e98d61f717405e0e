"""Compiled loop over the adjusted block: residuals and robust weights."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.adjustment.bundle.kernels import Layout, Rules, Scene, in_camera
from graphos_core.adjustment.bundle.robust_kernels import robust
from graphos_core.cameras.kernels import project
from graphos_core.data.record import Array


@njit(cache=True, nogil=True, error_model="numpy")
def residuals(
    scene: Scene, layout: Layout, rules: Rules, span: tuple[int, int, int], out: Array, weights: Array
) -> None:
    """Write projected − measured of the observations of points ``span[0]`` to ``span[1]``, and their weights.

    ``out`` (m, 2) is NaN behind the camera.
    """
    pixel = np.empty(2)
    slope = np.empty((2, 3))
    inner = np.empty((2, scene.values.shape[1]))
    for i in range(span[0], span[1]):
        for o in range(layout.start[i], layout.start[i + 1]):
            n = layout.photo[o]
            c = layout.camera[n]
            px, py, pz = in_camera(scene, n, i)
            side = -1.0 if pz < 0.0 and not rules.guard else 1.0
            pixel[0] = layout.xy[o, 0]  # backward models correct it, forward models overwrite it
            pixel[1] = layout.xy[o, 1]
            if project(
                layout.codes[c], scene.values[c], side * px, side * py, side * pz, pixel, slope, inner
            ):
                out[o, 0] = pixel[0] - layout.xy[o, 0]
                out[o, 1] = pixel[1] - layout.xy[o, 1]
                square = layout.weight[o] * (out[o, 0] ** 2 + out[o, 1] ** 2)
                weights[o] = robust(rules.robust, rules.scale, square)[1]
            else:
                out[o, 0] = np.nan
                out[o, 1] = np.nan
                weights[o] = 0.0
