"""Numbers for people: two digits of σ, thin spaces, true minus."""

import math

import numpy as np
import pytest

from graphos_core.number_format import THIN_SPACE, decimals_of_sigma, format_value


@pytest.mark.parametrize(
    ("value", "sigma", "unit", "expected"),
    [
        (2435.3812, 0.4567, "px", "2 435.38 ± 0.46 px"),
        (12.0, 0.0999, "m", "12.00 ± 0.10 m"),
        (12.0, 0.0996, "m", "12.00 ± 0.10 m"),
        (-3.14159, 0.012, "", "−3.142 ± 0.012"),
        (123456.7, 1234.0, "m", "123 500 ± 1 200 m"),
        (0.0, 0.5, "px", "0.00 ± 0.50 px"),
        (-0.0004, 0.5, "", "0.00 ± 0.50"),
        (4.58861e-3, 1.2e-6, "", "(4.5886 ± 0.0012) · 10⁻³"),
        (3.0e-9, 2.0e-10, "", "(3.00 ± 0.20) · 10⁻⁹"),
        (18708, None, "", "18 708"),
        (np.int32(18708), None, "", "18 708"),
        (1234567.0, None, "", "1 234 567"),
        (0.123456, None, "px", "0.1235 px"),
        (1.5e-7, None, "", "1.500 · 10⁻⁷"),
        (2.0e12, None, "", "2.000 · 10¹²"),
        (0.0, None, "m", "0 m"),
        (5.0, 0.0, "m", "5.000 m"),
        (5.0, math.nan, "m", "5.000 m"),
        (None, None, "m", "–"),
        (math.nan, 0.1, "m", "–"),
        (-math.inf, None, "", "−∞"),
    ],
)
def test_format_value(value: float | None, sigma: float | None, unit: str, expected: str) -> None:
    assert format_value(value, sigma, unit).replace(THIN_SPACE, " ") == expected


@pytest.mark.parametrize("exponent", range(-6, 5))
def test_sigma_always_shows_two_digits_and_the_value_ends_where_it_ends(exponent: int) -> None:
    for mantissa in (1.0, 1.04, 2.55, 9.4, 9.94, 9.97):
        sigma = mantissa * 10.0**exponent
        shown, error = format_value(1234.5678, sigma).replace(THIN_SPACE, "").split(" ± ")
        assert float(error) == pytest.approx(sigma, rel=0.06)
        if decimals_of_sigma(sigma) > 0:
            assert len(shown.split(".")[1]) == len(error.split(".")[1]) == decimals_of_sigma(sigma)
