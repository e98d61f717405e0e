import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera
from graphos_core.geometry.epipolar import (
    epipolar_curve,
    epipolar_lines,
    epipoles,
    essential_from_relative,
    fundamental_from_cameras,
    line_distances,
    line_transfer,
    relative_orientation,
    sampson_distances,
)
from graphos_core.geometry.rotation import look_at

A = Camera(model="pinhole", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5]))
B = Camera(model="pinhole", width=1600, height=1200, values=np.array([1300.0, 810.0, 590.0]))
CENTRE_A, CENTRE_B = np.array([0.0, -10.0, 1.0]), np.array([3.0, -9.0, 2.0])
R_A, R_B = look_at(CENTRE_A, np.zeros(3)), look_at(CENTRE_B, np.array([0.2, 0.0, 0.1]))
POSES = (A, R_A, CENTRE_A, B, R_B, CENTRE_B)
POINTS = np.random.default_rng(0).uniform(-2, 2, (200, 3))


def seen(camera: Camera, rotation: np.ndarray, centre: np.ndarray) -> np.ndarray:
    return pixel_from_ray(camera, (POINTS - centre) @ rotation.T)


def test_images_of_one_point_fulfil_the_epipolar_condition() -> None:
    fundamental = fundamental_from_cameras(*POSES)
    xy_a, xy_b = seen(A, R_A, CENTRE_A), seen(B, R_B, CENTRE_B)
    in_a, in_b = line_distances(fundamental, xy_a, xy_b)
    assert max(in_a.max(), in_b.max()) < 1e-8
    assert sampson_distances(fundamental, xy_a, xy_b).max() < 1e-8
    assert np.linalg.matrix_rank(fundamental, tol=1e-12) == 2


def test_distances_are_in_pixels() -> None:
    fundamental = fundamental_from_cameras(*POSES)
    xy_a, xy_b = seen(A, R_A, CENTRE_A), seen(B, R_B, CENTRE_B)
    lines = epipolar_lines(fundamental, xy_a)
    moved = xy_b + 3.0 * lines[:, :2]  # 3 px away from the line, at right angles
    assert line_distances(fundamental, xy_a, moved)[1] == pytest.approx(np.full(len(moved), 3.0))
    sampson = sampson_distances(fundamental, xy_a, moved)
    in_a, in_b = line_distances(fundamental, xy_a, moved)
    assert (sampson <= np.minimum(in_a, in_b) + 1e-9).all()


def test_epipoles_are_the_images_of_the_other_camera() -> None:
    in_a, in_b = epipoles(fundamental_from_cameras(*POSES))
    assert in_b[:2] / in_b[2] == pytest.approx(pixel(B, R_B, CENTRE_B, CENTRE_A))
    assert in_a[:2] / in_a[2] == pytest.approx(pixel(A, R_A, CENTRE_A, CENTRE_B))


def pixel(camera: Camera, rotation: np.ndarray, centre: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Also for points behind the camera, where the line of sight still meets the image plane."""
    p = rotation @ (point - centre)
    return camera.values[0] * p[:2] / p[2] + camera.values[1:3]


def test_the_essential_matrix_has_two_equal_singular_values_and_none_without_a_base() -> None:
    rotation, translation = relative_orientation(R_A, CENTRE_A, R_B, CENTRE_B)
    assert R_B @ (POINTS[0] - CENTRE_B) == pytest.approx(
        rotation @ (R_A @ (POINTS[0] - CENTRE_A)) + translation
    )
    assert np.linalg.svd(essential_from_relative(rotation, translation))[1] == pytest.approx([1, 1, 0])
    assert not fundamental_from_cameras(A, R_A, CENTRE_A, B, R_B, CENTRE_A).any()


def test_the_epipolar_curve_is_the_line_without_distortion_and_leaves_it_with() -> None:
    depths = np.linspace(5.0, 20.0, 9)
    straight = epipolar_curve(np.array([300.0, 400.0]), *POSES, depths)
    (line,) = epipolar_lines(fundamental_from_cameras(*POSES), np.array([[300.0, 400.0]]))
    assert np.abs(straight @ line[:2] + line[2]).max() < 1e-8
    wide = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.2, 0.03]))
    curve = epipolar_curve(np.array([300.0, 400.0]), wide, R_A, CENTRE_A, wide, R_B, CENTRE_B, depths)
    chord = np.cross([*curve[0], 1.0], [*curve[-1], 1.0])
    bend = np.abs(curve @ chord[:2] + chord[2]) / np.hypot(*chord[:2])
    assert bend.max() > 1.0


def test_the_curve_runs_through_the_image_of_the_point() -> None:
    wide = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.2, 0.03]))
    in_a, in_b = seen(wide, R_A, CENTRE_A), seen(wide, R_B, CENTRE_B)
    depth = (R_A @ (POINTS[7] - CENTRE_A))[2]
    found = epipolar_curve(in_a[7], wide, R_A, CENTRE_A, wide, R_B, CENTRE_B, np.array([depth]))
    assert found[0] == pytest.approx(in_b[7], abs=1e-6)


def test_epipolar_lines_of_two_photos_meet_where_the_third_sees_the_point():
    draw = np.random.default_rng(8)
    points = draw.uniform([-1, -1, 6], [1, 1, 9], (12, 3))
    centres = np.array([[0.0, 0, 0], [1.5, 0.3, 0.2], [0.4, 1.2, -0.3]])
    rotations = [look_at(c, np.array([0.0, 0.0, 7.0]), np.array([0.0, -1.0, 0.0])) for c in centres]
    rays = [(points - c) @ r.T for c, r in zip(centres, rotations, strict=True)]
    into_c = [
        essential_from_relative(*relative_orientation(rotations[i], centres[i], rotations[2], centres[2]))
        for i in (0, 1)
    ]
    found = line_transfer(into_c[0], into_c[1], rays[0], rays[1])
    assert np.allclose(found[:, :2] / found[:, 2:], rays[2][:, :2] / rays[2][:, 2:], atol=1e-9)
