"""The camera a person steers: orbit, pan, zoom and fit keep what they promise."""

import math

import numpy as np
from numpy.testing import assert_allclose

from graphos_core.data import Camera
from graphos_core.rendering import ViewCamera, camera_pyramids

SIZE = (320, 200)


def oblique() -> ViewCamera:
    return ViewCamera.looking([0.5, 0.8, -0.4]).focused(np.array([3.0, 2.0, 1.0]))


def test_zoom_keeps_the_point_under_the_cursor() -> None:
    camera = oblique()
    point = camera.point_at(40.0, 150.0, 1.2 * camera.distance, *SIZE)
    for factor in (1.4, 0.5):
        assert_allclose(camera.zoomed(factor, point).project(point, *SIZE)[0, :2], [40, 150], atol=1e-8)


def test_pan_moves_a_point_at_its_depth_with_the_cursor() -> None:
    camera = oblique()
    point = camera.point_at(100.0, 90.0, 2.0 * camera.distance, *SIZE)
    moved = camera.panned(25.0, -13.0, *SIZE, depth=2.0 * camera.distance)
    assert_allclose(moved.project(point, *SIZE)[0, :2], [125, 77], atol=1e-8)


def test_orbit_keeps_the_pivot_in_place_and_its_distance() -> None:
    camera = oblique()
    pivot = camera.point_at(250.0, 60.0, 0.8 * camera.distance, *SIZE)
    turned = camera.orbited(0.7, 0.2, pivot)
    assert_allclose(turned.project(pivot, *SIZE), camera.project(pivot, *SIZE), atol=1e-8)


def test_orbit_follows_the_hand_and_never_tips_over() -> None:
    camera = ViewCamera.looking([0.0, 1.0, 0.0])
    front = camera.target - 0.5 * camera.rotation[2]
    x, y, _ = camera.orbited(0.1, 0.1).project(front, *SIZE)[0]
    assert x > 160
    assert y > 100
    for _ in range(10):
        camera = camera.orbited(0.3, 0.5)
    assert -camera.rotation[2] @ camera.up <= math.sin(math.radians(89.6))
    assert camera.rotation[1] @ camera.up < 0  # up is still up
    assert_allclose(camera.rotation @ camera.rotation.T, np.eye(3), atol=1e-12)


def test_roll_turns_the_picture_about_its_middle() -> None:
    camera = oblique()
    right = camera.target + 0.1 * camera.rotation[0]
    x, y, _ = camera.rolled(math.pi / 2).project(right, *SIZE)[0]
    assert_allclose(x, 159.5, atol=1e-8)
    assert y > 100


def test_fit_shows_everything_and_touches_the_margin() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        points = rng.normal(size=(200, 3)) * rng.uniform(0.01, 100, 3) + rng.normal(size=3) * 1000
        camera = ViewCamera.looking(rng.normal(size=3)).fitted(points, *SIZE, share=0.9)
        placed = camera.project(points, *SIZE)
        assert np.isfinite(placed).all()
        offset = np.abs(placed[:, :2] - [159.5, 99.5]) / [160, 100]
        assert_allclose(offset.max(), 0.9, rtol=1e-6)


def test_pyramids_meet_the_rays_of_the_photo_corners() -> None:
    camera = Camera(model="pinhole", width=400, height=300, values=np.array([500.0, 210.0, 140.0]))
    rotation = ViewCamera.looking([1.0, 2.0, -0.5]).rotation
    centre = np.array([4.0, 5.0, 6.0])
    starts, ends, corners = camera_pyramids(rotation[None], centre[None], [camera], 2.0)
    assert_allclose(starts[0, :4], np.tile(centre, (4, 1)))
    outline = np.array([[-0.5, -0.5], [399.5, -0.5], [399.5, 299.5], [-0.5, 299.5]])
    local = (ends[0, :4] - centre) @ rotation.T
    assert_allclose(500 * local[:, :2] / local[:, 2:] + [210, 140], outline, atol=1e-9)
    assert_allclose(np.linalg.norm(corners[0, 1]), 2.0)
    assert_allclose(corners[0, 0] + corners[0, 1] + corners[0, 2], ends[0, 2], atol=1e-12)
