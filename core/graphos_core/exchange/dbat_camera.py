"""Camera files of the Damped Bundle Adjustment Toolbox (XML, ``dbat_camera_version``)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from graphos_core.data import Array
from graphos_core.exchange.dbat_script import camera_of_element
from graphos_core.exchange.formulas import ForeignCamera, Format, Formula, register
from graphos_core.exchange.formulas_other import backward_directions, pitch_of
from graphos_core.exchange.text_files import not_such, parse_xml

PARAMETERS = ("cc", "px", "py", "as", "sk", "K1", "K2", "K3", "P1", "P2")


def _function(values: Array, frame: Format, pixels: Array) -> Array:
    """Model 3: affinity before the distortion, y up in it; model 1 is the same without affinity."""
    c, px, py, b1, b2, k1, k2, k3, p1, p2 = values
    mm = (pixels + 0.5) * pitch_of(frame)
    x, y = mm[:, 0] - px, py - mm[:, 1]
    return backward_directions(
        (1 + b1) * x + b2 * y, y, c, np.array([k1, k2, k3]), np.array([p1, p2]), np.zeros(2)
    )


def _start(focal: float, principal: Array, frame: Format) -> Array:
    pitch = pitch_of(frame)
    return np.array([focal * pitch, *((np.asarray(principal) + 0.5) * pitch), *[0.0] * 7])


register(
    Formula("dbat", PARAMETERS, "measured → ideal", _function, _start, needs_pitch=True, constants=("sk",))
)


def read_dbat_camera(path: Path) -> ForeignCamera:
    """Read the first camera of a file.

    Raises
    ------
    UserError
        When it cannot be read.
    """
    root = parse_xml(path, "a camera of DBAT")
    element = root.find(".//camera")
    if element is None:
        raise not_such(path, "a camera of DBAT", "It has no <camera>.")
    try:
        c = camera_of_element(element, "loaded")
    except (ValueError, AttributeError) as problem:
        raise not_such(path, "a camera of DBAT", str(problem)) from problem
    values = np.array([c.constant_mm, *c.principal_mm, c.aspect, c.skew, *c.k, *c.p])
    return ForeignCamera("dbat", values, Format(c.width, c.height, c.pitch_mm), c.name)
