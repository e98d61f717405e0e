"""Tie points as a record: from observations, from pairs, and as pairs."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array, Tracks
from graphos_core.text import Text


@dataclass(frozen=True)
class TiePoints:
    """Tie points with the photos they were measured in.

    Attributes
    ----------
    photos : tuple of str
        Names; `Tracks.photo` counts in them.
    tracks : Tracks
        Positions in px of the full photo, centre of the top-left pixel at (0, 0).
    remarks : tuple of str
    """

    photos: tuple[str, ...]
    tracks: Tracks
    remarks: tuple[str, ...] = ()


def from_observations(
    photos: tuple[str, ...],
    point: Array,
    photo: Array,
    xy: Array,
    colours: Array | None = None,
    lost: int = 0,
) -> TiePoints:
    """Return tie points from observations; points seen once or twice in one photo are left out and counted.

    Parameters
    ----------
    photos : tuple of str
    point, photo : int (m,)
    xy : float64 (m, 2)
    colours : uint8 (p, 3) or None
    lost : int
        Points that were left out before.
    """
    keys, point = np.unique(np.asarray(point), return_inverse=True)
    pairs, count = np.unique(np.column_stack([point, photo]), axis=0, return_counts=True)
    twice = np.zeros(len(keys), dtype=bool)
    twice[pairs[count > 1, 0]] = True
    rays = np.bincount(pairs[:, 0], minlength=len(keys)) if len(pairs) else np.zeros(len(keys), dtype=int)
    good = (rays >= 2) & ~twice
    number = np.cumsum(good) - 1
    keep = good[point] if len(point) else np.zeros(0, dtype=bool)
    track, photo, xy = number[point[keep]], np.asarray(photo)[keep], np.asarray(xy, dtype=np.float64)[keep]
    order = np.lexsort((photo, track))
    feature = np.zeros(len(track), dtype=np.int32)
    for i in range(len(photos)):
        mine = np.flatnonzero(photo[order] == i)
        feature[mine] = np.arange(len(mine))
    found = int(good.sum())
    conflicts = int(twice.sum()) + lost
    tracks = Tracks(
        photo=photo[order].astype(np.int32), feature=feature, track=track[order].astype(np.int32),
        xy=np.ascontiguousarray(xy[order]).reshape(-1, 2),
        colour=np.full((found, 3), 128, dtype=np.uint8) if colours is None else np.asarray(colours)[keys[good]],
        count=found, conflicts=conflicts,
    )  # fmt: skip
    remarks = []
    if conflicts:
        remarks.append(
            Text("{count} points were left out: they have two positions in one photo.", count=conflicts)
        )
    single = int((rays == 1).sum())
    if single:
        remarks.append(Text("{count} points were left out: they are seen in one photo only.", count=single))
    return TiePoints(tuple(photos), tracks, tuple(remarks))


Key = tuple[int, float, float]
"""Photo, x, y of an image point."""


def join(photos: tuple[str, ...], pairs: list[tuple[Key, Key]]) -> TiePoints:
    """Join pairs of image points (photo, x, y) to points seen in several photos (connected components)."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    index: dict[Key, int] = {}
    a = [index.setdefault(first, len(index)) for first, _ in pairs]
    b = [index.setdefault(second, len(index)) for _, second in pairs]
    size = len(index)
    graph = coo_matrix((np.ones(len(a)), (a, b)), shape=(size, size))
    label = connected_components(graph, directed=False)[1] if size else np.zeros(0, dtype=int)
    table = np.array(list(index), dtype=np.float64).reshape(-1, 3)
    return from_observations(photos, label, table[:, 0].astype(int), table[:, 1:])


def pairs_of(points: TiePoints) -> dict[tuple[int, int], list[tuple[int, int]]]:
    """Return the observations of every pair of photos that see a common point."""
    t = points.tracks
    bounds = np.searchsorted(t.track, np.arange(t.count + 1))
    found: dict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for first, last in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        for i in range(first, last):
            for j in range(i + 1, last):
                found[int(t.photo[i]), int(t.photo[j])].append((i, j))
    return found


def flat_name(name: str) -> str:
    """Return a name of a photo without the separators of folders."""
    return name.replace("/", "_").replace("\\", "_")
