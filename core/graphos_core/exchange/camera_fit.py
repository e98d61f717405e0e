"""Conversion between other programs' camera formulas and our camera models, by fitting over the format.

A conversion is never a sign flip or a list of renamed coefficients: the parameters of the target are fitted to the
positions of a grid of pixels, so whatever the target can express comes out exactly (to rounding), and what it cannot is
a residual in px at every pixel of the grid. Parameters that the target cannot separate (a distortion centre without
distortion) stay where the fit starts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from graphos_core.cameras import camera_model, camera_models, pixel_from_ray, ray_from_pixel
from graphos_core.data import Array, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.camera_numerics import directions, fit, invert, rounded
from graphos_core.exchange.formulas import ForeignCamera, Format, Formula, formula
from graphos_core.text import Text

EXACT_PX = 1e-6
"""Largest residual over the format of a conversion that is called exact, px."""

POINTS = 25
"""Pixels of the grid along each side of the format."""

FISHEYES = ("equidistant", "equisolid")
"""Projections of our models that take directions beyond 90° from the axis."""

Target = TypeVar("Target")


@dataclass(frozen=True)
class Conversion(Generic[Target]):
    """A converted camera and what is left over.

    Attributes
    ----------
    camera : Camera or ForeignCamera
    pixels : float64 (n, 2)
        Grid over the format, px; only pixels that the source maps one to one.
    residuals : float64 (n, 2)
        Position in the target − position in the source of the same direction, px.
    without_image : int
        Pixels of the grid whose direction in the source has no image in the target.
    """

    camera: Target
    pixels: Array
    residuals: Array
    without_image: int

    @property
    def max_px(self) -> float:
        """Largest distance, px; 0 for an empty grid."""
        return float(np.hypot(*self.residuals.T).max(initial=0.0))

    @property
    def rms_px(self) -> float:
        """Root mean square per coordinate, px."""
        return float(np.sqrt((self.residuals**2).mean())) if self.residuals.size else 0.0

    @property
    def exact(self) -> bool:
        """Whether the target expresses the source, over the whole format."""
        return self.max_px <= EXACT_PX and not self.without_image

    def says(self, source: str, target: str) -> str:
        """Say in one sentence what the conversion costs."""
        if self.without_image:
            return Text(
                "{source} → {target}: {lost} of {all} sampled pixels cannot be expressed; of the others the largest difference "
                "is {worst:.3g} px, RMS {rms:.3g} px per coordinate.",
                source=source, target=target, lost=self.without_image, all=self.without_image + len(self.pixels),
                worst=self.max_px, rms=self.rms_px,
            )  # fmt: skip
        if self.exact:
            return Text("{source} → {target}: exact (largest difference {px:.1e} px over the format).",
                        source=source, target=target, px=self.max_px)  # fmt: skip
        return Text(
            "{source} → {target}: approximated; differences up to {worst:.3g} px, RMS {rms:.3g} px per coordinate.",
            source=source, target=target, worst=self.max_px, rms=self.rms_px,
        )  # fmt: skip


def pixel_grid(frame: Format, points: int = POINTS) -> Array:
    """Return pixels (points², 2) over the whole format, corner to corner."""
    x = np.linspace(-0.5, frame.width - 0.5, points)
    y = np.linspace(-0.5, frame.height - 0.5, points)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def format_of(camera: Camera) -> Format:
    """Return the format of a camera of ours.

    Raises
    ------
    UserError
        When the format is unknown: a conversion needs to know where it has to hold.
    """
    if camera.width <= 0 or camera.height <= 0:
        raise UserError(
            Text("The camera {name} cannot be converted.", name=camera.label or camera.model),
            "Its format in pixels is not known, and a conversion is fitted over the format.",
            "Give the width and height of its photos.",
        )
    return Format(camera.width, camera.height, camera.pixel_pitch_mm)


def to_foreign(camera: Camera, name: str) -> Conversion[ForeignCamera]:
    """Convert a camera of ours to a formula of another program.

    Raises
    ------
    UserError
        When the formula needs the pixel size and the camera has none, or the format is unknown.
    """
    target, frame = formula(name), format_of(camera)
    if target.needs_pitch and frame.pitch_mm is None:
        raise UserError(
            Text("The camera cannot be written in millimetres for {name}.", name=name),
            "The size of its pixels on the sensor is not known.",
            "Give the pixel size, or the size of the sensor.",
        )
    pixels = pixel_grid(frame)
    rays = ray_from_pixel(camera, pixels)
    directed = np.isfinite(rays).all(axis=1)
    seen = directed & (target.wide | (rays[:, 2] > 0))
    start = target.start(camera.focal_px, _principal(camera), frame)
    free = np.array([p not in target.constants for p in target.parameters])
    used = seen & _every_other(len(pixels))
    residual = _foreign_residual(target, frame, camera, pixels[used], rays[used])
    values = rounded(residual, fit(residual, start, free))
    made = ForeignCamera(name, values, frame, camera.label)
    left = _difference(target, made, camera, pixels[seen], rays[seen])
    good = np.isfinite(left).all(axis=1)
    return Conversion(made, pixels[seen][good], left[good], int(directed.sum() - good.sum()))


def from_foreign(source: ForeignCamera, model: str = "") -> Conversion[Camera]:
    """Convert a camera of another program to one of our models.

    Parameters
    ----------
    source : ForeignCamera
    model : str
        Name of our model; empty for the one with the fewest parameters that expresses the source, or the best one.

    Raises
    ------
    UserError
        When no model can be fitted at all.
    """
    pixels = pixel_grid(source.frame)
    rays = foreign_rays(source, pixels)
    seen = np.isfinite(rays).all(axis=1)
    if seen.sum() < 20:
        raise UserError(
            Text("The camera {name} cannot be converted.", name=source.label or source.formula),
            "Its formula gives hardly any pixel of the format a direction.",
            "Check its parameters.",
        )
    names = [model] if model else _candidates(source)
    best: Conversion[Camera] | None = None
    for name in names:
        found = _fit_ours(source, name, pixels[seen], rays[seen], _every_other(len(pixels))[seen])
        if best is None or (found.without_image, found.rms_px) < (best.without_image, 0.999 * best.rms_px):
            best = found
        if best.exact:
            break
    assert best is not None
    return best


def _candidates(source: ForeignCamera) -> list[str]:
    """Return our models that may express a formula: those of its direction first, fewest parameters first."""
    f = formula(source.formula)
    projections = FISHEYES if f.wide or "FishEye" in f.name else ("central",)
    names = [m.name for m in camera_models().values() if m.projection in projections]
    if "PolyDeg" not in source.formula:
        names = [n for n in names if not n.startswith(("polynomial", "ebner"))]
    other = {n: camera_model(n).backward != (f.direction == "measured → ideal") for n in names}
    return sorted(names, key=lambda n: (other[n], len(camera_model(n).parameters)))


def foreign_rays(source: ForeignCamera, pixels: Array) -> Array:
    """Return the direction (n, 3) of every pixel by a program's own formula; NaN where it has none."""
    f = formula(source.formula)
    if f.direction == "measured → ideal":
        return f.function(source.values, source.frame, pixels)
    return directions(invert(lambda a: f.function(source.values, source.frame, directions(a, f.wide)), pixels),
                       f.wide)  # fmt: skip


