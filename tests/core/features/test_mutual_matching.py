import itertools

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from graphos_core.data import Features
from graphos_core.features.matchers.mutual import MutualParams, mutual, nearest_two
from graphos_core.run import Run

RUN = Run()


def bytes_of_length_512(count: int, seed: int) -> np.ndarray:
    values = np.abs(np.random.default_rng(seed).normal(size=(count, 128))) ** 2
    return np.minimum(np.rint(512 * values / np.linalg.norm(values, axis=1, keepdims=True)), 255).astype(
        np.uint8
    )


def features(descriptors: np.ndarray) -> Features:
    n = len(descriptors)
    zero = np.zeros(n, np.float32)
    return Features(
        xy=np.arange(2 * n, dtype=np.float32).reshape(n, 2), scale=zero, angle=zero, response=zero, descriptors=descriptors,
        colour=np.zeros((n, 3), np.uint8), width=100, height=100,
    )  # fmt: skip


def squared_distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return ((a[:, None].astype(np.int64) - b[None].astype(np.int64)) ** 2).sum(axis=2)


@pytest.mark.parametrize(("n", "m"), [(300, 517), (257, 64), (2, 2), (600, 3)])
def test_nearest_and_second_nearest_are_exact_in_both_directions(n: int, m: int) -> None:
    a, b = bytes_of_length_512(n, 1), bytes_of_length_512(m, 2)
    b[: min(n, m) // 2] = a[: min(n, m) // 2]  # exact twins
    distance = squared_distances(a, b)
    row, column = nearest_two(a, b)
    for side, table in ((row, distance), (column, distance.T)):
        ordered = np.sort(table, axis=1)
        assert np.array_equal(-2 * side[0].astype(np.float64), ordered[:, 0])
        assert np.array_equal(-2 * side[1].astype(np.float64), ordered[:, 1])
        assert np.array_equal(side[2], table.argmin(axis=1))


def test_matches_are_mutual_and_pass_the_ratio_from_both_sides() -> None:
    a, b = bytes_of_length_512(400, 3), bytes_of_length_512(350, 4)
    rng = np.random.default_rng(5)
    b[:200] = np.clip(a[100:300].astype(int) + rng.integers(-12, 13, (200, 128)), 0, 255)
    b[350 - 20 :] = b[:20]  # twins in b: ambiguous from a
    distance = np.sqrt(squared_distances(a, b))
    expected = [
        (i, j)
        for i in range(400)
        if (j := int(distance[i].argmin())) is not None
        and distance[:, j].argmin() == i
        and distance[i, j] < 0.8 * np.partition(distance[i], 1)[1]
        and distance[i, j] < 0.8 * np.partition(distance[:, j], 1)[1]
    ]
    found = mutual(features(a), features(b), MutualParams(), run=RUN).matches
    assert found.dtype == np.int32
    assert [tuple(pair) for pair in found.tolist()] == expected
    assert [(i, i - 100) for i in range(120, 300)] == expected
    one_way = mutual(features(a), features(b), MutualParams(mutual=False), run=RUN)
    assert len(one_way) >= len(found)


def test_a_looser_ratio_only_adds_matches() -> None:
    a, b = bytes_of_length_512(500, 6), bytes_of_length_512(500, 7)
    found = [
        {
            tuple(pair)
            for pair in mutual(features(a), features(b), MutualParams(ratio=q), run=RUN).matches.tolist()
        }
        for q in (0.7, 0.9, 0.97, 1.0)
    ]
    assert all(one <= two for one, two in itertools.pairwise(found))
    assert len(found[-1]) > 100


def test_the_result_is_the_same_bit_for_bit_with_one_and_two_threads() -> None:
    a, b = bytes_of_length_512(1500, 8), bytes_of_length_512(1300, 9)
    results = []
    for threads in (1, 2):
        with threadpool_limits(threads, "blas"):
            results.append(nearest_two(a, b))
    for one, two in zip(*results, strict=True):
        assert all(np.array_equal(x, y) for x, y in zip(one, two, strict=True))


def test_float_descriptors_are_matched_too() -> None:
    rng = np.random.default_rng(10)
    a = rng.normal(size=(120, 64)).astype(np.float32)
    b = (a[::-1] + rng.normal(0, 0.05, a.shape)).astype(np.float32)
    found = mutual(features(a), features(b), MutualParams(), run=RUN).matches
    assert np.array_equal(found, np.stack([np.arange(120), np.arange(120)[::-1]], axis=1))


def test_photos_with_hardly_any_points_have_no_matches() -> None:
    some = features(bytes_of_length_512(50, 11))
    for count in (0, 1):
        few = features(bytes_of_length_512(count, 12))
        assert mutual(few, some, MutualParams(), run=RUN).matches.shape == (0, 2)
        assert mutual(some, few, MutualParams(), run=RUN).matches.shape == (0, 2)
