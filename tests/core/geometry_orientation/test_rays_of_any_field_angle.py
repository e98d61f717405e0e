"""Minimal solutions, relative orientation, resection and intersection with rays all round the camera."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.data import Array
from graphos_core.geometry.five_point import five_point
from graphos_core.geometry.rays import Rays, direction_rays, ideal_rays, joined, tangents
from graphos_core.geometry.relative_orientation import relative_orientation
from graphos_core.geometry.resection import space_resection
from graphos_core.geometry.rotation import angle_between, matrix_from_vector, skew
from graphos_core.geometry.three_point import three_point
from graphos_core.geometry.triangulation import distances_px, intersect_rays

SCALE = 600.0
"""Px per radian."""

ROTATION, CENTRE = matrix_from_vector(np.array([0.2, -0.4, 1.1])), np.array([0.8, -0.1, 0.3])


def unit(vectors: Array) -> Array:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def surroundings(count: int = 400, noise_px: float = 0.0, wrong: int = 0) -> tuple[Array, Rays, Rays]:
    """Points all round two photos, the first of them the object frame, with noisy and wrong rays."""
    rng = np.random.default_rng(6)
    points = unit(rng.normal(size=(count, 3))) * rng.uniform(2.0, 6.0, (count, 1))
    sides = []
    for seen in (points, (points - CENTRE) @ ROTATION.T):
        across, down = tangents(unit(seen))
        shift = rng.normal(0, noise_px / SCALE, (2, count, 1))
        sides.append(unit(unit(seen) + shift[0] * across + shift[1] * down))
    sides[1][:wrong] = unit(rng.normal(size=(wrong, 3)))
    return points, direction_rays(sides[0], SCALE), direction_rays(sides[1], SCALE)


def test_every_sample_of_five_contains_the_true_essential_matrix() -> None:
    _, a, b = surroundings()
    truth = skew(-ROTATION @ CENTRE) @ ROTATION
    truth /= np.linalg.norm(truth)
    pick = np.arange(100).reshape(20, 5)
    found, sample = five_point(a.directions[pick], b.directions[pick])
    for k in range(20):
        errors = np.minimum(*(np.abs(found[sample == k] - s * truth).max(axis=(1, 2)) for s in (1, -1)))
        assert errors.min() < 1e-8
    for essential in found[:40]:  # every solution is an essential matrix
        singular = np.linalg.svd(essential)[1]
        assert singular[0] - singular[1] < 1e-6 and singular[2] < 1e-6


def test_every_sample_of_three_contains_the_true_orientation() -> None:
    points, _, b = surroundings()
    pick = np.arange(90).reshape(30, 3)
    rotations, translations, sample = three_point(points[pick], b.directions[pick])
    for k in range(30):
        mine = np.flatnonzero(sample == k)
        centres = [-rotations[i].T @ translations[i] for i in mine]
        assert min(np.linalg.norm(c - CENTRE) for c in centres) < 1e-6


@pytest.mark.parametrize("noise_px", [0.0, 0.5])
def test_relative_orientation_all_round_with_a_third_of_wrong_matches(noise_px: float) -> None:
    _, a, b = surroundings(noise_px=noise_px, wrong=133)
    found = relative_orientation(a, b, 3.0 * max(noise_px, 0.1), seed=0)
    assert found and found.inliers[133:].mean() > 0.97 and found.inliers[:133].mean() < 0.05
    base = -ROTATION @ CENTRE / np.linalg.norm(CENTRE)
    limit = 1e-7 if noise_px == 0.0 else np.radians(0.1)
    assert angle_between(found.rotation, ROTATION) < limit
    assert np.arccos(min(1.0, found.translation @ base)) < max(limit * 5, 1e-6)
    again = relative_orientation(a, b, 3.0 * max(noise_px, 0.1), seed=0)
    assert np.array_equal(found.rotation, again.rotation)


def test_a_flat_object_is_no_obstacle_for_wide_rays() -> None:
    rng = np.random.default_rng(2)
    ground = np.column_stack([rng.uniform(-8, 8, (300, 2)), np.full(300, 1.5)])
    a, b = direction_rays(ground, SCALE), direction_rays((ground - CENTRE) @ ROTATION.T, SCALE)
    found = relative_orientation(a, b, 0.5, seed=0)
    assert found.inliers.all() and angle_between(found.rotation, ROTATION) < 1e-6


def test_resection_all_round_errs_as_the_noise_predicts() -> None:
    points, _, b = surroundings(noise_px=0.5, wrong=160)
    found = space_resection(points, b, 3.0, seed=0)
    assert found.inliers[160:].all() and found.inliers[:160].mean() < 0.05
    assert found.rms == pytest.approx(0.5 * np.sqrt(2.0), rel=0.1)
    assert np.linalg.norm(found.centre - CENTRE) < 0.01
    assert angle_between(found.rotation, ROTATION) < np.radians(0.1)


def test_rays_all_round_meet_in_the_exact_points_and_a_wrong_one_is_found() -> None:
    points = surroundings(60)[0]
    centres = np.array([[0.0, 0, 0], [0.8, -0.1, 0.3], [-0.5, 0.6, 0.2], [0.1, -0.7, -0.4]])
    rotations = np.stack([matrix_from_vector(v) for v in np.random.default_rng(1).normal(size=(4, 3))])
    seen = np.einsum("nij,pnj->pni", rotations, points[:, None] - centres).reshape(-1, 3)
    start, photo = 4 * np.arange(61), np.tile(np.arange(4), 60)
    rays = direction_rays(seen, SCALE)
    found = intersect_rays(start, photo, rays, rotations, centres, threshold_px=1.0)
    assert found.ok.all()
    np.testing.assert_allclose(found.points, points, atol=1e-9)
    wrong = start[:-1] + np.arange(60) % 4
    turned = seen.copy()
    turned[wrong] = np.cross(turned[wrong], [0.3, 0.5, 0.8])
    found = intersect_rays(start, photo, direction_rays(turned, SCALE), rotations, centres, threshold_px=1.0)
    assert not found.used[wrong].any() and found.ok.mean() > 0.95


def test_distances_are_angles_times_the_local_scale() -> None:
    ray = direction_rays(np.array([[0.2, 0.3, -0.8]]), SCALE)
    away = matrix_from_vector(0.002 * tangents(ray.directions)[0][0]) @ ray.directions[0]
    miss = distances_px(np.zeros(1), np.zeros(1), ray, np.eye(3)[None], np.zeros((1, 3)), 7.0 * away[None])
    assert miss[0] == pytest.approx(SCALE * 0.002, rel=1e-5)
    behind = distances_px(np.zeros(1), np.zeros(1), ray, np.eye(3)[None], np.zeros((1, 3)), -ray.directions)
    assert np.isinf(behind[0])


def test_central_rays_count_in_the_ideal_image_plane() -> None:
    rays = ideal_rays(np.array([[0.4, -0.3], [np.nan, 0.0]]), 1500.0)
    assert rays.valid.tolist() == [True, False]
    q = rays.frames[0] @ np.array([0.41, -0.28, 1.0]) * 5.0
    np.testing.assert_allclose(q[:2] / q[2], [15.0, 30.0])
    mixed = joined([(np.array([1]), rays[[0]]), (np.array([0]), direction_rays(np.eye(3)[:1]))], 2)
    assert not mixed.central and np.array_equal(mixed.directions[1], rays.directions[0])
