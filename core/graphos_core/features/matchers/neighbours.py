"""Nearest and second nearest neighbours as distances, and the tests that matchers make with them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array, Candidates, Features
from graphos_core.features.matchers.hamming import nearest_two_binary
from graphos_core.features.matchers.mutual import nearest_two
from graphos_core.features.matchers.places import Places


@dataclass(frozen=True)
class Neighbours:
    """The nearest and second nearest neighbour of each point of a photo in the other one.

    Attributes
    ----------
    first, second : float64 (n,)
        Distances; infinite where there is none.
    index : int32 (n,)
        Of the nearest; −1 where there is none.
    """

    first: Array
    second: Array
    index: Array

    def distinctive(self, ratio: float) -> Array:
        """Return which points pass the ratio test ``d₁ < q d₂``, bool (n,); without a second they pass."""
        return np.asarray((self.index >= 0) & (self.first < ratio * self.second))


def comparable(a: Features, b: Features) -> bool:
    """Say whether two photos have descriptors of one kind, and enough of them to tell nearest from second nearest."""
    alike = a.metric == b.metric and a.descriptors.shape[1] == b.descriptors.shape[1]
    return alike and len(a.descriptors) > 1 and len(b.descriptors) > 1


def exact_neighbours(
    a: Array, b: Array, metric: str, places: tuple[Places, Places] | None = None
) -> tuple[Neighbours, Neighbours]:
    """Return the exact neighbours of each row of `a` among `b` and of each of `b` among `a`.

    Parameters
    ----------
    a, b : (n, d), (m, d)
    metric : {"l2", "hamming"}
    places : (Places, Places), optional
        With l2: which rows are one point; neighbours are then those of points, not of rows.
    """
    sides = nearest_two_binary(a, b) if metric == "hamming" else nearest_two(a, b, places)
    row, column = (from_half_squares(*side[:3]) for side in sides)
    return row, column


def from_half_squares(first: Array, second: Array, index: Array) -> Neighbours:
    """Return neighbours from ``−½ d²`` of the nearest and second nearest."""
    one, two = (np.sqrt(np.maximum(-2.0 * score.astype(np.float64), 0.0)) for score in (first, second))
    return Neighbours(one, two, index)


def candidates_of(
    row: Neighbours, first: Array, steps: list[tuple[str, int]], places: tuple[Places, Places] | None = None
) -> Candidates:
    """Return the matches of the points `first` of photo a with their nearest in b, by the first feature of each."""
    matches = np.stack([first, row.index[first]], axis=1).astype(np.int32)
    if places is not None:
        matches = np.stack([places[0].first[matches[:, 0]], places[1].first[matches[:, 1]]], axis=1)
        order = np.argsort(matches[:, 0], kind="stable")
        matches, first = matches[order], first[order]
    nearest, second = row.first[first], row.second[first]
    return Candidates(
        matches=matches.astype(np.int32),
        distance=nearest.astype(np.float32),
        ratio=(nearest / np.maximum(second, 1e-12)).astype(np.float32),
        steps=tuple(steps),
    )


def mutual_points(row: Neighbours, column: Neighbours) -> Array:
    """Return which points of a are the nearest of their nearest, bool (n,)."""
    back = np.where(row.index >= 0, column.index[row.index], -1)
    return np.asarray((row.index >= 0) & (back == np.arange(len(row.index))))
