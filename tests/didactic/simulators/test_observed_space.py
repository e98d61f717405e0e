"""Somebody who looks at space sees it as a camera does, and a pointer finds back into it."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.data import Camera
from graphos_didactic.simulators.folded_wall import HALF_WIDTH, NEAR, FoldedWall
from graphos_didactic.simulators.format_edges import line_in_format
from graphos_didactic.simulators.observed_space import Observer

VIEW = Observer(np.array([0.5, 1.0, 0.2]), 12.0, orbit=35.0)


def test_the_middle_is_seen_in_the_middle_with_the_vertical_upright() -> None:
    low, high = VIEW.seen(np.array([[0.5, 1.0, 0.2], [0.5, 1.0, 1.2]]))
    np.testing.assert_allclose(low, [0.0, 0.0], atol=1e-9)
    assert high[0] == pytest.approx(0.0, abs=1e-9)
    assert high[1] < -10
    assert np.linalg.norm(VIEW.centre - VIEW.middle) == pytest.approx(12.0)


def test_a_place_of_the_picture_leads_back_to_the_plane_and_to_the_sphere() -> None:
    place = np.array([1.2, -0.4, 0.7])
    x, y = VIEW.seen(place[None])[0]
    found = VIEW.on_plane(np.array([9.0, 9.0, 0.7]), np.array([0.0, 0.0, 1.0]), x, y)
    assert found is not None
    np.testing.assert_allclose(found, place, atol=1e-9)
    towards = VIEW.centre - VIEW.middle
    tip = VIEW.middle + 2.0 * towards / np.linalg.norm(towards)
    way = VIEW.on_sphere(VIEW.middle, 2.0, *(VIEW.seen(tip[None])[0] + [25.0, -10.0]))
    assert np.linalg.norm(way) == pytest.approx(1.0)
    np.testing.assert_allclose(VIEW.seen((VIEW.middle + 2.0 * way)[None])[0], [25.0, -10.0], atol=1e-6)


def test_beside_the_sphere_the_nearest_direction_is_taken() -> None:
    way = VIEW.on_sphere(VIEW.middle, 1.0, 400.0, 0.0)
    assert np.linalg.norm(way) == pytest.approx(1.0)
    assert VIEW.seen((VIEW.middle + way)[None])[0][0] > 25


def test_points_of_the_folded_wall_lie_on_it_and_a_flat_one_is_flat() -> None:
    points = FoldedWall(2.0).points(20, seed=1)
    np.testing.assert_allclose(points[:, 1], NEAR + 2.0 * np.abs(points[:, 0]) / HALF_WIDTH)
    assert np.ptp(FoldedWall(0.0).points(20, seed=1)[:, 1]) == 0.0


def test_a_line_is_cut_where_the_format_ends() -> None:
    camera = Camera(model="pinhole", width=100, height=60, values=np.array([80.0, 49.5, 29.5]))
    ends = line_in_format(np.array([0.0, 1.0, -20.0]), camera)
    assert ends is not None
    np.testing.assert_allclose(ends, [[-0.5, 20.0], [99.5, 20.0]])
    assert line_in_format(np.array([0.0, 1.0, -80.0]), camera) is None
