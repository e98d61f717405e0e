"""Rotations: conventions proved against printed angles, and round trips."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from graphos_core.geometry.rotation import (
    FLIP,
    angle_between,
    look_at,
    matrix_from_opk,
    matrix_from_quaternion,
    matrix_from_turns,
    matrix_from_vector,
    opk_from_matrix,
    quaternion_from_matrix,
    shortest_turn,
    skew,
    turn_axes,
    turns_from_matrix,
    vector_from_matrix,
)

ANGLES = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, 3)) * [1.0, 0.49, 1.0]


@pytest.mark.data
def test_printed_angles_of_a_report_project_its_points_where_they_were_measured(data_dir):
    """Angles, centres, control and residuals printed by an independent program agree in our convention."""
    folder = data_dir / "dbat" / "prague2016_sxb"
    report = (folder / "dbatexports" / "f-op0-with-orient-dbatreport.txt").read_text()
    number = r"Value:\s+(\S+)"
    stations = [
        [float(v) for v in re.findall(number, part)[:6]]
        for part in re.split(r"\n\s+Photo \d+: ", report)[1:6]
    ]
    control = {
        int(words[0]): np.array([float(w) for w in words[1:4]])
        for words in (line.replace(",", " ").split() for line in report.split("Posterior")[1].splitlines())
        if len(words) == 9 and words[0].isdigit()
    }
    assert len(stations) == 5 and len(control) == 16
    squares = []
    for line in (folder / "pmexports" / "f-op0-with-orient-2dpts.txt").read_text().splitlines():
        words = line.split(",")
        if not words[0].isdigit():
            continue
        omega, phi, kappa, *centre = stations[int(words[1]) - 1]
        rotation = matrix_from_opk(*np.radians([omega, phi, kappa]))
        p = rotation @ (control[int(words[0])] - centre)
        pixel = 123.9392 / 0.006 * p[:2] / p[2] + np.array([26.577, 38.811]) / 0.006
        squares.append(((pixel - [float(words[2]), float(words[3])]) ** 2).sum())
    assert len(squares) == 47
    # the report's overall point RMS is 1.216 px; its control coordinates are rounded to a millimetre
    assert np.sqrt(np.mean(squares)) == pytest.approx(1.216, abs=0.02)


def test_omega_phi_kappa_are_right_handed_turns_about_x_y_z():
    flip = np.diag([1.0, -1.0, -1.0])
    for omega, phi, kappa in ANGLES:
        world_from_image = Rotation.from_euler("XYZ", [omega, phi, kappa]).as_matrix()
        assert np.allclose(matrix_from_opk(omega, phi, kappa), flip @ world_from_image.T, atol=1e-12)
        assert np.allclose(
            opk_from_matrix(matrix_from_opk(omega, phi, kappa)), [omega, phi, kappa], atol=1e-9
        )


def test_a_photo_from_above_with_zero_angles_looks_down_with_its_top_to_the_north():
    rotation = matrix_from_opk(0.0, 0.0, 0.0)
    assert np.allclose(rotation @ [0, 0, -1], [0, 0, 1])  # down is forward
    assert np.allclose(rotation @ [0, 1, 0], [0, -1, 0])  # north is up in the photo
    assert np.allclose(rotation @ [1, 0, 0], [1, 0, 0])  # east is right


@pytest.mark.parametrize("phi", [np.pi / 2, -np.pi / 2])
def test_gimbal_lock_keeps_the_rotation(phi):
    rotation = matrix_from_opk(0.3, phi, -0.8)
    omega, locked, kappa = opk_from_matrix(rotation)
    assert omega == 0.0
    assert locked == pytest.approx(phi, abs=1e-7)
    assert np.allclose(matrix_from_opk(omega, locked, kappa), rotation, atol=1e-7)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-8, 1e-4, 1.0, 3.0, np.pi - 1e-6])
def test_vectors_matrices_and_quaternions_agree_with_an_independent_implementation(angle):
    for axis in np.random.default_rng(1).normal(size=(10, 3)):
        vector = angle * axis / np.linalg.norm(axis)
        matrix = matrix_from_vector(vector)
        assert np.allclose(matrix, Rotation.from_rotvec(vector).as_matrix(), atol=1e-14)
        assert np.allclose(vector_from_matrix(matrix), vector, atol=1e-9)
        quaternion = quaternion_from_matrix(matrix)
        assert quaternion[0] >= 0
        assert np.linalg.norm(quaternion) == pytest.approx(1.0)
        assert np.allclose(matrix_from_quaternion(3.0 * quaternion), matrix, atol=1e-12)
        assert angle_between(np.eye(3), matrix) == pytest.approx(angle, abs=1e-9)


def test_skew_is_the_cross_product():
    a, b = np.random.default_rng(2).normal(size=(2, 3))
    assert np.allclose(skew(a) @ b, np.cross(a, b))


@pytest.mark.parametrize("target", [[0.0, 0.0, 0.0], [3.0, 4.0, -5.0]])
def test_look_at_puts_the_target_on_the_axis_and_up_up(target):
    centre = np.array([3.0, 4.0, 5.0])
    rotation = look_at(centre, target)
    seen = rotation @ (np.asarray(target) - centre)
    assert np.allclose(seen[:2], 0.0, atol=1e-12) and seen[2] > 0
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert (rotation @ [0.0, 0.0, 1.0])[1] <= 1e-12


@pytest.mark.parametrize("axes", ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"])
def test_turns_in_any_order_agree_with_scipy_and_come_back(axes: str) -> None:
    for angles in np.random.default_rng(4).uniform([-3.1, -1.5, -3.1], [3.1, 1.5, 3.1], (20, 3)):
        found = matrix_from_turns(axes, angles)
        np.testing.assert_allclose(found, Rotation.from_euler(axes.upper(), angles).as_matrix(), atol=1e-12)
        np.testing.assert_allclose(turns_from_matrix(axes, found), angles, atol=1e-9)


def test_turns_about_x_y_z_are_omega_phi_kappa() -> None:
    angles = (0.3, -0.4, 1.1)
    np.testing.assert_allclose(
        FLIP @ matrix_from_turns("xyz", np.array(angles)).T, matrix_from_opk(*angles), atol=1e-14
    )


@pytest.mark.parametrize("axes", ["xyz", "zyx", "yxz"])
@pytest.mark.parametrize("middle", [np.pi / 2, -np.pi / 2])
def test_turns_of_a_locked_gimbal_give_the_same_rotation(axes: str, middle: float) -> None:
    locked = matrix_from_turns(axes, np.array([0.7, middle, -0.2]))
    found = turns_from_matrix(axes, locked)
    assert found[0] == 0.0
    np.testing.assert_allclose(matrix_from_turns(axes, found), locked, atol=1e-9)


@pytest.mark.parametrize("axes", ["xyz", "zyx", "yxz"])
def test_turn_axes_are_the_derivative_and_lose_rank_at_a_right_angle(axes: str) -> None:
    angles, h = np.array([0.4, -0.9, 2.0]), 1e-6
    found = turn_axes(axes, angles)
    for i in range(3):
        step = np.zeros(3)
        step[i] = h
        change = matrix_from_turns(axes, angles + step) @ matrix_from_turns(axes, angles - step).T
        np.testing.assert_allclose(found[i], vector_from_matrix(change) / (2 * h), atol=1e-8)
    assert abs(np.linalg.det(found)) == pytest.approx(np.cos(angles[1]))
    assert abs(np.linalg.det(turn_axes(axes, np.array([0.4, np.pi / 2, 2.0])))) < 1e-12


def test_the_shortest_turn_takes_one_direction_to_the_other() -> None:
    draw = np.random.default_rng(5)
    pairs = [
        *draw.normal(size=(10, 2, 3)),
        np.array([[1.0, 2, 3], [-2.0, -4, -6]]),
        np.array([[0, 0, 1.0], [0, 0, 5]]),
    ]
    for a, b in pairs:
        a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
        turn = shortest_turn(a, b)
        np.testing.assert_allclose(turn @ a, b, atol=1e-12)
        assert angle_between(np.eye(3), turn) == pytest.approx(np.arccos(np.clip(a @ b, -1, 1)), abs=1e-7)
