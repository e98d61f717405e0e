"""Colour maps: ends, middle, missing values, even lightness."""

import cv2
import numpy as np
import pytest
from numpy.testing import assert_array_equal

from graphos_core.rendering import colour_table, colours_of_values


def lightness(name: str) -> np.ndarray:
    rgb = colour_table(name)[None].astype(np.float32) / 255
    return cv2.cvtColor(rgb, cv2.COLOR_RGB2Lab)[0, :, 0]


@pytest.mark.parametrize("name", ["viridis", "cividis", "bright viridis"])
def test_sequential_maps_get_steadily_lighter(name: str) -> None:
    values = lightness(name)
    assert (np.diff(values[::8]) > 0).all()


def test_the_diverging_map_is_white_at_zero_and_equally_dark_at_both_ends() -> None:
    values = lightness("diverging")
    assert values[127] > 94
    assert abs(values[0] - values[255]) < 3
    low, middle, high = colours_of_values(np.array([-2.0, 0.0, 2.0]), -2, 2, "diverging").astype(int)
    assert low[2] > low[0] + 60
    assert high[0] > high[2] + 60
    assert np.ptp(middle) < 8


def test_values_beyond_the_ends_get_the_end_and_missing_ones_grey() -> None:
    colours = colours_of_values(np.array([-9.0, 0.0, 1.0, 9.0, np.nan]), 0.0, 1.0, missing=(1, 2, 3))
    assert_array_equal(colours[0], colours[1])
    assert_array_equal(colours[2], colours[3])
    assert_array_equal(colours[1], colour_table("viridis")[0])
    assert_array_equal(colours[3], colour_table("viridis")[255])
    assert_array_equal(colours[4], [1, 2, 3])


def test_an_unknown_map_is_refused() -> None:
    with pytest.raises(ValueError, match="jet"):
        colour_table("jet")
