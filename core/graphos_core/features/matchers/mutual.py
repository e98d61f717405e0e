r"""Exact mutual nearest neighbours by one matrix product, with Lowe's ratio test in both directions."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from graphos_core.data import Array, Candidates, Features
from graphos_core.features.matchers.hamming import nearest_two_binary
from graphos_core.features.matchers.kernels import scan_rows
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
    n, m = len(a.descriptors), len(b.descriptors)
    alike = a.metric == b.metric and a.descriptors.shape[1] == b.descriptors.shape[1]
    if n < 2 or m < 2 or not alike:
        return Candidates.none()
    nearest_of = nearest_two_binary if a.metric == "hamming" else nearest_two
    row, column = nearest_of(a.descriptors, b.descriptors)
    square = np.float32(params.ratio) ** 2
    passed = _passes(row, square)
    candidate = row[2]
    steps = [("nearest", n), ("ratio", int(passed.sum()))]
    if params.mutual:
        passed &= (column[2][candidate] == np.arange(n)) & _passes(column, square)[candidate]
        steps.append(("mutual", int(passed.sum())))
    first = np.flatnonzero(passed)
    nearest, second = (np.sqrt(np.maximum(-2.0 * score[first], 0.0)) for score in row[:2])
    return Candidates(
        matches=np.stack([first, candidate[first]], axis=1).astype(np.int32),
        distance=nearest.astype(np.float32),
        ratio=(nearest / np.maximum(second, 1e-12)).astype(np.float32),
        steps=tuple(steps),
    )


def nearest_two(a: Array, b: Array) -> tuple[tuple[Array, Array, Array], tuple[Array, Array, Array]]:
    """Return for each row of `a` among `b`, and for each of `b` among `a`, the nearest and second nearest.

    Parameters
    ----------
    a, b : uint8 or float32 (n, d), (m, d)

    Returns
    -------
    two triples (float32 (n,), float32 (n,), int32 (n,))
        ``−½ d²`` of the nearest and of the second nearest, and the index of the nearest.
    """
    n, m = len(a), len(b)
    left = _extended(a, own_first=True)
    right = np.ascontiguousarray(_extended(b, own_first=False).T)
    row = (np.empty(n, np.float32), np.empty(n, np.float32), np.empty(n, np.int32))
    column = (
        np.full(m, -np.inf, np.float32),
        np.full(m, -np.inf, np.float32),
        np.full(m, -1, np.int32),
    )
    buffer = np.empty((min(TILE, n), m), np.float32)
    for start in range(0, n, TILE):
        tile = left[start : start + TILE]
        scores = np.matmul(tile, right, out=buffer[: len(tile)])
        scan_rows(scores, start, *row, *column)
    return row, column


def _extended(descriptors: Array, *, own_first: bool) -> Array:
    values = descriptors.astype(np.float32)
    half = -0.5 * np.einsum("ij,ij->i", values, values)[:, None]
    ones = np.ones_like(half)
    return np.hstack([values, half, ones] if own_first else [values, ones, half])


def _passes(side: tuple[Array, Array, Array], square: np.float32) -> Array:
    """d₁² < q² d₂² on −½ d²; with q = 1 everything but exact ties passes."""
    return np.asarray(side[0] > square * side[1])