def foreign_pixels(source: ForeignCamera, rays: Array) -> Array:
    """Return the pixel (n, 2) of every direction by a program's own formula; NaN where it has none."""
    f = formula(source.formula)
    if f.direction == "ideal → measured":
        return f.function(source.values, source.frame, np.asarray(rays, dtype=np.float64))
    target = np.asarray(rays)[:, :2] / np.asarray(rays)[:, 2:]

    def ideal(pixels: Array) -> Array:
        out = f.function(source.values, source.frame, pixels)
        return out[:, :2] / out[:, 2:]

    return invert(ideal, target, around=source.frame.centre, step=1e-3)


def _principal(camera: Camera) -> Array:
    names = camera_model(camera.model).names
    return np.array([camera.values[names.index("x0")], camera.values[names.index("y0")]])


def _foreign_residual(
    target: Formula, frame: Format, camera: Camera, pixels: Array, rays: Array
) -> Callable[[Array], Array]:
    """Return residuals in px for trial values: in the image for a forward formula, else in the ideal image."""
    if target.direction == "ideal → measured":
        return lambda values: target.function(values, frame, rays) - pixels
    ideal = rays[:, :2] / rays[:, 2:]

    def backward(values: Array) -> Array:
        found = target.function(values, frame, pixels)
        difference: Array = (found[:, :2] / found[:, 2:] - ideal) * camera.focal_px
        return difference

    return backward


def _difference(target: Formula, made: ForeignCamera, camera: Camera, pixels: Array, rays: Array) -> Array:
    """Return position in the target − in the source, px; of a backward formula with its direction seen by ours."""
    if target.direction == "ideal → measured":
        return target.function(made.values, made.frame, rays) - pixels
    return pixels - pixel_from_ray(camera, target.function(made.values, made.frame, pixels))


def _every_other(count: int) -> Array:
    """Return which pixels of the grid a fit uses: every other one in both directions; all are judged."""
    i = np.arange(count)
    chosen: Array = (i // POINTS % 2 == 0) & (i % POINTS % 2 == 0)
    return chosen


def _fit_ours(
    source: ForeignCamera, name: str, pixels: Array, rays: Array, used: Array
) -> Conversion[Camera]:
    model = camera_model(name)
    focal, principal = _focal_and_principal(pixels, rays, source.frame)
    constant = np.array([p.default == "constant" for p in model.parameters])
    start = np.where(constant, max(source.frame.width, source.frame.height) / 2.0, 0.0)
    start[:3] = [focal, *principal]
    camera = Camera(
        model=name, width=source.frame.width, height=source.frame.height, values=start, label=source.label,
        pixel_pitch_mm=source.frame.pitch_mm, focal_source=source.formula,
    )  # fmt: skip

    def residual(values: Array) -> Array:
        return pixel_from_ray(replace(camera, values=values), rays[used]) - pixels[used]

    camera = replace(camera, values=rounded(residual, fit(residual, start, ~constant)))
    left = pixel_from_ray(camera, rays) - pixels
    good = np.isfinite(left).all(axis=1)
    return Conversion(camera, pixels[good], left[good], len(pixels) - int(good.sum()))


def _focal_and_principal(pixels: Array, rays: Array, frame: Format) -> tuple[float, Array]:
    """Return a start from the pixels nearest to the image centre: pixel ≈ principal point + focal · (x/z, y/z)."""
    near = np.argsort(np.hypot(*(pixels - frame.centre).T))[:30]
    ideal = rays[near, :2] / rays[near, 2:]
    table = np.zeros((2 * len(near), 3))
    table[0::2, 0], table[1::2, 0] = ideal[:, 0], ideal[:, 1]
    table[0::2, 1] = table[1::2, 2] = 1.0
    focal, x0, y0 = np.linalg.lstsq(table, pixels[near].ravel(), rcond=None)[0]
    return float(abs(focal)), np.array([x0, y0])
