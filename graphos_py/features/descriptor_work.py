"""What the descriptor page computes in its thread: grey photos, patches, nearest neighbours in the other photo."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array, Features, PairMatches
from graphos_core.features.descriptor import Described, describe
from graphos_core.features.matchers.nearest_few import nearest_few
from graphos_core.run import Run

COUNT, SPARE = 6, 6
"""Nearest neighbours that are shown, and more that the ratio of the last ones may need."""


@dataclass(frozen=True)
class Neighbour:
    """One of the nearest descriptors in the other photo.

    Attributes
    ----------
    index : int
        Feature in the other photo.
    distance : float
        Between the descriptors, in their metric.
    ratio : float
        This distance through that of the next one at another place: the ratio test looks at that of the first.
    verified : bool
        Whether the pair holds it as a verified match of the keypoint.
    described : Described or None
        Its patch; None where it could not be cut.
    """

    index: int
    distance: float
    ratio: float
    verified: bool
    described: Described | None


@dataclass(frozen=True)
class Look:
    """A keypoint with its patch and its nearest neighbours; `why` says in a word why there are none."""

    photo: int
    keypoint: int
    other: int
    described: Described | None
    neighbours: tuple[Neighbour, ...]
    why: str = ""


class GreyPhotos:
    """The grey photos that were looked at last, as the detector saw them."""

    KEPT = 3

    def __init__(self) -> None:
        self._known: dict[str, Array] = {}

    def get(self, digest: str, read: Callable[[], Array]) -> Array:
        """Return a photo, reading it if it is not one of the last."""
        if digest not in self._known:
            while len(self._known) >= self.KEPT:
                self._known.pop(next(iter(self._known)))
            self._known[digest] = read()
        return self._known[digest]


def look_at(
    keypoint: tuple[int, int],
    other: int,
    features: tuple[Features, ...],
    pairs: tuple[PairMatches, ...],
    grey: Callable[[int], Array],
    run: Run,
) -> Look:
    """Return a keypoint (photo, index) with its patch and its nearest neighbours in photo `other` (−1 for none)."""
    photo, index = keypoint
    mine = features[photo]
    described = cut(grey(photo), mine, index)
    if other < 0:
        return Look(photo, index, other, described, ())
    theirs = features[other]
    if mine.descriptors.shape[1:] != theirs.descriptors.shape[1:] or mine.metric != theirs.metric:
        return Look(photo, index, other, described, (), "kinds")
    run.check()
    found, distance = nearest_few(mine.descriptors[index], theirs.descriptors, COUNT + SPARE, mine.metric)
    image = grey(other)
    verified = verified_partner(pairs, photo, index, other)
    ratios = ratios_to_next_place(distance, np.asarray(theirs.xy)[found])
    neighbours = [
        Neighbour(i, d, q, i == verified, cut(image, theirs, i))
        for i, d, q in zip(found.tolist(), distance.tolist(), ratios.tolist())
    ]
    return Look(photo, index, other, described, tuple(neighbours[:COUNT]))


def ratios_to_next_place(distance: Array, xy: Array) -> Array:
    """Return each distance through the next one of a point at another place (n,), 1 where there is none.

    Features at one place are one point with several descriptors, as the matchers take them
    (`graphos_core.features.matchers.places`).
    """
    ratios = np.ones(len(distance))
    for row, own in enumerate(distance.tolist()):
        later = np.flatnonzero((xy[row + 1 :] != xy[row]).any(axis=1))
        if len(later) and distance[row + 1 + later[0]] > 0:
            ratios[row] = own / distance[row + 1 + later[0]]
    return ratios


def cut(grey: Array, features: Features, index: int) -> Described | None:
    """Return the patch and gradients of a keypoint; None where it lies outside of the photo or has no size."""
    x, y = (float(v) for v in features.xy[index])
    try:
        return describe(grey, x, y, float(features.scale[index]), float(features.angle[index]))
    except ValueError:
        return None


def verified_partner(pairs: tuple[PairMatches, ...], photo: int, keypoint: int, other: int) -> int:
    """Return the feature of photo `other` that is the verified match of a keypoint; −1 where there is none."""
    for pair in pairs:
        if {pair.a, pair.b} == {photo, other} and not pair.reason:
            side = 0 if pair.a == photo else 1
            rows = np.flatnonzero(np.asarray(pair.matches)[:, side] == keypoint)
            return int(pair.matches[rows[0], 1 - side]) if len(rows) else -1
    return -1


def partners(pairs: tuple[PairMatches, ...], photo: int, count: int) -> list[int]:
    """Return the other photos, those with most verified matches first."""
    matches = np.zeros(count, np.int64)
    for pair in pairs:
        if photo in (pair.a, pair.b) and not pair.reason:
            matches[pair.b if pair.a == photo else pair.a] = len(pair.matches)
    return [int(i) for i in np.argsort(-matches, kind="stable") if i != photo]
