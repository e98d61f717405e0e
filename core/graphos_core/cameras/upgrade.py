"""From one camera model to another for a self-calibration: what has the same meaning keeps its value."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.cameras.model import camera_model
from graphos_core.data.cameras import Camera

BASE_SHARE = 0.4
"""Base length of the polynomials as a share of the larger side of the format, where nothing says another."""


def as_model(camera: Camera, name: str) -> Camera:
    """Return the camera with the model `name`; parameters of the same name keep their values, others start at zero.

    Raises
    ------
    UserError
        When there is no such model.
    """
    if camera.model == name:
        return camera
    old, new = camera_model(camera.model), camera_model(name)
    values = np.zeros(len(new.parameters))
    for i, parameter in enumerate(new.parameters):
        if parameter.name in old.names:
            values[i] = camera.values[old.index(parameter.name)]
        elif parameter.name == "base_px":
            values[i] = BASE_SHARE * max(camera.width, camera.height)
    return replace(camera, model=name, values=values, sigmas=None)
