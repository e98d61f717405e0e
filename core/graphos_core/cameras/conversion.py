"""Any camera in any other model: exact where the other can express it, else the best fit over the format.

The rays of a grid of pixels over the format are projected by the other model, and its parameters are fitted to the
pixels by least squares (Levenberg–Marquardt with analytic derivatives). A change of sign or of the direction of the
model is only a first-order inverse; the fit has no such error, and what it leaves is reported in px.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from graphos_core.cameras.model import CameraModel, camera_model, derivatives, pixel_from_ray, ray_from_pixel
from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.text import Text

EXACT_PX = 1e-6
"""A conversion that is nowhere off by more counts as exact."""

GRID = (41, 31)
"""Pixels across and down on which a conversion is fitted and judged."""

STEEPEST = 0.087
"""cos 85°: rays farther from the axis are not given to a central-perspective model."""


@dataclass(frozen=True)
class Conversion:
    """A camera in another model, and how far it is from the original.

    Attributes
    ----------
    camera : Camera
    pixels : float64 (n, 2)
        The grid over the format, row by row.
    residuals : float64 (n, 2)
        Converted minus original position of the same ray, px; NaN where one of the models has no image.
    """

    camera: Camera
    pixels: Array
    residuals: Array

    @property
    def max_px(self) -> float:
        """Largest distance between converted and original position."""
        return float(np.nanmax(np.hypot(*self.residuals.T), initial=0.0))

    @property
    def rms_px(self) -> float:
        """Root mean square of the residuals per coordinate."""
        return float(np.sqrt(np.nanmean(self.residuals**2)))

    @property
    def covered(self) -> float:
        """Share of the format on which both models project."""
        return float(np.isfinite(self.residuals[:, 0]).mean())

    @property
    def exact(self) -> bool:
        """Whether the conversion is exact to 1e-6 px over the whole format."""
        return self.covered == 1.0 and self.max_px <= EXACT_PX


def format_grid(camera: Camera, size: tuple[int, int] = GRID) -> Array:
    """Return (n, 2) pixels over the whole format, corner to corner, row by row.

    Raises
    ------
    UserError
        When the format of the camera is not known.
    """
    if camera.width <= 0 or camera.height <= 0:
        raise UserError(
            Text("The format of the camera {camera} is not known.", camera=camera.label or camera.model),
            "A camera model is judged and converted over the format of the photo.",
            "Give width and height of the photo in pixels.",
        )
    x = np.linspace(-0.5, camera.width - 0.5, size[0])
    y = np.linspace(-0.5, camera.height - 0.5, size[1])
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def convert(camera: Camera, name: str, *, free: Sequence[str] | None = None) -> Conversion:
    """Return the camera in the model `name`.

    Values that mean the same are carried over; when that is not exact, the default-free and the carried parameters
    are fitted, then all of them, and the simplest model that does it is kept.

    Parameters
    ----------
    camera : Camera
        With `Camera.before`, the whole chain is converted into one model.
    name : str
    free : sequence of str, optional
        Names of the parameters to fit instead; the others keep the carried value.

    Raises
    ------
    UserError
        When the format is not known, or the models have no ray in common.
    """
    pixels = format_grid(camera)
    target = camera_model(name)
    start = _carried(camera, target)
    rays = ray_from_pixel(camera, pixels)
    if not target.wide:
        with np.errstate(invalid="ignore"):
            rays[~(rays[:, 2] > STEEPEST * np.linalg.norm(rays, axis=1))] = np.nan
    if not np.isfinite(rays).any():
        raise UserError(
            Text("The camera cannot be converted to the model {model}.", model=target.label),
            "Not one ray of its format has an image in that model.",
            "Choose a fish-eye or spherical model.",
        )
    best = Conversion(start, pixels, _residuals(start, rays, pixels))
    for names in [tuple(free)] if free is not None else _stages(start, target):
        if best.exact or (best.covered < 1.0 and best.max_px <= EXACT_PX):
            break
        fitted = fit_camera(best.camera, rays, pixels, names)
        tried = Conversion(fitted, pixels, _residuals(fitted, rays, pixels))
        if tried.rms_px < 0.99 * best.rms_px:
            best = tried
    return best if best.exact else replace(best, camera=replace(best.camera, sigmas=None))


def as_model(camera: Camera, name: str) -> Camera:
    """Return the camera with its own model changed to `name`, for a start; `Camera.before` stays as it is.

    Raises
    ------
    UserError
        As `convert`.
    """
    if camera.model == name:
        return camera
    own = replace(camera, before=())
    if camera.width <= 0 and not _lost(own, camera_model(name)):
        return replace(_carried(own, camera_model(name)), before=camera.before)
    return replace(convert(own, name).camera, before=camera.before)


def _carried(camera: Camera, target: CameraModel) -> Camera:
    """Return a camera of the other model with the values, and σ, of the parameters that mean the same."""
    source = camera_model(camera.model)
    index = {p.meaning: k for k, p in enumerate(source.parameters) if p.meaning}
    values = np.zeros(len(target.parameters))
    sigmas = np.zeros(len(target.parameters))
    for k, parameter in enumerate(target.parameters):
        if parameter.default == "constant":
            values[k] = 0.5 * max(camera.width, camera.height) or parameter.usual
        if parameter.meaning in index:
            values[k] = camera.values[index[parameter.meaning]]
            if camera.sigmas is not None:
                sigmas[k] = camera.sigmas[index[parameter.meaning]]
    known = camera.sigmas is not None and not _lost(camera, target) and not camera.before
    return replace(camera, model=target.name, values=values, sigmas=sigmas if known else None, before=())


def _lost(camera: Camera, target: CameraModel) -> bool:
    """Say whether carrying values over loses something: another projection or direction, or a value without home."""
    source, known = camera_model(camera.model), {p.meaning for p in target.parameters}
    pairs = zip(source.parameters, camera.values, strict=True)
    terms = [p for p, v in pairs if v != 0.0 and p.group != "interior" and p.default != "constant"]
    turned = source.projection != target.projection or (source.backward != target.backward and bool(terms))
    return turned or any(p.meaning not in known for p in terms)


def _stages(start: Camera, target: CameraModel) -> list[tuple[str, ...]]:
    """Return the sets of parameters to fit, the simple one first; a distortion centre only where there was one."""
    pairs = list(zip(target.parameters, start.values, strict=True))
    movable = [(p, v) for p, v in pairs if p.default != "constant" and (p.group != "centre" or v != 0.0)]
    interior = tuple(p.name for p, v in movable if p.default == "free" or p.group == "interior" or v != 0.0)
    return [interior, tuple(p.name for p, _ in movable)]


def _residuals(camera: Camera, rays: Array, pixels: Array) -> Array:
    return pixel_from_ray(camera, rays) - pixels


def fit_camera(start: Camera, rays: Array, pixels: Array, free: Sequence[str]) -> Camera:
    """Fit parameters so that the camera images the rays at the pixels, by Levenberg–Marquardt.

    Columns are scaled to the same length, so parameters of any unit mix.

    Parameters
    ----------
    start : Camera
        Its own model is fitted; `Camera.before` is left out of account.
    rays : float64 (n, 3)
        Directions in the camera frame; rows with NaN are not used.
    pixels : float64 (n, 2)
    free : sequence of str
        Names of the parameters to fit; the others keep their value.

    Returns
    -------
    Camera
        With ``sigmas`` None when anything changed.
    """
    target = camera_model(start.model)
    index = [target.index(name) for name in free]
    use = np.isfinite(rays[:, 0])
    rays, pixels = np.ascontiguousarray(rays[use]), pixels[use]
    camera, damping = start, 1e-3
    seen, residual, slope = _linear(camera, rays, pixels, index)
    cost = _cost(residual)
    for _ in range(100):
        scale = np.maximum(np.linalg.norm(slope, axis=0), 1e-300)
        damped = np.concatenate([slope / scale, np.sqrt(damping) * np.eye(len(index))])
        step = (
            np.linalg.lstsq(damped, np.concatenate([-residual, np.zeros(len(index))]), rcond=1e-15)[0] / scale
        )
        values = np.array(camera.values)
        values[index] += step
        tried = replace(camera, values=values, sigmas=None)
        now_seen, now_residual, now_slope = _linear(tried, rays, pixels, index)
        if now_seen >= seen and (_cost(now_residual) < cost or seen < now_seen):
            gain = cost - _cost(now_residual)
            camera, seen, residual, slope = tried, now_seen, now_residual, now_slope
            cost, damping = _cost(residual), max(damping * 0.1, 1e-20)
            if abs(gain) <= 1e-12 * cost or cost < 1e-24:
                break
        else:
            damping *= 10.0
            if damping > 1e6:
                break
    return camera


def _cost(residual: Array) -> float:
    return float(residual @ residual) / max(len(residual), 1)


def _linear(camera: Camera, rays: Array, pixels: Array, free: list[int]) -> tuple[int, Array, Array]:
    """Return how many rays have an image, their residuals (2m,) and derivatives (2m, free)."""
    projected, _, by_values = derivatives(camera, rays)
    use = np.isfinite(projected[:, 0])
    residual = (projected - pixels)[use].ravel()
    return int(use.sum()), residual, by_values[use][:, :, free].reshape(len(residual), len(free))
