"""Approximate nearest neighbours by randomised kd-trees (FLANN)."""

from __future__ import annotations

from typing import Annotated

import cv2
import numpy as np

from graphos_core.data import Array, Candidates, Features
from graphos_core.features.matchers.mutual import MutualParams
from graphos_core.features.matchers.neighbours import (
    Neighbours,
    candidates_of,
    comparable,
    exact_neighbours,
    mutual_points,
)
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/flann"

KD_TREES = 1
"""FLANN's number of the algorithm."""


class FlannParams(MutualParams):
    """Parameters of approximate matching."""

    trees: Annotated[
        int,
        About(
            label="Trees",
            symbol="T",
            unit="trees",
            low=1,
            high=16,
            step=1,
            help="Randomised kd-trees that are searched together.",
            effect="Higher: more neighbours are found, slower to build. Lower: faster.",
            learn=LESSON,
            level="expert",
        ),
    ] = 4
    checks: Annotated[
        int,
        About(
            label="Checks",
            symbol="c",
            unit="leaves",
            low=1,
            high=4096,
            step=16,
            help="Descriptors compared before the search for a neighbour ends.",
            effect="Higher: nearer to exact, slower. Lower: faster, the true neighbour is missed more often.",
            learn=LESSON,
            level="student",
        ),
    ] = 64


@algorithm(
    stage="features",
    role="matcher",
    name="flann",
    label="Approximate neighbours (FLANN, kd-trees)",
    source="Muja and Lowe 2009, Fast approximate nearest neighbors; Silpa-Anan and Hartley 2008 (randomised kd-trees)",
    learn=LESSON,
)
def flann(a: Features, b: Features, params: FlannParams, *, run: Run) -> Candidates:
    """Match as `mutual` does, with neighbours that are found approximately.

    The trees are random; their seed is that of the run. Binary descriptors have no kd-tree and are matched exactly.

    Parameters
    ----------
    a, b : Features
    params : FlannParams
    run : Run

    Returns
    -------
    Candidates
        With the steps ``nearest``, ``ratio`` and, with `mutual`, ``mutual``.
    """
    if not comparable(a, b):
        return Candidates.none()
    if a.metric == "hamming":
        row, column = exact_neighbours(a.descriptors, b.descriptors, a.metric)
    else:
        row = approximate_neighbours(a.descriptors, b.descriptors, params, run.seed)
        column = approximate_neighbours(b.descriptors, a.descriptors, params, run.seed)
    passed = row.distinctive(params.ratio)
    steps = [("nearest", len(row.index)), ("ratio", int(passed.sum()))]
    if params.mutual:
        passed &= mutual_points(row, column)
        passed[passed] &= column.distinctive(params.ratio)[row.index[passed]]
        steps.append(("mutual", int(passed.sum())))
    return candidates_of(row, np.flatnonzero(passed), steps)


def approximate_neighbours(a: Array, b: Array, params: FlannParams, seed: int) -> Neighbours:
    """Return the neighbours of each row of `a` (n, d) among `b` (m, d), found in kd-trees of `b`."""
    cv2.setRNGSeed(seed)  # of this thread
    index = cv2.flann.Index(b.astype(np.float32), {"algorithm": KD_TREES, "trees": params.trees})
    found, squares = index.knnSearch(a.astype(np.float32), 2, params={"checks": params.checks})
    missing = found < 0
    distance = np.where(missing, np.inf, np.sqrt(np.maximum(squares.astype(np.float64), 0.0)))
    return Neighbours(distance[:, 0], distance[:, 1], found[:, 0].astype(np.int32))
