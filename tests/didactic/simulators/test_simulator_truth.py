"""What the simulators show is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.geometry.intersection_precision import normal_case_sigma_z
from graphos_didactic.scene import Line, Picture
from graphos_didactic.scene_layout import clipped, place, ticks
from graphos_didactic.scene_text import html_text
from graphos_didactic.simulator import Setting, drag, find_simulator
from graphos_didactic.simulators.adjustment.intersection_model import IntersectionParams, Pair, with_base
from graphos_didactic.simulators.features.epipolar_model import EpipolarParams, TwoCameras
from graphos_didactic.simulators.pictured_plane import Plane, photograph
from graphos_didactic.simulators.preprocessing.wallis_model import Filtered, WallisSimulatorParams
from graphos_didactic.simulators.simulated_photo import simulated_photo


def test_intersection_cloud_spreads_as_the_covariance_says() -> None:
    pairs = [Pair(IntersectionParams(seed=seed)) for seed in range(40)]
    errors = np.concatenate([pair.estimates for pair in pairs])
    np.testing.assert_allclose(errors.std(axis=0), pairs[0].precision.sigma_xyz, rtol=0.05)


def test_intersection_numbers_of_the_normal_case_follow_the_book() -> None:
    params = IntersectionParams(aim="down", a_x=-1.6, b_x=1.6)
    numbers = find_simulator("adjustment/intersection").scene(params).numbers()
    book = 1e3 * normal_case_sigma_z(10.0, 3.2, params.focal_px, params.sigma_px)
    assert numbers["σ_Z"].value == pytest.approx(book)


def test_intersection_without_a_base_says_that_the_depth_is_lost() -> None:
    simulator = find_simulator("adjustment/intersection")
    for name in ("no_base", "over"):
        scene = simulator.scene(simulator.preset(name))
        assert not np.isfinite(scene.numbers()["σ_Z"].value)
        assert "do not fix the depth" in scene.says


def test_with_base_keeps_the_middle() -> None:
    changed = with_base(IntersectionParams(a_x=0.0, b_x=2.0), 4.0)
    assert (changed.a_x, changed.b_x) == (-1.0, 3.0)


def test_epipolar_point_dragged_in_photo_b_stays_on_its_line_and_on_its_ray() -> None:
    simulator = find_simulator("features/epipolar")
    params = simulator.params()
    before = TwoCameras(params)
    handle = next(h for h in simulator.scene(params).handles if h.name == "in_b")
    moved = drag(params, handle, handle.at[0] - 120.0, handle.at[1] + 300.0)
    after = TwoCameras(moved)
    np.testing.assert_allclose(after.pixels[0], before.pixels[0], atol=1e-6)
    assert before.line is not None
    assert before.line[:2] @ after.pixels[1] + before.line[2] == pytest.approx(0.0, abs=1e-6)
    assert after.depth < before.depth


def test_epipolar_degenerate_presets_have_no_line() -> None:
    simulator = find_simulator("features/epipolar")
    for name in ("rotation", "base_line"):
        params = simulator.preset(name)
        assert isinstance(params, EpipolarParams)
        assert TwoCameras(params).line is None
        scene = simulator.scene(params)
        assert not [
            m for m in scene.marks if isinstance(m, Line) and (m.panel, m.thing) == ("photo_b", "ray")
        ]


def test_epipolar_forward_motion_has_the_epipole_in_both_photos() -> None:
    params = find_simulator("features/epipolar").preset("forward")
    assert isinstance(params, EpipolarParams)
    for epipole in TwoCameras(params).epipoles:
        assert epipole is not None
        assert np.all((epipole > 0) & (epipole < (1200, 900)))


def test_epipole_is_the_image_of_the_other_camera() -> None:
    both = TwoCameras(EpipolarParams(b_y=-3.0, a_turn=30.0))
    seen = both.image(0, both.centres[1:])[0]
    assert both.epipoles[0] is not None
    np.testing.assert_allclose(both.epipoles[0], seen, rtol=1e-6)


def test_pictured_wall_lies_where_the_camera_model_says() -> None:
    both = TwoCameras(EpipolarParams())
    picture = np.zeros((300, 400, 3), np.uint8)
    picture[100:104, 250:254] = 255
    wall = Plane.centred(np.array([0, 4.0, 0]), np.array([1.0, 0, 0]), np.array([0, 0, -1.0]), 8.0, picture)
    seen = photograph(both.camera, both.rotations[0], both.centres[0], wall, picture, columns=600)
    rows, columns = np.nonzero(seen[..., 0] > 200)
    middle = (np.array([columns.mean(), rows.mean()]) + 0.5) * 2 - 0.5
    truth = both.image(0, wall.at(252 / 400, 102 / 300)[None])[0]
    np.testing.assert_allclose(middle, truth, atol=1.0)


def test_wallis_with_full_weights_reaches_the_targets_in_the_window() -> None:
    params = WallisSimulatorParams(contrast=1.0, brightness=1.0, target_std=30.0, shadow=0.0)
    seen = Filtered(params, Setting())
    assert seen.value(seen.mean) == pytest.approx(127.0, abs=1e-3)
    assert seen.value(seen.mean + seen.std) == pytest.approx(157.0, abs=1e-2)


def test_wallis_takes_most_of_the_shadow_away() -> None:
    scene = find_simulator("preprocessing/wallis").scene(WallisSimulatorParams())
    numbers = scene.numbers()
    assert abs(numbers["after"].value) < 0.25 * abs(numbers["before"].value)


def test_wallis_line_of_the_window_is_the_result_at_its_centre() -> None:
    seen = Filtered(WallisSimulatorParams(x=30.0, y=30.0), Setting())
    row, column = seen.centre
    assert seen.value(float(seen.row_grey[column])) == pytest.approx(float(seen.after[row, column]), abs=0.51)


def test_wallis_blows_up_the_noise_of_a_surface_without_texture() -> None:
    simulator = find_simulator("preprocessing/wallis")
    numbers = simulator.scene(simulator.preset("flat")).numbers()
    assert numbers["Deviation after"].value > 20 * numbers["Deviation s"].value


def test_wallis_shows_a_large_photo_of_the_project_smaller() -> None:
    photo = np.random.default_rng(0).integers(0, 255, (1200, 1600, 3)).astype(np.uint8)
    scene = find_simulator("preprocessing/wallis").scene(WallisSimulatorParams(), Setting(photo, "IMG_1.jpg"))
    shown = next(m for m in scene.marks if isinstance(m, Picture))
    assert max(shown.pixels.shape) <= 640
    assert "IMG_1.jpg" in scene.panel("before").title


def test_simulated_photo_shows_texture_light_and_shadow() -> None:
    photo = simulated_photo()
    assert photo.shape == (540, 720, 3)
    assert photo.std() > 30


def test_axes_have_round_ticks_inside() -> None:
    assert ticks(-1.0, 1.0, 5) == [-1.0, -0.5, 0.0, 0.5, 1.0]
    assert ticks(0.0, 0.0, 5) == []


def test_panel_coordinates_come_back_from_the_canvas() -> None:
    panel = find_simulator("features/epipolar").scene(EpipolarParams()).panel("photo_b")
    frame = place(panel, 1100, 700, 13)
    for point in ((0.0, 0.0), (1199.0, 899.0)):
        x, y = frame.to_canvas(np.array([point]))[0]
        assert frame.contains(x, y)
        assert frame.to_panel(x, y) == pytest.approx(point, abs=1e-9)


def test_long_lines_are_cut_to_the_box_and_stay_where_they_are() -> None:
    line = np.array([[-1e6, -1e6], [1e6, 1e6]])
    np.testing.assert_allclose(clipped(line, (0, 0, 100, 50)), [[0, 0], [50, 50]], atol=1e-6)
    assert not len(clipped(line + np.array([1e7, 0.0]), (0, 0, 100, 50)))
    zigzag = np.array([[10.0, 10.0], [200.0, 10.0], [200.0, 40.0], [10.0, 40.0]])
    parts = clipped(zigzag, (0, 0, 100, 50))
    np.testing.assert_allclose(
        parts[np.isfinite(parts).all(axis=1)], [[10, 10], [100, 10], [100, 40], [10, 40]]
    )


def test_indices_are_lowered_and_markup_is_escaped() -> None:
    assert html_text("σ_Z < 3") == "σ<sub>Z</sub> &lt; 3"
    assert html_text("file_name") == "file_name"
