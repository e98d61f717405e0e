"""Templates of camera stations: couple, triple, grid, orbital (ARPENTEUR 2013), façade, and inside a courtyard.

Stations are placed about the origin of an object frame with x to the right, y away from the viewer and z up; move
them to the object with `Stations.moved`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from graphos_core.data.record import Array, record
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import look_at, matrix_from_vector
from graphos_core.params import About, Params, unknown_name


@record
class Stations:
    """Where photos are taken from.

    Attributes
    ----------
    names : tuple of str
        Photo names without extension.
    rotations : float64 (n, 3, 3)
        ``cam_from_world``.
    centres : float64 (n, 3)
        Projection centres, m.
    """

    names: tuple[str, ...]
    rotations: Array
    centres: Array

    def moved(self, by: Array) -> Stations:
        """Return the stations shifted by `by` (3,), m."""
        return Stations(names=self.names, rotations=self.rotations, centres=self.centres + np.asarray(by))

    def first(self, count: int) -> Stations:
        """Return the first `count` stations."""
        return Stations(
            names=self.names[:count], rotations=self.rotations[:count], centres=self.centres[:count]
        )


def _metres(label: str, text: str, effect: str = "", low: float = 0.0, **more: Any) -> About:
    return About(
        label=label, unit="m", low=low, high=10000, low_open=low == 0.0, help=text, effect=effect, **more
    )


def _degrees(label: str, text: str, low: float, high: float, effect: str = "", **more: Any) -> About:
    return About(label=label, unit="°", low=low, high=high, step=5, help=text, effect=effect, **more)


def _count(label: str, text: str, low: int = 1, high: int = 200) -> About:
    return About(label=label, unit="", low=low, high=high, step=1, help=text, effect="Higher: more photos.")


class CoupleParams(Params):
    """Two stations side by side."""

    base: Annotated[
        float, _metres("Base", "Distance between the two projection centres.", "Longer: better depth, less overlap.",
                       symbol="B")
    ] = 2.5  # fmt: skip
    distance: Annotated[
        float, _metres("Distance", "From the middle of the base to the middle of the object.", "Longer: coarser.",
                       symbol="D")
    ] = 12.0  # fmt: skip
    convergence: Annotated[
        float, _degrees("Convergence", "Angle between the two viewing directions; 0 is the normal case.", -90, 150,
                        symbol=r"\gamma")
    ] = 0.0  # fmt: skip


class TripleParams(Params):
    """Three stations in a row, the middle one raised."""

    base: Annotated[
        float, _metres("Base", "Distance between neighbouring projection centres along x.", symbol="B")
    ] = 2.5  # fmt: skip
    distance: Annotated[
        float, _metres("Distance", "From the row to the middle of the object.", symbol="D")
    ] = 12.0
    convergence: Annotated[
        float, _degrees("Convergence", "Angle between neighbouring viewing directions; 0 is the normal case.", -60, 75,
                        symbol=r"\gamma")
    ] = 12.0  # fmt: skip
    rise: Annotated[
        float, About(label="Rise", unit="m", low=-1000, high=1000, step=0.5,
                     help="How much higher the middle station stands.", effect="Other than 0: not on one line.")
    ] = 1.5  # fmt: skip


class GridParams(Params):
    """Parallel strips over terrain, looking down."""

    height: Annotated[
        float, _metres("Flying height", "Height of the projection centres above the middle of the terrain.",
                       "Higher: larger ground sampling distance.", symbol="h")
    ] = 30.0  # fmt: skip
    base: Annotated[float, _metres("Base", "Distance between photos along a strip.", symbol="B")] = 7.0
    spacing: Annotated[
        float, _metres("Strip spacing", "Distance between neighbouring strips.", symbol="A")
    ] = 9.0
    strips: Annotated[int, _count("Strips", "Number of strips.")] = 3
    per_strip: Annotated[int, _count("Photos per strip", "Number of photos in each strip.")] = 4
    oblique: Annotated[
        float, _degrees("Obliquity", "Angle between the viewing directions and the vertical, forwards in the strip.",
                        0, 60)
    ] = 0.0  # fmt: skip
    turned: Annotated[
        bool, About(label="Turn at the end", help="Whether every second strip is flown the other way.",
                    effect="On: better principal point.")
    ] = True  # fmt: skip


class OrbitalParams(Params):
    """Stations on the equators and meridians of an ellipsoid, looking at its centre."""

    axis_x: Annotated[float, _metres("Semi-axis x", "Of the ellipsoid, along x.", symbol="a")] = 4.0
    axis_y: Annotated[float, _metres("Semi-axis y", "Of the ellipsoid, along y.", symbol="b")] = 4.0
    axis_z: Annotated[float, _metres("Semi-axis z", "Of the ellipsoid, along z.", symbol="c")] = 3.5
    equators: Annotated[int, _count("Equators", "Number of horizontal rings.", 0)] = 2
    per_equator: Annotated[int, _count("Photos per equator", "Number of photos on each ring.")] = 16
    meridians: Annotated[int, _count("Meridians", "Number of upright half rings.", 0)] = 0
    per_meridian: Annotated[int, _count("Photos per meridian", "Number of photos on each half ring.")] = 7
    lowest: Annotated[
        float, _degrees("Lowest latitude", "Parametric latitude of the lowest station.", -85, 85)
    ] = 0.0
    highest: Annotated[
        float, _degrees("Highest latitude", "Parametric latitude of the highest station.", -85, 85)
    ] = 35.0  # fmt: skip


class FacadeParams(Params):
    """Stations on a convergent arc in front of a façade, at two heights, some turned about the viewing direction."""

    distance: Annotated[float, _metres("Distance", "Radius of the arc about the middle of the object.")] = (
        13.5
    )
    arc: Annotated[
        float, _degrees("Arc", "Angle between the outermost stations, seen from the object.", 1, 150,
                        "Wider: better intersection, harder matching.")
    ] = 66.0  # fmt: skip
    stations: Annotated[int, _count("Stations", "Number of photos.", 2)] = 12
    low: Annotated[
        float, About(label="Low height", unit="m", low=-1000, high=1000, step=0.5,
                     help="Height of the odd stations above the middle of the object.")
    ] = -2.0  # fmt: skip
    high: Annotated[
        float, About(label="High height", unit="m", low=-1000, high=1000, step=0.5,
                     help="Height of the even stations above the middle of the object.")
    ] = 2.6  # fmt: skip
    rolled_every: Annotated[
        int, About(label="Turned every", unit="", low=0, high=100, step=1,
                   help="Every so many photos the camera is turned by 90 degrees, alternately left and right; "
                        "0 for never.", effect="Turned photos separate principal point and orientation.")
    ] = 4  # fmt: skip


class InsideParams(Params):
    """Stations on a ring inside a room or courtyard, looking across it, some turned about the viewing direction."""

    radius: Annotated[float, _metres("Radius", "Of the ring.", "Larger: longer bases.")] = 1.8
    stations: Annotated[int, _count("Stations", "Number of photos.", 2)] = 12
    tilt: Annotated[
        float, _degrees("Tilt", "Of the viewing direction, up and down in turn.", 0, 60, "Higher: more of floor and sky.")
    ] = 15.0  # fmt: skip
    rolled_every: Annotated[
        int, About(label="Turned every", unit="", low=0, high=100, step=1,
                   help="Every so many photos the camera is turned by 90 degrees; 0 for never.",
                   effect="Turned photos separate principal point and orientation.")
    ] = 3  # fmt: skip


def _stations(prefix: str, rotations: list[Array], centres: list[Array]) -> Stations:
    names = tuple(f"{prefix}_{i:03d}" for i in range(1, len(centres) + 1))
    return Stations(names=names, rotations=np.array(rotations), centres=np.array(centres, dtype=np.float64))


def _facing(turn: float) -> Array:
    """``cam_from_world`` of a level camera that looks along +y, turned to the right by `turn` radians."""
    return look_at(np.zeros(3), np.array([np.sin(turn), np.cos(turn), 0.0]))


def _roll(cam_from_world: Array, angle: float) -> Array:
    result: Array = matrix_from_vector(np.array([0.0, 0.0, angle])) @ cam_from_world
    return result


def couple(params: CoupleParams) -> Stations:
    """Return two level stations at (∓base/2, −distance, 0), turned inwards by half the convergence each."""
    half = np.radians(params.convergence) / 2
    x = params.base / 2
    return _stations(
        "couple", [_facing(half), _facing(-half)], [np.array([s * x, -params.distance, 0.0]) for s in (-1, 1)]
    )


def triple(params: TripleParams) -> Stations:
    """Return three level stations at (k·base, −distance, 0), k = −1, 0, 1, the middle one raised."""
    turn = np.radians(params.convergence)
    return _stations(
        "triple",
        [_facing(-k * turn) for k in (-1, 0, 1)],
        [np.array([k * params.base, -params.distance, params.rise if k == 0 else 0.0]) for k in (-1, 0, 1)],
    )


def grid(params: GridParams) -> Stations:
    """Return strips along x, the first at the lowest y, at the flying height, image top towards the flight."""
    rotations, centres = [], []
    tilt = np.radians(params.oblique)
    for strip in range(params.strips):
        heading = -1.0 if params.turned and strip % 2 else 1.0
        order = range(params.per_strip)[:: int(heading)]
        for k in order:
            x = (k - (params.per_strip - 1) / 2) * params.base
            y = (strip - (params.strips - 1) / 2) * params.spacing
            look = np.array([heading * np.sin(tilt), 0.0, -np.cos(tilt)])
            rotations.append(look_at(np.zeros(3), look, np.array([heading, 0.0, 0.0])))
            centres.append(np.array([x, y, params.height]))
    return _stations("grid", rotations, centres)


def orbital(params: OrbitalParams) -> Stations:
    """Return stations ``(a cosφ cosλ, b cosφ sinλ, c sinφ)`` in parametric latitude φ and longitude λ.

    Rings at latitudes evenly spaced from the lowest to the highest (one ring: in the middle), then half rings at
    longitudes evenly spaced over 360°; a station that another already occupies is left out.

    Raises
    ------
    UserError
        When there is no station at all.
    """
    lowest, highest = np.radians([params.lowest, params.highest])
    places: list[tuple[float, float]] = []
    for latitude in _spread(lowest, highest, params.equators):
        places += [
            (latitude, 2 * np.pi * k / params.per_equator - np.pi / 2) for k in range(params.per_equator)
        ]
    for m in range(params.meridians):
        longitude = 2 * np.pi * m / params.meridians - np.pi / 2
        places += [(latitude, longitude) for latitude in _spread(lowest, highest, params.per_meridian)]
    axes = np.array([params.axis_x, params.axis_y, params.axis_z])
    centres: list[Array] = []
    for lat, lon in places:
        centre = axes * [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]
        if all(np.linalg.norm(centre - other) > 1e-6 * axes.max() for other in centres):
            centres.append(centre)
    if not centres:
        raise UserError("The orbit has no stations.", "It has neither equators nor meridians.", "Add one.")
    return _stations("orbital", [look_at(centre, np.zeros(3)) for centre in centres], centres)


def _spread(low: float, high: float, count: int) -> list[float]:
    return [0.5 * (low + high)] if count == 1 else [float(v) for v in np.linspace(low, high, count)]


def facade(params: FacadeParams) -> Stations:
    """Return stations on an arc from left to right, low and high in turn, all looking at the middle."""
    rotations, centres = [], []
    for k, angle in enumerate(np.radians(np.linspace(-params.arc / 2, params.arc / 2, params.stations))):
        height = params.high if k % 2 else params.low
        centre = np.array([params.distance * np.sin(angle), -params.distance * np.cos(angle), height])
        rotation = look_at(centre, np.zeros(3))
        if params.rolled_every and k % params.rolled_every == params.rolled_every - 2:
            rotation = _roll(rotation, np.pi / 2 * (-1.0) ** (k // params.rolled_every))
        rotations.append(rotation)
        centres.append(centre)
    return _stations("facade", rotations, centres)


def inside(params: InsideParams) -> Stations:
    """Return stations on a ring about the origin, in turn 0.4 m below and above it, each looking across the ring."""
    rotations, centres = [], []
    for k in range(params.stations):
        angle = 2.0 * np.pi * k / params.stations
        centre = np.array([params.radius * np.cos(angle), params.radius * np.sin(angle), 0.4 * (-1.0) ** k])
        tilt = np.radians(params.tilt) * (-1.0) ** (k // 2)
        aim = np.array([-np.cos(angle) * np.cos(tilt), -np.sin(angle) * np.cos(tilt), np.sin(tilt)])
        rotation = look_at(np.zeros(3), aim)
        if params.rolled_every and k % params.rolled_every == 0:
            rotation = _roll(rotation, np.pi / 2)
        rotations.append(rotation)
        centres.append(centre)
    return _stations("inside", rotations, centres)


@dataclass(frozen=True)
class Template:
    """A template: its parameter sheet, its function, and the scene it is photographed with."""

    params: type[Params]
    function: Callable[[Any], Stations]
    scene: str

    @property
    def summary(self) -> str:
        """First sentence of the parameter sheet's documentation."""
        return (self.params.__doc__ or "").partition("\n")[0]


TEMPLATES: dict[str, Template] = {
    "couple": Template(CoupleParams, couple, "facade"),
    "triple": Template(TripleParams, triple, "facade"),
    "grid": Template(GridParams, grid, "terrain"),
    "orbital": Template(OrbitalParams, orbital, "statue"),
    "facade": Template(FacadeParams, facade, "facade"),
    "inside": Template(InsideParams, inside, "courtyard"),
}
"""Every template by name."""


def template(name: str) -> Template:
    """Return a template by name.

    Raises
    ------
    UserError
        When there is none of that name.
    """
    if name not in TEMPLATES:
        raise UserError(unknown_name(name, list(TEMPLATES), "template"))
    return TEMPLATES[name]


def place(name: str, params: Params | None = None) -> Stations:
    """Return the stations of a template, by default with its own parameters.

    Raises
    ------
    UserError
        When there is no template of that name.
    """
    found = template(name)
    return found.function(params if params is not None else found.params())
