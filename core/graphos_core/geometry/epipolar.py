r"""Epipolar geometry: essential and fundamental matrices, lines, epipoles, distances.

Relative orientation is ``b_from_a``: ``p_b = R p_a + t`` with ``R = R_b R_aᵀ`` and ``t = R_b (C_a − C_b)``. Rays
``y = (X/Z, Y/Z, 1)`` in the camera frames satisfy ``y_bᵀ E y_a = 0``, distortion-free pixels ``x_bᵀ F x_a = 0``.
Source: Hartley and Zisserman 2004, chapter 9 and section 11.4.3.
"""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Array, Camera
from graphos_core.geometry.rotation import skew


def relative_orientation(
    rotation_a: Array, centre_a: Array, rotation_b: Array, centre_b: Array
) -> tuple[Array, Array]:
    """Return R (3, 3) and t (3,) of ``b_from_a`` from two exterior orientations (``cam_from_world``, centre)."""
    rotation = np.asarray(rotation_b) @ np.asarray(rotation_a).T
    return rotation, np.asarray(rotation_b) @ (np.asarray(centre_a) - np.asarray(centre_b))


def essential_from_relative(rotation: Array, translation: Array) -> Array:
    """Return ``E = [t]× R`` (3, 3) with t scaled to length 1; zeros for t = 0, where there is no epipolar geometry."""
    translation = np.asarray(translation, dtype=np.float64)
    length = float(np.linalg.norm(translation))
    if length == 0.0:
        return np.zeros((3, 3))
    return skew(translation / length) @ np.asarray(rotation)


def interior_matrix(camera: Camera) -> Array:
    """Return K (3, 3) of the camera without its distortion: pixels from rays."""
    f, x0, y0 = (float(value) for value in camera.values[:3])
    return np.array([[f, 0.0, x0], [0.0, f, y0], [0.0, 0.0, 1.0]])


def fundamental_from_essential(essential: Array, camera_a: Camera, camera_b: Camera) -> Array:
    """Return ``F = K_b⁻ᵀ E K_a⁻¹`` (3, 3) for distortion-free pixels, scaled to Frobenius norm 1."""
    inverse_a, inverse_b = np.linalg.inv(interior_matrix(camera_a)), np.linalg.inv(interior_matrix(camera_b))
    fundamental = inverse_b.T @ np.asarray(essential) @ inverse_a
    norm = float(np.linalg.norm(fundamental))
    return fundamental / norm if norm > 0.0 else fundamental


def fundamental_from_cameras(
    camera_a: Camera,
    rotation_a: Array,
    centre_a: Array,
    camera_b: Camera,
    rotation_b: Array,
    centre_b: Array,
) -> Array:
    """Return F (3, 3) of two oriented photos for distortion-free pixels; zeros for equal centres.

    Parameters
    ----------
    camera_a, camera_b : Camera
        Only f, x0, y0 are used.
    rotation_a, rotation_b : float64 (3, 3)
        ``cam_from_world``.
    centre_a, centre_b : float64 (3,)
        Projection centres, world frame.
    """
    rotation, translation = relative_orientation(rotation_a, centre_a, rotation_b, centre_b)
    return fundamental_from_essential(essential_from_relative(rotation, translation), camera_a, camera_b)


def epipolar_lines(fundamental: Array, xy: Array, *, into_a: bool = False) -> Array:
    """Return the epipolar lines of points: (n, 3) with ``l₀ x + l₁ y + l₂ = 0`` and (l₀, l₁) of length 1.

    Parameters
    ----------
    fundamental : float64 (3, 3)
    xy : float64 (n, 2)
        Points in a, or in b when `into_a`.
    into_a : bool
        Give the lines in a of points in b.
    """
    matrix = np.asarray(fundamental).T if into_a else np.asarray(fundamental)
    points = np.asarray(xy, dtype=np.float64).reshape(-1, 2)
    lines = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    norm = np.hypot(lines[:, 0], lines[:, 1])[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):  # the epipole itself has no line: NaN
        return np.asarray(lines / np.where(norm > 0.0, norm, np.nan))


