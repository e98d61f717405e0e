"""Control points and their measurements as a person edits them: immutable, so that every state can be gone back to."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from graphos_core.data import Control, ControlObservations, KnownDistance

Role = Literal["control", "check", "off"]
ROLES: tuple[Role, ...] = ("control", "check", "off")
Triple = tuple[float, float, float]
UNKNOWN: Triple = (math.nan, math.nan, math.nan)


@dataclass(frozen=True)
class SheetPoint:
    """One row.

    Attributes
    ----------
    name : str
    xyz : tuple of float
        Coordinates, m; NaN on an axis that is not known.
    sigma : tuple of float
        A priori standard deviations, m; NaN takes the default of the adjustment, 0 holds fixed.
    role : {"control", "check", "off"}
    """

    name: str
    xyz: Triple = UNKNOWN
    sigma: Triple = UNKNOWN
    role: Role = "control"

    @property
    def known(self) -> bool:
        """Whether any coordinate is known; a point without is a tie point measured by hand."""
        return any(math.isfinite(v) for v in self.xyz)


@dataclass(frozen=True)
class Mark:
    """One measurement in a photo: place in px, and its a priori standard deviation, NaN for the default."""

    x: float
    y: float
    sigma_px: float = math.nan

    @property
    def xy(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """Place as an array (2,)."""
        return np.array([self.x, self.y])


@dataclass(frozen=True)
class SheetDistance:
    """A known distance.

    Attributes
    ----------
    a, b : str
        Names of two points, or of two photos (distance of their projection centres).
    metres : float
    sigma : float
        A priori standard deviation, m; NaN takes the default of the adjustment.
    check : bool
        Takes no part and only checks the scale.
    """

    a: str
    b: str
    metres: float
    sigma: float = math.nan
    check: bool = False


@dataclass(frozen=True)
class ControlSheet:
    """All points, their measurements and the known distances.

    Attributes
    ----------
    points : tuple of SheetPoint
        Names are unique.
    marks : mapping
        ``marks[name of point, name of photo]``.
    crs : str
        ``"EPSG:25832"``, or empty for a local system.
    distances : tuple of SheetDistance
    """

    points: tuple[SheetPoint, ...] = ()
    marks: Mapping[tuple[str, str], Mark] = field(default_factory=dict)
    crs: str = ""
    distances: tuple[SheetDistance, ...] = ()

    def __eq__(self, other: object) -> bool:
        # as text, because there NaN equals NaN
        return isinstance(other, ControlSheet) and repr(self._plain()) == repr(other._plain())

    __hash__ = None  # type: ignore[assignment]

    def _plain(self) -> tuple[object, ...]:
        return self.points, sorted(self.marks.items()), self.crs, self.distances

    def index(self, name: str) -> int:
        """Return the row of a point, −1 where there is none."""
        return next((i for i, point in enumerate(self.points) if point.name == name), -1)

    def free_name(self, stem: str = "P") -> str:
        """Return the first name of the kind P1, P2 … that is not taken."""
        taken, number = {point.name for point in self.points}, 1
        while f"{stem}{number}" in taken:
            number += 1
        return f"{stem}{number}"

    def marks_of(self, name: str) -> dict[str, Mark]:
        """Return the measurements of a point by photo."""
        return {photo: mark for (point, photo), mark in self.marks.items() if point == name}

    def marks_in(self, photo: str) -> dict[str, Mark]:
        """Return the measurements in a photo by point."""
        return {point: mark for (point, where), mark in self.marks.items() if where == photo}

    # ----------------------------------------------------------------------------------------------------- edits

    def with_point(self, row: int, point: SheetPoint) -> ControlSheet:
        """Return the sheet with a row replaced; measurements follow a new name.

        Raises
        ------
        ValueError
            When another row has this name, or it is empty.
        """
        old = self.points[row].name
        if not point.name.strip() or (point.name != old and self.index(point.name) >= 0):
            raise ValueError(f"the name “{point.name}” is empty or taken")
        marks = {
            (point.name if name == old else name, photo): mark for (name, photo), mark in self.marks.items()
        }
        points = (*self.points[:row], point, *self.points[row + 1 :])
        ends = {old: point.name}
        distances = tuple(replace(d, a=ends.get(d.a, d.a), b=ends.get(d.b, d.b)) for d in self.distances)
        return replace(self, points=points, marks=marks, distances=distances)

    def with_points(self, points: Iterable[SheetPoint]) -> ControlSheet:
        """Return the sheet with points added; one whose name is there replaces that row."""
        rows = {point.name: point for point in self.points}
        rows.update({point.name: point for point in points})
        return replace(self, points=tuple(rows.values()))

    def without(self, names: Iterable[str]) -> ControlSheet:
        """Return the sheet without points, their measurements and distances."""
        gone = set(names)
        return replace(
            self, points=tuple(p for p in self.points if p.name not in gone),
            marks={key: mark for key, mark in self.marks.items() if key[0] not in gone},
            distances=tuple(d for d in self.distances if not {d.a, d.b} & gone),
        )  # fmt: skip

    def marked(self, name: str, photo: str, mark: Mark | None) -> ControlSheet:
        """Return the sheet with a measurement set, or taken away."""
        marks = {key: value for key, value in self.marks.items() if key != (name, photo)}
        if mark is not None:
            marks[name, photo] = mark
        return replace(self, marks=marks)

    # ------------------------------------------------------------------------------------------------- records

    @classmethod
    def from_known(
        cls,
        control: Control | None,
        measured: ControlObservations | None,
        distances: Iterable[KnownDistance] = (),
    ) -> ControlSheet:
        """Return the sheet of the records that a project reads."""
        known = tuple(
            SheetDistance(d.a, d.b, d.metres, math.nan if d.sigma is None else d.sigma, d.check)
            for d in distances
        )
        if control is None:
            return cls(distances=known)
        xyz = np.asarray(control.xyz) + np.asarray(control.origin)
        sigma = np.full_like(xyz, np.nan) if control.sigma is None else np.asarray(control.sigma)
        off = np.zeros(len(xyz), dtype=bool) if control.off is None else np.asarray(control.off)
        points = tuple(
            SheetPoint(
                name, _triple(xyz[i]), _triple(sigma[i]), _role(xyz[i], bool(control.check[i]), bool(off[i]))
            )
            for i, name in enumerate(control.names)
        )
        marks: dict[tuple[str, str], Mark] = {}
        if measured is not None:
            for i, photo in enumerate(measured.photo):
                own = math.nan if measured.sigma_px is None else float(measured.sigma_px[i])
                x, y = (float(v) for v in measured.xy[i])
                marks[control.names[int(measured.point[i])], photo] = Mark(x, y, own)
        return cls(points, marks, control.crs, known)


def _triple(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Triple:
    x, y, z = (round(float(v), 9) for v in values)
    return x, y, z


def _role(xyz: np.ndarray[tuple[int], np.dtype[np.float64]], check: bool, off: bool) -> Role:
    if off:
        return "off"
    return "check" if check and np.isfinite(xyz).any() else "control"
