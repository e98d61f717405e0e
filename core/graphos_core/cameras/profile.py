r"""Distortion as people look at it: radial profile, Gaussian and balanced, decentring profile, grid, uncertainty.

Everything is taken from the camera's own model, so every model has a profile; `Camera.before` is not in it. A displacement is measured minus ideal
position, px, of the same ray; the ideal position is that of the model with its distortion set to 0, so for central
perspective the ideal radius is r = f tan θ. Standard deviations are propagated from the covariance of the camera's
parameters with the analytic derivatives, at fixed direction of the ray.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.cameras.chain import without_distortion
from graphos_core.cameras.conversion import format_grid
from graphos_core.cameras.model import camera_model, derivatives, last_pixel_from_ray, last_ray_from_pixel
from graphos_core.cameras.projections import REACH, ideal_direction, on_sphere
from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array

AZIMUTHS = 36
"""Directions round the principal point over which a profile is taken."""

BALANCE_SHARE = 2.0 / 3.0
"""Share of the half diagonal at which balanced distortion is zero by default (Wester-Ebbinghaus 1981)."""


@dataclass(frozen=True)
class Profile:
    """A distortion curve over the radius.

    Attributes
    ----------
    radius_px : float64 (n,)
        Ideal distance from the principal point.
    displacement_px : float64 (n,)
    sigma_px : float64 (n,) or None
        Its standard deviation; None without a covariance.
    focal_px : float
        Principal distance to which the curve belongs: f, or the balanced one.
    """

    radius_px: Array
    displacement_px: Array
    sigma_px: Array | None
    focal_px: float

    def band(self, factor: float = 1.96) -> tuple[Array, Array]:
        """Return lower and upper limit of the confidence band; `factor` 1.96 for 95 %, 2.576 for 99 %.

        Raises
        ------
        ValueError
            When the profile has no standard deviations.
        """
        if self.sigma_px is None:
            raise ValueError("a profile without covariance has no band")
        return self.displacement_px - factor * self.sigma_px, self.displacement_px + factor * self.sigma_px


def half_diagonal(camera: Camera) -> float:
    """Return half the diagonal of the format, px."""
    return 0.5 * float(np.hypot(camera.width, camera.height))


def radii(camera: Camera, count: int = 101) -> Array:
    """Return radii from 0 to the corner of the format that is farthest from the principal point, px."""
    x0, y0 = camera.values[1:3]
    reach = np.hypot(max(x0, camera.width - x0), max(y0, camera.height - y0))
    return np.linspace(0.0, float(reach), count)


def radial_profile(
    camera: Camera, covariance: Array | None = None, *, radius_px: Array | None = None
) -> Profile:
    """Return the Gaussian radial profile: the radial displacement, mean over all directions, with f as it is.

    For Brown's polynomial Δr = k1 r³/f² + k2 r⁵/f⁴ + … (Brown 1971).

    Parameters
    ----------
    camera : Camera
    covariance : float64 (k, k), optional
        Of the parameters of the camera in the order of its model, zeros where a parameter is held fixed.
    radius_px : float64 (n,), optional
        Ideal radii; by default 101 from 0 to the farthest corner.
    """
    radius = radii(camera) if radius_px is None else np.asarray(radius_px, dtype=np.float64)
    across, _, slopes, _ = _around(camera, radius)
    value, slope = across.mean(axis=1), slopes.mean(axis=1)
    return Profile(radius, value, _sigma(slope, covariance), camera.focal_px)


def balanced_profile(
    camera: Camera,
    covariance: Array | None = None,
    *,
    zero_px: float | None = None,
    radius_px: Array | None = None,
) -> Profile:
    """Return the balanced radial profile: zero at a chosen radius, where a changed principal distance takes it up.

    A ray has r + Δr = r (1 + a) + (Δr − a r) with a = Δr(r0)/r0, so with the balanced principal distance
    f' = f (1 + a) the distortion that is left is Δr' = Δr − r Δr(r0)/r0. For Brown's polynomial that is
    k1 r (r² − r0²)/f² + … (Wester-Ebbinghaus 1981; Luhmann et al. 2020, Close-Range Photogrammetry and 3D
    Imaging, chapter 3). The sum of both, and
    with it every position, is the same.

    Parameters
    ----------
    camera, covariance, radius_px
        As `radial_profile`.
    zero_px : float, optional
        The radius r0; by default two thirds of half the diagonal.
    """
    reach = min(half_diagonal(camera), camera.focal_px * REACH[camera_model(camera.model).projection])
    zero = BALANCE_SHARE * reach if zero_px is None else float(zero_px)
    radius = radii(camera) if radius_px is None else np.asarray(radius_px, dtype=np.float64)
    across, _, slopes, _ = _around(camera, np.append(radius, zero))
    value, slope = across.mean(axis=1), slopes.mean(axis=1)
    share = value[-1] / zero
    left = value[:-1] - radius * share
    left_slope = slope[:-1] - (radius / zero)[:, None] * slope[-1]
    return Profile(radius, left, _sigma(left_slope, covariance), camera.focal_px * (1.0 + share))


def decentring_profile(
    camera: Camera, covariance: Array | None = None, *, radius_px: Array | None = None
) -> Profile:
    """Return the decentring profile P(r): amplitude of the tangential displacement once round the principal point.

    For Brown's terms P(r) = √(p1² + p2²) r²/f; the radial part is three times as large (Brown 1966, Decentering
    distortion of lenses). Where P is 0 its σ is that of the larger of its two components.

    Parameters
    ----------
    camera, covariance, radius_px
        As `radial_profile`.
    """
    radius = radii(camera) if radius_px is None else np.asarray(radius_px, dtype=np.float64)
    _, along, _, slopes = _around(camera, radius)
    angle = _azimuths()
    waves = 2.0 * np.stack([np.cos(angle), np.sin(angle)]) / AZIMUTHS
    parts = np.einsum("wa,ra->rw", waves, along)
    amplitude = np.hypot(parts[:, 0], parts[:, 1])
    if covariance is None:
        return Profile(radius, amplitude, None, camera.focal_px)
    part_slopes = np.einsum("wa,rak->rwk", waves, slopes)
    spread = part_slopes @ covariance @ part_slopes.transpose(0, 2, 1)
    towards = parts / np.where(amplitude > 0.0, amplitude, 1.0)[:, None]
    variance = np.where(
        amplitude > 1e-12,
        np.einsum("ri,rij,rj->r", towards, spread, towards),
        np.linalg.eigvalsh(spread)[:, -1],
    )
    return Profile(radius, amplitude, np.sqrt(np.maximum(variance, 0.0)), camera.focal_px)


@dataclass(frozen=True)
class FormatGrid:
    """Positions over the format.

    Attributes
    ----------
    ideal_px, measured_px : float64 (rows, columns, 2)
        Position without and with distortion; NaN where a ray has no image.
    """

    ideal_px: Array
    measured_px: Array

    @property
    def displacement_px(self) -> Array:
        """Measured minus ideal position, (rows, columns, 2)."""
        return self.measured_px - self.ideal_px


def distortion_grid(camera: Camera, size: tuple[int, int] = (25, 19)) -> FormatGrid:
    """Return a regular grid of ideal positions over the format and where the camera images their rays.

    Parameters
    ----------
    camera : Camera
    size : tuple of int
        Columns and rows.

    Raises
    ------
    UserError
        When the format is not known.
    """
    ideal = format_grid(camera, size)
    measured = last_pixel_from_ray(camera, last_ray_from_pixel(without_distortion(camera), ideal))
    shape = (size[1], size[0], 2)
    return FormatGrid(ideal.reshape(shape), measured.reshape(shape))


def projection_covariance(
    camera: Camera, covariance: Array, size: tuple[int, int] = (25, 19)
) -> tuple[Array, Array]:
    """Return how well the interior orientation fixes the position of a ray's image, over the format.

    C = A Σ Aᵀ with A = ∂pixel/∂parameters at a fixed direction of the ray. The exterior orientation takes part of it
    up in practice (x0 and a tilt, f and the distance): this is the uncertainty of the calibration used elsewhere.

    Parameters
    ----------
    camera : Camera
    covariance : float64 (k, k)
        Of the parameters of the camera.
    size : tuple of int
        Columns and rows.

    Returns
    -------
    pixels : float64 (rows, columns, 2)
    covariances : float64 (rows, columns, 2, 2)
        px²; the semi-axes of the error ellipse are the roots of its eigenvalues. NaN where a pixel has no ray.
    """
    pixels = format_grid(camera, size)
    _, _, slopes = derivatives(camera, last_ray_from_pixel(camera, pixels))
    spread = slopes @ covariance @ slopes.transpose(0, 2, 1)
    return pixels.reshape(size[1], size[0], 2), spread.reshape(size[1], size[0], 2, 2)


def largest_effects(camera: Camera, changes: Array) -> dict[str, float]:
    """Return, for each parameter, how far a change of it moves the image of a ray at most over the format, px.

    First-order effect of the parameter itself, whatever other unknowns do about it; with standard deviations as
    changes it says which parameter a block hardly determines.

    Parameters
    ----------
    camera : Camera
    changes : float64 (k,)
        In the units of the parameters.
    """
    rays = last_ray_from_pixel(camera, format_grid(camera, (21, 21)))
    _, _, slopes = derivatives(camera, rays[np.isfinite(rays[:, 0])])
    effect = np.linalg.norm(slopes, axis=1).max(axis=0, initial=0.0)
    names = camera_model(camera.model).names
    return {name: float(e) for name, e in zip(names, effect * np.abs(changes), strict=True)}


def _azimuths() -> Array:
    return 2.0 * np.pi * np.arange(AZIMUTHS) / AZIMUTHS


def _around(camera: Camera, radius: Array) -> tuple[Array, Array, Array, Array]:
    """Return radial and tangential displacement (r, a) and their derivatives by the parameters (r, a, k)."""
    angle = _azimuths()
    out = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    position = (radius[:, None, None] / camera.focal_px) * out
    flat = position.reshape(-1, 2)
    model = camera_model(camera.model)
    if model.wide:
        rays = ideal_direction(model.projection, flat)
        rays[~on_sphere(model.projection, flat)] = np.nan
    else:
        rays = np.concatenate([flat, np.ones((len(flat), 1))], axis=1)
    pixels, _, slopes = derivatives(camera, rays)
    moved = (pixels - camera.values[1:3] - camera.focal_px * flat).reshape(*position.shape)
    slopes = slopes.reshape(*position.shape, -1).copy()
    slopes[..., 0] -= position
    slopes[..., 0, 1] -= 1.0
    slopes[..., 1, 2] -= 1.0
    side = np.stack([-out[:, 1], out[:, 0]], axis=1)
    return (
        np.einsum("rai,ai->ra", moved, out),
        np.einsum("rai,ai->ra", moved, side),
        np.einsum("raik,ai->rak", slopes, out),
        np.einsum("raik,ai->rak", slopes, side),
    )


def _sigma(slope: Array, covariance: Array | None) -> Array | None:
    if covariance is None:
        return None
    return np.sqrt(np.maximum(np.einsum("rk,kl,rl->r", slope, covariance, slope), 0.0))
