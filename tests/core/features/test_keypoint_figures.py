"""What became of each keypoint is counted from pairs and tracks."""

import numpy as np

from graphos_core.data import PairMatches, Tracks
from graphos_core.features.keypoint_figures import pairs_of_keypoints, rays_of_keypoints


def pair(a: int, b: int, matches: list[list[int]], reason: str = "") -> PairMatches:
    return PairMatches(
        a=a,
        b=b,
        matches=np.array(matches, np.int32),
        candidates=9,
        kind="none",
        matrix=np.eye(3),
        reason=reason,
    )


def test_each_pair_counts_once_from_either_side_and_unused_ones_do_not() -> None:
    pairs = [pair(0, 1, [[0, 2], [3, 2], [3, 4]]), pair(1, 2, [[2, 0]]), pair(0, 2, [[1, 1]], "too few")]
    assert pairs_of_keypoints(pairs, 0, 5).tolist() == [1, 0, 0, 1, 0]
    assert pairs_of_keypoints(pairs, 1, 5).tolist() == [0, 0, 2, 0, 1]


def test_rays_are_the_photos_of_the_track() -> None:
    tracks = Tracks(
        photo=np.array([0, 1, 2, 0, 2], np.int32), feature=np.array([3, 0, 1, 4, 2], np.int32),
        track=np.array([0, 0, 0, 1, 1], np.int32), xy=np.zeros((5, 2)), colour=np.zeros((2, 3), np.uint8), count=2,
    )  # fmt: skip
    assert rays_of_keypoints(tracks, 0, 6).tolist() == [0, 0, 0, 3, 2, 0]
    assert rays_of_keypoints(tracks, 1, 2).tolist() == [3, 0]
