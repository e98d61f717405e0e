r"""Exact mutual nearest neighbours by one matrix product, with Lowe's ratio test in both directions."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from graphos_core.data import Array, Candidates, Features
from graphos_core.features.matchers.hamming import Nearest, nearest_two_binary
from graphos_core.features.matchers.kernels import scan_rows
from graphos_core.features.matchers.places import Places, best_columns, places_of, row_tiles
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/matching"

TILE = 256
"""Rows of the similarity matrix computed at a time: large enough for the product, small enough for the cache."""


class MutualParams(Params):
    """Parameters of mutual matching."""

    ratio: Annotated[
        float,
        About(
            label="Ratio",
            symbol="q",
            low=0.0,
            low_open=True,
            high=1.0,
            step=0.05,
            help="A match counts if its distance is less than q times that of the second best candidate.",
            effect="Higher: more matches, more wrong ones (1: no test). Lower: fewer, safer matches.",
            learn=LESSON,
            level="novice",
        ),
    ] = 0.8
    mutual: Annotated[
        bool,
        About(
            label="Both directions",
            help="A match must be the best one, and pass the ratio test, seen from either photo.",
            effect="On: wrong matches at repeated structure fall away. Off: more matches, more wrong ones.",
            learn=LESSON,
            level="student",
        ),
    ] = True


@algorithm(
    stage="features",
    role="matcher",
    name="mutual",
    label="Mutual nearest neighbour",
    source="Lowe 2004, section 7.1 (ratio test)",
    learn=LESSON,
)
def mutual(a: Features, b: Features, params: MutualParams, *, run: Run) -> Candidates:
    r"""Match each point with the nearest descriptor, if it is clearly the nearest and from both photos.

    One product gives every distance, ``−½ d² = a·b − ½ a·a − ½ b·b``, the squares as two more columns of the
    descriptors. Both directions are read from it. With descriptors of bytes all sums are multiples of ½ below 2²³,
    hence exact in float32, in whatever order they are added: the result does not depend on threads or processor.
    Binary descriptors are compared by the number of bits in which they differ.

    Features at one and the same place are one point (`graphos_core.features.matchers.places`): the distance of two
    points is that of their nearest descriptors, the second nearest is another point, and a match names the first
    feature of each.

    Parameters
    ----------
    a, b : Features
        With n and m descriptors of the same length and metric; of different ones nothing matches.
    params : MutualParams
    run : Run

    Returns
    -------
    Candidates
        With the steps ``nearest``, ``ratio`` and, with `MutualParams.mutual`, ``mutual``.
    """
    places = (points_of(a), points_of(b))
    alike = a.metric == b.metric and a.descriptors.shape[1] == b.descriptors.shape[1]
    if min(len(places[0]), len(places[1])) < 2 or not alike:
        return Candidates.none()
    row, column = nearest_points(a, b, places)
    square = np.float32(params.ratio) ** 2
    passed = _passes(row, square)
    candidate = row[2]
    steps = [("nearest", len(passed)), ("ratio", int(passed.sum()))]
    if params.mutual:
        passed &= (column[2][candidate] == np.arange(len(passed))) & _passes(column, square)[candidate]
        steps.append(("mutual", int(passed.sum())))
    matches = np.stack([places[0].first, places[1].first[candidate]], axis=1).astype(np.int32)
    first = np.flatnonzero(passed)
    first = first[np.argsort(matches[first, 0], kind="stable")]
    nearest, second = (np.sqrt(np.maximum(-2.0 * score[first], 0.0)) for score in row[:2])
    return Candidates(
        matches=matches[first],
        distance=nearest.astype(np.float32),
        ratio=(nearest / np.maximum(second, 1e-12)).astype(np.float32),
        steps=tuple(steps),
    )


def points_of(features: Features) -> Places:
    """Return which features are one point; with binary descriptors each is one of its own."""
    if features.metric == "hamming":
        return Places(np.arange(len(features.xy)), (len(features.xy),))
    return places_of(features.xy)


def nearest_points(a: Features, b: Features, places: tuple[Places, Places]) -> tuple[Nearest, Nearest]:
    """Return for each point of `a` among those of `b`, and the other way, the nearest and second nearest.

    Parameters
    ----------
    a, b : Features
        Of the same metric.
    places : (Places, Places)
        Their points, as `points_of` gives them.

    Returns
    -------
    two triples (float32 (p,), float32 (p,), int32 (p,))
        As `nearest_two` gives them, by point instead of by feature.
    """
    if a.metric == "hamming":
        return nearest_two_binary(a.descriptors, b.descriptors)
    return nearest_two(a.descriptors, b.descriptors, places)


def nearest_two(a: Array, b: Array, places: tuple[Places, Places] | None = None) -> tuple[Nearest, Nearest]:
    """Return for each row of `a` among `b`, and for each of `b` among `a`, the nearest and second nearest.

    Parameters
    ----------
    a, b : uint8 or float32 (n, d), (m, d)
    places : (Places, Places), optional
        Which rows are one point; without it each is one of its own.

    Returns
    -------
    two triples (float32 (n,), float32 (n,), int32 (n,))
        ``−½ d²`` of the nearest and of the second nearest, and the index of the nearest.
    """
    rows, columns = places or (Places(np.arange(len(a)), (len(a),)), Places(np.arange(len(b)), (len(b),)))
    n, m = len(rows), len(columns)
    left = _extended(a, own_first=True)
    right = np.ascontiguousarray(_extended(b[columns.order], own_first=False).T)
    row = (np.empty(n, np.float32), np.empty(n, np.float32), np.empty(n, np.int32))
    column = (
        np.full(m, -np.inf, np.float32),
        np.full(m, -np.inf, np.float32),
        np.full(m, -1, np.int32),
    )
    for start, layers in row_tiles(rows, TILE):
        scores = best_columns(np.matmul(left[np.concatenate(layers)], right), columns)
        best = scores[: len(layers[0])]
        begin = len(best)
        for layer in layers[1:]:
            np.maximum(best[: len(layer)], scores[begin : begin + len(layer)], out=best[: len(layer)])
            begin += len(layer)
        scan_rows(np.ascontiguousarray(best), start, *row, *column)
    return row, column


def _extended(descriptors: Array, *, own_first: bool) -> Array:
    values = descriptors.astype(np.float32)
    half = -0.5 * np.einsum("ij,ij->i", values, values)[:, None]
    ones = np.ones_like(half)
    return np.hstack([values, half, ones] if own_first else [values, ones, half])


def _passes(side: tuple[Array, Array, Array], square: np.float32) -> Array:
    """d₁² < q² d₂² on −½ d²; with q = 1 everything but exact ties passes."""
    return np.asarray(side[0] > square * side[1])
