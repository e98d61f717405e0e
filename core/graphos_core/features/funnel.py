"""The funnel: how many points and matches were left after each step, for each pair and in total."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data import Features, PairMatches, Tracks
from graphos_core.results import FeaturesResult


@dataclass(frozen=True)
class PairFunnel:
    """The funnel of one pair.

    Attributes
    ----------
    a, b : int
    steps : tuple of (str, int)
        In order: ``keypoints`` of the first photo, the steps of the matcher, ``verified``, ``kept`` (with a thinning),
        ``in tracks`` (matches of which both points belong to one track).
    scene, reason : str
        As in `PairMatches`.
    """

    a: int
    b: int
    steps: tuple[tuple[str, int], ...]
    scene: str
    reason: str


@dataclass(frozen=True)
class Funnel:
    """The funnel of a block.

    Attributes
    ----------
    pairs : tuple of PairFunnel
    total : tuple of (str, int)
        In order: ``found`` and ``keypoints`` of all photos, the steps summed over the pairs, then ``observations`` and
        ``tracks``.
    tried, used : int
        Pairs that were matched, and those that were verified.
    conflicts : int
        Tracks that had two points in one photo.
    """

    pairs: tuple[PairFunnel, ...]
    total: tuple[tuple[str, int], ...]
    tried: int
    used: int
    conflicts: int


def funnel(result: FeaturesResult) -> Funnel:
    """Return the whole funnel of a features result."""
    track_of = _tracks_of_features(result.features, result.tracks)
    pairs = tuple(_pair_funnel(pair, result.features, track_of) for pair in result.pairs)
    total = {
        "found": sum(max(f.found, len(f.xy)) for f in result.features),
        "keypoints": sum(len(f.xy) for f in result.features),
    }
    for pair in pairs:
        for name, count in pair.steps:
            if name != "keypoints":
                total[name] = total.get(name, 0) + count
    total["observations"] = len(result.tracks.track)
    total["tracks"] = result.tracks.count
    used = sum(1 for pair in pairs if not pair.reason)
    return Funnel(pairs, tuple(total.items()), len(pairs), used, result.tracks.conflicts)


def _pair_funnel(pair: PairMatches, features: tuple[Features, ...], track_of: list[np.ndarray]) -> PairFunnel:
    steps = [("keypoints", len(features[pair.a].xy)), *pair.steps]
    if not pair.steps:
        steps += [("candidates", pair.candidates), ("verified", len(pair.matches))]
    one, two = track_of[pair.a][pair.matches[:, 0]], track_of[pair.b][pair.matches[:, 1]]
    steps.append(("in tracks", int(((one >= 0) & (one == two)).sum())))
    return PairFunnel(pair.a, pair.b, tuple(steps), pair.scene, pair.reason)


def _tracks_of_features(features: tuple[Features, ...], tracks: Tracks) -> list[np.ndarray]:
    """Return the track of each feature of each photo, −1 for none."""
    found = [np.full(len(own.xy), -1, np.int64) for own in features]
    for photo, table in enumerate(found):
        mine = tracks.photo == photo
        table[tracks.feature[mine]] = tracks.track[mine]
    return found
