"""What the simulator of lens distortion shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_didactic.simulator import drag, find_simulator
from graphos_didactic.simulators.adjustment.distortion_model import CORNER, MIDDLE, RADII, Lens
from graphos_didactic.simulators.adjustment.distortion_params import DistortionParams


def test_the_profile_is_browns_polynomial() -> None:
    lens = Lens(DistortionParams(model="basic", k1=-0.2, k2=0.07, focal_px=2500.0))
    rho = RADII / 2500.0
    np.testing.assert_allclose(
        lens.gaussian.displacement_px, 2500.0 * (-0.2 * rho**3 + 0.07 * rho**5), atol=1e-9
    )


def test_balancing_moves_no_point_and_is_zero_where_it_should_be() -> None:
    lens = Lens(DistortionParams(zero_px=1500.0))
    f = lens.params.focal_px
    positions = RADII + lens.gaussian.displacement_px
    balanced = RADII * lens.balanced.focal_px / f + lens.balanced.displacement_px
    np.testing.assert_allclose(balanced, positions, atol=1e-9)
    at = np.interp(1500.0, RADII, lens.balanced.displacement_px)
    assert at == pytest.approx(0.0, abs=0.1)


def test_pulling_the_corner_of_the_grid_brings_it_along_the_diagonal_to_the_pointer() -> None:
    simulator = find_simulator("adjustment/distortion")
    params = DistortionParams(p1=0.0, p2=0.0, b1=0.0, b2=0.0)
    handle = next(h for h in simulator.scene(params).handles if h.name == "corner")
    out = np.array(handle.at) - MIDDLE
    goal = np.array(handle.at) + 100.0 * out / np.hypot(*out)
    after = simulator.scene(drag(params, handle, *goal.tolist()))
    found = next(h for h in after.handles if h.name == "corner")
    np.testing.assert_allclose(found.at, goal, atol=1e-6)


def test_the_lens_is_met_when_it_has_the_true_coefficients() -> None:
    params = DistortionParams(model="basic", k1=-0.1, k2=0.02)
    assert Lens(params).rms_px == pytest.approx(0.0, abs=1e-9)
    assert Lens(params.replace(k1=0.1, k2=-0.02)).rms_px > 50


def test_a_polynomial_that_turns_back_is_said() -> None:
    simulator = find_simulator("adjustment/distortion")
    params = simulator.preset("folded")
    turning = params.focal_px * (1 / (3 * 0.5)) ** 0.5  # type: ignore[attr-defined]  # 1 + 3 k1 r² = 0
    said = simulator.scene(params).says
    assert "turns back" in said
    assert int(said.split(" at ")[1].split(" px")[0]) == pytest.approx(turning, abs=CORNER / 60)


def test_a_fish_eye_images_rays_from_beside() -> None:
    simulator = find_simulator("adjustment/distortion")
    lens = Lens(simulator.preset("fisheye"))  # type: ignore[arg-type]
    assert lens.image_radius(lens.camera, np.array([np.pi / 2]))[0] == pytest.approx(2000 * np.sin(np.pi / 4))
    assert "90°" in simulator.scene(lens.params).says


@pytest.mark.parametrize("name", ["pinhole", "ebner", "spherical"])
def test_other_models_have_a_scene_too(name: str) -> None:
    simulator = find_simulator("adjustment/distortion")
    scene = simulator.scene(simulator.described(f"model={name}"))
    assert scene.says
    assert "nan" not in scene.says
