"""The covariance of an intersection agrees with what noisy measurements really do."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.geometry.intersection_precision import (
    error_ellipse,
    image_derivatives,
    intersection_angle,
    intersection_precision,
    normal_case_sigma_z,
)
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.triangulation import triangulate

CAMERA = Camera(
    model="basic", width=4000, height=3000, values=np.array([3000.0, 2010.0, 1490.0, -0.08, 0.02])
)
POINT = np.array([0.4, 0.3, -0.2])


def eyes(places: list[tuple[float, float, float]]) -> tuple[np.ndarray, np.ndarray]:
    centres = np.array(places)
    return np.stack([look_at(c, [0.3, 0.0, 0.0], (0, 1, 0)) for c in centres]), centres


def test_derivatives_agree_with_differences() -> None:
    rotations, centres = eyes([(-2.0, 0.5, 9.0)])
    found = image_derivatives(CAMERA, rotations[0], centres[0], POINT)
    assert found is not None
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = 1e-5
        ends = np.stack([POINT + step, POINT - step])
        pixels = pixel_from_ray(CAMERA, (ends - centres[0]) @ rotations[0].T)
        np.testing.assert_allclose(found[:, axis], (pixels[0] - pixels[1]) / 2e-5, rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize(
    "places",
    [[(-1.5, 0, 10), (1.5, 0, 10)], [(-2, 1, 8), (2, -1, 9), (0.5, 3, 12)], [(-0.4, 0, 10), (0.4, 0, 10)]],
)
def test_covariance_agrees_with_monte_carlo(places: list[tuple[float, float, float]]) -> None:
    rotations, centres = eyes(places)
    count, draws, sigma = len(places), 4000, 0.5
    true = np.concatenate(
        [pixel_from_ray(CAMERA, (POINT - c)[None] @ r.T) for r, c in zip(rotations, centres)]
    )
    noise = np.random.default_rng(3).normal(size=(draws, count, 2)) * sigma
    rays = ray_from_pixel(CAMERA, (true + noise).reshape(-1, 2))[:, :2]
    found = triangulate(
        np.arange(0, draws * count + 1, count),
        np.tile(np.arange(count), draws),
        rays,
        np.full(count, CAMERA.focal_px),
        rotations,
        centres,
    )
    assert found.ok.all()
    errors = found.points - POINT
    precision = intersection_precision([CAMERA] * count, list(rotations), list(centres), POINT, sigma)
    # χ² of the errors in the metric of the covariance has mean 3 and, for n draws, σ = √(6/n)
    chi2 = np.einsum("ni,ij,nj->n", errors, np.linalg.inv(precision.covariance), errors).mean()
    assert chi2 == pytest.approx(3.0, abs=4 * np.sqrt(6 / draws) + 0.06)
    np.testing.assert_allclose(errors.std(axis=0), precision.sigma_xyz, rtol=0.06)


def test_normal_case_formula_is_the_covariance_of_parallel_cameras() -> None:
    camera = Camera(model="pinhole", width=4000, height=3000, values=np.array([3000.0, 2000.0, 1500.0]))
    centres = [np.array([-1.5, 0.0, 10.0]), np.array([1.5, 0.0, 10.0])]
    down = [look_at(c, c - [0, 0, 1], (0, 1, 0)) for c in centres]
    found = intersection_precision([camera, camera], down, centres, np.zeros(3), 0.5)
    assert found.sigma_xyz[2] == pytest.approx(normal_case_sigma_z(10.0, 3.0, 3000.0, 0.5), rel=1e-12)


def test_without_a_base_only_the_depth_is_undetermined() -> None:
    rotations, centres = eyes([(0, 0, 10), (0, 0, 10)])
    found = intersection_precision([CAMERA, CAMERA], list(rotations), list(centres), POINT, 0.5)
    assert not found.determined
    assert np.isinf(found.sigmas[0])
    assert np.isfinite(found.sigmas[1:]).all()
    ray = (POINT - centres[0]) / np.linalg.norm(POINT - centres[0])
    assert abs(found.directions[0] @ ray) == pytest.approx(1.0)
    assert np.isinf(normal_case_sigma_z(10.0, 0.0, 3000.0, 0.5))


def test_photos_that_do_not_see_the_point_add_nothing() -> None:
    rotations, centres = eyes([(-1, 0, 10), (1, 0, 10)])
    away = look_at(np.array([0, 0, 10.0]), [0, 0, 20.0], (0, 1, 0))
    two = intersection_precision([CAMERA] * 2, list(rotations), list(centres), POINT, 0.5)
    three = intersection_precision(
        [CAMERA] * 3, [*rotations, away], [*centres, np.array([0, 0, 10.0])], POINT, 0.5
    )
    np.testing.assert_array_equal(two.covariance, three.covariance)


def test_error_ellipse_holds_the_stated_part_of_the_errors() -> None:
    covariance = np.array([[4.0, 1.5], [1.5, 1.0]])
    outline = error_ellipse(covariance, 0.95)
    radius = np.einsum("ni,ij,nj->n", outline, np.linalg.inv(covariance), outline)
    np.testing.assert_allclose(radius, radius[0])
    draws = np.random.default_rng(1).multivariate_normal([0, 0], covariance, 20000)
    inside = np.einsum("ni,ij,nj->n", draws, np.linalg.inv(covariance), draws) < radius[0]
    assert inside.mean() == pytest.approx(0.95, abs=0.006)


def test_intersection_angle_is_the_largest_of_all_pairs() -> None:
    places = [np.array([-1.0, 0, 1.0]), np.array([1.0, 0, 1.0]), np.array([0.0, 0, 1.0])]
    assert intersection_angle(places, np.zeros(3)) == pytest.approx(np.pi / 2)
