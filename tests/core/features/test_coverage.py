import numpy as np
import pytest
from scipy.spatial import ConvexHull

from graphos_core.data import Features, PairMatches
from graphos_core.features.coverage import (
    CoverageParams,
    camera_coverage,
    convex_hull,
    coverage,
    matched_features,
    photo_coverage,
    polygon_area,
)

WIDTH, HEIGHT = 3000, 2000


def spread(count: int, low: tuple[float, float], high: tuple[float, float], seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(low, high, (count, 2))


def test_hull_and_its_area_are_those_of_scipy() -> None:
    for seed, count in enumerate((3, 8, 400)):
        xy = spread(count, (0, 0), (WIDTH, HEIGHT), seed).astype(np.float32).astype(float)
        assert polygon_area(convex_hull(xy)) == pytest.approx(ConvexHull(xy).volume, rel=1e-9)


@pytest.mark.parametrize("xy", [np.zeros((0, 2)), np.full((5, 2), 7.0), np.arange(8.0)[:, None] * [1, 2]])
def test_points_without_area_cover_nothing_and_alert(xy: np.ndarray) -> None:
    found = coverage(xy, WIDTH, HEIGHT)
    assert found.hull_share == pytest.approx(0.0, abs=1e-9) and found.alert and found.advice


def test_shares_of_a_covered_half_are_one_half() -> None:
    found = coverage(spread(5000, (0, 0), (1499, 1999)), WIDTH, HEIGHT)
    assert found.occupied_share == 0.5
    assert found.hull_share == pytest.approx(0.5, abs=0.005)
    assert found.alert and found.empty == ("the right third",)
    assert found.counts.sum() == found.points == 5000


def test_a_full_format_is_enough_and_the_zones_follow_the_area() -> None:
    found = coverage(spread(20_000, (0, 0), (2999, 1999)), WIDTH, HEIGHT)
    assert not found.alert and found.advice == "" and found.empty == ()
    assert np.abs(found.radial_share - found.radial_area).max() < 0.01
    assert found.radial_share.sum() == pytest.approx(1.0) and found.radial_area.sum() == pytest.approx(1.0)
    assert found.reach > 0.98


def test_a_hole_is_seen_by_the_cells_and_overlooked_by_the_hull() -> None:
    xy = spread(8000, (0, 0), (2999, 1999))
    hole = (np.abs(xy - [1500, 1000]) < [1100, 800]).all(axis=1)
    found = coverage(xy[~hole], WIDTH, HEIGHT)
    assert found.hull_share > 0.98 and found.occupied_share < 0.6 and found.alert
    assert found.empty == ("the centre",)


def test_few_points_are_told_from_a_bad_distribution() -> None:
    few = coverage(spread(30, (0, 0), (2999, 1999)), WIDTH, HEIGHT)
    expected = 1 - (1 - 1 / few.counts.size) ** 30
    assert few.possible_share == pytest.approx(expected)
    assert few.occupied_share == pytest.approx(expected, abs=0.1)
    assert few.advice.startswith("Only 30 matched points")


def test_the_advice_tells_missing_structure_from_missing_partners() -> None:
    matched = spread(3000, (0, 800), (2999, 1999))
    sky = coverage(matched, WIDTH, HEIGHT, keypoints=matched)
    assert sky.empty == ("the upper third",) and "Hardly any keypoints" in sky.advice
    alone = coverage(matched, WIDTH, HEIGHT, keypoints=spread(9000, (0, 0), (2999, 1999)))
    assert "no other photo confirms them" in alone.advice


def features(xy: np.ndarray) -> Features:
    n = len(xy)
    zero = np.zeros(n, np.float32)
    return Features(
        xy=xy.astype(np.float32), scale=zero, angle=zero, response=zero, descriptors=np.zeros((n, 128), np.uint8),
        colour=np.zeros((n, 3), np.uint8), width=WIDTH, height=HEIGHT,
    )  # fmt: skip


def pair(a: int, b: int, matches: list[list[int]], reason: str = "") -> PairMatches:
    return PairMatches(
        a=a, b=b, matches=np.array(matches, np.int32), candidates=9, kind="none", matrix=np.zeros((3, 3)), reason=reason
    )  # fmt: skip


def test_points_of_rejected_pairs_do_not_count_and_none_counts_twice() -> None:
    photos = [features(spread(50, (0, 0), (2999, 1999), seed)) for seed in range(3)]
    pairs = [pair(0, 1, [[3, 1], [4, 2]]), pair(0, 2, [[3, 9], [8, 7]]), pair(1, 2, [[0, 0]], "too few")]
    assert matched_features(photos, pairs, 0).tolist() == [3, 4, 8]
    assert matched_features(photos, pairs, 1).tolist() == [1, 2]
    assert photo_coverage(photos, pairs, 0).points == 3
    everything = camera_coverage(photos, pairs, [0, 1, 2], CoverageParams(cells=6))
    assert everything.points == 7 and everything.counts.shape == (4, 6)
