"""Compiled loops that take a step: photos and cameras move, points follow by back-substitution, the cost is taken."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.adjustment.bundle.kernels import (
    COST,
    LOST,
    PREDICTED,
    SCALED2,
    SIZE2,
    STEP2,
    Image,
    Layout,
    Rules,
    Scene,
    in_camera,
    linearise,
)
from graphos_core.adjustment.bundle.reduction_kernels import invert, point_block
from graphos_core.adjustment.bundle.robust_kernels import robust
from graphos_core.cameras.kernels import project
from graphos_core.data.record import Array


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
        pixel[0] = layout.xy[o, 0]  # backward models correct it, forward models overwrite it
        pixel[1] = layout.xy[o, 1]
        if not project(
            layout.codes[c], scene.values[c], side * px, side * py, side * pz, pixel, slope, inner
        ):
            lost += 1
            continue
        vx = pixel[0] - layout.xy[o, 0]
        vy = pixel[1] - layout.xy[o, 1]
        cost += 0.5 * robust(rules.robust, rules.scale, layout.weight[o] * (vx * vx + vy * vy))[0]
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
    share: float,
    seen: Array,
    sums: Array,
) -> tuple[int, float]:
    """Sum what back-substitution needs of point i, without forming the rows of the reduced unknowns.

    ``sums`` (12,) becomes the upper triangle of V, its gradient g, and share · g + Wᵀ step; ``shift`` (n, 3) is R δC of each
    photo. Returns how many observations are in front of their camera, and ½ Σ ρ.
    """
    pixel, slope, inner = image
    for b in range(12):
        sums[b] = 0.0
    cost = 0.0
    count = 0
    for k in range(layout.start[i + 1] - layout.start[i]):
        o = layout.start[i] + k
        n = layout.photo[o]
        c = layout.camera[n]
        px, py, pz = in_camera(scene, n, i)
        side = -1.0 if pz < 0.0 and not rules.guard else 1.0
        pixel[0] = layout.xy[o, 0]  # backward models correct it, forward models overwrite it
        pixel[1] = layout.xy[o, 1]
        seen[k] = project(
            layout.codes[c], scene.values[c], side * px, side * py, side * pz, pixel, slope, inner
        )
        if not seen[k]:
            continue
        count += 1
        vx = pixel[0] - layout.xy[o, 0]
        vy = pixel[1] - layout.xy[o, 1]
        rho, weight = robust(rules.robust, rules.scale, layout.weight[o] * (vx * vx + vy * vy))
        cost += 0.5 * rho
        weight *= layout.weight[o]
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
            both = share * v + weight * change
            sums[9] += j0 * both
            sums[10] += j1 * both
            sums[11] += j2 * both
    return count, cost


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def substitute(
    scene: Scene, layout: Layout, rules: Rules, damping: float, span: tuple[int, int, int],
    step: Array, down: Array, shift: Array, shares: tuple[float, float], moved: Scene, totals: Array,
) -> None:  # fmt: skip
    """Move the points by back-substitution and take the cost of the moved scene.

    Parameters
    ----------
    step, down : float64 (u,)
        Parts of the step of the reduced unknowns: a share of the full step, and one of steepest descent.
    shift : float64 (n, 3)
        What `step` moves each projection centre, in the frame of its camera.
    shares : (float, float)
        The two shares, for the points: (1, 0) is the full step; steepest descent is −g / diagonal of V.
    moved : Scene
        Cameras and photos already moved; its points are written here.
    totals : float64 (8,)
        Cost after the step, lost observations, squared norms of step and size of the points, their part of the
        decrease predicted by the linear model (of a full step), and Σ diagonal · step².

    Notes
    -----
    A point whose step would carry it behind one of its cameras goes half, a quarter, … of its way.
    """
    image = Image(np.empty(2), np.empty((2, 3)), np.empty((2, scene.values.shape[1])))
    seen = np.empty(span[2], dtype=np.bool_)
    sums = np.empty(12)
    m = np.empty(3)
    inverse = np.empty((3, 3))
    for i in range(span[0], span[1]):
        count, before = _sum_point(scene, layout, rules, i, image, step, shift, shares[0], seen, sums)
        for b in range(3):
            moved.points[i, b] = scene.points[i, b]
            totals[SIZE2] += scene.points[i, b] * scene.points[i, b]
        for b in range(3):
            m[b] = 0.0
        if layout.point_column[i] >= 0:  # its step is among the reduced unknowns
            for b in range(3):
                m[b] = step[layout.point_column[i] + b] + down[layout.point_column[i] + b]
        if layout.free_point[i]:
            if count < 2 or not invert(sums, damping, inverse):
                continue
            for b in range(3):
                m[b] = -(inverse[b, 0] * sums[9] + inverse[b, 1] * sums[10] + inverse[b, 2] * sums[11])
            if shares[1] != 0.0:
                m[0] -= shares[1] * sums[6] / sums[0]
                m[1] -= shares[1] * sums[7] / sums[3]
                m[2] -= shares[1] * sums[8] / sums[5]
            totals[SCALED2] += sums[0] * m[0] * m[0] + sums[3] * m[1] * m[1] + sums[5] * m[2] * m[2]
            for b in range(3):
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
            if lost == 0 or not layout.free_point[i]:
                break
            share *= 0.5
        totals[LOST] += lost
        totals[COST] += max(after, before) if lost > 0 else after


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def steepest(
    scene: Scene, layout: Layout, rules: Rules, span: tuple[int, int, int], direction: Array, totals: Array
) -> None:
    """Sum what steepest descent needs over points ``span[0]`` to ``span[1]``.

    The direction is d = −D⁻¹ g with D the diagonal of JᵀJ: ``direction`` (u,) of the reduced unknowns, the points' own
    is computed here. ``totals`` (2,) becomes Σ g²/D of the points and |J d|² of all image observations.
    """
    rays = span[2]
    image = Image(np.empty(2), np.empty((2, 3)), np.empty((2, scene.values.shape[1])))
    rows = np.empty((rays, 2, layout.row[0]))
    ground = np.empty((rays, 2, 3))
    misfit = np.empty((rays, 2))
    seen = np.empty(rays, dtype=np.bool_)
    v = np.empty(6)
    g = np.empty(3)
    down = np.empty(3)
    inverse = np.empty((3, 3))
    for i in range(span[0], span[1]):
        count, _ = linearise(scene, layout, rules, i, image, rows, ground, misfit, seen)
        all_rays = layout.start[i + 1] - layout.start[i]
        down[0] = 0.0
        down[1] = 0.0
        down[2] = 0.0
        if layout.free_point[i]:
            point_block(ground, misfit, seen, all_rays, v, g)
            if count < 2 or not invert(v, 0.0, inverse):
                continue
            down[0] = -g[0] / v[0]
            down[1] = -g[1] / v[3]
            down[2] = -g[2] / v[5]
            totals[0] += g[0] * g[0] / v[0] + g[1] * g[1] / v[3] + g[2] * g[2] / v[5]
        for k in range(all_rays):
            if not seen[k]:
                continue
            n = layout.photo[layout.start[i] + k]
            c = layout.camera[n]
            w = layout.width[n]
            shared = layout.camera_column[c]
            free = layout.free_count[c] if shared >= 0 else 0
            for a in range(2):
                along = 0.0
                for x in range(w):
                    along += rows[k, a, x] * direction[layout.photo_column[n] + x]
                for x in range(free):
                    along += rows[k, a, w + x] * direction[shared + x]
                for b in range(3):
                    if layout.point_column[i] >= 0:
                        along += rows[k, a, w + free + b] * direction[layout.point_column[i] + b]
                    else:
                        along += ground[k, a, b] * down[b]
                totals[1] += along * along


@njit(cache=True, nogil=True)
def move_photos(scene: Scene, layout: Layout, step: Array, moved: Scene, shift: Array) -> None:
    """Move photos and cameras by the step of the reduced unknowns: ``R ← exp(ω) R``, ``C ← C + δC``.

    ``shift`` (n, 3) becomes R δC.
    """
    for n in range(layout.pose.shape[0]):
        for b in range(3):
            moved.centres[n, b] = scene.centres[n, b]
            for a in range(3):
                moved.rotations[n, a, b] = scene.rotations[n, a, b]
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
    for c in range(scene.values.shape[0]):
        for k in range(scene.values.shape[1]):
            moved.values[c, k] = scene.values[c, k]
    for n in range(layout.camera.shape[0]):  # a photo's own camera
        c = layout.camera[n]
        if layout.width[n] > layout.pose[n]:
            for k in range(layout.free_count[c]):
                moved.values[c, layout.free_index[c, k]] += step[layout.photo_column[n] + layout.pose[n] + k]
    for c in range(layout.codes.shape[0]):
        if layout.camera_column[c] >= 0:
            for k in range(layout.free_count[c]):
                moved.values[c, layout.free_index[c, k]] += step[layout.camera_column[c] + k]
