"""Numbers as people should read them: value ± σ and unit, two digits of the σ, thousands by a thin space."""

from __future__ import annotations

import math
from numbers import Integral

THIN_SPACE = "\u2009"
MINUS = "\u2212"
UNKNOWN = "–"
_EXPONENT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def format_value(value: float | None, sigma: float | None = None, unit: str = "", digits: int = 4) -> str:
    """Return a value with its standard deviation and unit, as `docs` and views show it.

    The standard deviation is rounded to two significant digits and the value to the same decimal place. Without
    a standard deviation the value has `digits` significant digits; whole numbers given as ``int`` are exact.

    Parameters
    ----------
    value : float or None
        None and NaN are shown as a dash.
    sigma : float or None
        Standard deviation in the unit of `value`; None, NaN or a value ≤ 0 where there is none.
    unit : str
        Appended after a thin space; ``"°"`` and ``"%"`` too. Empty for none.
    digits : int
        Significant digits where there is no sigma.

    Returns
    -------
    str

    Examples
    --------
    >>> format_value(2435.3812, 0.4567, "px").replace(THIN_SPACE, " ")
    '2 435.38 ± 0.46 px'
    >>> format_value(18708).replace(THIN_SPACE, " ")
    '18 708'
    >>> format_value(0.123456)
    '0.1235'
    """
    text = format_number(value, sigma, digits)
    if text != UNKNOWN and sigma is not None and math.isfinite(sigma) and sigma > 0:
        assert value is not None
        text = _with_sigma(float(value), float(sigma))
    return f"{text}{THIN_SPACE}{unit}" if unit and text != UNKNOWN else text


def format_number(value: float | None, sigma: float | None = None, digits: int = 4) -> str:
    """Return a value alone, rounded as its standard deviation demands, else to `digits` significant digits."""
    if value is None or math.isnan(value):
        return UNKNOWN
    if math.isinf(value):
        return f"{MINUS if value < 0 else ''}∞"
    if sigma is not None and math.isfinite(sigma) and sigma > 0:
        return group_thousands(_fixed(float(value), decimals_of_sigma(sigma)))
    if isinstance(value, Integral):
        return group_thousands(f"{int(value):d}")
    return _significant(float(value), digits)


def decimals_of_sigma(sigma: float) -> int:
    """Return the decimal places that show two significant digits of `sigma`; negative left of the point.

    >>> decimals_of_sigma(0.4567), decimals_of_sigma(0.0999), decimals_of_sigma(0.0994), decimals_of_sigma(1234.0)
    (2, 2, 3, -2)
    """
    return 1 - int(f"{sigma:.1e}".split("e")[1])


def group_thousands(text: str) -> str:
    """Put a thin space between groups of three digits before the decimal point and a true minus in front.

    Four digits stay together only where they are a decimal part: ``1234.5`` becomes ``1 234.5``.
    """
    sign, body = (MINUS, text[1:]) if text.startswith("-") else ("", text)
    whole, point, fraction = body.partition(".")
    if not any(c in "123456789" for c in body):
        sign = ""
    return f"{sign}{int(whole):,}".replace(",", THIN_SPACE) + point + fraction


def _with_sigma(value: float, sigma: float) -> str:
    decimals = decimals_of_sigma(sigma)
    exponent = math.floor(math.log10(max(abs(value), sigma)))
    if decimals > 6 and exponent < 0:  # a factor common to both keeps such numbers readable
        power = f"10{str(exponent).translate(_EXPONENT)}"
        scale = 10.0**-exponent
        inner = _with_sigma(value * scale, sigma * scale)
        return f"({inner}){THIN_SPACE}·{THIN_SPACE}{power}"
    shown = group_thousands(_fixed(value, decimals))
    return f"{shown} ± {group_thousands(_fixed(sigma, decimals))}"


def _fixed(value: float, decimals: int) -> str:
    return f"{round(value, decimals):.{max(decimals, 0)}f}"


def _significant(value: float, digits: int) -> str:
    if value == 0.0:
        return "0"
    exponent = int(f"{abs(value):.{digits - 1}e}".split("e")[1])
    if exponent < -4 or exponent >= 9:
        mantissa = f"{value:.{digits - 1}e}".split("e")[0]
        power = f"10{str(exponent).translate(_EXPONENT)}"
        return f"{group_thousands(mantissa)}{THIN_SPACE}·{THIN_SPACE}{power}"
    return group_thousands(f"{value:.{max(digits - 1 - exponent, 0)}f}")
