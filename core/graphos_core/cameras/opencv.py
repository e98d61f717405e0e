r"""OpenCV's camera: rational radial distortion k1…k6, tangential p1, p2, thin prism s1…s4, with f_x = f (1 + b1)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from graphos_core.cameras.model import CameraModel, Parameter
from graphos_core.cameras.sheet import (
    AFFINITY,
    DECENTRING,
    DECENTRING_AND_PRINCIPAL_POINT,
    INTERIOR,
    RADIAL_FIXED_AGAINST_F,
    decentring,
    on_sensor,
    radial_parameters,
)
from graphos_core.text import Text


def equations(p: Any, u: Any, v: Any) -> tuple[Any, Any]:
    """Return the pixel of a projected position; OpenCV's p1 and p2 are Brown's p2 and p1."""
    r2 = u * u + v * v
    factor = (1 + r2 * (p.k1 + r2 * (p.k2 + r2 * p.k3))) / (1 + r2 * (p.k4 + r2 * (p.k5 + r2 * p.k6)))
    decentring_u, decentring_v = decentring(u, v, p.p2, p.p1)
    return on_sensor(
        p,
        u * factor + decentring_u + r2 * (p.s1 + r2 * p.s2),
        v * factor + decentring_v + r2 * (p.s3 + r2 * p.s4),
        p.b1,
    )


DENOMINATOR = Text(
    "Numerator and denominator of the rational factor do nearly the same: k4 to k6 only help lenses wider than 100°."
)
PRISM = Text(
    "s1 and s3 are quadratic like a tilt of the photo together with p1, p2: a thin prism is told from them by s2, s4 "
    "alone."
)

_P1, _P2 = DECENTRING
_K = radial_parameters(0.1, 0.05, 0.01, 0.05, 0.02, 0.005)

MODEL = CameraModel(
    name="opencv",
    label="OpenCV (rational, thin prism)",
    parameters=(
        *INTERIOR,
        *_K[:3],
        *(replace(k, default="fixed", prior_sigma=0.1, reason=DENOMINATOR, same_as="") for k in _K[3:]),
        replace(_P1, same_as="p2"),
        replace(_P2, same_as="p1"),
        *(
            Parameter(f"s{i}", f"s_{i}", Text("Thin prism {i}", i=i), "", "prism", 1e-4, "fixed", 1e-4, PRISM)
            for i in range(1, 5)
        ),
        AFFINITY[0],
    ),
    direction="ideal → measured",
    source="OpenCV, calib3d, projectPoints; Weng, Cohen and Herniou 1992 for the thin prism",
    formula=r"x = x_0 + f\,(1 + b_1)\,[u\,\frac{1 + k_1 r^2 + k_2 r^4 + k_3 r^6}{1 + k_4 r^2 + k_5 r^4 + k_6 r^6} "
    r"+ 2 p_1 u v + p_2 (r^2 + 2 u^2) + s_1 r^2 + s_2 r^4],\quad r^2 = u^2 + v^2",
    equations=equations,
    dependences=(
        RADIAL_FIXED_AGAINST_F,
        DENOMINATOR,
        DECENTRING_AND_PRINCIPAL_POINT,
        PRISM,
        Text("Affinity acts on x alone (f_x = f (1 + b1), f_y = f): the same scale in both axes is f."),
    ),
)

MODELS = (MODEL,)
