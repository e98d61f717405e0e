r"""Matching along epipolar lines: with a known orientation the partner of a point is looked for on its line only."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from graphos_core.data import Array, Candidates, Features
from graphos_core.features.given_pair import GivenPair
from graphos_core.features.matchers.hamming import words_of
from graphos_core.features.matchers.hamming_kernels import half_squares
from graphos_core.features.matchers.kernels import scan_rows
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.features.matchers.neighbours import (
    Neighbours,
    candidates_of,
    comparable,
    from_half_squares,
    mutual_points,
)
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/guided-matching"

TILE = 256
"""Rows of the table of similarities computed at a time."""


class GuidedParams(MutualParams):
    """Parameters of guided matching."""

    band: Annotated[
        float,
        About(
            label="Width of the band",
            symbol="d",
            unit="px",
            low=0.5,
            high=200.0,
            step=0.5,
            help="A partner is looked for within this distance from the epipolar line, in both photos.",
            effect="Higher: tolerates a poorer orientation, more rivals. Lower: fewer rivals, so more points pass the "
            "ratio test.",
            learn=LESSON,
            level="novice",
        ),
    ] = 4.0


@algorithm(
    stage="features",
    role="matcher",
    name="guided",
    label="Guided along epipolar lines",
    source="Hartley and Zisserman 2004, section 11.6 (guided matching); Lowe 2004 (ratio test)",
    learn=LESSON,
)
def guided(
    a: Features, b: Features, params: GuidedParams, *, run: Run, given: GivenPair | None = None
) -> Candidates:
    """Match each point with the nearest descriptor among the points near its epipolar line.

    Cameras and exterior orientation come from the orientation given with the project. The ratio test compares with the
    second nearest *in the band*, so points of repeated structure that were ambiguous are matched. A pair that is not
    oriented there is matched as by `mutual`.

    Parameters
    ----------
    a, b : Features
    params : GuidedParams
    run : Run
    given : GivenPair, optional
        Orientation of both photos.

    Returns
    -------
    Candidates
        With the steps ``nearest`` (points that have any partner in the band), ``ratio`` and, with `mutual`, ``mutual``.
    """
    if given is None:
        return mutual(a, b, MutualParams(ratio=params.ratio, mutual=params.mutual), run=run)
    if not comparable(a, b):
        return Candidates.none()
    row, column = neighbours_in_band(a, b, given, params.band)
    passed = row.distinctive(params.ratio)
    steps = [("nearest", int((row.index >= 0).sum())), ("ratio", int(passed.sum()))]
    if params.mutual:
        passed &= mutual_points(row, column)
        passed[passed] &= column.distinctive(params.ratio)[row.index[passed]]
        steps.append(("mutual", int(passed.sum())))
    return candidates_of(row, np.flatnonzero(passed), steps)


def neighbours_in_band(
    a: Features, b: Features, given: GivenPair, band: float
) -> tuple[Neighbours, Neighbours]:
    """Return the neighbours of the points of both photos among those within `band` px of their epipolar lines."""
    matrix, p, q, length_b, length_a = given.epipolar(a.xy, b.xy)
    lines = (p @ matrix.T).astype(np.float32)
    q, length_a, length_b = (np.ascontiguousarray(v, np.float32) for v in (q, length_a, length_b))
    n, m = len(lines), len(q)
    row = (np.empty(n, np.float32), np.empty(n, np.float32), np.empty(n, np.int32))
    column = (np.full(m, -np.inf, np.float32), np.full(m, -np.inf, np.float32), np.full(m, -1, np.int32))
    similar = _Similarity(a.descriptors, b.descriptors, a.metric)
    for start in range(0, n, TILE):
        part = slice(start, start + TILE)
        scores = similar.rows(part)
        reach = band * np.minimum(length_b[part, None], length_a[None])
        near = np.abs(lines[part] @ q.T) <= reach  # false for NaN
        scores[~near] = -np.inf
        scan_rows(scores, start, *row, *column)
    return from_half_squares(*row), from_half_squares(*column)


class _Similarity:
    """Rows of ``−½ d²`` between the descriptors of two photos."""

    def __init__(self, a: Array, b: Array, metric: str) -> None:
        self._binary = metric == "hamming"
        if self._binary:
            self._left, right = (words_of(side) for side in (a, b))
            self._right = np.ascontiguousarray(right.T)
            return
        values = [side.astype(np.float32) for side in (a, b)]
        half = [-0.5 * np.einsum("ij,ij->i", v, v)[:, None] for v in values]
        self._left = np.hstack([values[0], half[0], np.ones_like(half[0])])
        self._right = np.ascontiguousarray(np.hstack([values[1], np.ones_like(half[1]), half[1]]).T)

    def rows(self, part: slice) -> Array:
        """Return float32 (t, m)."""
        left = self._left[part]
        if not self._binary:
            return left @ self._right
        scores = np.empty((len(left), self._right.shape[1]), np.float32)
        half_squares(left, self._right, scores)
        return scores
