"""Distances from and registration to a reference of known shape."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.data import Array, Cloud, Mesh
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import angle_between, matrix_from_vector
from graphos_core.geometry.similarity import Similarity
from graphos_core.quality.distances.nearest import NearestParams, nearest
from graphos_core.quality.registration.icp import IcpParams, icp
from graphos_core.quality.registration.placed import PlacedParams, placed
from graphos_core.run import Run

FAR_AWAY = np.array([400_000.0, 5_500_000.0, 300.0])


def surface(x: Array, y: Array) -> Array:
    return 0.3 * np.sin(1.3 * x) * np.cos(y) + 0.1 * x


def cloud_of(points: Array, normals: Array | None = None) -> Cloud:
    return Cloud(
        points=points,
        colours=np.zeros((len(points), 3), np.uint8),
        normals=np.zeros((0, 3), np.float32) if normals is None else normals.astype(np.float32),
        views=np.zeros(0, np.uint8),
        unit="m",
    )


def sampled(count: int, seed: int) -> Array:
    xy = np.random.default_rng(seed).uniform(-4, 4, (count, 2))
    return np.column_stack([xy, surface(xy[:, 0], xy[:, 1])])


def grid_mesh(side: int = 120) -> Mesh:
    x, y = np.meshgrid(np.linspace(-5, 5, side), np.linspace(-5, 5, side))
    vertices = np.column_stack([x.ravel(), y.ravel(), surface(x, y).ravel()])
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    triangles = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + side]),
            np.column_stack([corner + 1, corner + side + 1, corner + side]),
        ]
    )
    return Mesh(vertices=vertices, triangles=triangles.astype(np.int32), unit="m")


def test_injected_noise_is_the_measured_spread_against_a_mesh_far_from_the_origin() -> None:
    mesh = grid_mesh()
    mesh = Mesh(vertices=mesh.vertices + FAR_AWAY, triangles=mesh.triangles, unit="m")
    rng = np.random.default_rng(4)
    points = sampled(20_000, 5) + FAR_AWAY
    slope_x = 0.39 * np.cos(1.3 * (points[:, 0] - FAR_AWAY[0])) * np.cos(points[:, 1] - FAR_AWAY[1]) + 0.1
    slope_y = -0.3 * np.sin(1.3 * (points[:, 0] - FAR_AWAY[0])) * np.sin(points[:, 1] - FAR_AWAY[1])
    normals = np.column_stack([-slope_x, -slope_y, np.ones(len(points))])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    noisy = points + normals * rng.normal(0.005, 0.01, (len(points), 1))
    found = nearest(cloud_of(noisy), mesh, NearestParams(), run=Run())
    assert found.unit == "m"
    assert found.statistics["mean"] == pytest.approx(0.005, abs=5e-4)
    assert found.statistics["std"] == pytest.approx(0.01, rel=0.05)
    assert "mesh" in found.definition


def test_a_flat_cloud_knows_on_which_side_a_point_lies() -> None:
    x, y = np.meshgrid(np.linspace(-2, 2, 60), np.linspace(-2, 2, 60))
    flat = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    up = np.tile([0.0, 0.0, 1.0], (len(flat), 1))
    points = np.array([[0.1, 0.2, 0.05], [0.3, -0.2, -0.07], [0.0, 0.0, 3.0]])
    found = nearest(cloud_of(points), cloud_of(flat, up), NearestParams(farthest=1.0), run=Run())
    np.testing.assert_allclose(found.distances[:2], [0.05, -0.07], atol=1e-6)
    assert np.isnan(found.distances[2])
    assert found.statistics["count"] == 2


@pytest.mark.parametrize("with_mesh", [False, True])
def test_icp_recovers_a_known_motion(with_mesh: bool) -> None:
    motion = Similarity(
        1.0, matrix_from_vector(np.array([0.01, -0.015, 0.02])), np.array([0.03, -0.02, 0.04])
    )
    moved = cloud_of(motion.inverse().apply(sampled(8000, 6)))
    reference = grid_mesh() if with_mesh else cloud_of(sampled(20_000, 7))
    found = icp(moved, reference, None, IcpParams(points=20_000), run=Run())
    assert angle_between(found.rotation, motion.rotation) < 2e-3
    np.testing.assert_allclose(found.apply(moved.points), motion.apply(moved.points), atol=8e-3)


def test_icp_says_when_nothing_is_near() -> None:
    away = cloud_of(sampled(2000, 8) + np.array([0.0, 0.0, 500.0]))
    with pytest.raises(UserError, match="could not be registered"):
        icp(away, cloud_of(sampled(2000, 9)), None, IcpParams(), run=Run())


def test_the_placement_by_control_is_kept_as_it_is() -> None:
    given = Similarity(2.0, matrix_from_vector(np.array([0.0, 0.0, 1.0])), np.array([1.0, 2.0, 3.0]))
    some = cloud_of(sampled(10, 1))
    assert placed(some, some, given, PlacedParams(), run=Run()) is given
    kept = placed(some, some, None, PlacedParams(), run=Run())
    np.testing.assert_array_equal(kept.apply(some.points), some.points)


def test_an_empty_cloud_is_refused() -> None:
    with pytest.raises(UserError, match="nothing to compare"):
        nearest(cloud_of(np.empty((0, 3))), grid_mesh(), NearestParams(), run=Run())


@pytest.mark.parametrize("times", [1, 2])
def test_a_random_or_doubled_reference_cloud_still_has_planes(times: int) -> None:
    rng = np.random.default_rng(3)
    flat = np.column_stack([rng.uniform(-1.0, 1.0, (4000, 2)), np.zeros(4000)])
    points = np.column_stack([rng.uniform(-0.9, 0.9, (500, 2)), np.full(500, 0.02)])
    up = np.tile([0.0, 0.0, 1.0], (4000 * times, 1))
    found = nearest(cloud_of(points), cloud_of(np.vstack([flat] * times), up), NearestParams(), run=Run())
    assert np.isclose(found.distances, 0.02, atol=1e-9).mean() > 0.99
