"""The trifocal tensor against three known cameras."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array
from graphos_core.geometry.dlt import compose_projection
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.six_points import robust_trifocal, six_point_trifocal
from graphos_core.geometry.trifocal import (
    epipoles,
    fundamentals,
    linear_trifocal,
    projections_from_trifocal,
    transfer_distances,
    transfer_line,
    transfer_pixels,
    transfer_points,
    trifocal_from_projections,
)

INTERIOR = np.array([[2000.0, 0.0, 800.0], [0.0, 2000.0, 600.0], [0.0, 0.0, 1.0]])
CENTRES = np.array([[-2.0, -6.0, 0.5], [0.3, -6.5, 0.0], [2.2, -5.8, 1.0]])
PROJECTIONS = [compose_projection(INTERIOR, look_at(c, np.zeros(3)), c) for c in CENTRES]
TENSOR = trifocal_from_projections(*PROJECTIONS)


def project(matrix: Array, points: Array) -> Array:
    projected = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return projected[:, :2] / projected[:, 2:]


def images(count: int = 60, noise_px: float = 0.0, seed: int = 0) -> list[Array]:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (count, 3))
    return [project(matrix, points) + rng.normal(0, noise_px, (count, 2)) for matrix in PROJECTIONS]


def up_to_sign(a: Array, b: Array) -> float:
    return float(min(np.abs(a - b).max(), np.abs(a + b).max()))


def test_points_are_transferred_to_the_third_photo_exactly() -> None:
    a, b, c = images()
    np.testing.assert_allclose(transfer_pixels(TENSOR, a, b), c, atol=1e-8)
    assert transfer_distances(TENSOR, a, b, c).max() < 1e-8
    moved = c + np.array([3.0, 4.0])
    assert transfer_distances(TENSOR, a, b, moved).min() >= 5.0 - 1e-6


def test_transfer_works_where_epipolar_lines_coincide() -> None:
    """On the plane of the three projection centres both epipolar lines in the third photo are the same line."""
    along = CENTRES[1:] - CENTRES[0]
    ahead = along.T @ np.linalg.lstsq(along.T, np.array([0.0, 6.0, 0.0]), rcond=None)[0]
    inside = (
        CENTRES[1] + np.array([[0.9], [1.0], [1.2]]) * ahead + np.array([[-0.1], [0.0], [0.2]]) * along[0]
    )
    a, b, c = (project(matrix, inside) for matrix in PROJECTIONS)
    f_cb = fundamentals(trifocal_from_projections(PROJECTIONS[1], PROJECTIONS[2], PROJECTIONS[0]))[0]
    lines = [np.column_stack([xy, np.ones(3)]) @ f.T for f, xy in ((fundamentals(TENSOR)[1], a), (f_cb, b))]
    unit = [line / np.linalg.norm(line, axis=1, keepdims=True) for line in lines]
    assert np.abs(np.cross(*unit)).max() < 1e-9
    np.testing.assert_allclose(transfer_pixels(TENSOR, a, b), c, atol=1e-6)


def test_lines_are_transferred_too() -> None:
    ends = np.array([[0.1, 0.2, -0.4], [-0.5, 0.4, 0.6]])
    lines = [np.cross(*(np.append(xy, 1.0) for xy in project(matrix, ends))) for matrix in PROJECTIONS]
    found = transfer_line(TENSOR, lines[1], lines[2])
    assert up_to_sign(found / np.linalg.norm(found), lines[0] / np.linalg.norm(lines[0])) < 1e-9


def test_rays_of_any_field_angle_are_transferred() -> None:
    points = np.random.default_rng(1).normal(size=(50, 3)) * 4.0
    poses = [compose_projection(np.eye(3), look_at(c, np.zeros(3)), c) for c in CENTRES]
    rays = [np.column_stack([points, np.ones(50)]) @ pose.T for pose in poses]
    assert (rays[0][:, 2] < 0).any()
    found = transfer_points(trifocal_from_projections(*poses), rays[0], rays[1])
    np.testing.assert_allclose(np.cross(found, rays[2]), 0.0, atol=1e-9 * np.abs(found).max() * 10)


def test_epipoles_fundamentals_and_projections_belong_to_the_cameras() -> None:
    first_centre = np.append(CENTRES[0], 1.0)
    for matrix, epipole in zip(PROJECTIONS[1:], epipoles(TENSOR), strict=True):
        direct = matrix @ first_centre
        assert up_to_sign(epipole, direct / np.linalg.norm(direct)) < 1e-9
    a, b, c = images()
    for matrix, other in zip(fundamentals(TENSOR), (b, c), strict=True):
        misfit = np.einsum(
            "ni,ij,nj->n", np.column_stack([other, np.ones(60)]), matrix, np.column_stack([a, np.ones(60)])
        )
        assert np.abs(misfit).max() < 1e-9
    assert up_to_sign(trifocal_from_projections(*projections_from_trifocal(TENSOR)), TENSOR) < 1e-12


def test_seven_points_give_the_tensor_linearly_and_six_minimally() -> None:
    seven = linear_trifocal(*images(7))
    assert seven and up_to_sign(seven.tensor, TENSOR) < 1e-7
    for seed in range(5):
        six = six_point_trifocal(*images(6, seed=seed))
        assert 1 <= len(six) <= 3
        assert min(up_to_sign(tensor, TENSOR) for tensor in six) < 1e-5


def test_noise_hardly_moves_the_transfer_and_outliers_are_found() -> None:
    noisy = images(60, noise_px=0.5, seed=3)
    wrong = 15
    noisy[2][:wrong] += np.random.default_rng(4).uniform(20.0, 90.0, (wrong, 2))
    found = robust_trifocal(*noisy, 3.0, seed=1)
    assert found and not found.inliers[:wrong].any() and found.inliers[wrong:].mean() > 0.8
    clean = images(60, seed=9)
    assert np.sqrt((transfer_distances(found.tensor, *clean) ** 2).mean()) < 2.0
    again = robust_trifocal(*noisy, 3.0, seed=1)
    assert np.array_equal(found.tensor, again.tensor)


def test_degenerate_and_senseless_points_are_said() -> None:
    assert "6 points" in linear_trifocal(*images(6)).reason
    flat = np.random.default_rng(2).uniform(-1, 1, (30, 3)) * [1.0, 0.0, 1.0]
    assert "one plane" in linear_trifocal(*(project(matrix, flat) for matrix in PROJECTIONS)).reason
    rng = np.random.default_rng(0)
    senseless = robust_trifocal(*(rng.uniform(0, 1600, (12, 2)) for _ in range(3)), 0.5, seed=0)
    assert not senseless and "do not agree" in senseless.reason
