"""Relative orientation and space resection against exact geometry and injected noise."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.data import Array
from graphos_core.geometry.relative_orientation import depths, relative_orientation
from graphos_core.geometry.resection import space_resection
from graphos_core.geometry.rotation import angle_between, matrix_from_vector

FOCAL = 2000.0


def scene(noise_px: float = 0.0, outliers: float = 0.0) -> tuple[Array, Array, Array, Array, Array]:
    """Points, rays in two photos, and the second photo's rotation and centre; the first is the object frame."""
    rng = np.random.default_rng(4)
    points = rng.uniform(-1, 1, (400, 3)) * [2.0, 1.5, 1.0] + [0.0, 0.0, 6.0]
    rotation, centre = matrix_from_vector(np.array([0.05, -0.25, 0.1])), np.array([1.5, 0.2, -0.1])
    moved = (points - centre) @ rotation.T
    a, b = points[:, :2] / points[:, 2:], moved[:, :2] / moved[:, 2:]
    a, b = (side + rng.normal(0, noise_px / FOCAL, side.shape) for side in (a, b))
    wrong = int(outliers * len(b))
    b[:wrong] = rng.uniform(-0.3, 0.3, (wrong, 2))
    return points, a, b, rotation, centre


def test_exact_rays_give_the_relative_orientation_exactly() -> None:
    _, a, b, rotation, centre = scene()
    found = relative_orientation(a, b, 1.0 / FOCAL, seed=0)
    base = -rotation @ centre
    assert found and found.inliers.all()
    assert angle_between(found.rotation, rotation) < 1e-9
    np.testing.assert_allclose(found.translation, base / np.linalg.norm(base), atol=1e-9)


def test_relative_orientation_survives_a_third_of_wrong_matches() -> None:
    _, a, b, rotation, _ = scene(noise_px=0.5, outliers=0.33)
    found = relative_orientation(a, b, 2.0 / FOCAL, seed=0)
    assert found.inliers[132:].mean() > 0.97
    assert found.inliers[:132].mean() < 0.05
    assert np.degrees(angle_between(found.rotation, rotation)) < 0.1


@pytest.mark.parametrize("noise_px", [0.0, 0.5])
def test_a_flat_object_is_no_obstacle(noise_px: float) -> None:
    rng = np.random.default_rng(8)
    points = np.column_stack([rng.uniform(-2, 2, (300, 2)), np.full(300, 6.0)])
    points[:, 2] += 0.3 * points[:, 0]
    rotation, centre = matrix_from_vector(np.array([0.02, -0.2, 0.01])), np.array([1.8, 0.1, 0.2])
    moved = (points - centre) @ rotation.T
    a, b = points[:, :2] / points[:, 2:], moved[:, :2] / moved[:, 2:]
    a, b = (side + rng.normal(0, noise_px / FOCAL, side.shape) for side in (a, b))
    found = relative_orientation(a, b, 3.0 / FOCAL, seed=0)
    assert found.inliers.all()
    assert np.degrees(angle_between(found.rotation, rotation)) < (0.5 if noise_px else 1e-6)


def test_depths_are_those_of_the_points() -> None:
    points, a, b, rotation, centre = scene()
    za, zb = depths(rotation, -rotation @ centre, a, b)
    np.testing.assert_allclose(za, points[:, 2], rtol=1e-9)
    np.testing.assert_allclose(zb, ((points - centre) @ rotation.T)[:, 2], rtol=1e-9)


def test_exact_points_give_the_resection_exactly() -> None:
    points, _, b, rotation, centre = scene()
    found = space_resection(points, b, 1.0 / FOCAL, seed=0)
    assert found and found.inliers.all()
    np.testing.assert_allclose(found.centre, centre, atol=1e-8)
    assert angle_between(found.rotation, rotation) < 1e-8


def test_resection_errs_as_the_injected_noise_predicts() -> None:
    points, _, b, rotation, centre = scene(noise_px=0.5, outliers=0.4)
    found = space_resection(points, b, 3.0 / FOCAL, seed=0)
    assert found.inliers[160:].all()
    expected = 0.5 * np.sqrt(2.0) / FOCAL
    assert found.rms == pytest.approx(expected, rel=0.1)
    assert np.linalg.norm(found.centre - centre) < 0.01
    assert np.degrees(angle_between(found.rotation, rotation)) < 0.1


@pytest.mark.parametrize("seed", [0, 1, 7])
def test_the_same_seed_gives_the_same_bits(seed: int) -> None:
    points, a, b, _, _ = scene(noise_px=0.5, outliers=0.3)
    one, two = (relative_orientation(a, b, 2.0 / FOCAL, seed=seed) for _ in range(2))
    assert np.array_equal(one.rotation, two.rotation)
    three, four = (space_resection(points, b, 2.0 / FOCAL, seed=seed) for _ in range(2))
    assert np.array_equal(three.centre, four.centre)


def test_too_few_or_senseless_rays_say_why() -> None:
    rng = np.random.default_rng(0)
    assert (
        "4 corresponding points"
        in relative_orientation(np.zeros((4, 2)), np.zeros((4, 2)), 1e-3, seed=0).reason
    )
    assert "3 points" in space_resection(np.zeros((3, 3)), np.zeros((3, 2)), 1e-3, seed=0).reason
    senseless = space_resection(rng.normal(size=(50, 3)), rng.normal(size=(50, 2)), 1e-5, seed=0)
    assert not senseless and "do not agree" in senseless.reason
