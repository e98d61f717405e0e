r"""Radial polynomial: f, x0, y0 and k1…k5."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from graphos_core.cameras.model import CameraModel
from graphos_core.cameras.sheet import INTERIOR, RADIAL_FIXED_AGAINST_F, on_sensor, radial, radial_parameters
from graphos_core.text import Text


def equations(p: Any, u: Any, v: Any) -> tuple[Any, Any]:
    """Return the pixel of a projected position."""
    radial_u, radial_v = radial(u, v, p.k1, p.k2, p.k3, p.k4, p.k5)
    return on_sensor(p, u + radial_u, v + radial_v)


_RADIAL = radial_parameters(0.1, 0.05, 0.01, 0.002, 4e-4)

MODEL = CameraModel(
    name="radial",
    label="Radial polynomial",
    parameters=(
        *INTERIOR,
        *_RADIAL[:3],
        *(
            replace(
                k,
                default="fixed",
                prior_sigma=5.0 * k.usual,
                reason=Text(
                    "Neighbouring coefficients are strongly correlated; free it for strong wide-angle "
                    "lenses whose residuals still show rings."
                ),
            )
            for k in _RADIAL[3:]
        ),
    ),
    direction="ideal → measured",
    source="Brown 1971, Close-range camera calibration, radial terms, in units of f",
    formula=r"x = x_0 + f\,u\,(1 + k_1 r^2 + k_2 r^4 + \dots + k_5 r^{10}),\quad r^2 = u^2 + v^2",
    equations=equations,
    dependences=(RADIAL_FIXED_AGAINST_F,),
)

MODELS = (MODEL,)
