r"""Brown as photogrammetric programs use it: corrections are added to the measured position."""

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
    radial,
    radial_parameters,
)


def equations(p: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """Return the ideal position of a pixel: square pixels first, corrections about the principal point, shear."""
    s = (1 + p.b1) * (x - p.x0) / p.focal_px
    t = (y - p.y0) / p.focal_px
    radial_u, radial_v = radial(s, t, p.k1, p.k2, p.k3)
    decentring_u, decentring_v = decentring(s, t, p.p1, p.p2)
    v = t + radial_v + decentring_v
    return s + radial_u + decentring_u + p.b2 * v, v


MODEL = CameraModel(
    name="brown_backward",
    label="Brown, corrections of the measured position",
    parameters=(*INTERIOR, *radial_parameters(0.1, 0.05, 0.01), *DECENTRING, *AFFINITY),
    direction="measured → ideal",
    source="Brown 1971, Close-range camera calibration; the pixel scaled by 1 + b1 in x before the "
    "corrections and sheared by b2 after them: Börlin, Murtiyoso and Grussenmeyer 2019, Flexible photogrammetric "
    "computations using modular bundle adjustment, model 3 (there y points up: the signs of P2 and of the skew change)",
    formula=r"\frac{X}{Z} = s + s\,(k_1 r^2 + k_2 r^4 + k_3 r^6) + p_1 (r^2 + 2 s^2) + 2 p_2 s t + b_2 \frac{Y}{Z},\quad "
    r"s = (1 + b_1)\,\frac{x - x_0}{f},\quad t = \frac{y - y_0}{f},\quad r^2 = s^2 + t^2",
    equations=equations,
    backward=True,
    dependences=(
        RADIAL_FIXED_AGAINST_F,
        DECENTRING_AND_PRINCIPAL_POINT,
        AFFINITY_FIXED_AGAINST_F_AND_ROTATION,
    ),
)

MODELS = (MODEL,)
