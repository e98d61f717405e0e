"""Measuring the test field in all photos, and saying why it was not found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import partial

import numpy as np

from graphos_core.adjustment.calibration.chessboard import find_chessboard, size_of_chessboard
from graphos_core.adjustment.calibration.circles import find_discs
from graphos_core.adjustment.calibration.lattice import extent, join, lay_over
from graphos_core.adjustment.calibration.markers import CodedBoard, find_markers, recognise
from graphos_core.adjustment.calibration.observed import TargetObservations, nothing
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.data import Array, Photo
from graphos_core.errors import GraphosError, UserError
from graphos_core.images import read_pixels
from graphos_core.preprocessing.grey import eight_bit
from graphos_core.run import Run, map_items
from graphos_core.text import Text

LEAST_POINTS = 8
"""A photo with fewer measured points is not used."""
LEAST_BELIEVED = 20
"""Corners a board must have to be named as what was found instead."""
LOOKED_AT = 3
"""Photos that are looked at to find out what a board is."""


def detect_target(
    photos: Sequence[Photo], target: TargetParams, *, run: Run
) -> tuple[list[TargetObservations], TargetParams]:
    """Measure the test field in every photo.

    Parameters
    ----------
    photos : sequence of Photo
    target : TargetParams
    run : Run

    Returns
    -------
    observations : list of TargetObservations
        One per photo.
    target : TargetParams
        With dictionary and side of the markers, where the photos told them.

    Raises
    ------
    UserError
        When it is found in no photo, saying what was found instead.
    Stopped
    """
    coded = None
    if target.target == "aruco":
        coded = recognise([_grey(p) for p in photos[:LOOKED_AT]], target)
        if coded is None:
            raise _no_markers(photos, target)
        target = target.replace(dictionary=coded.dictionary, marker_mm=coded.marker_mm)
    found = map_items(run, partial(_detect, target, coded), photos, "photos searched for the target")
    if not any(found):
        raise _not_found(photos, target, found)
    return _unmirrored(found), target


def _detect(target: TargetParams, coded: CodedBoard | None, photo: Photo) -> TargetObservations:
    try:
        grey = _grey(photo)
    except GraphosError as problem:
        return nothing(photo.name, str(problem))
    if target.target == "circles":
        return _circles(grey, target, photo.name)
    measured = (
        find_markers(grey, target, coded) if coded is not None else find_chessboard(grey, *target.shape)
    )
    if measured is None:
        return nothing(photo.name, Text("the target was not found in it"))
    point, xy, sigma = measured
    if len(point) < LEAST_POINTS:
        return nothing(
            photo.name,
            Text("only {n} points of the target were found, {least} are needed", n=len(point), least=LEAST_POINTS),
        )  # fmt: skip
    return TargetObservations(photo=photo.name, point=point, xy=xy, sigma=sigma, area=np.zeros(len(point)))


def _circles(grey: Array, target: TargetParams, name: str) -> TargetObservations:
    xy, sigma, area = find_discs(grey)
    lattice = join(xy, target.layout == "hexagonal")
    laid = lay_over(target, lattice, xy)
    if laid is None:
        columns, rows = extent(lattice, target.layout)
        return nothing(
            name,
            Text("a grid of {c} × {r} circles was found", c=columns, r=rows) if len(lattice.index) >= LEAST_POINTS
            else Text("no grid of circles was found"),
        )  # fmt: skip
    order = np.argsort(laid.point)
    chosen = laid.index[order]
    return TargetObservations(
        photo=name, point=laid.point[order], xy=xy[chosen], sigma=sigma[chosen], area=area[chosen],
        mirrored=laid.mirrored,
    )  # fmt: skip


def _unmirrored(found: list[TargetObservations]) -> list[TargetObservations]:
    """Leave out photos that show the mirror image of what most photos show."""
    forms = Counter(o.mirrored for o in found if o)
    kept = forms.most_common(1)[0][0]
    return [
        o if not o or o.mirrored == kept else nothing(o.photo, Text("it shows the mirror image of the board"))
        for o in found
    ]


def _grey(photo: Photo) -> Array:
    grey: Array = np.ascontiguousarray(eight_bit(read_pixels(photo, grey=True)))
    return grey


def _not_found(
    photos: Sequence[Photo], target: TargetParams, found: Sequence[TargetObservations]
) -> UserError:
    """Say what is in the photos instead of the board that was asked for."""
    what = Text(
        "The target ({kind}, {c} × {r}) was found in none of the {n} photos.", kind=NAMES[target.target],
        c=target.columns, r=target.rows, n=len(photos),
    )  # fmt: skip
    if target.target == "chessboard":
        sizes = Counter(
            size for p in photos[:LOOKED_AT] if (size := size_of_chessboard(_grey(p))) is not None
        )
        # panes and panels look like a small chessboard, and one photo alone may be mistaken
        several = [
            size for size, times in sizes.items()
            if times >= min(2, len(photos)) and size[0] * size[1] >= LEAST_BELIEVED
        ]  # fmt: skip
        if several:
            columns, rows = max(several)
            return UserError(
                what, Text("The photos show a chessboard with {c} × {r} inner corners.", c=columns, r=rows),
                Text("Give --columns {c} --rows {r}: inner corners, not squares.", c=columns, r=rows),
                learn="adjustment/calibrate",
            )  # fmt: skip
    reasons = Counter(str(o.reason) for o in found)
    todo = Text("Check kind, columns and rows of the target; the whole board must be in the photo, sharp and "
                "evenly lit.")  # fmt: skip
    if target.target == "circles":
        other = [lay for lay in ("symmetric", "asymmetric", "hexagonal") if lay != target.layout]
        todo = Text("{todo} Is the layout {a} or {b} rather than {given}?", todo=todo, a=other[0], b=other[1],
                    given=target.layout)  # fmt: skip
    return UserError(what, Text("{reason}.", reason=reasons.most_common(1)[0][0].capitalize()), todo,
                     learn="adjustment/calibrate")  # fmt: skip


def _no_markers(photos: Sequence[Photo], target: TargetParams) -> UserError:
    swapped = recognise(
        [_grey(p) for p in photos[:LOOKED_AT]], target.replace(columns=target.rows, rows=target.columns)
    )
    todo = Text("Give --dictionary, and columns and rows as inner corners of the chessboard (of a grid of markers "
                "with --markers-only: as markers).")  # fmt: skip
    if swapped is not None and target.columns != target.rows:
        todo = Text("With columns and rows swapped it works: give --columns {c} --rows {r}.", c=target.rows,
                    r=target.columns)  # fmt: skip
    return UserError(
        Text("No board of markers ({c} × {r}) was recognised in the photos.", c=target.columns, r=target.rows),
        "Fewer than four markers were found, or they are not where such a board has them.", todo,
        learn="adjustment/calibrate",
    )  # fmt: skip


NAMES = {"chessboard": "chessboard", "circles": "grid of circles", "aruco": "ArUco board"}
