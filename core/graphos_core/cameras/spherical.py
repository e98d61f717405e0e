r"""Spherical camera: the equirectangular panorama, f pixels per radian."""

from __future__ import annotations

from dataclasses import replace

from graphos_core.cameras.model import CameraModel
from graphos_core.cameras.sheet import INTERIOR, on_sensor
from graphos_core.text import Text

SEAM = Text(
    "A full panorama has the width 2π f: f follows from the stitching and is not a property of a lens."
)
TURN = Text("A shift of the panorama in x is a turn of the photo about its vertical axis.")
HORIZON = Text("Stitching puts the horizon into the middle of the picture.")

_F, _X0, _Y0 = INTERIOR

MODEL = CameraModel(
    name="spherical",
    label="Spherical (panorama)",
    parameters=(
        replace(_F, default="fixed", reason=SEAM),
        replace(_X0, default="fixed", reason=TURN),
        replace(_Y0, default="fixed", reason=HORIZON),
    ),
    direction="ideal → measured (nothing is distorted)",
    source="Fangi and Nardinocchi 2013, Photogrammetric processing of spherical panoramas, Photogrammetric Record 28",
    formula=r"x = x_0 + f\,\arctan\frac{X}{Z},\quad y = y_0 + f\,\arctan\frac{Y}{\sqrt{X^2 + Z^2}}",
    projection="spherical",
    equations=on_sensor,
    dependences=(SEAM, TURN),
)

MODELS = (MODEL,)
