r"""Fish-eye, equidistant projection with additional polynomial: f, x0, y0, k1…k4, p1, p2, b1, b2."""

from __future__ import annotations

from typing import Any

from graphos_core.cameras.model import CameraModel
from graphos_core.cameras.sheet import (
    AFFINITY,
    AFFINITY_FIXED_AGAINST_F_AND_ROTATION,
    DECENTRING,
    DECENTRING_AND_PRINCIPAL_POINT,
    INTERIOR,
    RADIAL_FIXED_AGAINST_F,
    decentring,
    fixed,
    on_sensor,
    radial,
    radial_parameters,
)


def equations(p: Any, u: Any, v: Any) -> tuple[Any, Any]:
    """Return the pixel of a projected position: radial and decentring distortion, then the sensor."""
    radial_u, radial_v = radial(u, v, p.k1, p.k2, p.k3, p.k4)
    decentring_u, decentring_v = decentring(u, v, p.p1, p.p2)
    return on_sensor(p, u + radial_u + decentring_u, v + radial_v + decentring_v, p.b1, p.b2)


MODEL = CameraModel(
    name="fisheye_equidistant",
    label="Fish-eye, equidistant",
    parameters=(
        *INTERIOR,
        *radial_parameters(0.03, 0.005, 0.001, 2e-4),
        *fixed(*DECENTRING),
        *AFFINITY,
    ),
    direction="ideal → measured",
    source="Schneider, Schwalbe and Maas 2009, Validation of geometric models for fisheye lenses; radial polynomial "
    "in θ as Kannala and Brandt 2006",
    formula=r"x = x_0 + f\,u'\,(1 + b_1) + f\,b_2\,v',\quad u' = u\,(1 + k_1 r^2 + \dots + k_4 r^8) + "
    r"p_1 (r^2 + 2u^2) + 2 p_2 u v,\quad r = \theta",
    projection="equidistant",
    equations=equations,
    dependences=(
        RADIAL_FIXED_AGAINST_F,
        DECENTRING_AND_PRINCIPAL_POINT,
        AFFINITY_FIXED_AGAINST_F_AND_ROTATION,
    ),
)

MODELS = (MODEL,)
