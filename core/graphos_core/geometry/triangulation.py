"""Points from rays: spatial intersection of any number of rays, many points at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry import triangulation_kernels as kernels
from graphos_core.geometry.rays import Rays, ideal_rays


@dataclass(frozen=True)
class Triangulation:
    """Intersected points.

    Attributes
    ----------
    points : float64 (p, 3)
        Object frame, in the unit of the projection centres; meaningless where not `ok`.
    angles : float64 (p,)
        Largest intersection angle of two used rays, radians; 0 where none.
    ok : bool (p,)
        Whether the point was found: more than half of its rays are used (two or more), it lies in front of their
        cameras, and the angle is large enough.
    used : bool (m,)
        Which rays took part; none of a point that is not `ok`.
    """

    points: Array
    angles: Array
    ok: Array
    used: Array


def intersect_rays(
    start: Array,
    photo: Array,
    rays: Rays,
    rotations: Array,
    centres: Array,
    *,
    threshold_px: float = np.inf,
    min_angle: float = 0.0,
) -> Triangulation:
    """Intersect the rays of many points, of any cameras.

    The point nearest to all rays (linear, ``Σ(I − d dᵀ)(X − C) = 0``) is refined by Gauss–Newton on the distances in
    the planes of the rays. If a ray misses the result by more than the threshold, the point that most rays agree
    with is sought among the intersections of pairs of rays and refined with those rays (Hartley and Zisserman
    2004, sections 12.2 and 12.3).

    Parameters
    ----------
    start : int (p + 1,)
        Rays ``start[i]`` to ``start[i + 1]`` belong to point i.
    photo : int (m,)
        Photo of each ray.
    rays : Rays
        In the camera frames, all valid.
    rotations : float64 (n, 3, 3)
        ``cam_from_world``.
    centres : float64 (n, 3)
        Projection centres in the object frame.
    threshold_px : float
        Largest distance of a used ray from its point, px.
    min_angle : float
        Smallest admissible value of the largest intersection angle, radians.

    Returns
    -------
    Triangulation
    """
    start = np.ascontiguousarray(start, dtype=np.int64)
    photo = np.ascontiguousarray(photo, dtype=np.int32)
    count = len(start) - 1
    points, angles = np.zeros((count, 3)), np.zeros(count)
    used, ok = np.zeros(len(photo), dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    world, frames = kernels.turn(photo, _float(rays.directions), _float(rays.frames), _float(rotations))
    kernels.triangulate_many(
        start, photo, world, frames, _float(centres), float(threshold_px) ** 2, float(min_angle), points, angles,
        used, ok,
    )  # fmt: skip
    return Triangulation(points, angles, ok, used)


def triangulate(
    start: Array,
    photo: Array,
    rays: Array,
    focal: Array,
    rotations: Array,
    centres: Array,
    *,
    threshold_px: float = np.inf,
    min_angle: float = 0.0,
) -> Triangulation:
    """Intersect central rays given by ideal image coordinates x/z, y/z (m, 2); see `intersect_rays`.

    Parameters
    ----------
    focal : float64 (n,)
        Principal distance of each photo, px: turns distances of rays into pixels.
    """
    return intersect_rays(
        start, photo, ideal_rays(rays, np.asarray(focal)[photo]), rotations, centres, threshold_px=threshold_px,
        min_angle=min_angle,
    )  # fmt: skip


def intersection_angles(start: Array, photo: Array, used: Array, centres: Array, points: Array) -> Array:
    """Return the largest intersection angle (p,) of each point over its used rays, radians; see `triangulate`."""
    return kernels.intersection_angles(
        np.ascontiguousarray(start, dtype=np.int64),
        np.ascontiguousarray(photo, dtype=np.int32),
        np.ascontiguousarray(used, dtype=np.bool_),
        _float(centres),
        _float(points),
    )


def distances_px(
    point: Array, photo: Array, rays: Rays, rotations: Array, centres: Array, points: Array
) -> Array:
    """Return the distance (m,) of every ray from its point in the plane of the ray, px; infinite behind it.

    Parameters
    ----------
    point, photo : int (m,)
        Point and photo of each ray.
    rays, rotations, centres : Rays and arrays
        As in `intersect_rays`.
    points : float64 (p, 3)
    """
    photo = np.ascontiguousarray(photo, dtype=np.int32)
    _, frames = kernels.turn(photo, _float(rays.directions), _float(rays.frames), _float(rotations))
    return np.sqrt(
        kernels.squared_errors(
            np.ascontiguousarray(point, dtype=np.int64), photo, frames, _float(centres), _float(points)
        )
    )


def ray_distances_px(
    point: Array, photo: Array, rays: Array, focal: Array, rotations: Array, centres: Array, points: Array
) -> Array:
    """Return the distance (m,) of central rays, given as x/z, y/z (m, 2), from their points; see `distances_px`."""
    return distances_px(point, photo, ideal_rays(rays, np.asarray(focal)[photo]), rotations, centres, points)


def _float(values: Array) -> Array:
    return np.ascontiguousarray(values, dtype=np.float64)
