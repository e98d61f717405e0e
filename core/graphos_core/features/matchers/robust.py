r"""Robust matching: ratio test, then a limit of the distance relative to the largest, then both directions."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from graphos_core.data import Array, Candidates, Features
from graphos_core.features.matchers.mutual import MutualParams, points_of
from graphos_core.features.matchers.neighbours import (
    Neighbours,
    candidates_of,
    comparable,
    exact_neighbours,
    mutual_points,
)
from graphos_core.features.matchers.places import Places
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/robust-matching"


class RobustParams(MutualParams):
    """Parameters of robust matching."""

    discrepancy: Annotated[
        float,
        About(
            label="Discrepancy K",
            symbol="K",
            low=0.0,
            high=1.0,
            step=0.05,
            help="A match stays when its distance is at most K times the largest of those that passed the ratio test.",
            effect="Higher: more matches (1: no limit). Lower: only the most alike stay.",
            learn=LESSON,
            level="novice",
        ),
    ] = 0.8
    distance: Annotated[
        Literal["l2", "hellinger", "bhattacharyya"],
        About(
            label="Distance",
            help="How two descriptors are compared.",
            effect="Euclidean: as they are. Hellinger: as histograms, large bins weigh less. Bhattacharyya: as Hellinger, "
            "but the ratio test then compares about squares and lets more pass.",
            choices={"l2": "Euclidean (L2)", "hellinger": "Hellinger", "bhattacharyya": "Bhattacharyya"},
            learn="features/descriptor-distances",
            level="student",
        ),
    ] = "l2"
    rooted: Annotated[
        bool,
        About(
            label="Roots already",
            help="The descriptors are square roots of histograms already, as RootSIFT makes them.",
            effect="On: Hellinger and Bhattacharyya take them as they are. Off: roots are taken first.",
            learn="features/descriptor-distances",
            level="expert",
        ),
    ] = True


@algorithm(
    stage="features",
    role="matcher",
    name="robust",
    label="Robust (ratio, discrepancy, both directions)",
    source="González-Aguilera et al. 2018 (GRAPHOS), robust matcher; Lowe 2004; Arandjelović and Zisserman 2012 (Hellinger); "
    "Bhattacharyya 1943",
    learn=LESSON,
)
def robust(a: Features, b: Features, params: RobustParams, *, run: Run) -> Candidates:
    """Match in three steps: distinctive points, of these the more alike, of these the mutual ones.

    The distances are exact (`nearest_two`). Binary descriptors have one distance only, the number of different bits;
    the choice of another does not concern them. Features at one place are one point, as in `mutual`.

    Parameters
    ----------
    a, b : Features
    params : RobustParams
    run : Run

    Returns
    -------
    Candidates
        With the steps ``nearest``, ``ratio``, ``discrepancy`` and, with `mutual`, ``mutual``.
    """
    places = points_of(a), points_of(b)
    if not comparable(a, b) or min(len(places[0]), len(places[1])) < 2:
        return Candidates.none()
    row, column = described_neighbours(a, b, params.distance, params.rooted, places)
    passed = row.distinctive(params.ratio)
    steps = [("nearest", len(row.index)), ("ratio", int(passed.sum()))]
    largest = float(row.first[passed].max(initial=0.0))
    passed &= row.first <= params.discrepancy * largest
    steps.append(("discrepancy", int(passed.sum())))
    if params.mutual:
        passed &= mutual_points(row, column)
        passed[passed] &= column.distinctive(params.ratio)[row.index[passed]]
        steps.append(("mutual", int(passed.sum())))
    return candidates_of(row, np.flatnonzero(passed), steps, places)


def described_neighbours(
    a: Features, b: Features, distance: str, rooted: bool, places: tuple[Places, Places]
) -> tuple[Neighbours, Neighbours]:
    """Return the neighbours of the points of both photos by a distance of their descriptors."""
    if a.metric == "hamming" or distance == "l2":
        return exact_neighbours(a.descriptors, b.descriptors, a.metric, places)
    sides = exact_neighbours(
        unit_roots(a.descriptors, rooted), unit_roots(b.descriptors, rooted), "l2", places
    )
    row, column = (
        Neighbours(histogram_distance(s.first, distance), histogram_distance(s.second, distance), s.index)
        for s in sides
    )
    return row, column


def unit_roots(descriptors: Array, rooted: bool) -> Array:
    """Return roots of histograms as unit vectors, float32 (n, d): ``√(p / Σp)``; of roots only the length is set.

    Negative entries, which no histogram has, count as zero.
    """
    values = np.maximum(descriptors.astype(np.float32), 0.0)
    if not rooted:
        values = np.sqrt(values)
    return values / np.maximum(np.linalg.norm(values, axis=1, keepdims=True), np.float32(1e-12))


def histogram_distance(chord: Array, name: str) -> Array:
    """Return the distance of histograms from the distance of their unit roots, ``chord = √(2 − 2 BC)``.

    With the coefficient ``BC = Σ √(p q)``: Hellinger ``√(1 − BC)``, Bhattacharyya ``−ln BC`` (infinite for nothing in
    common).
    """
    square = np.minimum(chord**2 / 2.0, 1.0)
    if name == "hellinger":
        return np.asarray(np.sqrt(square))
    with np.errstate(divide="ignore"):
        return np.asarray(-np.log1p(-square))
