"""What the simulator of collinearity and DLT shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_didactic.simulator import drag, find_simulator
from graphos_didactic.simulators.adjustment.collinearity_model import (
    X0,
    CollinearityParams,
    ControlPhoto,
    errors_of_folds,
)


def test_without_errors_the_eleven_parameters_hold_the_camera() -> None:
    photo = ControlPhoto(CollinearityParams(sigma_px=0.0))
    found = photo.decomposed
    assert found is not None
    np.testing.assert_allclose(
        found.interior, [[1350, 0, X0], [0, 1350, photo.camera.values[2]], [0, 0, 1]], atol=1e-5
    )
    assert photo.centre_errors[0] < 1e-8
    assert photo.centre_errors[1] < 1e-5
    values = np.append(photo.linear.coefficients, 1.0).reshape(3, 4)
    projected = np.column_stack([photo.points, np.ones(len(photo.points))]) @ values.T
    np.testing.assert_allclose(projected[:, :2] / projected[:, 2:], photo.true_pixels, atol=1e-6)


def test_coplanar_control_breaks_the_dlt_and_thin_control_hides_it() -> None:
    flat = ControlPhoto(CollinearityParams(fold=0.0))
    assert flat.decomposed is None
    assert flat.centre_errors[1] < 0.1
    deep, thin = (ControlPhoto(CollinearityParams(fold=fold)) for fold in (2.0, 0.1))
    assert thin.centre_errors[0] > 5 * deep.centre_errors[0]
    assert thin.linear.rms_px == pytest.approx(deep.linear.rms_px, rel=0.2)
    assert np.isnan(errors_of_folds(CollinearityParams())[0, 0])


def test_residuals_have_the_size_that_redundancy_lets_them_have() -> None:
    squares, expected = 0.0, 0.0
    for seed in range(30):
        photo = ControlPhoto(CollinearityParams(seed=seed, sigma_px=1.0, x=0.5, y=-3.0, z=0.3))
        assert photo.used.all()
        squares += float((photo.linear.residuals**2).sum())
        expected += 2 * len(photo.points) - 11
    assert squares == pytest.approx(expected, rel=0.25)


def test_the_level_camera_projects_as_the_challenge_says() -> None:
    photo = ControlPhoto(CollinearityParams(aim="ahead", x=0.3, y=-1.0, z=0.2))
    point = photo.points[0]
    assert photo.true_pixels[0, 0] == pytest.approx(X0 + 1350 * (point[0] - 0.3) / (point[1] + 1.0))


def test_the_camera_follows_the_pointer_at_its_height() -> None:
    simulator = find_simulator("adjustment/collinearity")
    params = simulator.params()
    handle = next(h for h in simulator.scene(params).handles if h.name == "camera")
    moved = drag(params, handle, handle.at[0] - 12.0, handle.at[1] + 6.0)
    assert isinstance(moved, CollinearityParams)
    assert moved.z == CollinearityParams().z
    again = next(h for h in simulator.scene(moved).handles if h.name == "camera")
    np.testing.assert_allclose(again.at, [handle.at[0] - 12.0, handle.at[1] + 6.0], atol=1e-6)
