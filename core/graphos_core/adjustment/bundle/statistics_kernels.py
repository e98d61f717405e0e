"""Compiled loops over the adjusted block: covariance of each object point, redundancy of each observation.

With Q the cofactors of the reduced unknowns, V the block of an eliminated point and W its coupling, the cofactors are

    point:            P = V⁻¹ + V⁻¹ Wᵀ Q W V⁻¹
    reduced, point:  −T,  T = Q W V⁻¹

and of an adjusted, weighted observation with rows a (reduced) and g (point) ``q = a Q aᵀ − 2 a T gᵀ + g P gᵀ``; its
redundancy number is ``1 − q`` (Förstner and Wrobel 2016, sections 4.6.2 and 15.2).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.adjustment.bundle.kernels import Image, Layout, Rules, Scene, linearise
from graphos_core.adjustment.bundle.reduction_kernels import gather, invert, point_block
from graphos_core.data.record import Array


@njit(cache=True, nogil=True, error_model="numpy")
def _coupled(
    reduced: Array, blocks: int, coupling: Array, column: Array, width: Array, inverse: Array, t: Array,
    cofactor: Array,
) -> None:  # fmt: skip
    """Fill ``t`` (s, row, 3) = Q W V⁻¹ and ``cofactor`` (3, 3) = V⁻¹ + V⁻¹ Wᵀ Q W V⁻¹ of one point."""
    for a in range(3):
        for b in range(3):
            cofactor[a, b] = inverse[a, b]
    for s in range(blocks):
        for a in range(width[s]):
            h0 = 0.0
            h1 = 0.0
            h2 = 0.0
            for u in range(blocks):
                for b in range(width[u]):
                    q = reduced[column[s] + a, column[u] + b]
                    h0 += q * coupling[u, b, 0]
                    h1 += q * coupling[u, b, 1]
                    h2 += q * coupling[u, b, 2]
            for b in range(3):
                t[s, a, b] = h0 * inverse[0, b] + h1 * inverse[1, b] + h2 * inverse[2, b]
    for a in range(3):
        for s in range(blocks):
            for c in range(width[s]):
                y = 0.0
                for b in range(3):
                    y += inverse[a, b] * coupling[s, c, b]
                for b in range(3):
                    cofactor[a, b] += y * t[s, c, b]


@njit(cache=True, nogil=True, error_model="numpy")
def _place(layout: Layout, i: int, n: int, place: Array) -> int:
    """Write the reduced columns of an observation of point i in photo n into ``place``; return how many."""
    c = layout.camera[n]
    count = 0
    for a in range(layout.width[n]):
        place[count] = layout.photo_column[n] + a
        count += 1
    if layout.camera_column[c] >= 0:
        for a in range(layout.free_count[c]):
            place[count] = layout.camera_column[c] + a
            count += 1
    if layout.point_column[i] >= 0:
        for a in range(3):
            place[count] = layout.point_column[i] + a
            count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def statistics(
    scene: Scene, layout: Layout, rules: Rules, span: tuple[int, int, int], reduced: Array, delta0: float,
    points: Array, redundancy: Array, effect: Array,
) -> None:  # fmt: skip
    """Write the statistics of points ``span[0]`` to ``span[1]`` and of their observations.

    Parameters
    ----------
    reduced : float64 (u, u)
        Full symmetric cofactor matrix of the reduced unknowns.
    delta0 : float
        Non-centrality of the minimal detectable bias; negative: observations are passed over.
    points : float64 (p, 3, 3)
        Cofactors of the points; infinity on the diagonal of a point that its rays do not fix, 0 where held fixed.
    redundancy, effect : float64 (m, 2)
        Redundancy number of each coordinate, and how far its minimal detectable bias moves the point.
    """
    rays = span[2]
    row = layout.row[0]
    image = Image(np.empty(2), np.empty((2, 3)), np.empty((2, scene.values.shape[1])))
    rows = np.zeros((rays, 2, row))
    ground = np.empty((rays, 2, 3))
    misfit = np.empty((rays, 2))
    seen = np.empty(rays, dtype=np.bool_)
    coupling = np.empty((2 * rays, row, 3))
    t = np.empty((2 * rays, row, 3))
    column = np.empty(2 * rays, dtype=np.int64)
    width = np.empty(2 * rays, dtype=np.int64)
    place = np.empty(row, dtype=np.int64)
    v = np.empty(6)
    g = np.empty(3)
    inverse = np.empty((3, 3))
    shift = np.empty(3)
    for i in range(span[0], span[1]):
        linearise(scene, layout, rules, i, image, rows, ground, misfit, seen)
        count = layout.start[i + 1] - layout.start[i]
        blocks = 0
        if layout.free_point[i]:
            point_block(ground, misfit, seen, count, v, g)
            if not invert(v, 0.0, inverse):
                for b in range(3):
                    points[i, b, b] = np.inf
                continue
            blocks = gather(layout, i, rows, ground, seen, coupling, column, width)
            _coupled(reduced, blocks, coupling, column, width, inverse, t, points[i])
        elif layout.point_column[i] >= 0:
            first = layout.point_column[i]
            for a in range(3):
                for b in range(3):
                    points[i, a, b] = reduced[first + a, first + b]
        if delta0 < 0.0:
            continue
        for k in range(count):
            if not seen[k]:
                continue
            o = layout.start[i] + k
            n = layout.photo[o]
            length = _place(layout, i, n, place)
            for a in range(2):
                q = 0.0
                for x in range(length):
                    part = 0.0
                    for y in range(length):
                        part += reduced[place[x], place[y]] * rows[k, a, y]
                    q += rows[k, a, x] * part
                for b in range(3):
                    shift[b] = 0.0
                if layout.free_point[i]:
                    for b in range(3):
                        for c in range(3):
                            shift[b] += points[i, b, c] * ground[k, a, c]
                    for s in range(blocks):
                        own = column[s] == layout.photo_column[n] and layout.width[n] > 0
                        offset = 0 if own else layout.width[n]
                        if own or column[s] == layout.camera_column[layout.camera[n]]:
                            for x in range(width[s]):
                                for b in range(3):
                                    along = rows[k, a, offset + x] * t[s, x, b]
                                    shift[b] -= along
                                    q -= along * ground[k, a, b]
                    for b in range(3):
                        q += ground[k, a, b] * shift[b]
                elif layout.point_column[i] >= 0:
                    for b in range(3):
                        for x in range(length):
                            shift[b] += reduced[layout.point_column[i] + b, place[x]] * rows[k, a, x]
                r = min(max(1.0 - q, 0.0), 1.0)
                redundancy[o, a] = r
                size = np.sqrt(shift[0] ** 2 + shift[1] ** 2 + shift[2] ** 2)
                effect[o, a] = np.inf if r < 1e-9 else size * delta0 / np.sqrt(r)
