"""Compiled loops of the bundle adjustment: normal equations with the object points eliminated, point by point.

Residual ``v = projected − measured``. Unknowns of a photo: a small rotation ω about the camera's axes
(``R ← exp(ω) R``) and the projection centre C. With ``p = R (X − C)`` and ``D = ∂pixel/∂p``::

    ∂v/∂ω = −D [p]×      ∂v/∂C = −D R      ∂v/∂X = D R

Every kernel works on points ``begin`` to ``end`` and writes into accumulators of its own, so chunks of points run in
any thread and are summed in chunk order. Equations: Triggs et al. 2000, "Bundle adjustment: a modern synthesis",
sections 4 and 6.1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from graphos_core.cameras.kernels import MAX_VALUES, project
from graphos_core.data.record import Array

ROW = 6 + MAX_VALUES
"""Largest number of reduced unknowns that one observation depends on."""

NONE, HUBER, CAUCHY = 0, 1, 2
"""Codes of the robust functions."""

COST, GRADIENT, VISIBLE, LOST, STEP2, SIZE2, PREDICTED = range(7)
"""Places in the totals of a chunk."""


class Scene(NamedTuple):
    """What is adjusted.

    Attributes
    ----------
    values : float64 (c, MAX_VALUES)
        Camera parameters.
    rotations, centres : float64 (n, 3, 3), (n, 3)
    points : float64 (p, 3)
    """

    values: Array
    rotations: Array
    centres: Array
    points: Array


class Rules(NamedTuple):
    """How residuals count.

    Attributes
    ----------
    robust : int
        Code of the robust function.
    scale_px : float
        Its scale.
    guard : bool
        True sets observations behind their camera aside; False projects them through the projection centre, as
        the formula of a central camera does (for comparison with other programs).
    """

    robust: int
    scale_px: float
    guard: bool


class Layout(NamedTuple):
    """What is observed, and where each unknown stands in the reduced system.

    Attributes
    ----------
    codes : int64 (c,)
        Camera models.
    camera : int64 (n,)
        Camera of each photo.
    start : int64 (p + 1,)
        Observations of point i are ``start[i]`` to ``start[i + 1]``.
    photo : int64 (m,)
    xy : float64 (m, 2)
    free_point : bool (p,)
    photo_column : int64 (n,)
        First column of a photo's unknowns.
    pose : int64 (n,)
        6 where the exterior orientation is free, else 0.
    width : int64 (n,)
        Unknowns of the photo's block; includes those of its camera where the camera is the photo's own.
    camera_column : int64 (c,)
        First column of a camera shared by several photos; −1 where it has none of its own.
    free_index : int64 (c, MAX_VALUES)
        Which parameters of a camera are free, in order.
    free_count : int64 (c,)
    """

    codes: Array
    camera: Array
    start: Array
    photo: Array
    xy: Array
    free_point: Array
    photo_column: Array
    pose: Array
    width: Array
    camera_column: Array
    free_index: Array
    free_count: Array


class Image(NamedTuple):
    """Where a projection is written: ``pixel`` (2,), ``slope`` (2, 3) = ∂pixel/∂p, ``inner`` = ∂pixel/∂values."""

    pixel: Array
    slope: Array
    inner: Array


@njit(cache=True, nogil=True, inline="always")
def robust(kind: int, scale: float, square: float) -> tuple[float, float]:
    """Return ρ(s) and the weight ρ'(s) of the squared length s of a residual, with the scale in px."""
    limit = scale * scale
    if kind == HUBER and square > limit:
        length = np.sqrt(square)
        return 2.0 * scale * length - limit, scale / length
    if kind == CAUCHY:
        ratio = 1.0 + square / limit
        return limit * np.log(ratio), 1.0 / ratio
    return square, 1.0


