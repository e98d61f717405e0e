"""Matches that another program found, read from its files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np

from graphos_core.data import Array, Candidates, Features
from graphos_core.errors import UserError
from graphos_core.exchange.feature_records import PhotoFeatures
from graphos_core.exchange.tie_point_records import flat_name
from graphos_core.features.detectors.imported import LESSON, whole_source
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run

SAME = 0.02
"""A match of a file belongs to the keypoint of the same position and size (px) and direction, to this."""


class ImportedMatchesParams(Params):
    """Parameters of imported matches."""

    source: Annotated[
        str,
        About(
            label="Folder or database",
            help="Folder with a file of keypoints for each photo and matches.txt or matches.csv, or COLMAP's database.",
            effect="Another source: other matches.",
            learn=LESSON,
            level="novice",
        ),
    ] = ""


@algorithm(
    stage="features",
    role="matcher",
    name="imported-matches",
    label="Imported matches",
    source="Files of any matcher; COLMAP documentation, database and match importer (text form)",
    learn=LESSON,
)
def imported_matches(
    a: Features, b: Features, params: ImportedMatchesParams, *, run: Run, names: tuple[str, str] = ("", "")
) -> Candidates:
    """Take the matches of a pair from files; they go through the same verification as any others.

    A match is found again by position, size and direction of its two keypoints, so masks and a largest number of points may have left
    some out.

    Parameters
    ----------
    a, b : Features
        With the same keypoints as the source.
    params : ImportedMatchesParams
    run : Run
    names : (str, str)
        Of the photos.

    Returns
    -------
    Candidates
        With the steps ``in file`` and ``found again``.

    Raises
    ------
    UserError
        When no source is given.
    """
    if not params.source:
        raise UserError(
            "No source of imported matches is given.",
            todo="Name a folder or a database in the parameter “Folder or database”.",
            learn=LESSON,
        )
    files = whole_source(Path(params.source).expanduser())
    place = {flat_name(name): i for i, name in enumerate(files.photos)}
    index = [place.get(flat_name(name), -1) for name in names]
    matches = np.zeros((0, 2), np.int64)
    for pair in files.pairs:
        if [pair.a, pair.b] == index:
            matches = pair.matches
        elif [pair.b, pair.a] == index:
            matches = pair.matches[:, ::-1]
    if not len(matches):
        return Candidates.none((("in file", 0), ("found again", 0)))
    here = [
        same_points(_shape(files.features[i])[matches[:, side]], _shape(own))
        for side, (i, own) in enumerate(zip(index, (a, b), strict=True))
    ]
    both = np.column_stack(here)
    known = both[(both >= 0).all(axis=1)]
    found = np.unique(known, axis=0).astype(np.int32)
    plain = Candidates.of(found)
    steps = (("in file", len(matches)), ("found again", len(found)))
    return Candidates(matches=found, distance=plain.distance, ratio=plain.ratio, steps=steps)


def _shape(points: Features | PhotoFeatures) -> Array:
    """Return what identifies a keypoint, float64 (n, 5): a place may have several, of other size or direction."""
    angle = np.asarray(points.angle, np.float64)
    return np.column_stack([points.xy, points.scale, np.cos(angle), np.sin(angle)]).astype(np.float64)


def same_points(wanted: Array, there: Array) -> Array:
    """Return the index in `there` (m, d) of the same keypoint as each wanted one (n, d), −1 where there is none."""
    from scipy.spatial import cKDTree

    if not len(there):
        return np.full(len(wanted), -1)
    distance, index = cKDTree(there).query(wanted)
    return np.where(distance <= SAME, index, -1)
