"""What the simulator of rotations shows is true."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from graphos_didactic.scene import Line
from graphos_didactic.simulator import drag, find_simulator
from graphos_didactic.simulators.adjustment.rotations_model import MARKS, RotationsParams, TurnedPhoto


def test_one_turn_and_quaternion_are_those_of_an_independent_library() -> None:
    photo = TurnedPhoto(RotationsParams(omega=25.0, phi=-20.0, kappa=35.0))
    other = Rotation.from_euler("XYZ", [25.0, -20.0, 35.0], degrees=True)
    axis, angle = photo.one_turn
    np.testing.assert_allclose(np.radians(angle) * axis, other.as_rotvec(), atol=1e-12)
    np.testing.assert_allclose(photo.quaternion, other.as_quat()[[3, 0, 1, 2]], atol=1e-12)
    back = Rotation.from_euler("xyz", [25.0, -20.0, 35.0], degrees=True)
    assert photo.reversed_turn == pytest.approx(np.degrees((back * other.inv()).magnitude()), abs=1e-9)


def test_gimbal_lock_is_said_and_only_the_sum_counts() -> None:
    simulator = find_simulator("adjustment/rotations")
    locked = simulator.preset("gimbal")
    scene = simulator.scene(locked)
    assert "Gimbal lock" in scene.says
    assert scene.numbers()["Axes apart (1: right angles, 0: lock)"].value == pytest.approx(0.0, abs=1e-9)
    other = locked.replace(omega=10.0, kappa=40.0)
    np.testing.assert_allclose(TurnedPhoto(other).frame, TurnedPhoto(locked).frame, atol=1e-12)  # type: ignore[arg-type]


@pytest.mark.parametrize("order", ["xyz", "zyx"])
def test_pulling_an_axis_or_a_mark_turns_the_photo_so_that_it_follows(order: str) -> None:
    simulator = find_simulator("adjustment/rotations")
    params = RotationsParams(order=order)  # type: ignore[arg-type]
    handles = {h.name: h for h in simulator.scene(params).handles}
    moved = drag(params, handles["mark"], 700.0, 300.0)
    photo = TurnedPhoto(moved)  # type: ignore[arg-type]
    np.testing.assert_allclose(photo.image(photo.rotation, MARKS[4:])[0], [700.0, 300.0], atol=1e-6)
    x, y = handles["axis_x"].at
    pulled = drag(params, handles["axis_x"], x - 12.0, y + 9.0)
    again = next(h for h in simulator.scene(pulled).handles if h.name == "axis_x")
    np.testing.assert_allclose(again.at, [x - 12.0, y + 9.0], atol=1e-6)


def test_marks_lie_in_their_rings_when_the_orientation_is_true() -> None:
    params = RotationsParams(omega=8.0, phi=6.0, kappa=15.0)
    simulator = find_simulator("adjustment/rotations")
    scene = simulator.scene(params)
    assert scene.numbers()["Error: one turn from the truth"].value == pytest.approx(0.0, abs=1e-6)
    gaps = [m.xy for m in scene.marks if isinstance(m, Line) and (m.panel, m.thing) == ("photo", "marks")]
    assert len(gaps) == len(MARKS)
    assert max(float(np.abs(np.diff(gap, axis=0)).max()) for gap in gaps) < 1e-6


def test_the_shortest_way_ends_at_the_three_angles() -> None:
    photo = TurnedPhoto(RotationsParams())
    frames, angles = photo.on_the_way(np.array([0.0, 1.0]))
    np.testing.assert_allclose(frames[1], photo.frame, atol=1e-12)
    np.testing.assert_allclose(angles[1], [25.0, -20.0, 35.0], atol=1e-9)
