r"""Fish-eye, equisolid-angle projection with additional polynomial: the equations of the equidistant one."""

from __future__ import annotations

from dataclasses import replace

from graphos_core.cameras import brown, fisheye_equidistant

MODEL = replace(
    fisheye_equidistant.MODEL,
    name="fisheye_equisolid",
    label="Fish-eye, equisolid-angle",
    source="Schneider, Schwalbe and Maas 2009, Validation of geometric models for fisheye lenses, with Brown's "
    "additional terms",
    formula=r"r = 2\,\sin\frac{\theta}{2},\quad " + brown.MODEL.formula,
    projection="equisolid",
)

MODELS = (MODEL,)
