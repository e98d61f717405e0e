"""Scale space: blurs that add up, octaves that fit together, a cut layer that is the layer of the whole."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from graphos_core.features.detectors.scale_space import (
    blur_steps,
    cut_layer,
    first_image,
    layer_of,
    scale_space,
)


def test_layers_are_the_photo_blurred_once() -> None:
    """Independent: one SciPy blur from the photo, whose own blur is 0.5 px."""
    point = np.zeros((128, 128), np.float32)
    point[64, 64] = 1000.0
    point = gaussian_filter(point, 0.5)
    space = scale_space(point, layers=3, sigma=1.6, octaves=3)
    for octave in (1, 2):  # pixels of 1 and 2 px of the photo
        for layer in range(6):
            sigma = np.sqrt(space.blur(octave, layer) ** 2 - 0.5**2)
            once = gaussian_filter(point, sigma, truncate=6.0)[:: 2 ** (octave - 1), :: 2 ** (octave - 1)]
            got = space.gaussians[octave][layer]
            assert np.abs(got - once).max() < 0.05 * once.max()


def test_a_pixel_of_an_octave_lies_where_the_convention_says() -> None:
    ramp = np.tile(np.arange(96, dtype=np.float32), (96, 1))
    space = scale_space(ramp, octaves=3)
    for octave in range(3):
        row = space.gaussians[octave][0][20]
        columns = np.arange(len(row) // 3, len(row) // 2)
        np.testing.assert_allclose(row[columns], columns * space.pixel(octave), atol=0.05)


def test_blurs_add_up_to_the_double_after_an_octave() -> None:
    for layers in (1, 3, 5):
        assert 1.6**2 + np.sum(np.square(blur_steps(layers, 1.6, layers))) == pytest.approx(3.2**2)


def test_differences_are_those_of_neighbours() -> None:
    grey = np.random.default_rng(0).integers(0, 255, (60, 70)).astype(np.uint8)
    space = scale_space(grey, layers=2)
    assert space.gaussians[0].shape == (5, 120, 140)
    assert space.differences[0].shape == (4, 120, 140)
    np.testing.assert_array_equal(space.differences[1][2], space.gaussians[1][3] - space.gaussians[1][2])
    assert 2 <= min(space.gaussians[-1].shape[1:]) <= 7


@pytest.mark.parametrize(("octave", "layer"), [(0, 0), (0, 2), (1, 3), (2, 1)])
def test_a_cut_layer_is_part_of_the_whole(octave: int, layer: int) -> None:
    grey = np.random.default_rng(1).integers(0, 255, (203, 311)).astype(np.uint8)
    whole = scale_space(grey, octaves=3).gaussians[octave][layer]
    pixel = 0.5 * 2.0**octave
    for place in ((150.0, 100.0), (2.0, 3.0), (309.5, 201.0)):
        part, at = cut_layer(grey, place, 8.0, octave, layer)
        left, top = round(place[0] / pixel - at[0]), round(place[1] / pixel - at[1])
        for dx, dy in ((0, 0), (3, -2), (-4, 4)):
            column, row = round(place[0] / pixel) + dx, round(place[1] / pixel) + dy
            if 0 <= row < whole.shape[0] and 0 <= column < whole.shape[1]:
                assert part[row - top, column - left] == pytest.approx(whole[row, column], abs=1e-3)


def test_the_layer_of_a_blur_is_the_one_with_that_blur() -> None:
    space = scale_space(np.zeros((64, 64), np.uint8), layers=4, sigma=1.8, octaves=3)
    for octave in range(3):
        for layer in range(1, 5):
            assert layer_of(space.blur(octave, layer + 0.4), layers=4, sigma=1.8) == (octave, layer)
    assert layer_of(0.01) == (0, 0)


def test_the_enlarged_photo_keeps_its_mean_and_size() -> None:
    large = first_image(np.full((5, 7), 130, np.uint8), 1.6)
    assert large.shape == (10, 14)
    np.testing.assert_allclose(large, 130.0, atol=1e-3)
