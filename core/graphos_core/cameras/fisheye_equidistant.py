r"""Fish-eye, equidistant projection with additional polynomial: f, x0, y0, k1…k4, p1, p2, b1, b2."""

from __future__ import annotations

from dataclasses import replace

from graphos_core.cameras import brown
from graphos_core.cameras.sheet import AFFINITY, DECENTRING, INTERIOR, fixed, radial_parameters
from graphos_core.text import Text

CENTRED = Text(
    "Small for a well centred lens; free it when residuals lean to one side and photos are rolled by 90°."
)

MODEL = replace(
    brown.MODEL,
    name="fisheye_equidistant",
    label="Fish-eye, equidistant",
    parameters=(
        *INTERIOR,
        *radial_parameters(0.03, 0.005, 0.001, 2e-4),
        *fixed(CENTRED, *DECENTRING),
        *AFFINITY,
    ),
    source="Schneider, Schwalbe and Maas 2009, Validation of geometric models for fisheye lenses, with Brown's "
    "additional terms; without p and b the polynomial in θ of Kannala and Brandt 2006",
    formula=r"r = \theta,\quad " + brown.MODEL.formula,
    projection="equidistant",
)

MODELS = (MODEL,)
