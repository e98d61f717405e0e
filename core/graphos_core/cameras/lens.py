"""The kind of lens that is declared before anything is calibrated: which camera model photos start with."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from graphos_core.cameras.model import camera_model
from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.text import Text

Lens = Literal["perspective", "fisheye-equidistant", "fisheye-equisolid", "spherical"]

MODEL_OF_LENS: dict[str, str] = {
    "perspective": "basic",
    "fisheye-equidistant": "fisheye_equidistant",
    "fisheye-equisolid": "fisheye_equisolid",
    "spherical": "spherical",
}
"""Camera model of each lens."""

LENSES = tuple(MODEL_OF_LENS)

CIRCLE = {"fisheye_equidistant": math.pi / 2.0, "fisheye_equisolid": math.sqrt(2.0)}
"""Radius of the image circle of a field of 180°, in principal distances."""

FIELD = math.radians(185.0)
"""Field of view of a simulated fish-eye lens, from edge to edge of the image circle."""


def within_field(camera: Camera, directions: Array) -> Array:
    """Say which directions (…, 3) of the camera frame fall into the image circle of a fish-eye; all for others."""
    directions = np.asarray(directions)
    if camera.model not in CIRCLE:
        return np.ones(directions.shape[:-1], dtype=bool)
    with np.errstate(invalid="ignore"):
        return np.asarray(directions[..., 2] >= math.cos(FIELD / 2.0) * np.linalg.norm(directions, axis=-1))


def with_lens(camera: Camera, lens: str) -> Camera:
    """Return the camera with the model of a lens, undistorted, for an approximate start.

    A known principal distance is kept. An estimated one becomes that of a field of 180° whose image circle touches the
    longer sides of the photo, ``f = r / (π/2)`` or ``r / √2`` (equisolid-angle), for a panorama ``width / 2π``; it
    stays flagged as estimated. A camera that has the model already is left as it is.

    Parameters
    ----------
    camera : Camera
    lens : str
        One of `LENSES`.
    """
    model = camera_model(MODEL_OF_LENS[lens])
    if lens == "perspective" or camera.model == model.name:
        return camera
    focal, estimated, source = camera.focal_px, camera.focal_estimated, camera.focal_source
    if lens == "spherical":
        focal, estimated = camera.width / (2.0 * math.pi), False
        source = Text("width of the panorama over 2π")
    elif estimated:
        focal = 0.5 * min(camera.width, camera.height) / CIRCLE[model.name]
        source = Text("estimated: an image circle of 180° that touches the longer sides of the photo")
    values = np.zeros(len(model.parameters))
    values[:3] = focal, camera.values[1], camera.values[2]
    return replace(
        camera,
        model=model.name,
        values=values,
        sigmas=None,
        focal_estimated=estimated,
        focal_source=source,
    )
