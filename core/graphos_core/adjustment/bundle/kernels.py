"""Compiled loops of the bundle adjustment: normal equations with the object points eliminated, point by point.

Residual ``v = projected − measured``; for backward camera models in the corrected picture. Unknowns of a photo: a small rotation ω about the camera's axes
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

from graphos_core.adjustment.bundle.robust_kernels import robust
from graphos_core.cameras.kernels import project
from graphos_core.data.record import Array

COST, GRADIENT, VISIBLE, LOST, STEP2, SIZE2, PREDICTED, SCALED2 = range(8)
"""Places in the totals of a chunk."""


class Scene(NamedTuple):
    """What is adjusted.

    Attributes
    ----------
    values : float64 (c, k)
        Camera parameters; k of the camera with most.
    rotations, centres : float64 (n, 3, 3), (n, 3)
    points : float64 (p, 3)
    extra : float64 (e,)
        Unknowns of other observations: lever arm, plane, … .
    """

    values: Array
    rotations: Array
    centres: Array
    points: Array
    extra: Array


class Rules(NamedTuple):
    """How residuals count.

    Attributes
    ----------
    robust : int
        Code of the robust function.
    scale : float
        Its scale, in units of the a priori standard deviation of an observation.
    guard : bool
        True sets observations behind their camera aside; False projects them through the projection centre, as
        the formula of a central camera does (for comparison with other programs).
    """

    robust: int
    scale: float
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
    weight : float64 (m,)
        1/σ² of each observation, px⁻².
    free_point : bool (p,)
        Points that are eliminated.
    point_column : int64 (p,)
        First column of a point that is kept in the reduced system, because other observations than images concern
        it; −1 for eliminated points and those held fixed.
    photo_column : int64 (n,)
        First column of a photo's unknowns.
    pose : int64 (n,)
        6 where the exterior orientation is free, else 0.
    width : int64 (n,)
        Unknowns of the photo's block; includes those of its camera where the camera is the photo's own.
    camera_column : int64 (c,)
        First column of a camera shared by several photos; −1 where it has none of its own.
    free_index : int64 (c, k)
        Which parameters of a camera are free, in order.
    free_count : int64 (c,)
    row : int64 (1,)
        Largest number of reduced unknowns that one observation depends on.
    """

    codes: Array
    camera: Array
    start: Array
    photo: Array
    xy: Array
    weight: Array
    free_point: Array
    point_column: Array
    photo_column: Array
    pose: Array
    width: Array
    camera_column: Array
    free_index: Array
    free_count: Array
    row: Array


class Image(NamedTuple):
    """Where a projection is written: ``pixel`` (2,), ``slope`` (2, 3) = ∂pixel/∂p, ``inner`` = ∂pixel/∂values."""

    pixel: Array
    slope: Array
    inner: Array


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
    """Linearise the observations of point i, times the root of their weights.

    Fills ``rows`` (k, 2, row) = ∂v/∂(photo, camera, kept point), ``ground`` (k, 2, 3) = ∂v/∂X, ``misfit`` (k, 2) = v
    and ``seen`` (k,); returns how many have an image, and ½ Σ ρ.
    """
    pixel, slope, inner = image
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
        root = np.sqrt(weight * layout.weight[o])
        turn = root * side
        misfit[k, 0] = vx * root
        misfit[k, 1] = vy * root
        pose = layout.pose[n]
        free = layout.free_count[c]
        r00 = scene.rotations[n, 0, 0]
        r01 = scene.rotations[n, 0, 1]
        r02 = scene.rotations[n, 0, 2]
        r10 = scene.rotations[n, 1, 0]
        r11 = scene.rotations[n, 1, 1]
        r12 = scene.rotations[n, 1, 2]
        r20 = scene.rotations[n, 2, 0]
        r21 = scene.rotations[n, 2, 1]
        r22 = scene.rotations[n, 2, 2]
        for a in range(2):
            s0 = slope[a, 0] * turn
            s1 = slope[a, 1] * turn
            s2 = slope[a, 2] * turn
            j0 = s0 * r00 + s1 * r10 + s2 * r20
            j1 = s0 * r01 + s1 * r11 + s2 * r21
            j2 = s0 * r02 + s1 * r12 + s2 * r22
            ground[k, a, 0] = j0
            ground[k, a, 1] = j1
            ground[k, a, 2] = j2
            if pose > 0:
                rows[k, a, 0] = s2 * py - s1 * pz
                rows[k, a, 1] = s0 * pz - s2 * px
                rows[k, a, 2] = s1 * px - s0 * py
                rows[k, a, 3] = -j0
                rows[k, a, 4] = -j1
                rows[k, a, 5] = -j2
            for b in range(free):
                rows[k, a, pose + b] = inner[a, layout.free_index[c, b]] * root
            if layout.point_column[i] >= 0:
                rows[k, a, pose + free] = j0
                rows[k, a, pose + free + 1] = j1
                rows[k, a, pose + free + 2] = j2
    return count, cost
