"""Features at one and the same place are one point with several descriptors.

SIFT gives a blob a feature for every peak of its orientation histogram, detectors with simulated views one for every
view. Lowe's ratio test compares with the nearest descriptor *of another object point* (Lowe 2004, section 7.1); a
second feature of the same place would make a point doubt itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array


@dataclass(frozen=True)
class Places:
    """Features by place, in layers: the first ones of all places, then the second ones of those that have two.

    Places with most features come first, so that layer l belongs to the first ``layers[l]`` places and the best of
    all features of a place is a plain maximum over layers.

    Attributes
    ----------
    order : int64 (n,)
        Features, layer after layer.
    layers : tuple of int
        Size of each layer, not growing.
    """

    order: Array
    layers: tuple[int, ...]

    def __len__(self) -> int:
        return self.layers[0] if self.layers else 0

    @property
    def first(self) -> Array:
        """First feature of every place, int64 (p,)."""
        return self.order[: len(self)]

    def starts(self) -> tuple[int, ...]:
        """Where each layer begins in `order`."""
        return tuple(int(start) for start in np.cumsum((0, *self.layers))[:-1])


def places_of(xy: Array) -> Places:
    """Return the places of features: those with exactly equal positions share one.

    Parameters
    ----------
    xy : float32 (n, 2)
    """
    n = len(xy)
    key = np.ascontiguousarray(xy, np.float32).view(np.int64).ravel()
    _, group, size = np.unique(key, return_inverse=True, return_counts=True)
    if len(size) == n:
        return Places(np.arange(n), (n,) if n else ())
    grouped = np.argsort(group, kind="stable")
    begins = np.cumsum(np.r_[0, size])[:-1]
    rank = np.empty(n, np.int64)
    rank[grouped] = np.arange(n) - np.repeat(begins, size)
    place = np.empty(len(size), np.int64)
    place[np.lexsort((grouped[begins], -size))] = np.arange(len(size))
    order = np.lexsort((place[group], rank))
    return Places(order, tuple(int(count) for count in np.bincount(rank)))


def best_columns(scores: Array, places: Places) -> Array:
    """Return the best score of every place, (t, p), of columns in the order of the places; `scores` is changed."""
    best = scores[:, : len(places)]
    for start, count in zip(places.starts()[1:], places.layers[1:], strict=True):
        np.maximum(best[:, :count], scores[:, start : start + count], out=best[:, :count])
    return best


def row_tiles(places: Places, most: int) -> list[tuple[int, list[Array]]]:
    """Return the places in tiles of about `most` features: first place, and the features of each layer."""
    tiles = []
    begin = 0
    while begin < len(places):
        depth = sum(count > begin for count in places.layers)
        end = min(len(places), begin + max(1, most // depth))
        layers = [
            places.order[start + begin : start + min(end, count)]
            for start, count in zip(places.starts(), places.layers, strict=True)
            if count > begin
        ]
        tiles.append((begin, layers))
        begin = end
    return tiles