def line_transfer(fundamental_a: Array, fundamental_b: Array, a: Array, b: Array) -> Array:
    """Return where points seen in a and b lie in c: the intersection of both epipolar lines, homogeneous (n, 3).

    ``x_c ~ (F_ca x_a) × (F_cb x_b)``. Both lines are one where the point lies in the plane of the three projection
    centres: the result is then zero or noise (Hartley and Zisserman 2004, section 15.3.1).

    Parameters
    ----------
    fundamental_a, fundamental_b : float64 (3, 3)
        From a to c and from b to c, for pixels or for rays as the points are.
    a, b : float64 (n, 3)
        Homogeneous points, or rays.
    """
    return np.cross(np.asarray(a) @ np.asarray(fundamental_a).T, np.asarray(b) @ np.asarray(fundamental_b).T)


def epipolar_circle(essential: Array, ray: Array, count: int, *, into_a: bool = False) -> Array:
    """Return directions (count, 3) all round the epipolar plane of one ray: what becomes a curve in a fish-eye photo.

    Parameters
    ----------
    essential : float64 (3, 3)
    ray : float64 (3,)
        In a, or in b when `into_a`.
    """
    normal = (np.asarray(essential).T if into_a else np.asarray(essential)) @ np.asarray(ray)
    plane = np.linalg.svd(normal[None])[2][1:]
    angle = np.linspace(0.0, 2.0 * np.pi, count)
    return np.asarray(np.column_stack([np.cos(angle), np.sin(angle)]) @ plane)


def epipoles(fundamental: Array) -> tuple[Array, Array]:
    """Return the epipoles in a and in b as homogeneous points (3,) of length 1 with third component ≥ 0.

    ``F e_a = 0`` and ``Fᵀ e_b = 0``; a third component near 0 means an epipole at infinity.
    """
    left, _, right = np.linalg.svd(np.asarray(fundamental, dtype=np.float64))
    pair = (right[2], left[:, 2])
    return tuple(e if e[2] >= 0.0 else -e for e in pair)  # type: ignore[return-value]


def line_distances(fundamental: Array, xy_a: Array, xy_b: Array) -> tuple[Array, Array]:
    """Return the distance of each point from the epipolar line of its partner: in a (n,) and in b (n,), px."""
    return (
        _point_line(epipolar_lines(fundamental, xy_b, into_a=True), xy_a),
        _point_line(epipolar_lines(fundamental, xy_a), xy_b),
    )


def sampson_distances(fundamental: Array, xy_a: Array, xy_b: Array) -> Array:
    """Return the Sampson distance (n,), px: the first-order distance of a match from fulfilling ``x_bᵀ F x_a = 0``.

    ``|x_bᵀ F x_a| / √((F x_a)₁² + (F x_a)₂² + (Fᵀ x_b)₁² + (Fᵀ x_b)₂²)`` (Hartley and Zisserman 2004, eq. 11.9).
    """
    a = np.column_stack([xy_a, np.ones(len(xy_a))])
    b = np.column_stack([xy_b, np.ones(len(xy_b))])
    in_b, in_a = a @ np.asarray(fundamental).T, b @ np.asarray(fundamental)
    residual = np.abs(np.einsum("ij,ij->i", b, in_b))
    slope = np.sqrt(in_b[:, 0] ** 2 + in_b[:, 1] ** 2 + in_a[:, 0] ** 2 + in_a[:, 1] ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(residual / slope)


def epipolar_curve(
    xy: Array,
    camera_a: Camera,
    rotation_a: Array,
    centre_a: Array,
    camera_b: Camera,
    rotation_b: Array,
    centre_b: Array,
    depths: Array,
) -> Array:
    """Return the image in b of the ray of one pixel of a, at the given depths: the epipolar line bent by distortion.

    Parameters
    ----------
    xy : float64 (2,)
        Measured pixel in a.
    camera_a, camera_b : Camera
        With distortion.
    rotation_a, rotation_b : float64 (3, 3)
        ``cam_from_world``.
    centre_a, centre_b : float64 (3,)
        World frame.
    depths : float64 (n,)
        z in the frame of camera a, in the unit of the centres.

    Returns
    -------
    float64 (n, 2)
        Measured pixels in b; NaN where the point lies behind b.
    """
    ray = ray_from_pixel(camera_a, np.asarray(xy, dtype=np.float64).reshape(1, 2))[0]
    world = (np.asarray(depths)[:, None] * ray) @ np.asarray(rotation_a) + np.asarray(centre_a)
    return pixel_from_ray(camera_b, (world - np.asarray(centre_b)) @ np.asarray(rotation_b).T)


def _point_line(lines: Array, xy: Array) -> Array:
    return np.asarray(np.abs(lines[:, 0] * xy[:, 0] + lines[:, 1] * xy[:, 1] + lines[:, 2]))
