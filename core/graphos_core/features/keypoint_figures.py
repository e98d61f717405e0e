"""What became of the keypoints of one photo: in how many pairs each was matched, how many photos see its point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphos_core.data import Array, PairMatches, Tracks


def pairs_of_keypoints(pairs: Sequence[PairMatches], photo: int, count: int) -> Array:
    """Return the number of pairs, int32 (count,), in which each keypoint of a photo has a verified match.

    Parameters
    ----------
    pairs : sequence of PairMatches
        Pairs with a reason are passed over.
    photo : int
    count : int
        Keypoints of the photo.
    """
    number = np.zeros(count, np.int32)
    for pair in pairs:
        if photo in (pair.a, pair.b) and not pair.reason:
            mine = np.asarray(pair.matches).reshape(-1, 2)[:, 0 if photo == pair.a else 1]
            number[np.unique(mine)] += 1
    return number


def rays_of_keypoints(tracks: Tracks, photo: int, count: int) -> Array:
    """Return the number of photos, int32 (count,), that see the object point of each keypoint of a photo; 0 for none."""
    number = np.zeros(count, np.int32)
    track = np.asarray(tracks.track)
    mine = np.asarray(tracks.photo) == photo
    lengths = np.bincount(track, minlength=tracks.count)
    number[np.asarray(tracks.feature)[mine]] = lengths[track[mine]]
    return number
