"""Every camera model: analytic derivatives are the numerical ones, and distortion can be undone over the format."""

import numpy as np
import pytest

from graphos_core.cameras import camera_model, camera_models, pixel_from_ray, ray_from_pixel
from graphos_core.cameras.kernels import MAX_VALUES, project
from graphos_core.data import Camera
from graphos_core.errors import UserError

TYPICAL = {"pinhole": [1500.0, 805.0, 592.0], "basic": [1500.0, 805.0, 592.0, -0.15, 0.06]}
STRONG = {"pinhole": [400.0, 805.0, 592.0], "basic": [900.0, 805.0, 592.0, -0.10, 0.015]}


def camera_of(name, values):
    return Camera(model=name, width=1600, height=1200, values=np.array(values))


def projected(code, values, point):
    pixel, slope, inner = np.empty(2), np.empty((2, 3)), np.empty((2, MAX_VALUES))
    assert project(code, values, *point, pixel, slope, inner)
    return pixel, slope, inner[:, : len(values)]


def test_every_model_has_test_values():
    assert set(TYPICAL) == set(STRONG) == set(camera_models())


@pytest.mark.parametrize("name", sorted(camera_models()))
def test_analytic_derivatives_are_the_numerical_ones(name):
    code, values = camera_model(name).code, np.array(TYPICAL[name])
    rng = np.random.default_rng(0)
    for point in rng.uniform([-0.5, -0.4, 0.8], [0.5, 0.4, 2.0], (20, 3)):
        _, slope, inner = projected(code, values, point)
        for k in range(3):
            h = 1e-6 * np.eye(3)[k]
            numeric = (projected(code, values, point + h)[0] - projected(code, values, point - h)[0]) / 2e-6
            assert np.allclose(slope[:, k], numeric, rtol=1e-7, atol=1e-5)
        for k in range(len(values)):
            h = 1e-5 * max(1.0, abs(values[k])) * np.eye(len(values))[k]
            numeric = projected(code, values + h, point)[0] - projected(code, values - h, point)[0]
            assert np.allclose(inner[:, k], numeric / (2 * h[k]), rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize("name", sorted(camera_models()))
@pytest.mark.parametrize("sheet", [TYPICAL, STRONG])
def test_distortion_is_undone_over_the_whole_format(name, sheet):
    camera = camera_of(name, sheet[name])
    x, y = np.meshgrid(np.linspace(-0.5, 1599.5, 41), np.linspace(-0.5, 1199.5, 31))
    pixels = np.stack([x.ravel(), y.ravel()], axis=1)
    assert np.abs(pixel_from_ray(camera, 3.7 * ray_from_pixel(camera, pixels)) - pixels).max() < 1e-8


@pytest.mark.parametrize("name", sorted(camera_models()))
def test_a_point_behind_the_camera_has_no_image(name):
    camera = camera_of(name, TYPICAL[name])
    pixels = pixel_from_ray(camera, np.array([[0.1, 0.1, -1.0], [0.1, 0.1, 0.0], [0.1, 0.1, 1.0]]))
    assert np.isnan(pixels[:2]).all()
    assert np.isfinite(pixels[2]).all()


def test_a_pixel_beyond_the_fold_of_the_distortion_has_no_ray():
    camera = camera_of("basic", [1000.0, 800.0, 600.0, -0.5, 0.0])  # r (1 − r²/2) never exceeds 0.544
    assert np.isnan(ray_from_pixel(camera, np.array([[800.0 + 600.0, 600.0]]))).all()
    assert np.isfinite(ray_from_pixel(camera, np.array([[800.0 + 500.0, 600.0]]))).all()


def test_the_principal_distance_comes_first_and_axes_point_right_and_down():
    for name, model in camera_models().items():
        assert model.names[0] == "focal_px"
        camera = camera_of(name, TYPICAL[name])
        centre, right, down = pixel_from_ray(camera, np.array([[0, 0, 1.0], [0.01, 0, 1], [0, 0.01, 1]]))
        assert np.allclose(centre, [805.0, 592.0])
        assert right[0] > centre[0] and right[1] == pytest.approx(centre[1])
        assert down[1] > centre[1] and down[0] == pytest.approx(centre[0])


def test_an_unknown_model_is_refused_with_the_known_ones():
    with pytest.raises(UserError, match="pinhole"):
        camera_model("pinhol")
