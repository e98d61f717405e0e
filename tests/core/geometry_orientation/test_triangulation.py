"""Spatial intersection against exact points and against a plain numpy twin."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array
from graphos_core.geometry.rays import ideal_rays
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.triangulation import distances_px, intersection_angles, triangulate

FOCAL = 1500.0


def rays_of(points: Array, photos: int = 4) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Start, photo, rays, focal, rotations, centres of points that every photo on an arc sees."""
    angles = np.linspace(-0.4, 0.4, photos)
    centres = np.column_stack([8 * np.sin(angles), -8 * np.cos(angles), 0.3 * angles])
    rotations = np.stack([look_at(c, np.zeros(3)) for c in centres])
    camera = np.einsum("nij,pnj->pni", rotations, points[:, None] - centres)
    rays = (camera[..., :2] / camera[..., 2:]).reshape(-1, 2)
    photo = np.tile(np.arange(photos), len(points))
    start = np.arange(len(points) + 1) * photos
    return start, photo, rays, np.full(photos, FOCAL), rotations, centres


def test_exact_rays_meet_in_the_exact_point_and_angle() -> None:
    points = np.random.default_rng(0).uniform(-1, 1, (200, 3))
    start, photo, rays, focal, rotations, centres = rays_of(points)
    found = triangulate(start, photo, rays, focal, rotations, centres, threshold_px=1.0)
    assert found.ok.all() and found.used.all()
    np.testing.assert_allclose(found.points, points, atol=1e-10)
    to_first, to_last = points - centres[0], points - centres[-1]
    cosine = (to_first * to_last).sum(1) / np.linalg.norm(to_first, axis=1) / np.linalg.norm(to_last, axis=1)
    np.testing.assert_allclose(found.angles, np.arccos(cosine), atol=1e-9)
    np.testing.assert_allclose(intersection_angles(start, photo, found.used, centres, points), found.angles)


def test_one_wrong_ray_is_found_and_left_out() -> None:
    points = np.random.default_rng(1).uniform(-1, 1, (50, 3))
    start, photo, rays, focal, rotations, centres = rays_of(points, photos=5)
    wrong = start[:-1] + np.arange(50) % 5
    rays[wrong] += 40.0 / FOCAL
    found = triangulate(start, photo, rays, focal, rotations, centres, threshold_px=3.0)
    assert found.ok.all()
    assert not found.used[wrong].any() and found.used.sum() == 4 * 50
    np.testing.assert_allclose(found.points, points, atol=1e-9)


def test_noise_spreads_points_as_least_squares_predicts() -> None:
    """The covariance of a plain numpy solution of the same problem is the truth."""
    noise_px = 0.5
    rng = np.random.default_rng(2)
    point = np.array([0.2, 0.1, -0.3])
    start, photo, rays, focal, rotations, centres = rays_of(np.repeat(point[None], 4000, axis=0))
    noisy = rays + rng.normal(0, noise_px / FOCAL, rays.shape)
    found = triangulate(start, photo, noisy, focal, rotations, centres)
    normal = np.zeros((3, 3))
    for rotation, centre in zip(rotations, centres, strict=True):
        x, y, z = rotation @ (point - centre)
        image = FOCAL * np.array([[1 / z, 0, -x / z**2], [0, 1 / z, -y / z**2]]) @ rotation
        normal += image.T @ image / noise_px**2
    predicted = np.sqrt(np.diag(np.linalg.inv(normal)))
    np.testing.assert_allclose(found.points.std(axis=0), predicted, rtol=0.05)
    np.testing.assert_allclose(found.points.mean(axis=0), point, atol=4 * predicted.max() / np.sqrt(4000))


def test_points_behind_narrow_or_single_are_refused() -> None:
    point = np.array([[0.0, 0.0, 0.0]])
    start, photo, rays, focal, rotations, centres = rays_of(point)
    flip = np.diag([-1.0, 1.0, -1.0])
    behind = triangulate(start, photo, rays * [-1, 1], focal, flip @ rotations, centres, threshold_px=2.0)
    assert not behind.ok.any()
    narrow = triangulate(start, photo, rays, focal, rotations, centres, min_angle=1.0)
    assert not narrow.ok.any() and not narrow.used.any()
    single = triangulate(np.array([0, 1]), photo[:1], rays[:1], focal, rotations, centres)
    assert not single.ok.any()


def test_distances_are_those_of_the_projection() -> None:
    points = np.random.default_rng(3).uniform(-1, 1, (20, 3))
    _, photo, rays, _, rotations, centres = rays_of(points)
    moved = ideal_rays(rays + np.array([3.0, 4.0]) / FOCAL, FOCAL)
    point = np.repeat(np.arange(20), 4)
    np.testing.assert_allclose(distances_px(point, photo, moved, rotations, centres, points), 5.0)
