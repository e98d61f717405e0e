import cv2
import numpy as np
import pytest

from graphos_core.geometry.homography import four_point, homography, transfer, transfer_squares
from graphos_core.geometry.normalisation import homogeneous
from graphos_core.geometry.seven_point import seven_point


def seen(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    points = rng.uniform((-1, -1, 3), (1, 1, 6), (count, 3))
    angle = 0.2
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    moved = points @ turn.T + [-0.8, 0.1, 0.2]
    return points[:, :2] / points[:, 2:], moved[:, :2] / moved[:, 2:]


def test_seven_points_fulfil_every_solution_and_one_is_opencvs() -> None:
    samples = [seen(7, seed) for seed in range(30)]
    a, b = (np.stack([homogeneous(s[side]) for s in samples]) for side in (0, 1))
    found, which = seven_point(a, b)
    misfit = np.einsum("kni,kij,knj->kn", b[which], found, a[which])
    assert np.abs(misfit).max() < 1e-10
    assert np.abs(np.linalg.det(found)).max() < 1e-10
    for index, sample in enumerate(samples):
        expected, _ = cv2.findFundamentalMat(*sample, cv2.FM_7POINT)
        expected = expected.reshape(-1, 9)
        own = found[which == index].reshape(-1, 9)
        assert len(own) == len(expected)
        expected /= np.linalg.norm(expected, axis=1, keepdims=True)
        assert np.abs(np.abs(own @ expected.T).max(axis=1) - 1.0).max() < 1e-8


TRUE = np.array([[0.9, -0.2, 30.0], [0.15, 1.1, -20.0], [1e-4, -5e-5, 1.0]])


def test_four_points_give_the_homography_that_made_them() -> None:
    rng = np.random.default_rng(0)
    xy = rng.uniform(0, 800, (50, 4, 2)) / 800
    scaled = np.diag([1 / 800, 1 / 800, 1]) @ TRUE @ np.diag([800, 800, 1])
    b = transfer(scaled, xy.reshape(-1, 2)).reshape(50, 4, 2)
    ones = np.ones((50, 4, 1))
    found, which = four_point(np.concatenate([xy, ones], 2), np.concatenate([b, ones], 2))
    assert len(which) == 50
    ratio = found / found[:, 2:, 2:]
    assert np.abs(ratio - scaled / scaled[2, 2]).max() < 1e-6


def test_a_sample_that_turns_over_is_left_out() -> None:
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    swapped = square[[0, 1, 3, 2]]  # a quadrangle that crosses itself
    ones = np.ones((1, 4, 1))
    _, which = four_point(np.concatenate([square[None], ones], 2), np.concatenate([swapped[None], ones], 2))
    assert len(which) == 0


def test_the_least_squares_homography_is_as_good_as_opencvs() -> None:
    rng = np.random.default_rng(1)
    xy = rng.uniform(0, 800, (200, 2))
    noisy = transfer(TRUE, xy) + rng.normal(0, 0.5, (200, 2))
    found = homography(xy, noisy)
    other, _ = cv2.findHomography(xy, noisy, 0)
    corners = np.array([[0.0, 0], [800, 0], [800, 800], [0, 800]])
    error, others = (np.linalg.norm(transfer(h, corners) - transfer(TRUE, corners), axis=1).max() for h in (found, other))  # fmt: skip
    assert error < 1.2 * others + 0.05
    forth, back = transfer_squares(found, xy, noisy)
    assert np.sqrt(forth.mean() / 2) == pytest.approx(0.5, rel=0.1)
    assert np.isfinite(back).all()
