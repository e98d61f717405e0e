"""Chains of camera models: a known distortion is taken away before the last model applies."""

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.cameras import (
    after_correction,
    as_measured,
    as_model,
    pixel_from_ray,
    pre_corrected,
    ray_from_pixel,
)
from graphos_core.cameras.conversion import format_grid
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.store import Store


def make(model, *values, before=()):
    return Camera(model=model, width=1600, height=1200, values=np.array(values), before=before)


LENS = make("radial", 1480.0, 801.0, 598.0, -0.12, 0.05, -0.01, 0.0, 0.0)
GLASS = make("brown_backward", 1490.0, 800.0, 600.0, 0.01, 0.0, 0.0, 1e-3, -1e-3, 0.0, 0.0)
CHAIN = make("basic", 1500.0, 805.0, 592.0, -0.01, 0.004, before=(LENS, GLASS))


def test_each_model_takes_away_its_distortion_and_keeps_its_interior():
    pixels = format_grid(CHAIN, (9, 7))
    step = ray_from_pixel(LENS, pixels)[:, :2] * 1480.0 + [801.0, 598.0]
    step = ray_from_pixel(GLASS, step)[:, :2] * 1490.0 + [800.0, 600.0]
    assert np.allclose(pre_corrected(CHAIN, pixels), step, rtol=0, atol=1e-9)
    rays = ray_from_pixel(replace(CHAIN, before=()), step)
    assert np.allclose(ray_from_pixel(CHAIN, pixels), rays, rtol=0, atol=1e-12)


def test_a_chain_is_undone_over_the_whole_format():
    pixels = format_grid(CHAIN)
    assert np.abs(as_measured(CHAIN, pre_corrected(CHAIN, pixels)) - pixels).max() < 1e-8
    assert np.abs(pixel_from_ray(CHAIN, ray_from_pixel(CHAIN, pixels)) - pixels).max() < 1e-8


def test_with_the_right_correction_nothing_is_left_for_the_last_model():
    pinhole = make("pinhole", 1480.0, 801.0, 598.0, before=(LENS,))
    pixels = format_grid(pinhole)
    assert np.allclose(ray_from_pixel(pinhole, pixels), ray_from_pixel(LENS, pixels), rtol=0, atol=1e-12)


def test_a_fisheye_is_corrected_on_its_own_projection():
    lens = make("fisheye_equisolid", 620.0, 801.0, 598.0, 0.03, -0.01, 0, 0, 1e-3, 0, 0, 0)
    chain = make("fisheye_equisolid", 620.0, 801.0, 598.0, *[0.0] * 8, before=(lens,))
    pixels = format_grid(chain)
    rays = ray_from_pixel(chain, pixels)
    assert rays[:, 2].min() < 0.0
    assert np.allclose(rays, ray_from_pixel(lens, pixels), rtol=0, atol=1e-12)


def test_a_camera_with_a_chain_is_stored_and_read(tmp_path):
    Store(tmp_path).save("adjustment", "k", (CHAIN,), {})
    (read,) = Store(tmp_path).load("adjustment", "k")
    assert [c.model for c in read.before] == ["radial", "brown_backward"]
    assert np.array_equal(read.before[0].values, LENS.values)


def test_a_camera_stored_before_there_were_chains_is_read(tmp_path):
    Store(tmp_path).save("adjustment", "k", (LENS,), {})
    file = tmp_path / "adjustment" / "k" / "result.json"
    text = file.read_text("utf-8")
    assert ', "before": {"tuple": []}' in text
    file.write_text(text.replace(', "before": {"tuple": []}', ""), "utf-8")
    (read,) = Store(tmp_path).load("adjustment", "k")
    assert read.before == ()


def test_a_known_calibration_becomes_the_correction_before_another_model():
    chain = after_correction(LENS, "complete")
    assert [c.model for c in chain.before] == ["radial"] and chain.model == "complete"
    pixels = format_grid(chain)
    assert np.allclose(ray_from_pixel(chain, pixels), ray_from_pixel(LENS, pixels), rtol=0, atol=1e-12)
    again = after_correction(chain, "polynomial3")
    assert [c.model for c in again.before] == ["radial", "complete"]
    assert np.allclose(ray_from_pixel(again, pixels), ray_from_pixel(LENS, pixels), rtol=0, atol=1e-11)
    with pytest.raises(UserError, match="projection"):
        after_correction(LENS, "fisheye_equisolid")


def test_changing_the_own_model_keeps_the_chain():
    changed = as_model(CHAIN, "complete")
    assert changed.before == CHAIN.before
    pixels = format_grid(CHAIN)
    assert np.allclose(ray_from_pixel(changed, pixels), ray_from_pixel(CHAIN, pixels), rtol=0, atol=1e-9)