@njit(cache=True, nogil=True, inline="always")
def in_camera(scene: Scene, n: int, i: int) -> tuple[float, float, float]:
    """Return point i in the frame of photo n's camera."""
    d0 = scene.points[i, 0] - scene.centres[n, 0]
    d1 = scene.points[i, 1] - scene.centres[n, 1]
    d2 = scene.points[i, 2] - scene.centres[n, 2]
    r = scene.rotations
    return (
        r[n, 0, 0] * d0 + r[n, 0, 1] * d1 + r[n, 0, 2] * d2,
        r[n, 1, 0] * d0 + r[n, 1, 1] * d1 + r[n, 1, 2] * d2,
        r[n, 2, 0] * d0 + r[n, 2, 1] * d1 + r[n, 2, 2] * d2,
    )


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def linearise(
    scene: Scene,
    layout: Layout,
    rules: Rules,
    i: int,
    image: Image,
    rows: Array,
    ground: Array,
    misfit: Array,
    seen: Array,
) -> tuple[int, float]:
    """Linearise the observations of point i, times the root of their robust weights.

    Fills ``rows`` (k, 2, ROW) = ∂v/∂(photo, camera), ``ground`` (k, 2, 3) = ∂v/∂X, ``misfit`` (k, 2) = v and
    ``seen`` (k,); returns how many are in front of their camera, and ½ Σ ρ.
    """
    pixel, slope, inner = image
    cost = 0.0
    count = 0
    for k in range(layout.start[i + 1] - layout.start[i]):
        o = layout.start[i] + k
        n = layout.photo[o]
        c = layout.camera[n]
        r = scene.rotations[n]
        px, py, pz = in_camera(scene, n, i)
        side = -1.0 if pz < 0.0 and not rules.guard else 1.0
        seen[k] = project(
            layout.codes[c], scene.values[c], side * px, side * py, side * pz, pixel, slope, inner
        )
        if not seen[k]:
            continue
        count += 1
        vx = pixel[0] - layout.xy[o, 0]
        vy = pixel[1] - layout.xy[o, 1]
        rho, weight = robust(rules.robust, rules.scale_px, vx * vx + vy * vy)
        cost += 0.5 * rho
        root = np.sqrt(weight)
        turn = root * side
        misfit[k, 0] = vx * root
        misfit[k, 1] = vy * root
        pose = layout.pose[n]
        for a in range(2):
            s0 = slope[a, 0] * turn
            s1 = slope[a, 1] * turn
            s2 = slope[a, 2] * turn
            for b in range(3):
                ground[k, a, b] = s0 * r[0, b] + s1 * r[1, b] + s2 * r[2, b]
            if pose > 0:
                rows[k, a, 0] = s2 * py - s1 * pz
                rows[k, a, 1] = s0 * pz - s2 * px
                rows[k, a, 2] = s1 * px - s0 * py
                rows[k, a, 3] = -ground[k, a, 0]
                rows[k, a, 4] = -ground[k, a, 1]
                rows[k, a, 5] = -ground[k, a, 2]
            for b in range(layout.free_count[c]):
                rows[k, a, pose + b] = inner[a, layout.free_index[c, b]] * root
    return count, cost


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def _point_block(ground: Array, misfit: Array, seen: Array, rays: int, v: Array, g: Array) -> None:
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
def _gather(
    layout: Layout,
    i: int,
    rows: Array,
    ground: Array,
    seen: Array,
    coupling: Array,
    column: Array,
    width: Array,
) -> int:
    """Collect ``coupling`` (s, ROW, 3) = (∂v/∂block)ᵀ ∂v/∂X of every block of unknowns that sees point i.

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
            coupling[s] = 0.0
        shift = layout.pose[n]
        for a in range(width[s]):
            for b in range(3):
                coupling[s, a, b] += (
                    rows[k, 0, shift + a] * ground[k, 0, b] + rows[k, 1, shift + a] * ground[k, 1, b]
                )
    return count


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def _add_block(
    matrix: Array, row: int, col: int, pair: Array, place: tuple[int, int], size: tuple[int, int]
) -> None:
    """Add ``A B`` to a block of ``matrix``, A and B the parts of ``pair`` (2, ROW) from ``place`` with ``size``.

    Of a block on the diagonal the upper triangle is added (and entries below it that nobody reads). Three columns
    stay in registers while the rows pass, which beats short loops along the rows.
    """
    for b in range(0, size[1] - size[1] % 3, 3):
        p0 = pair[0, place[1] + b]
        p1 = pair[1, place[1] + b]
        q0 = pair[0, place[1] + b + 1]
        q1 = pair[1, place[1] + b + 1]
        r0 = pair[0, place[1] + b + 2]
        r1 = pair[1, place[1] + b + 2]
        last = size[0] if row != col else b + 3
        for a in range(last):
            j0 = pair[0, place[0] + a]
            j1 = pair[1, place[0] + a]
            m0 = matrix[row + a, col + b] + (j0 * p0 + j1 * p1)
            m1 = matrix[row + a, col + b + 1] + (j0 * q0 + j1 * q1)
            m2 = matrix[row + a, col + b + 2] + (j0 * r0 + j1 * r1)
            matrix[row + a, col + b] = m0
            matrix[row + a, col + b + 1] = m1
            matrix[row + a, col + b + 2] = m2
    for b in range(size[1] - size[1] % 3, size[1]):
        p0 = pair[0, place[1] + b]
        p1 = pair[1, place[1] + b]
        last = size[0] if row != col else b + 1
        for a in range(last):
            matrix[row + a, col + b] += pair[0, place[0] + a] * p0 + pair[1, place[0] + a] * p1


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
        pair = rows[k]
        _add_block(matrix, col, col, pair, (0, 0), (w, w))
        if free > 0:
            _add_block(matrix, col, shared, pair, (0, w), (w, free))
            _add_block(matrix, shared, shared, pair, (w, w), (free, free))
        for a in range(w + free):
            place = col + a if a < w else shared + a - w
            vectors[0, place] += pair[0, a] * misfit[k, 0] + pair[1, a] * misfit[k, 1]
            vectors[2, place] += pair[0, a] * pair[0, a] + pair[1, a] * pair[1, a]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def _subtract_point(
    matrix: Array, count: int, coupling: Array, column: Array, width: Array, inverse: Array, solved: Array
) -> None:
    """Subtract ``W V⁻¹ Wᵀ`` of one point from the upper triangle of ``matrix``; ``solved`` (ROW, 3) is scratch.

    Three columns of W stay in registers while the rows pass: twice as fast as row by row.
    """
    for s in range(count):
        first = column[s]
        for a in range(width[s]):
            w0 = coupling[s, a, 0]
            w1 = coupling[s, a, 1]
            w2 = coupling[s, a, 2]
            solved[a, 0] = inverse[0, 0] * w0 + inverse[0, 1] * w1 + inverse[0, 2] * w2
            solved[a, 1] = inverse[0, 1] * w0 + inverse[1, 1] * w1 + inverse[1, 2] * w2
            solved[a, 2] = inverse[0, 2] * w0 + inverse[1, 2] * w1 + inverse[2, 2] * w2
        for t in range(s, count):
            whole = width[t] - width[t] % 3
            for b in range(0, whole, 3):
                col = column[t] + b
                last = width[s] if s != t else b + 3
                p0 = coupling[t, b, 0]
                p1 = coupling[t, b, 1]
                p2 = coupling[t, b, 2]
                q0 = coupling[t, b + 1, 0]
                q1 = coupling[t, b + 1, 1]
                q2 = coupling[t, b + 1, 2]
                r0 = coupling[t, b + 2, 0]
                r1 = coupling[t, b + 2, 1]
                r2 = coupling[t, b + 2, 2]
                for a in range(last):
                    y0 = solved[a, 0]
                    y1 = solved[a, 1]
                    y2 = solved[a, 2]
                    m0 = matrix[first + a, col] - (y0 * p0 + y1 * p1 + y2 * p2)
                    m1 = matrix[first + a, col + 1] - (y0 * q0 + y1 * q1 + y2 * q2)
                    m2 = matrix[first + a, col + 2] - (y0 * r0 + y1 * r1 + y2 * r2)
                    matrix[first + a, col] = m0
                    matrix[first + a, col + 1] = m1
                    matrix[first + a, col + 2] = m2
            for b in range(whole, width[t]):
                p0 = coupling[t, b, 0]
                p1 = coupling[t, b, 1]
                p2 = coupling[t, b, 2]
                for a in range(width[s]):
                    matrix[first + a, column[t] + b] -= (
                        solved[a, 0] * p0 + solved[a, 1] * p1 + solved[a, 2] * p2
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
    solved = np.empty((ROW, 3))
    for i in range(span[0], span[1]):
        count, cost = linearise(scene, layout, rules, i, image, rows, ground, misfit, seen)
        if layout.free_point[i]:
            if count < 2:
                continue
            _point_block(ground, misfit, seen, layout.start[i + 1] - layout.start[i], v, g)
            if not invert(v, damping, inverse):
                continue
            totals[GRADIENT] = max(totals[GRADIENT], abs(g[0]), abs(g[1]), abs(g[2]))
        totals[COST] += cost
        totals[VISIBLE] += count
        _add_reduced(layout, i, rows, misfit, seen, matrix, vectors)
        if layout.free_point[i]:
            blocks = _gather(layout, i, rows, ground, seen, coupling, column, width)
            _subtract_point(matrix, blocks, coupling, column, width, inverse, solved)
            y0 = inverse[0, 0] * g[0] + inverse[0, 1] * g[1] + inverse[0, 2] * g[2]
            y1 = inverse[1, 0] * g[0] + inverse[1, 1] * g[1] + inverse[1, 2] * g[2]
            y2 = inverse[2, 0] * g[0] + inverse[2, 1] * g[1] + inverse[2, 2] * g[2]
            for s in range(blocks):
                for a in range(width[s]):
                    vectors[1, column[s] + a] -= (
                        coupling[s, a, 0] * y0 + coupling[s, a, 1] * y1 + coupling[s, a, 2] * y2
                    )


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def cost_of_point(
    scene: Scene, layout: Layout, rules: Rules, i: int, image: Image, seen: Array
) -> tuple[float, int]:
    """Return ½ Σ ρ over those observations of point i marked ``seen``, and how many of them are lost behind cameras."""
    pixel, slope, inner = image
    cost = 0.0
    lost = 0
    for k in range(layout.start[i + 1] - layout.start[i]):
        if not seen[k]:
            continue
        o = layout.start[i] + k
        n = layout.photo[o]
        c = layout.camera[n]
        px, py, pz = in_camera(scene, n, i)
        side = -1.0 if pz < 0.0 and not rules.guard else 1.0
        if not project(
            layout.codes[c], scene.values[c], side * px, side * py, side * pz, pixel, slope, inner
        ):
            lost += 1
            continue
        vx = pixel[0] - layout.xy[o, 0]
        vy = pixel[1] - layout.xy[o, 1]
        cost += 0.5 * robust(rules.robust, rules.scale_px, vx * vx + vy * vy)[0]
    return cost, lost


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, inline="always")
def _sum_point(
    scene: Scene,
    layout: Layout,
    rules: Rules,
    i: int,
    image: Image,
    step: Array,
    shift: Array,
    seen: Array,
    sums: Array,
) -> tuple[int, float]:
    """Sum what back-substitution needs of point i, without forming the rows of the reduced unknowns.

    ``sums`` (12,) becomes the upper triangle of V, its gradient g, and g + Wᵀ step; ``shift`` (n, 3) is R δC of each
    photo. Returns how many observations are in front of their camera, and ½ Σ ρ.
    """
    pixel, slope, inner = image
    sums[:] = 0.0
    cost = 0.0
    count = 0
    for k in range(layout.start[i + 1] - layout.start[i]):
        o = layout.start[i] + k
        n = layout.photo[o]
        c = layout.camera[n]
        px, py, pz = in_camera(scene, n, i)
        side = -1.0 if pz < 0.0 and not rules.guard else 1.0
        seen[k] = project(
            layout.codes[c], scene.values[c], side * px, side * py, side * pz, pixel, slope, inner
        )
        if not seen[k]:
            continue
        count += 1
        vx = pixel[0] - layout.xy[o, 0]
        vy = pixel[1] - layout.xy[o, 1]
        rho, weight = robust(rules.robust, rules.scale_px, vx * vx + vy * vy)
        cost += 0.5 * rho
        m0 = 0.0
        m1 = 0.0
        m2 = 0.0
        col = layout.photo_column[n]
        if layout.pose[n] > 0:
            m0 = step[col + 1] * pz - step[col + 2] * py - shift[n, 0]
            m1 = step[col + 2] * px - step[col] * pz - shift[n, 1]
            m2 = step[col] * py - step[col + 1] * px - shift[n, 2]
        first = layout.camera_column[c] if layout.camera_column[c] >= 0 else col + layout.pose[n]
        for a in range(2):
            s0 = slope[a, 0] * side
            s1 = slope[a, 1] * side
            s2 = slope[a, 2] * side
            change = s0 * m0 + s1 * m1 + s2 * m2
            for b in range(layout.free_count[c]):
                change += inner[a, layout.free_index[c, b]] * step[first + b]
            r = scene.rotations
            j0 = s0 * r[n, 0, 0] + s1 * r[n, 1, 0] + s2 * r[n, 2, 0]
            j1 = s0 * r[n, 0, 1] + s1 * r[n, 1, 1] + s2 * r[n, 2, 1]
            j2 = s0 * r[n, 0, 2] + s1 * r[n, 1, 2] + s2 * r[n, 2, 2]
            v = (vx if a == 0 else vy) * weight
            sums[0] += weight * j0 * j0
            sums[1] += weight * j0 * j1
            sums[2] += weight * j0 * j2
            sums[3] += weight * j1 * j1
            sums[4] += weight * j1 * j2
            sums[5] += weight * j2 * j2
            sums[6] += j0 * v
            sums[7] += j1 * v
            sums[8] += j2 * v
            both = v + weight * change
            sums[9] += j0 * both
            sums[10] += j1 * both
            sums[11] += j2 * both
    return count, cost


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def substitute(
    scene: Scene, layout: Layout, rules: Rules, damping: float, span: tuple[int, int, int],
    step: Array, shift: Array, moved: Scene, totals: Array,
) -> None:  # fmt: skip
    """Move the points by back-substitution and take the cost of the moved scene.

    Parameters
    ----------
    step : float64 (u,)
        Step of the reduced unknowns.
    shift : float64 (n, 3)
        Step of each projection centre in the frame of its camera.
    moved : Scene
        Cameras and photos already moved; its points are written here.
    totals : float64 (7,)
        Cost after the step, lost observations, squared norms of step and size of the points, and their part of
        the decrease predicted by the linear model.

    Notes
    -----
    A point whose step would carry it behind one of its cameras goes half, a quarter, … of its way.
    """
    image = Image(np.empty(2), np.empty((2, 3)), np.empty((2, MAX_VALUES)))
    seen = np.empty(span[2], dtype=np.bool_)
    sums = np.empty(12)
    m = np.empty(3)
    inverse = np.empty((3, 3))
    for i in range(span[0], span[1]):
        count, before = _sum_point(scene, layout, rules, i, image, step, shift, seen, sums)
        for b in range(3):
            moved.points[i, b] = scene.points[i, b]
            totals[SIZE2] += scene.points[i, b] * scene.points[i, b]
        if layout.free_point[i]:
            if count < 2 or not invert(sums, damping, inverse):
                continue
            for b in range(3):
                m[b] = -(inverse[b, 0] * sums[9] + inverse[b, 1] * sums[10] + inverse[b, 2] * sums[11])
                totals[STEP2] += m[b] * m[b]
                totals[PREDICTED] -= 0.5 * sums[6 + b] * m[b]
            totals[PREDICTED] += (
                0.5 * damping * (sums[0] * m[0] * m[0] + sums[3] * m[1] * m[1] + sums[5] * m[2] * m[2])
            )
            share = 1.0
            after = 0.0
            lost = 0
            for _ in range(5):
                for b in range(3):
                    moved.points[i, b] = scene.points[i, b] + share * m[b]
                after, lost = cost_of_point(moved, layout, rules, i, image, seen)
                if lost == 0:
                    break
                share *= 0.5
        else:
            after, lost = cost_of_point(moved, layout, rules, i, image, seen)
        totals[LOST] += lost
        totals[COST] += max(after, before) if lost > 0 else after


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
                out[o] = np.nan
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
        out[i] = 0.0
        if not layout.free_point[i]:
            continue
        linearise(scene, layout, rules, i, image, rows, ground, misfit, seen)
        _point_block(ground, misfit, seen, layout.start[i + 1] - layout.start[i], v, g)
        if not invert(v, 0.0, inverse):
            for b in range(3):
                out[i, b, b] = np.inf
            continue
        blocks = _gather(layout, i, rows, ground, seen, coupling, column, width)
        middle[:] = 0.0
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
        out[i] = inverse + inverse @ middle @ inverse


@njit(cache=True, nogil=True)
def move_photos(scene: Scene, layout: Layout, step: Array, moved: Scene, shift: Array) -> None:
    """Move photos and cameras by the step of the reduced unknowns: ``R ← exp(ω) R``, ``C ← C + δC``.

    ``shift`` (n, 3) becomes R δC.
    """
    for n in range(layout.pose.shape[0]):
        moved.rotations[n] = scene.rotations[n]
        moved.centres[n] = scene.centres[n]
        if layout.pose[n] == 0:
            continue
        s = step[layout.photo_column[n] : layout.photo_column[n] + 6]
        angle = np.sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2])
        if angle > 1e-8:
            sine = np.sin(angle) / angle
            cosine = (1.0 - np.cos(angle)) / (angle * angle)
        else:
            sine = 1.0
            cosine = 0.5
        for b in range(3):
            r0 = scene.rotations[n, 0, b]
            r1 = scene.rotations[n, 1, b]
            r2 = scene.rotations[n, 2, b]
            c0 = s[1] * r2 - s[2] * r1
            c1 = s[2] * r0 - s[0] * r2
            c2 = s[0] * r1 - s[1] * r0
            moved.rotations[n, 0, b] = r0 + sine * c0 + cosine * (s[1] * c2 - s[2] * c1)
            moved.rotations[n, 1, b] = r1 + sine * c1 + cosine * (s[2] * c0 - s[0] * c2)
            moved.rotations[n, 2, b] = r2 + sine * c2 + cosine * (s[0] * c1 - s[1] * c0)
            moved.centres[n, b] = scene.centres[n, b] + s[3 + b]
            shift[n, b] = (
                scene.rotations[n, b, 0] * s[3]
                + scene.rotations[n, b, 1] * s[4]
                + scene.rotations[n, b, 2] * s[5]
            )
    moved.values[:] = scene.values
    for n in range(layout.camera.shape[0]):  # a photo's own camera
        c = layout.camera[n]
        if layout.width[n] > layout.pose[n]:
            for k in range(layout.free_count[c]):
                moved.values[c, layout.free_index[c, k]] += step[layout.photo_column[n] + layout.pose[n] + k]
    for c in range(layout.codes.shape[0]):
        if layout.camera_column[c] >= 0:
            for k in range(layout.free_count[c]):
                moved.values[c, layout.free_index[c, k]] += step[layout.camera_column[c] + k]
