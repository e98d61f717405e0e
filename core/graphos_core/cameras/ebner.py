r"""Ebner's twelve parameters, orthogonal on the 3 × 3 grid of an aerial photo."""

from __future__ import annotations

from typing import Any

from graphos_core.cameras.model import CameraModel, Parameter
from graphos_core.cameras.sheet import INTERIOR, on_sensor
from graphos_core.text import Text

BASE = Parameter(
    "base_px", "b", Text("Base length"), "px", "base", 800.0, "constant",
    reason=Text("The distance of the 3 × 3 points on which the terms are orthogonal; about half the format."),
)  # fmt: skip

LEFT_OUT = (
    Text(
        "Of the linear terms only affinity e1 and shear e2 are there: a scale is f, a turn is kappa; constants are x0, y0."
    ),
    Text(
        "Of the six quadratic terms the two that a tilt makes (x² with xy in y, xy with y² in x) are left out: what is "
        "left, e3 to e6, is orthogonal to them."
    ),
)


def coefficient(name: str, label: str) -> Parameter:
    """Return the sheet of one coefficient in px: its displacement at the distance of the base length."""
    letter, index = name[0], name[1:]
    return Parameter(name, f"{letter}_{{{index}}}", label, "px", "polynomial", 2.0)


def equations(p: Any, u: Any, v: Any) -> tuple[Any, Any]:
    """Return the pixel of an ideal position."""
    x, y = u * p.focal_px / p.base_px, v * p.focal_px / p.base_px
    xx, yy = x * x - 2 / 3, y * y - 2 / 3
    dx = p.e1 * x + p.e2 * y - 2 * p.e3 * xx + p.e4 * x * y + p.e5 * yy
    dy = -p.e1 * y + p.e2 * x + p.e3 * x * y - 2 * p.e4 * yy + p.e6 * xx
    dx += p.e7 * x * yy + p.e9 * y * xx + p.e11 * xx * yy
    dy += p.e8 * y * xx + p.e10 * x * yy + p.e12 * xx * yy
    ideal_x, ideal_y = on_sensor(p, u, v)
    return ideal_x + dx, ideal_y + dy


MODEL = CameraModel(
    name="ebner",
    label="Ebner (12)",
    parameters=(*INTERIOR, BASE, *(coefficient(f"e{i}", Text("Ebner {i}", i=i)) for i in range(1, 13))),
    direction="ideal → measured",
    source="Ebner 1976, Self calibrating block adjustment, Bildmessung und Luftbildwesen 44",
    formula=r"x = x_0 + f\,u + e_1 \xi + e_2 \eta - 2 e_3 \xi_2 + e_4 \xi \eta + e_5 \eta_2 + e_7 \xi \eta_2 "
    r"+ e_9 \eta \xi_2 + e_{11} \xi_2 \eta_2,\quad y = y_0 + f\,v - e_1 \eta + e_2 \xi + e_3 \xi \eta - 2 e_4 \eta_2 "
    r"+ e_6 \xi_2 + e_8 \eta \xi_2 + e_{10} \xi \eta_2 + e_{12} \xi_2 \eta_2,\quad \xi = \frac{f u}{b},\quad "
    r"\xi_2 = \xi^2 - \frac{2}{3}",
    equations=equations,
    dependences=(
        *LEFT_OUT,
        Text(
            "Made for vertical photos of flat ground, where f, x0 and y0 cannot be told from the position: hold them fixed "
            "there."
        ),
    ),
)

MODELS = (MODEL,)
