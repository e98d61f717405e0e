r"""Brown: radial k1…k4, decentring p1, p2, and a sensor with affinity b1 and shear b2."""

from __future__ import annotations

from dataclasses import replace
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
    on_sensor,
    radial,
    radial_parameters,
)
from graphos_core.text import Text


def equations(p: Any, u: Any, v: Any) -> tuple[Any, Any]:
    """Return the pixel of a projected position: radial and decentring distortion, then the sensor."""
    radial_u, radial_v = radial(u, v, p.k1, p.k2, p.k3, p.k4)
    decentring_u, decentring_v = decentring(u, v, p.p1, p.p2)
    return on_sensor(p, u + radial_u + decentring_u, v + radial_v + decentring_v, p.b1, p.b2)


_RADIAL = radial_parameters(0.1, 0.05, 0.01, 0.002)

MODEL = CameraModel(
    name="brown",
    label="Brown",
    parameters=(
        *INTERIOR,
        *_RADIAL[:3],
        replace(
            _RADIAL[3],
            default="fixed",
            prior_sigma=0.01,
            reason=Text("k1 to k3 describe nearly every lens; k4 is strongly correlated with them."),
        ),
        *DECENTRING,
        *AFFINITY,
    ),
    direction="ideal → measured",
    source="Brown 1971, Close-range camera calibration, radial and decentring terms, applied to the ideal position in units of "
    "f; affinity and shear of the sensor act on the distorted position",
    formula=r"x = x_0 + f\,(1 + b_1)\,u' + f\,b_2\,v',\quad y = y_0 + f\,v',\quad "
    r"u' = u\,(1 + k_1 r^2 + \dots + k_4 r^8) + p_1 (r^2 + 2u^2) + 2 p_2 u v,\quad "
    r"v' = v\,(1 + k_1 r^2 + \dots + k_4 r^8) + p_2 (r^2 + 2v^2) + 2 p_1 u v",
    equations=equations,
    dependences=(
        RADIAL_FIXED_AGAINST_F,
        DECENTRING_AND_PRINCIPAL_POINT,
        AFFINITY_FIXED_AGAINST_F_AND_ROTATION,
    ),
)

MODELS = (MODEL,)
