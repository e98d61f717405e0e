"""Counts against a known homography, on points of which the answer is known by construction."""

import numpy as np
import pytest

from graphos_core.data import Features
from graphos_core.features_comparison.measures import (
    against_truth,
    occupied_cells,
    repeated_points,
    right_matches,
)
from graphos_core.features_comparison.truth import mapped

SHIFT = np.array([[1.0, 0.0, 20.0], [0.0, 1.0, 5.0], [0.0, 0.0, 1.0]])


def features(xy: np.ndarray, size: tuple[int, int] = (200, 100)) -> Features:
    n = len(xy)
    zero = np.zeros(n, np.float32)
    return Features(
        xy=np.asarray(xy, np.float32).reshape(-1, 2), scale=zero, angle=zero, response=zero,
        descriptors=np.zeros((n, 8), np.uint8), colour=np.zeros((n, 3), np.uint8), width=size[0], height=size[1],
    )  # fmt: skip


def test_a_match_is_right_within_three_pixels_of_the_truth() -> None:
    a = features(np.array([[10.0, 10.0], [10.0, 10.0], [50.0, 40.0], [51.0, 40.5]]))
    b = features(np.array([[32.9, 15.0], [33.1, 15.0], [70.0, 45.0], [71.0, 45.5]]))
    matches = np.array([[0, 0], [1, 1], [2, 2], [3, 3]])
    assert right_matches(a, b, matches, SHIFT).tolist() == [True, False, True, True]
    found = against_truth(a, b, matches, SHIFT)
    assert (found.matches, found.correct_3px) == (4, 3)
    assert found.correct_cells_2px == 2  # (50, 40) and (51, 40.5) lie in one cell
    assert found.precision == 0.75


def test_cells_begin_at_the_corner_of_the_first_pixel() -> None:
    assert occupied_cells(np.array([[-0.5, -0.5], [1.4, 1.4]])) == 1
    assert occupied_cells(np.array([[1.4, 0.0], [1.6, 0.0]])) == 2
    assert occupied_cells(np.zeros((0, 2))) == 0


def test_repeatability_counts_one_to_one_in_the_common_part_only() -> None:
    common = np.array([[20.0, 20.0], [60.0, 30.0], [100.0, 60.0], [150.0, 80.0]])
    outside_of_b = np.array([[190.0, 50.0], [100.0, 97.0]])
    a = features(np.vstack([common, common[:1], outside_of_b]))  # one point with two directions
    moved = common + np.array([20.0, 5.0])
    moved[1] += [1.4, 0.0]  # still repeated
    moved[2] += [1.6, 0.0]  # not any more
    twice = moved[:1] + np.array([0.5, 0.0])  # a second point near a partner that is taken
    outside_of_a = np.array([[10.0, 50.0], [100.0, 3.0]])
    b = features(np.vstack([moved, twice, outside_of_a]))
    repeated, common_points = repeated_points(a, b, SHIFT)
    assert (repeated, common_points) == (3, 4)
    assert against_truth(a, b, np.zeros((0, 2), int), SHIFT).repeatability == 0.75


def test_a_point_behind_the_horizon_is_not_in_the_photo() -> None:
    strong = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.01, 0.0, 1.0]])
    _, inside = mapped(strong, np.array([[10.0, 10.0], [150.0, 10.0]]), (200, 100))
    assert inside.tolist() == [True, False]


def test_without_points_nothing_is_repeated_and_nothing_is_divided() -> None:
    found = against_truth(
        features(np.zeros((0, 2))), features(np.array([[3.0, 4.0]])), np.zeros((0, 2), int), SHIFT
    )
    assert found.repeatability is None and found.precision is None and found.matching_score is None
    assert found.correct_cells_2px == 0


def test_points_by_chance_repeat_as_often_as_their_density_says() -> None:
    rng = np.random.default_rng(0)
    size = (1000, 1000)
    a, b = (features(rng.uniform(0, 1000, (3000, 2)), size) for _ in range(2))
    repeated, common = repeated_points(a, b, np.eye(3))
    by_chance = 1.0 - np.exp(-3000 / 1e6 * np.pi * 1.5**2)
    assert repeated / common == pytest.approx(by_chance, rel=0.2)


def test_one_partner_is_not_given_to_two_points() -> None:
    a = features(np.array([[30.0, 30.0], [30.8, 30.0], [80.0, 40.0]]))
    b = features(np.array([[50.0, 35.0], [100.0, 45.0], [150.0, 80.0]]))
    assert repeated_points(a, b, SHIFT) == (2, 3)
