"""Relative precision of tie points from the scale of their keypoints."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.tie_weights import GROWTH, relative_sigma, with_scale_sigma
from graphos_core.data import Features, Tracks


def features_of(scale: list[float]) -> Features:
    n = len(scale)
    return Features(
        xy=np.zeros((n, 2), np.float32), scale=np.array(scale, np.float32), angle=np.zeros(n, np.float32),
        response=np.zeros(n, np.float32), descriptors=np.zeros((n, 128), np.uint8), colour=np.zeros((n, 3), np.uint8),
        width=10, height=10,
    )  # fmt: skip


def test_every_observation_gets_the_scale_of_its_own_keypoint(make_block) -> None:
    block = make_block(points=12, photos=8).truth
    rng = np.random.default_rng(0)
    rows = [(p, n) for p, n in zip(block.obs_point, block.obs_photo, strict=True)]
    feature = np.zeros(len(rows), dtype=np.int32)
    scales: list[list[float]] = [[] for _ in block.names]
    truth = np.zeros(len(rows))
    for i in rng.permutation(len(rows)):
        truth[i] = rng.uniform(3.0, 30.0)
        feature[i] = len(scales[rows[i][1]])
        scales[rows[i][1]].append(float(truth[i]))
    tracks = Tracks(
        photo=block.obs_photo, feature=feature, track=block.obs_point, xy=block.obs_xy,
        colour=np.zeros((12, 3), np.uint8), count=12,
    )  # fmt: skip
    sigma = with_scale_sigma(block, tracks, [features_of(s) for s in scales]).obs_sigma_px
    expected = (truth / np.median(truth)) ** GROWTH
    np.testing.assert_allclose(sigma, np.clip(expected, 0.5, 2.0), rtol=1e-6)


def test_without_scales_all_count_alike() -> None:
    np.testing.assert_array_equal(relative_sigma(np.full(3, np.nan)), 1.0)
    assert relative_sigma(np.array([4.0, 4.0, np.nan])).tolist() == [1.0, 1.0, 1.0]
