"""Any camera in any other model: exact where the other can express it, else the smallest residual."""

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.cameras import as_model, camera_model, convert, pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.errors import UserError

EXACT = [
    ("pinhole", "polynomial3"),
    ("basic", "radial"),
    ("basic", "complete"),
    ("basic", "opencv"),
    ("basic", "polynomial5"),
    ("radial", "opencv"),
    ("polynomial3", "polynomial4"),
]


def camera(name, **given):
    values = {"focal_px": 1500.0, "x0": 805.0, "y0": 592.0} | given
    names = camera_model(name).names
    return Camera(model=name, width=1600, height=1200, values=np.array([values.get(n, 0.0) for n in names]))


@pytest.mark.parametrize(("source", "target"), EXACT)
def test_conversion_is_exact_where_the_other_model_can_express_it(source, target, typical):
    original = typical(source)
    if source == "radial":  # k4, k5 of r⁸ and r¹⁰ have no counterpart in OpenCV's numerator
        original = replace(original, values=original.values * [1, 1, 1, 1, 1, 1, 0, 0])
    found = convert(original, target)
    assert found.exact and found.max_px <= 1e-6
    rays = ray_from_pixel(original, found.pixels)
    assert np.abs(pixel_from_ray(found.camera, rays) - found.pixels).max() <= 1e-6


def test_decentring_keeps_its_meaning_under_its_other_name():
    brown = camera("brown", k1=-0.1, k2=0.03, p1=1e-3, p2=-4e-4, b1=1e-3)
    opencv = convert(brown, "opencv")
    assert opencv.exact
    values = dict(zip(camera_model("opencv").names, opencv.camera.values, strict=True))
    assert (values["p1"], values["p2"], values["k4"]) == (-4e-4, 1e-3, 0.0)


def test_a_change_of_direction_is_fitted_and_its_residual_is_true():
    forward = camera("basic", k1=-0.15, k2=0.06)
    found = convert(forward, "brown_backward")
    signs = camera("brown_backward", k1=0.15, k2=-0.06)
    first_order = pixel_from_ray(signs, ray_from_pixel(forward, found.pixels)) - found.pixels
    assert 1e-6 < found.max_px < 0.05 < np.abs(first_order).max()
    truth = pixel_from_ray(found.camera, ray_from_pixel(forward, found.pixels)) - found.pixels
    assert np.array_equal(truth, found.residuals)
    assert found.rms_px == pytest.approx(np.sqrt(np.mean(truth**2)))
    back = convert(found.camera, "basic")
    assert np.allclose(back.camera.values[:3], forward.values[:3], atol=0.05)


def test_the_fit_is_the_minimum():
    found = convert(camera("brown", k1=-0.1, p1=1e-3, b1=1e-3), "basic")
    rays = ray_from_pixel(camera("brown", k1=-0.1, p1=1e-3, b1=1e-3), found.pixels)
    for k, step in enumerate([0.01, 0.01, 0.01, 1e-5, 1e-5]):
        for sign in (-1.0, 1.0):
            values = found.camera.values + sign * step * np.eye(5)[k]
            moved = pixel_from_ray(replace(found.camera, values=values), rays) - found.pixels
            assert np.sqrt(np.mean(moved**2)) > found.rms_px


def test_fisheyes_convert_into_each_other_beyond_180_degrees(typical):
    found = convert(typical("fisheye_equisolid", strong=True), "fisheye_equidistant")
    assert found.covered == 1.0 and found.max_px < 1.0
    partly = convert(typical("fisheye_equisolid", strong=True), "brown")
    assert 0.1 < partly.covered < 1.0
    assert np.isnan(partly.residuals).any(axis=1).mean() == pytest.approx(1.0 - partly.covered)


def test_standard_deviations_survive_only_an_exact_change():
    basic = replace(camera("basic", k1=-0.1, k2=0.02), sigmas=np.array([1.0, 0.5, 0.4, 1e-3, 2e-3]))
    assert np.allclose(as_model(basic, "complete").sigmas[[0, 1, 2, 5, 6]], basic.sigmas)
    assert as_model(basic, "pinhole").sigmas is None
    assert as_model(basic, "basic") is basic


def test_without_a_format_only_what_is_carried_over_exactly_is_converted():
    bal = Camera(model="basic", width=0, height=0, values=np.array([500.0, 0.0, 0.0, -0.1, 0.01]))
    assert as_model(bal, "brown").values[:5].tolist() == bal.values.tolist()
    with pytest.raises(UserError, match="format"):
        as_model(bal, "fisheye_equisolid")


def test_chosen_parameters_alone_are_fitted():
    found = convert(camera("radial", k1=-0.1, k2=0.02, k3=0.01), "basic", free=("k1", "k2"))
    assert found.camera.values[:3].tolist() == [1500.0, 805.0, 592.0]
    assert found.rms_px > convert(camera("radial", k1=-0.1, k2=0.02, k3=0.01), "basic").rms_px
