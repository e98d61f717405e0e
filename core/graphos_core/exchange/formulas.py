"""How other programs' camera models project: their formulas, in their units, with our pixels at the border.

A `Formula` is what a file means, independent of its syntax. It maps directions in the camera frame (x right, y down,
z forward) to pixels, or pixels to directions, by the program's own definition; pixels have the centre of the top-left
pixel at (0, 0). `graphos_core.exchange.camera_fit` converts between formulas and the camera models of this program.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.params import unknown_name

CORNER = 0.5
"""What the coordinates of a program have more than ours when its origin is the corner of the first pixel."""

Direction = Literal["ideal → measured", "measured → ideal"]


@dataclass(frozen=True)
class Format:
    """Format of a photo, px, and the size of a pixel on the sensor, mm, where known."""

    width: int
    height: int
    pitch_mm: float | None = None

    @property
    def centre(self) -> Array:
        """Image centre, px, ours."""
        return np.array([(self.width - 1) / 2.0, (self.height - 1) / 2.0])


@dataclass(frozen=True)
class Formula:
    """A camera model of another program.

    Attributes
    ----------
    name : str
        ``"colmap OPENCV"``: program and the model's name there.
    parameters : tuple of str
        As the program calls them, in the order of its values.
    direction : str
        ``"ideal → measured"``: `function` maps directions (n, 3) to pixels (n, 2); ``"measured → ideal"``: pixels
        (n, 2) to directions (n, 3).
    function : callable
        ``(values, format, input) -> output``; NaN where there is no image.
    start : callable
        ``(focal_px, principal_px, format) -> values``: the distortion-free camera.
    wide : bool
        Whether directions beyond 90° from the axis have an image: a fish-eye.
    needs_pitch : bool
        Whether values are in millimetres.
    constants : tuple of str
        Parameters that are no unknowns but belong to the formula, such as a scale.
    """

    name: str
    parameters: tuple[str, ...]
    direction: Direction
    function: Callable[[Array, Format, Array], Array]
    start: Callable[[float, Array, Format], Array]
    wide: bool = False
    needs_pitch: bool = False
    constants: tuple[str, ...] = ()


@dataclass(frozen=True)
class ForeignCamera:
    """A camera as another program describes it.

    Attributes
    ----------
    formula : str
        Name of its `Formula`.
    values : float64 (k,)
        In the program's units.
    frame : Format
    label : str
        Name for people.
    """

    formula: str
    values: Array
    frame: Format
    label: str = ""

    def value(self, name: str) -> float:
        """Return one parameter by its name."""
        return float(self.values[formula(self.formula).parameters.index(name)])


_formulas: dict[str, Formula] = {}


def register(formula: Formula) -> Formula:
    """Add a formula to the list."""
    _formulas[formula.name] = formula
    return formula


def formulas() -> dict[str, Formula]:
    """Return every formula by name."""
    from graphos_core.exchange import dbat_camera, formulas_colmap, formulas_micmac, formulas_other  # noqa: F401

    return _formulas


def formula(name: str) -> Formula:
    """Return a formula by name.

    Raises
    ------
    UserError
        When there is none of that name.
    """
    known = formulas()
    if name not in known:
        raise UserError(unknown_name(name, list(known), "camera formula"))
    return known[name]


def perspective(rays: Array) -> Array:
    """Return x/z, y/z (n, 2); NaN for directions that are not in front."""
    z = np.where(rays[:, 2] > 0, rays[:, 2], np.nan)
    xy: Array = rays[:, :2] / z[:, None]
    return xy


def fisheye(rays: Array, radius_of_angle: Callable[[Array], Array]) -> Array:
    """Return the image (n, 2) of directions at the radius that a fish-eye gives their angle from the axis."""
    across = np.hypot(rays[:, 0], rays[:, 1])
    angle = np.arctan2(across, rays[:, 2])
    scale = np.divide(radius_of_angle(angle), across, out=np.ones_like(across), where=across > 1e-15)
    scale = np.where(across > 1e-15, scale, 1.0 / np.maximum(rays[:, 2], 1e-300))
    xy: Array = rays[:, :2] * scale[:, None]
    return xy


def radial(r2: Array, coefficients: Array) -> Array:
    """Return ``k1 r² + k2 r⁴ + …``."""
    out = np.zeros_like(r2)
    for k in coefficients[::-1]:
        out = (out + k) * r2
    return out


def decentring(x: Array, y: Array, r2: Array, p1: float, p2: float) -> tuple[Array, Array]:
    """Return Brown's decentring terms: P1 (r² + 2x²) + 2 P2 x y, and P2 (r² + 2y²) + 2 P1 x y."""
    return p1 * (r2 + 2 * x * x) + 2 * p2 * x * y, p2 * (r2 + 2 * y * y) + 2 * p1 * x * y
