"""Direct linear transformation and the eight points: exact on exact input, honest on degenerate input."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from graphos_core.data import Array
from graphos_core.geometry.dlt import compose_projection, decompose_projection, direct_linear_transformation
from graphos_core.geometry.eight_point import (
    coplanarity,
    decompose_essential,
    eight_point_fundamental,
    longuet_higgins,
)
from graphos_core.geometry.rotation import angle_between, look_at, matrix_from_vector

INTERIOR = np.array([[2000.0, 3.0, 820.0], [0.0, 1980.0, 590.0], [0.0, 0.0, 1.0]])
ROTATION, CENTRE = look_at(np.array([4.0, -7.0, 3.0]), np.zeros(3)), np.array([4.0, -7.0, 3.0])


def objects(count: int = 40, seed: int = 0) -> Array:
    return np.random.default_rng(seed).uniform(-1, 1, (count, 3))


def seen(points: Array) -> Array:
    projected = (
        np.column_stack([points, np.ones(len(points))]) @ compose_projection(INTERIOR, ROTATION, CENTRE).T
    )
    return projected[:, :2] / projected[:, 2:]


def test_exact_points_give_both_orientations_exactly() -> None:
    points = objects()
    found = direct_linear_transformation(points, seen(points))
    parts = decompose_projection(found.matrix)
    assert found and found.rms_px < 1e-8
    np.testing.assert_allclose(parts.interior, INTERIOR, atol=1e-6)
    np.testing.assert_allclose(parts.centre, CENTRE, atol=1e-8)
    assert angle_between(parts.rotation, ROTATION) < 1e-9
    eleven = found.coefficients
    x = (points @ eleven[:3] + eleven[3]) / (points @ eleven[8:11] + 1.0)
    np.testing.assert_allclose(x, seen(points)[:, 0], atol=1e-7)


def test_six_points_are_enough_and_five_are_not() -> None:
    points = objects(6, seed=2)
    assert direct_linear_transformation(points, seen(points)).rms_px < 1e-6
    few = direct_linear_transformation(points[:5], seen(points[:5]))
    assert not few and "5 points" in few.reason


def test_noise_comes_back_as_residuals() -> None:
    points = objects(300)
    noisy = seen(points) + np.random.default_rng(1).normal(0, 0.5, (300, 2))
    found = direct_linear_transformation(points, noisy)
    assert found.rms_px == pytest.approx(0.5 * np.sqrt(1.0 - 11.0 / 600.0), rel=0.06)
    assert np.linalg.norm(decompose_projection(found.matrix).centre - CENTRE) < 0.1


@pytest.mark.parametrize("noise_px", [0.0, 0.5])
def test_points_in_a_plane_are_refused(noise_px: float) -> None:
    points = objects() @ matrix_from_vector(np.array([0.3, -0.2, 0.1])) * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.3]
    pixels = seen(points) + np.random.default_rng(1).normal(0, noise_px, (len(points), 2))
    found = direct_linear_transformation(points, pixels)
    assert not found and "one plane" in found.reason


def test_decomposition_agrees_with_opencv() -> None:
    matrix = compose_projection(INTERIOR, ROTATION, CENTRE)
    interior, rotation, centre = cv2.decomposeProjectionMatrix(matrix)[:3]
    ours = decompose_projection(-3.0 * matrix)
    np.testing.assert_allclose(ours.interior, interior / interior[2, 2], atol=1e-8)
    np.testing.assert_allclose(ours.rotation, rotation, atol=1e-10)
    np.testing.assert_allclose(ours.centre, (centre[:3] / centre[3]).ravel(), atol=1e-9)


def two_photos(count: int = 30) -> tuple[Array, Array, Array, Array]:
    """Rays in a and b, all round, and ``b_from_a``."""
    points = np.random.default_rng(3).normal(size=(count, 3)) * 3.0
    rotation, base = matrix_from_vector(np.array([0.2, -0.4, 0.1])), np.array([0.8, -0.1, 0.3])
    return points, points @ rotation.T + base, rotation, base


def test_coplanarity_is_the_essential_matrix_and_zero_for_rays_that_meet() -> None:
    a, b, rotation, base = two_photos()
    np.testing.assert_allclose(coplanarity(rotation, base, a, b), 0.0, atol=1e-12)
    turned = coplanarity(rotation, base, a, np.roll(b, 1, axis=0))
    assert np.abs(turned).min() > 1e-6


def test_longuet_higgins_finds_the_orientation_for_rays_of_any_field_angle() -> None:
    a, b, rotation, base = two_photos()
    assert (a[:, 2] < 0).any() and (b[:, 2] < 0).any()
    found = longuet_higgins(a, b)
    choices = decompose_essential(found.matrix)
    best = min(choices, key=lambda c: angle_between(c[0], rotation) - c[1] @ base)
    assert found and angle_between(best[0], rotation) < 1e-9
    np.testing.assert_allclose(best[1], base / np.linalg.norm(base), atol=1e-9)
    np.testing.assert_allclose(np.linalg.svd(found.matrix)[1], [np.sqrt(0.5), np.sqrt(0.5), 0.0], atol=1e-12)


def test_eight_points_give_the_fundamental_matrix_of_opencv() -> None:
    a, b, _, _ = two_photos(60)
    a, b = a + np.array([0, 0, 20.0]), b + np.array([0, 0, 20.0])
    xy_a, xy_b = (2000 * side[:, :2] / side[:, 2:] + [800, 600] for side in (a, b))
    rng = np.random.default_rng(5)
    xy_a, xy_b = (side + rng.normal(0, 0.3, side.shape) for side in (xy_a, xy_b))
    found = eight_point_fundamental(xy_a, xy_b)
    theirs, _ = cv2.findFundamentalMat(xy_a, xy_b, cv2.FM_8POINT)
    theirs /= np.linalg.norm(theirs) * np.sign((theirs * found.matrix).sum())
    np.testing.assert_allclose(found.matrix, theirs, atol=1e-7)
    assert abs(np.linalg.det(found.matrix)) < 1e-15


def test_a_plane_or_too_few_points_are_said() -> None:
    a, b, rotation, base = two_photos()
    flat = a * [1.0, 1.0, 0.0] + [0.0, 0.0, 6.0]
    assert "one plane" in longuet_higgins(flat, flat @ rotation.T + base).reason
    assert "7 pairs" in longuet_higgins(a[:7], b[:7]).reason
    still = longuet_higgins(a, a @ rotation.T)
    assert not still and "no base" in still.reason
