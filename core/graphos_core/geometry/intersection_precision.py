"""How precisely rays from several photos fix a point: the covariance of their intersection."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphos_core.cameras import camera_model, values_of
from graphos_core.data import Camera
from graphos_core.data.record import Array


@dataclass(frozen=True, eq=False)
class IntersectionPrecision:
    """Precision of one intersected point, in the object frame.

    Attributes
    ----------
    covariance : float64 (3, 3)
        Covariance of X, Y, Z in squared object units; infinite entries where a direction is not determined.
    sigmas : float64 (3,)
        Standard deviations along the principal axes of the error ellipsoid, largest first; ``inf`` along a
        direction that the rays do not determine.
    directions : float64 (3, 3)
        Unit vectors of these axes in the object frame, one per row.
    """

    covariance: Array
    sigmas: Array
    directions: Array

    @property
    def determined(self) -> bool:
        """Whether the rays fix the point in all three directions."""
        return bool(np.isfinite(self.sigmas).all())

    @property
    def sigma_xyz(self) -> Array:
        """Standard deviations of X, Y, Z, float64 (3,), object units."""
        return np.sqrt(np.diag(self.covariance))


def image_derivatives(camera: Camera, rotation: Array, centre: Array, point: Array) -> Array | None:
    """Return ∂(x, y)/∂(X, Y, Z), float64 (2, 3) in px per object unit, of one point in one photo.

    Parameters
    ----------
    camera : Camera
    rotation : float64 (3, 3)
        ``cam_from_world``.
    centre, point : float64 (3,)
        Projection centre and point in the object frame.

    Returns
    -------
    float64 (2, 3) or None
        None when the point has no image in this photo.
    """
    from graphos_core.cameras.kernels import project

    x, y, z = np.asarray(rotation) @ (np.asarray(point, dtype=np.float64) - centre)
    values = values_of(camera)
    pixel, d_point, d_values = np.empty(2), np.empty((2, 3)), np.empty((2, len(values)))
    code = camera_model(camera.model).code
    if not project(code, values, float(x), float(y), float(z), pixel, d_point, d_values):
        return None
    return d_point @ np.asarray(rotation)


def intersection_precision(
    cameras: Sequence[Camera],
    rotations: Sequence[Array],
    centres: Sequence[Array],
    point: Array,
    sigma_px: float | Sequence[float],
) -> IntersectionPrecision:
    """Return the precision of a point intersected from photos of known orientation.

    With A the derivatives of all image coordinates by (X, Y, Z) and P = 1/σ², the covariance is (AᵀPA)⁻¹
    (Luhmann et al. 2020, Close-Range Photogrammetry and 3D Imaging, chapter 4,
    spatial intersection). Orientation and calibration are taken as
    free of error.

    Parameters
    ----------
    cameras : sequence of Camera
    rotations : sequence of float64 (3, 3)
        ``cam_from_world`` of each photo.
    centres : sequence of float64 (3,)
        Projection centres in the object frame.
    point : float64 (3,)
        In the object frame; the derivatives are taken here.
    sigma_px : float or sequence of float
        Standard deviation of an image coordinate, px, for all photos or one per photo.

    Returns
    -------
    IntersectionPrecision
        In the unit of `centres`. Directions whose standard deviation exceeds 10⁷ times the smallest are
        reported as not determined.
    """
    sigmas_px = np.broadcast_to(np.asarray(sigma_px, dtype=np.float64), (len(cameras),))
    normal = np.zeros((3, 3))
    for camera, rotation, centre, sigma in zip(cameras, rotations, centres, sigmas_px, strict=True):
        rows = image_derivatives(camera, rotation, centre, point)
        if rows is not None:
            normal += rows.T @ rows / sigma**2
    weights, vectors = np.linalg.eigh(normal)
    known = weights > max(float(weights[-1]), 0.0) * 1e-14
    variances = np.where(known, 1.0 / np.where(known, weights, 1.0), np.inf)
    covariance = (vectors[:, known] * variances[known]) @ vectors[:, known].T
    for vector in vectors[:, ~known].T:
        touched = np.abs(vector) > 1e-9
        covariance[np.outer(touched, touched)] = np.inf
    return IntersectionPrecision(covariance, np.sqrt(variances), vectors.T.copy())


def intersection_angle(centres: Sequence[Array], point: Array) -> float:
    """Return the largest angle between any two rays to `point`, radians, 0 to π.

    Parameters
    ----------
    centres : sequence of float64 (3,)
        Projection centres.
    point : float64 (3,)
        In the frame of the centres.
    """
    rays = [np.asarray(point, dtype=np.float64) - centre for centre in centres]
    largest = 0.0
    for i, a in enumerate(rays):
        for b in rays[i + 1 :]:
            largest = max(largest, float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))
    return largest


def normal_case_sigma_z(height: float, base: float, focal_px: float, sigma_px: float) -> float:
    """Return the standard deviation of the depth in the normal case of stereophotogrammetry.

    ``σ_Z = √2 · H/B · H/f · σ`` for two photos with parallel axes at right angles to the base (Kraus 2007,
    Photogrammetry; the parallax is the difference of two measurements, hence √2).

    Parameters
    ----------
    height, base : float
        Distance from base to point and length of the base, object units.
    focal_px : float
        Principal distance, px.
    sigma_px : float
        Standard deviation of an image coordinate, px.

    Returns
    -------
    float
        Object units; infinite without a base.
    """
    if base == 0.0:
        return np.inf
    return float(np.sqrt(2.0) * height / base * height / focal_px * sigma_px)


def error_ellipse(covariance: Array, probability: float = 0.95, corners: int = 72) -> Array:
    """Return the error ellipse of a plane point as a polygon about the origin, float64 (corners, 2).

    Parameters
    ----------
    covariance : float64 (2, 2)
        Finite.
    probability : float
        That the true point lies inside, for normally distributed errors: semi-axes are the principal standard
        deviations times ``√(−2 ln(1 − probability))`` (Mikhail and Ackermann 1976, Observations and Least
        Squares); 0.3935 gives 1 σ.
    corners : int
    """
    variances, axes = np.linalg.eigh(covariance)
    radii = np.sqrt(np.maximum(variances, 0.0) * -2.0 * np.log(1.0 - probability))
    turn = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    return np.stack([np.cos(turn), np.sin(turn)], axis=1) * radii @ axes.T
