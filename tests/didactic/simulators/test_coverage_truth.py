"""What the simulator of the coverage of the format shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_didactic.simulator import Setting, find_simulator
from graphos_didactic.simulators.features.coverage_model import (
    CAMERA,
    NAMES,
    STATIONS,
    Covered,
    even,
)
from graphos_didactic.simulators.features.coverage_params import HEIGHT, WIDTH, CoverageSimulatorParams


def preset(name: str, **changes: object) -> Covered:
    params = find_simulator("features/coverage").preset(name)
    assert isinstance(params, CoverageSimulatorParams)
    return Covered(params.replace(**changes), Setting())


def test_the_known_points_are_seen_where_the_points_on_the_format_are() -> None:
    block = preset("corners").exact
    for photo in range(len(STATIONS.names)):
        mine = np.asarray(block.obs_photo) == photo
        seen = (block.points[mine] - STATIONS.centres[photo]) @ STATIONS.rotations[photo].T
        assert pixel_from_ray(CAMERA, seen) == pytest.approx(block.obs_xy[mine], abs=1e-6)
        assert (block.obs_xy[mine] >= 0).all()
        assert (block.obs_xy[mine] <= (WIDTH - 1, HEIGHT - 1)).all()


def test_the_errors_of_many_calibrations_have_the_promised_standard_deviation() -> None:
    """Injected noise: σ of the parameters and of the image, against the spread over 40 seeds of the noise."""
    errors, images, sigmas = [], [], []
    for seed in range(40):
        seen = preset("corners", points=24, seed=seed)
        errors.append([seen.error(name) for name in NAMES])
        images.append(seen.image_errors**2)
        sigmas.append(seen.sigmas)
    ratio = np.sqrt(np.mean((np.array(errors) / sigmas) ** 2, axis=0))
    assert ((ratio > 0.68) & (ratio < 1.36)).all()  # χ² of 40 draws, 99.8 %
    found = np.sqrt(np.mean(images, axis=0))
    assert found == pytest.approx(preset("corners", points=24).image_sigmas, rel=0.4)


def test_precision_follows_the_noise_and_the_root_of_the_number() -> None:
    once = preset("corners")
    assert preset("corners", sigma_px=1.0).sigmas == pytest.approx(2.0 * once.sigmas)
    assert preset("corners", points=200).sigmas == pytest.approx(
        preset("corners", points=48).sigmas * np.sqrt(48 / 200), rel=0.15
    )


def test_points_in_the_middle_leave_the_distortion_open_and_corners_do_not() -> None:
    middle, corners = preset("middle"), preset("corners")
    k1 = NAMES.index("k1")
    assert middle.sigmas[k1] > 2.0 * corners.sigmas[k1]
    assert middle.image_sigmas[-1] > 8.0 * corners.image_sigmas[-1]
    assert middle.coverage.alert
    assert not preset("even").coverage.alert
    best = even(corners.params.points, corners.params.sigma_px)[0]
    assert (corners.sigmas < 3.0 * best).all()


def test_one_spot_determines_nothing_and_says_so() -> None:
    seen = preset("spot")
    assert np.isnan(seen.sigmas).all()
    assert seen.estimate is None
    scene = find_simulator("features/coverage").scene(seen.params)
    assert "do not determine" in scene.says


def test_points_of_a_photo_lie_on_features_inside_the_groups() -> None:
    seen = preset("photo")
    gaps = np.hypot(*(seen.xy[:, None] - seen.middles).transpose(2, 0, 1)).min(axis=1)
    assert len(seen.xy) > 60
    assert gaps.max() <= seen.radius + 1e-9
    empty = preset("photo", spread=0.0)
    assert not empty.enough
    assert np.isnan(empty.sigmas).all()
