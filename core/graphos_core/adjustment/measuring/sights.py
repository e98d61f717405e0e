"""Where one control point stands in every photo of a project: measured, predicted, on a line, or out of sight."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from graphos_core.adjustment.measuring.prediction import (
    Intersection,
    Prediction,
    intersect,
    intersect_many,
    predict,
    project_many,
)
from graphos_core.data import Array, Block, Georeference
from graphos_core.exchange.control_sheet import ControlSheet, Mark

State = Literal["measured", "predicted", "line", "out of sight", "not oriented", "nothing known"]
PLACED_WITHOUT_COORDINATES = ("none", "known distance")
"""Ways of placing a block after which its frame is not that of the control points."""


@dataclass(frozen=True)
class Sight:
    """A point in one photo.

    Attributes
    ----------
    photo : str
    state : str
    mark : Mark or None
        The measurement.
    prediction : Prediction or None
        From the other photos; None without an oriented block.
    residual : float64 (2,) or None
        Projected − measured of the point intersected by all its rays, px.
    """

    photo: str
    state: State
    mark: Mark | None
    prediction: Prediction | None
    residual: Array | None


@dataclass(frozen=True)
class Standing:
    """Everything that is shown while control points are measured.

    Attributes
    ----------
    name : str
        The chosen point, empty for none.
    meeting : Intersection or None
        Of its rays.
    sights : list of Sight
        The chosen point in every photo; empty without one.
    image_rms : mapping
        RMS of the image residuals of every point, px.
    distances : list of float
        What the block says of every known distance of the sheet, in its unit; NaN where it says nothing.
    """

    name: str
    meeting: Intersection | None
    sights: list[Sight]
    image_rms: Mapping[str, float]
    distances: list[float]


def standing(
    sheet: ControlSheet,
    name: str,
    photos: Sequence[str],
    block: Block | None,
    georeference: Georeference | None,
) -> Standing:
    """Return how things stand with a sheet in a block; see `Standing`."""
    known = None
    if block is not None and georeference is not None:
        known = known_place(sheet, name, block, georeference)
    meeting, found = sights(sheet, name, photos, block, known) if name else (None, [])
    if block is None:
        return Standing(name, meeting, found, {}, [float("nan")] * len(sheet.distances))
    distances = [measured_distance(sheet, block, d.a, d.b) for d in sheet.distances]
    return Standing(name, meeting, found, image_rms(sheet, block), distances)


def sights(
    sheet: ControlSheet, name: str, photos: Sequence[str], block: Block | None, xyz: Array | None = None
) -> tuple[Intersection | None, list[Sight]]:
    """Return the intersection of a point's rays, and the point in every photo.

    Parameters
    ----------
    sheet : ControlSheet
    name : str
        Point.
    photos : sequence of str
        All photos of the project.
    block : Block or None
        Oriented block, where there is one; photos are found by their names.
    xyz : float64 (3,) or None
        Known coordinates in the frame of the block.
    """
    marks = sheet.marks_of(name)
    if block is None:
        return None, [
            Sight(p, "measured" if p in marks else "nothing known", marks.get(p), None, None) for p in photos
        ]
    index = {photo: i for i, photo in enumerate(block.names)}
    measured = {index[photo]: mark.xy for photo, mark in marks.items() if photo in index}
    meeting = intersect(block, measured)
    found = []
    for photo in photos:
        place = index.get(photo, -1)
        prediction = predict(block, measured, place, xyz) if place >= 0 else None
        mark = marks.get(photo)
        residual = meeting.residuals.get(place)
        oriented = place >= 0 and bool(block.oriented[place])
        found.append(Sight(photo, _state(mark, oriented, prediction), mark, prediction, residual))
    return meeting, found


def known_place(sheet: ControlSheet, name: str, block: Block, georeference: Georeference) -> Array | None:
    """Return the coordinates of a point in the frame of the block, m; None where that frame is another one."""
    row = sheet.index(name)
    if row < 0 or block.unit != "m" or georeference.method in PLACED_WITHOUT_COORDINATES:
        return None
    xyz = np.array(sheet.points[row].xyz) - np.asarray(georeference.origin)
    return xyz if np.isfinite(xyz).all() else None


def image_rms(sheet: ControlSheet, block: Block) -> Mapping[str, float]:
    """Return the RMS of the image residuals per coordinate of every point that two rays or more intersect, px.

    The same as `intersect` says of each point, for all of them at once.
    """
    index = {photo: i for i, photo in enumerate(block.names) if block.oriented[i]}
    marks = sorted(
        (name, index[photo], mark) for (name, photo), mark in sheet.marks.items() if photo in index
    )
    names = sorted({name for name, _, _ in marks})
    if not names:
        return {}
    number = {name: i for i, name in enumerate(names)}
    point = np.array([number[name] for name, _, _ in marks])
    photo, xy = np.array([p for _, p, _ in marks]), np.array([mark.xy for _, _, mark in marks])
    xyz, ok = intersect_many(block, point, photo, xy, len(names))
    squares = np.zeros(len(names))
    for p in np.unique(photo):
        mine = photo == p
        residuals = project_many(block, int(p), xyz[point[mine]]) - xy[mine]
        np.add.at(squares, point[mine], (residuals**2).sum(axis=1))
    count = 2 * np.bincount(point, minlength=len(names))
    rms = np.sqrt(squares / count)
    return {name: float(rms[i]) for i, name in enumerate(names) if ok[i] and np.isfinite(rms[i])}


def _state(mark: Mark | None, oriented: bool, prediction: Prediction | None) -> State:
    if mark is not None:
        return "measured"
    if not oriented or prediction is None:
        return "not oriented"
    if not prediction.source:
        return "nothing known"
    if not prediction.inside:
        return "out of sight"
    return "line" if prediction.source == "lines" else "predicted"


def measured_distance(sheet: ControlSheet, block: Block, a: str, b: str) -> float:
    """Return the distance of two measured points, or of two projection centres, in the unit of the block.

    NaN where an end is neither a point that two rays intersect nor an oriented photo.
    """
    ends = [_end(sheet, block, name) for name in (a, b)]
    return float(np.linalg.norm(ends[0] - ends[1]))


def _end(sheet: ControlSheet, block: Block, name: str) -> Array:
    index = {photo: i for i, photo in enumerate(block.names)}
    measured = {index[photo]: mark.xy for photo, mark in sheet.marks_of(name).items() if photo in index}
    if not measured and name in index and block.oriented[index[name]]:
        return np.asarray(block.centres[index[name]])
    xyz = intersect(block, measured).xyz
    return np.full(3, np.nan) if xyz is None else xyz


def marks_of_point(block: Block, point: int) -> Mapping[str, Mark]:
    """Return the observations of an object point as measurements by photo: a tie point becomes a named point."""
    mine = np.flatnonzero(np.asarray(block.obs_point) == point)
    return {
        block.names[int(block.obs_photo[i])]: Mark(*(round(float(v), 4) for v in block.obs_xy[i]))
        for i in mine
    }
