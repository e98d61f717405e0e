"""Features at one place are one point: the layers, the matching of points, and what it does to twins."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from graphos_core.data import Candidates, Features
from graphos_core.features.matchers.mutual import MutualParams, mutual, nearest_two
from graphos_core.features.matchers.places import places_of
from graphos_core.features.matchers.robust import RobustParams, robust
from graphos_core.run import Run

RUN = Run()
GENERATOR = np.random.default_rng(5)


def with_places(n: int, places: int) -> tuple[np.ndarray, np.ndarray]:
    xy = GENERATOR.uniform(0, 900, (places, 2)).astype(np.float32)
    group = np.r_[np.arange(places), GENERATOR.integers(0, places, n - places)]
    GENERATOR.shuffle(group)
    return xy[group], group


def features(xy: np.ndarray, descriptors: np.ndarray) -> Features:
    n = len(xy)
    flat = np.zeros(n, np.float32)
    return Features(
        xy=xy.astype(np.float32), scale=flat + 5, angle=flat, response=flat, descriptors=descriptors,
        colour=np.zeros((n, 3), np.uint8), width=1000, height=1000,
    )  # fmt: skip


def test_layers_hold_every_feature_once_and_the_places_with_most_first() -> None:
    xy, group = with_places(200, 70)
    places = places_of(xy)
    assert len(places) == 70
    assert sorted(places.order.tolist()) == list(range(200))
    sizes = np.bincount(group)
    for start, count, rank in zip(places.starts(), places.layers, range(99), strict=False):
        layer = places.order[start : start + count]
        np.testing.assert_array_equal(group[layer], group[places.first[:count]])
        assert (sizes[group[layer]] > rank).all()
    assert all(first == np.flatnonzero(group == group[first])[0] for first in places.first)


def test_features_at_different_places_keep_their_order() -> None:
    places = places_of(GENERATOR.uniform(0, 900, (50, 2)).astype(np.float32))
    np.testing.assert_array_equal(places.order, np.arange(50))
    assert places.layers == (50,)


def test_points_are_compared_by_their_nearest_descriptors() -> None:
    (xy_a, group_a), (xy_b, group_b) = with_places(700, 300), with_places(330, 120)
    a, b = (GENERATOR.integers(0, 256, (n, 32), dtype=np.uint8) for n in (700, 330))
    places = places_of(xy_a), places_of(xy_b)
    square = ((a[:, None].astype(np.int64) - b[None].astype(np.int64)) ** 2).sum(axis=2)
    expected = np.array([
        [square[np.ix_(group_a == group_a[i], group_b == group_b[j])].min() for j in places[1].first]
        for i in places[0].first
    ])  # fmt: skip
    for (best, second, index), table in zip(nearest_two(a, b, places), (expected, expected.T), strict=True):
        ranked = np.sort(table, axis=1)
        np.testing.assert_array_equal(-2 * best, ranked[:, 0])
        np.testing.assert_array_equal(-2 * second, ranked[:, 1])
        np.testing.assert_array_equal(table[np.arange(len(table)), index], ranked[:, 0])


@pytest.mark.parametrize("match", [
    lambda a, b, **changes: mutual(a, b, MutualParams(**changes), run=RUN),
    lambda a, b, **changes: robust(a, b, RobustParams(discrepancy=1.0, **changes), run=RUN),
    lambda a, b, **changes: robust(a, b, RobustParams(discrepancy=1.0, distance="hellinger", **changes), run=RUN),
])  # fmt: skip
def test_twins_at_one_place_do_not_fail_the_ratio_test_and_give_one_match(
    match: Callable[..., Candidates],
) -> None:
    xy = GENERATOR.uniform(0, 900, (60, 2)).astype(np.float32)
    own = GENERATOR.integers(0, 256, (60, 32), dtype=np.uint8)
    twin = np.clip(own.astype(int) + GENERATOR.integers(-3, 4, own.shape), 0, 255).astype(np.uint8)
    doubled = features(np.concatenate([xy, xy]), np.concatenate([own, twin]))
    found = match(features(xy, twin), doubled)
    np.testing.assert_array_equal(found.matches, np.stack([np.arange(60), np.arange(60)], axis=1))
    apart = features(np.concatenate([xy, xy + 30]), np.concatenate([own, twin]))
    others = match(features(xy, twin), apart, ratio=0.8, mutual=False)
    assert (others.matches[:, 1] >= 60).all()


def test_a_photo_with_a_single_point_matches_nothing() -> None:
    one = features(np.zeros((5, 2)), GENERATOR.integers(0, 256, (5, 32), dtype=np.uint8))
    assert len(mutual(one, one, MutualParams(), run=RUN)) == 0
