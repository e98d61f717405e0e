"""Compiled loops that build the reduced normal equations: object points are eliminated point by point.

With V the block of a point, W its coupling with the photos and cameras that see it, the reduced matrix is
``U − Σ W V⁻¹ Wᵀ`` and the reduced gradient ``g − Σ W V⁻¹ g_point`` (Triggs et al. 2000, section 6.1).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.adjustment.bundle.kernels import (
    COST,
    GRADIENT,
    VISIBLE,
    Image,
    Layout,
    Rules,
    Scene,
    linearise,
)
from graphos_core.data.record import Array

ZERO, ONE, TWO, THREE = np.uint64(0), np.uint64(1), np.uint64(2), np.uint64(3)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def point_block(ground: Array, misfit: Array, seen: Array, rays: int, v: Array, g: Array) -> None:
    """Sum the normal equations of one point: ``v`` (6,) = upper triangle of Σ GᵀG, ``g`` (3,) = Σ Gᵀv."""
    v0 = v1 = v2 = v3 = v4 = v5 = g0 = g1 = g2 = 0.0
    for k in range(rays):
        if not seen[k]:
            continue
        for a in range(2):
            j0 = ground[k, a, 0]
            j1 = ground[k, a, 1]
            j2 = ground[k, a, 2]
            v0 += j0 * j0
            v1 += j0 * j1
            v2 += j0 * j2
            v3 += j1 * j1
            v4 += j1 * j2
            v5 += j2 * j2
            g0 += j0 * misfit[k, a]
            g1 += j1 * misfit[k, a]
            g2 += j2 * misfit[k, a]
    v[0] = v0
    v[1] = v1
    v[2] = v2
    v[3] = v3
    v[4] = v4
    v[5] = v5
    g[0] = g0
    g[1] = g1
    g[2] = g2


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def invert(v: Array, damping: float, inverse: Array) -> bool:
    """Invert the damped 3×3 block ``v`` (upper triangle) into ``inverse`` (3, 3); False where it is singular."""
    a = v[0] * (1.0 + damping)
    d = v[3] * (1.0 + damping)
    f = v[5] * (1.0 + damping)
    b = v[1]
    c = v[2]
    e = v[4]
    # Cholesky: the pivots tell how near to singular the block is
    if a <= 0.0 or d <= 0.0 or f <= 0.0:
        return False
    p1 = d - b * b / a
    if p1 <= 1e-14 * d:
        return False
    m = e - b * c / a
    p2 = f - c * c / a - m * m / p1
    if p2 <= 1e-14 * f:
        return False
    l1 = b / a
    l2 = c / a
    l3 = m / p1
    q = l1 * l3 - l2
    inverse[2, 2] = 1.0 / p2
    inverse[1, 2] = -l3 / p2
    inverse[0, 2] = q / p2
    inverse[1, 1] = 1.0 / p1 + l3 * l3 / p2
    inverse[0, 1] = -l1 / p1 - l3 * q / p2
    inverse[0, 0] = 1.0 / a + l1 * l1 / p1 + q * q / p2
    inverse[1, 0] = inverse[0, 1]
    inverse[2, 0] = inverse[0, 2]
    inverse[2, 1] = inverse[1, 2]
    return True


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def gather(
    layout: Layout,
    i: int,
    rows: Array,
    ground: Array,
    seen: Array,
    coupling: Array,
    column: Array,
    width: Array,
) -> int:
    """Collect ``coupling`` (s, row, 3) = (∂v/∂block)ᵀ ∂v/∂X of every block of unknowns that sees point i.

    Photos first, in order, then shared cameras; returns their number s.
    """
    count = 0
    rays = layout.start[i + 1] - layout.start[i]
    for k in range(rays):
        n = layout.photo[layout.start[i] + k]
        if not seen[k] or layout.width[n] == 0:
            continue
        column[count] = layout.photo_column[n]
        width[count] = layout.width[n]
        for a in range(layout.width[n]):
            for b in range(3):
                coupling[count, a, b] = rows[k, 0, a] * ground[k, 0, b] + rows[k, 1, a] * ground[k, 1, b]
        count += 1
    photos = count
    for k in range(rays):
        n = layout.photo[layout.start[i] + k]
        c = layout.camera[n]
        if not seen[k] or layout.camera_column[c] < 0:
            continue
        s = photos
        while s < count and column[s] != layout.camera_column[c]:
            s += 1
        if s == count:
            count += 1
            column[s] = layout.camera_column[c]
            width[s] = layout.free_count[c]
            for a in range(width[s]):
                for b in range(3):
                    coupling[s, a, b] = 0.0
        shift = layout.pose[n]
        for a in range(width[s]):
            for b in range(3):
                coupling[s, a, b] += (
                    rows[k, 0, shift + a] * ground[k, 0, b] + rows[k, 1, shift + a] * ground[k, 1, b]
                )
    return count


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def _add_block(
    matrix: Array, row: int, col: int, rows: Array, k: int, place: tuple[int, int], size: tuple[int, int]
) -> None:
    """Add ``A B`` to a block of ``matrix``, A and B the parts of ``rows[k]`` (2, row) from ``place`` with ``size``.

    Of a block on the diagonal the upper triangle is added (and entries below it that nobody reads). Three columns
    stay in registers while the rows pass, which beats short loops along the rows.
    """
    o = np.uint64(k)
    top = np.uint64(row)
    left = np.uint64(col)
    height = np.uint64(size[0])
    columns = np.uint64(size[1])
    p = np.uint64(place[0])
    q = np.uint64(place[1])
    for g in range(columns // THREE):
        b = g * THREE
        c = left + b
        p0 = rows[o, ZERO, q + b]
        p1 = rows[o, ONE, q + b]
        q0 = rows[o, ZERO, q + b + ONE]
        q1 = rows[o, ONE, q + b + ONE]
        r0 = rows[o, ZERO, q + b + TWO]
        r1 = rows[o, ONE, q + b + TWO]
        for a in range(height if row != col else b + THREE):
            j0 = rows[o, ZERO, p + a]
            j1 = rows[o, ONE, p + a]
            m0 = matrix[top + a, c] + (j0 * p0 + j1 * p1)
            m1 = matrix[top + a, c + ONE] + (j0 * q0 + j1 * q1)
            m2 = matrix[top + a, c + TWO] + (j0 * r0 + j1 * r1)
            matrix[top + a, c] = m0
            matrix[top + a, c + ONE] = m1
            matrix[top + a, c + TWO] = m2
    for rest in range(columns - columns % THREE, columns):
        p0 = rows[o, ZERO, q + rest]
        p1 = rows[o, ONE, q + rest]
        for a in range(height if row != col else rest + ONE):
            matrix[top + a, left + rest] += rows[o, ZERO, p + a] * p0 + rows[o, ONE, p + a] * p1


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def _add_reduced(
    layout: Layout, i: int, rows: Array, misfit: Array, seen: Array, matrix: Array, vectors: Array
) -> None:
    """Add the products of the reduced unknowns of point i's observations to the upper triangle of ``matrix``."""
    for k in range(layout.start[i + 1] - layout.start[i]):
        if not seen[k]:
            continue
        n = layout.photo[layout.start[i] + k]
        c = layout.camera[n]
        w = layout.width[n]
        col = layout.photo_column[n]
        shared = layout.camera_column[c]
        free = layout.free_count[c] if shared >= 0 else 0
        _add_block(matrix, col, col, rows, k, (0, 0), (w, w))
        if free > 0:
            _add_block(matrix, col, shared, rows, k, (0, w), (w, free))
            _add_block(matrix, shared, shared, rows, k, (w, w), (free, free))
        kept = layout.point_column[i]
        extra = 0
        if kept >= 0:
            extra = 3
            _add_block(matrix, col, kept, rows, k, (0, w + free), (w, 3))
            if free > 0:
                _add_block(matrix, shared, kept, rows, k, (w, w + free), (free, 3))
            _add_block(matrix, kept, kept, rows, k, (w + free, w + free), (3, 3))
        for a in range(w + free + extra):
            place = col + a if a < w else shared + a - w if a < w + free else kept + a - w - free
            vectors[0, place] += rows[k, 0, a] * misfit[k, 0] + rows[k, 1, a] * misfit[k, 1]
            vectors[2, place] += rows[k, 0, a] * rows[k, 0, a] + rows[k, 1, a] * rows[k, 1, a]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def _subtract_point(
    matrix: Array, count: int, coupling: Array, column: Array, width: Array, inverse: Array, solved: Array
) -> None:
    """Subtract ``W V⁻¹ Wᵀ`` of ONE point from the upper triangle of ``matrix``; ``solved`` (row, 3) is scratch.

    Three columns of W stay in registers while the rows pass, and indices are unsigned (a signed one is tested for
    being negative at each access): each makes this loop, the longest of all, much faster.
    """
    n = np.uint64(count)
    for s in range(n):
        first = np.uint64(column[s])
        ws = np.uint64(width[s])
        for a in range(ws):
            w0 = coupling[s, a, ZERO]
            w1 = coupling[s, a, ONE]
            w2 = coupling[s, a, TWO]
            solved[a, ZERO] = inverse[0, 0] * w0 + inverse[0, 1] * w1 + inverse[0, 2] * w2
            solved[a, ONE] = inverse[0, 1] * w0 + inverse[1, 1] * w1 + inverse[1, 2] * w2
            solved[a, TWO] = inverse[0, 2] * w0 + inverse[1, 2] * w1 + inverse[2, 2] * w2
        for t in range(s, n):
            wt = np.uint64(width[t])
            ct = np.uint64(column[t])
            for g in range(wt // THREE):
                b = g * THREE
                col = ct + b
                last = ws if s != t else b + THREE
                p0 = coupling[t, b, ZERO]
                p1 = coupling[t, b, ONE]
                p2 = coupling[t, b, TWO]
                q0 = coupling[t, b + ONE, ZERO]
                q1 = coupling[t, b + ONE, ONE]
                q2 = coupling[t, b + ONE, TWO]
                r0 = coupling[t, b + TWO, ZERO]
                r1 = coupling[t, b + TWO, ONE]
                r2 = coupling[t, b + TWO, TWO]
                for a in range(last):
                    y0 = solved[a, ZERO]
                    y1 = solved[a, ONE]
                    y2 = solved[a, TWO]
                    m0 = matrix[first + a, col] - (y0 * p0 + y1 * p1 + y2 * p2)
                    m1 = matrix[first + a, col + ONE] - (y0 * q0 + y1 * q1 + y2 * q2)
                    m2 = matrix[first + a, col + TWO] - (y0 * r0 + y1 * r1 + y2 * r2)
                    matrix[first + a, col] = m0
                    matrix[first + a, col + ONE] = m1
                    matrix[first + a, col + TWO] = m2
            for rest in range(wt - wt % THREE, wt):
                p0 = coupling[t, rest, ZERO]
                p1 = coupling[t, rest, ONE]
                p2 = coupling[t, rest, TWO]
                for a in range(ws):
                    matrix[first + a, ct + rest] -= (
                        solved[a, ZERO] * p0 + solved[a, ONE] * p1 + solved[a, TWO] * p2
                    )


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def build(
    scene: Scene, layout: Layout, rules: Rules, damping: float, span: tuple[int, int, int],
    matrix: Array, vectors: Array, totals: Array,
) -> None:  # fmt: skip
    """Add points ``span[0]`` to ``span[1]`` (at most ``span[2]`` rays each) to the reduced normal equations.

    Parameters
    ----------
    damping : float
        λ: the diagonal of every point's block is multiplied by 1 + λ before it is eliminated.
    matrix : float64 (u, u)
        Upper triangle of the reduced matrix, not damped itself.
    vectors : float64 (3, u)
        Gradient before the elimination, its change by it, and the diagonal of JᵀJ before it.
    totals : float64 (7,)
        Cost, largest gradient element of a point, observations in front of their cameras.
    """
    rays = span[2]
    row = layout.row[0]
    image = Image(np.empty(2), np.empty((2, 3)), np.empty((2, scene.values.shape[1])))
    rows = np.empty((rays, 2, row))
    ground = np.empty((rays, 2, 3))
    misfit = np.empty((rays, 2))
    seen = np.empty(rays, dtype=np.bool_)
    coupling = np.empty((2 * rays, row, 3))
    column = np.empty(2 * rays, dtype=np.int64)
    width = np.empty(2 * rays, dtype=np.int64)
    v = np.empty(6)
    g = np.empty(3)
    inverse = np.empty((3, 3))
    solved = np.empty((row, 3))
    for i in range(span[0], span[1]):
        count, cost = linearise(scene, layout, rules, i, image, rows, ground, misfit, seen)
        if layout.free_point[i]:
            if count < 2:
                continue
            point_block(ground, misfit, seen, layout.start[i + 1] - layout.start[i], v, g)
            if not invert(v, damping, inverse):
                continue
            totals[GRADIENT] = max(totals[GRADIENT], abs(g[0]), abs(g[1]), abs(g[2]))
        totals[COST] += cost
        totals[VISIBLE] += count
        _add_reduced(layout, i, rows, misfit, seen, matrix, vectors)
        if layout.free_point[i]:
            blocks = gather(layout, i, rows, ground, seen, coupling, column, width)
            _subtract_point(matrix, blocks, coupling, column, width, inverse, solved)
            y0 = inverse[0, 0] * g[0] + inverse[0, 1] * g[1] + inverse[0, 2] * g[2]
            y1 = inverse[1, 0] * g[0] + inverse[1, 1] * g[1] + inverse[1, 2] * g[2]
            y2 = inverse[2, 0] * g[0] + inverse[2, 1] * g[1] + inverse[2, 2] * g[2]
            for s in range(blocks):
                for a in range(width[s]):
                    vectors[1, column[s] + a] -= (
                        coupling[s, a, 0] * y0 + coupling[s, a, 1] * y1 + coupling[s, a, 2] * y2
                    )
