r"""The complete camera of Fraser: f, x0, y0, distortion centre x1, y1, k1…k3, p1, p2, b1, b2."""

from __future__ import annotations

from typing import Any

from graphos_core.cameras.model import CameraModel, Parameter
from graphos_core.cameras.sheet import (
    AFFINITY,
    AFFINITY_FIXED_AGAINST_F_AND_ROTATION,
    DECENTRING,
    DECENTRING_AND_PRINCIPAL_POINT,
    INTERIOR,
    RADIAL_FIXED_AGAINST_F,
    decentring,
    on_sensor,
    radial,
    radial_parameters,
)
from graphos_core.text import Text


def equations(p: Any, u: Any, v: Any) -> tuple[Any, Any]:
    """Return the pixel of an ideal position; distortion is about the distortion centre."""
    s, t = u - p.x1 / p.focal_px, v - p.y1 / p.focal_px
    radial_u, radial_v = radial(s, t, p.k1, p.k2, p.k3)
    decentring_u, decentring_v = decentring(s, t, p.p1, p.p2)
    return on_sensor(p, u + radial_u + decentring_u + p.b1 * u + p.b2 * v, v + radial_v + decentring_v)


TIED = Text(
    "A shift c of the distortion centre and decentring p = −k1 c / f are the same displacement as long as k1 alone "
    "is large: the centre is tied to the principal point, or carries a prior when it is freed."
)

MODEL = CameraModel(
    name="complete",
    label="Complete (Fraser)",
    parameters=(
        *INTERIOR,
        Parameter(
            "x1",
            "x_1",
            Text("Distortion centre x, from the principal point"),
            "px",
            "centre",
            5.0,
            "fixed",
            2.0,
            TIED,
        ),
        Parameter(
            "y1",
            "y_1",
            Text("Distortion centre y, from the principal point"),
            "px",
            "centre",
            5.0,
            "fixed",
            2.0,
            TIED,
        ),
        *radial_parameters(0.1, 0.05, 0.01),
        *DECENTRING,
        *AFFINITY,
    ),
    direction="ideal → measured",
    source="Fraser 1997, Digital camera self-calibration, ISPRS Journal 52, the ten-parameter model, applied to the ideal "
    "position in units of f",
    formula=r"x = x_0 + f\,[u + \bar u\,(k_1 r^2 + k_2 r^4 + k_3 r^6) + p_1 (r^2 + 2 \bar u^2) + 2 p_2 \bar u \bar v "
    r"+ b_1 u + b_2 v],\quad \bar u = u - \frac{x_1}{f},\quad \bar v = v - \frac{y_1}{f},\quad "
    r"r^2 = \bar u^2 + \bar v^2",
    equations=equations,
    dependences=(
        RADIAL_FIXED_AGAINST_F,
        TIED,
        DECENTRING_AND_PRINCIPAL_POINT,
        AFFINITY_FIXED_AGAINST_F_AND_ROTATION,
    ),
)

MODELS = (MODEL,)
