r"""Tracks: matches joined over all photos, so that each track is one object point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np

from graphos_core.data import Array, Features, PairMatches, Tracks
from graphos_core.features.graph import components
from graphos_core.features.track_kernels import join_all, join_without_conflict
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/tracks"


class TrackParams(Params):
    """Parameters of track building."""

    minimum: Annotated[
        int,
        About(
            label="Least photos",
            symbol="n",
            unit="photos",
            low=2,
            high=20,
            step=1,
            help="A track is kept when it is seen in so many photos.",
            effect="Higher: fewer, safer object points (a wrong match hardly survives three photos). Lower: more.",
            learn=LESSON,
            level="student",
        ),
    ] = 2
    conflicts: Annotated[
        Literal["cut", "drop"],
        About(
            label="Contradictions",
            help="What happens to a track with two points in one photo, which a wrong match causes.",
            effect="Cut: the match that would cause it is left out, strongest pairs come first. "
            "Drop: the whole track is left out.",
            choices={"cut": "cut the track", "drop": "drop the track"},
            learn=LESSON,
            level="expert",
        ),
    ] = "cut"


@algorithm(
    stage="features",
    role="tracks",
    name="tracks",
    label="Tracks by union–find",
    source="Moulon and Monasse 2012, Unordered feature tracking made fast and easy",
    learn=LESSON,
)
def tracks(
    features: Sequence[Features], pairs: Sequence[PairMatches], params: TrackParams, *, run: Run
) -> Tracks:
    """Join the verified matches of all pairs: features connected by matches see the same object point.

    Pairs are taken in the order of their number of verified matches (ties: by index), which matters only where
    contradictions are cut. Tracks are numbered by their first observation.

    Parameters
    ----------
    features : sequence of Features
        Of all photos.
    pairs : sequence of PairMatches
        Pairs with a reason are passed over.
    params : TrackParams
    run : Run

    Returns
    -------
    Tracks
        ``conflicts`` counts the connected sets that had two features in one photo.
    """
    offsets = np.concatenate([[0], np.cumsum([len(f.xy) for f in features])]).astype(np.int64)
    count = int(offsets[-1])
    photo = np.repeat(np.arange(len(features)), np.diff(offsets)).astype(np.int32)
    used = sorted(
        (pair for pair in pairs if not pair.reason), key=lambda pair: (-len(pair.matches), pair.a, pair.b)
    )
    empty = np.zeros(0, np.int32)
    first = np.concatenate([empty, *(p.matches[:, 0] + offsets[p.a] for p in used)]).astype(np.int32)
    second = np.concatenate([empty, *(p.matches[:, 1] + offsets[p.b] for p in used)]).astype(np.int32)
    run.check()
    plain = join_all(first, second, count)
    contradicting = _contradicting(plain, photo, len(features))
    if params.conflicts == "cut" and len(contradicting):
        label = join_without_conflict(first, second, photo, len(features))
        dropped = empty
    else:
        label, dropped = plain, contradicting
    members = np.flatnonzero(_kept(label, params.minimum, dropped))
    members = members[np.lexsort((members, label[members]))]
    _, track = np.unique(label[members], return_inverse=True)
    feature = members - offsets[photo[members]]
    return Tracks(
        photo=photo[members],
        feature=feature.astype(np.int32),
        track=track.astype(np.int32),
        xy=_gather([f.xy for f in features], members, 2).astype(np.float64),
        colour=_mean_colour(_gather([f.colour for f in features], members, 3), track),
        count=int(track[-1]) + 1 if len(track) else 0,
        conflicts=len(contradicting),
        components=components(len(features), used),
    )


def _contradicting(label: Array, photo: Array, photos: int) -> Array:
    """Labels of sets with two nodes in one photo."""
    keys, times = np.unique(label.astype(np.int64) * photos + photo, return_counts=True)
    return np.unique(keys[times > 1] // max(photos, 1))


def _kept(label: Array, minimum: int, dropped: Array) -> Array:
    size = np.bincount(label, minlength=len(label)) if len(label) else np.zeros(0, np.int64)
    size[dropped] = 0
    return np.asarray(size[label] >= minimum)


def _gather(parts: list[Array], members: Array, columns: int) -> Array:
    return np.concatenate([np.zeros((0, columns), np.float32), *parts])[members]


def _mean_colour(colour: Array, track: Array) -> Array:
    if len(track) == 0:
        return np.zeros((0, 3), np.uint8)
    number = np.bincount(track)
    means = [np.bincount(track, weights=colour[:, channel]) / number for channel in range(3)]
    return np.rint(np.stack(means, axis=1)).astype(np.uint8)
