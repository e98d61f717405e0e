"""Binary descriptors: exact nearest neighbours by the number of differing bits."""

import cv2
import numpy as np
import pytest

from graphos_core.data import Features
from graphos_core.features.matchers.hamming import nearest_two_binary
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.run import Run

RUN = Run()


def random_bits(count: int, size: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (count, size), dtype=np.uint8)


def flipped(descriptors: np.ndarray, bits: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    table = np.unpackbits(descriptors, axis=1)
    for row in table:
        row[rng.choice(len(row), bits, replace=False)] ^= 1
    return np.packbits(table, axis=1)


def features(descriptors: np.ndarray, metric: str = "hamming") -> Features:
    n = len(descriptors)
    zero = np.zeros(n, np.float32)
    return Features(
        xy=np.zeros((n, 2), np.float32), scale=zero, angle=zero, response=zero, descriptors=descriptors,
        colour=np.zeros((n, 3), np.uint8), width=100, height=100, metric=metric,
    )  # fmt: skip


@pytest.mark.parametrize(("n", "m", "size"), [(130, 211, 32), (64, 65, 61), (3, 2, 64), (200, 90, 1)])
def test_nearest_and_second_nearest_are_those_of_counting_bits(n: int, m: int, size: int) -> None:
    a, b = random_bits(n, size, 1), random_bits(m, size, 2)
    distance = np.unpackbits(a[:, None] ^ b[None], axis=2).sum(axis=2).astype(float)
    for side, table in zip(nearest_two_binary(a, b), (distance, distance.T), strict=True):
        ordered = np.sort(table, axis=1)
        assert np.array_equal(np.sqrt(-2.0 * side[0]), ordered[:, 0])
        assert np.array_equal(np.sqrt(-2.0 * side[1]), ordered[:, 1])
        assert np.array_equal(side[2], table.argmin(axis=1))


def test_matches_and_their_ratios_are_those_of_opencv() -> None:
    a = random_bits(300, 61, 3)
    b = np.concatenate([flipped(a[40:240], 60, 4), random_bits(50, 61, 5)])
    found = mutual(features(a), features(b), MutualParams(ratio=0.7, mutual=False), run=RUN)
    nearest = cv2.BFMatcher(cv2.NORM_HAMMING).knnMatch(a, b, 2)
    expected = [
        (m.queryIdx, m.trainIdx, m.distance, m.distance / s.distance)
        for m, s in nearest
        if m.distance < 0.7 * s.distance
    ]
    assert [tuple(pair) for pair in found.matches.tolist()] == [e[:2] for e in expected]
    assert len(found) >= 200
    assert found.distance == pytest.approx(np.array([e[2] for e in expected]))
    assert found.ratio == pytest.approx(np.array([e[3] for e in expected]), rel=1e-5)
    both = mutual(features(a), features(b), MutualParams(ratio=0.7), run=RUN)
    assert {tuple(p) for p in both.matches.tolist()} <= {tuple(p) for p in found.matches.tolist()}
    assert {(i, i - 40) for i in range(40, 240)} <= {tuple(p) for p in both.matches.tolist()}


def test_bits_and_numbers_are_not_compared_with_each_other() -> None:
    a = random_bits(50, 32, 6)
    assert len(mutual(features(a), features(a), MutualParams(), run=RUN)) == 50
    assert len(mutual(features(a), features(a, "l2"), MutualParams(), run=RUN)) == 0
