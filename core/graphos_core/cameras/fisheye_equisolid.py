r"""Fish-eye, equisolid-angle projection with additional polynomial: the equations of the equidistant one."""

from __future__ import annotations

from dataclasses import replace

from graphos_core.cameras import fisheye_equidistant

MODEL = replace(
    fisheye_equidistant.MODEL,
    name="fisheye_equisolid",
    label="Fish-eye, equisolid-angle",
    source="Schneider, Schwalbe and Maas 2009, Validation of geometric models for fisheye lenses",
    formula=r"x = x_0 + f\,u'\,(1 + b_1) + f\,b_2\,v',\quad u' = u\,(1 + k_1 r^2 + \dots + k_4 r^8) + "
    r"p_1 (r^2 + 2u^2) + 2 p_2 u v,\quad r = 2\,\sin\frac{\theta}{2}",
    projection="equisolid",
)

MODELS = (MODEL,)
