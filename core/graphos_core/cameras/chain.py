"""Chains of camera models: fixed pre-corrections, then the model that is estimated.

A known distortion (a laboratory calibration, a profile of the lens) is taken away first; the last model describes
what is left of it. A pre-correction maps a measured pixel to where its camera would have imaged the ray without
distortion: same projection, principal distance and principal point, all other terms 0. So the chain changes positions
by a few pixels and the last model keeps its meaning.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.cameras.model import camera_model, last_pixel_from_ray, last_ray_from_pixel
from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.text import Text


def without_distortion(camera: Camera) -> Camera:
    """Return the camera with every term set to 0 but the interior and the constants of the formula."""
    values = [
        value if parameter.group == "interior" or parameter.default == "constant" else 0.0
        for parameter, value in zip(camera_model(camera.model).parameters, camera.values, strict=True)
    ]
    return replace(camera, values=np.array(values), sigmas=None, before=())


def after_correction(camera: Camera, name: str) -> Camera:
    """Return a camera whose last model describes what `camera`, held fixed as a pre-correction, leaves.

    Parameters
    ----------
    camera : Camera
        A known calibration; its own chain comes first.
    name : str
        The last model; it starts with the interior of `camera` and no distortion.

    Raises
    ------
    UserError
        When the two models belong to different projections, so that one cannot follow the other.
    """
    first, last = camera_model(camera.model), camera_model(name)
    if first.projection != last.projection:
        raise UserError(
            Text("{last} cannot follow a correction by {first}.", last=last.label, first=first.label),
            "The correction leaves a picture of its own projection, which the other model does not have.",
            "Choose a model of the same projection.",
        )
    values = [
        0.5 * max(camera.width, camera.height) if p.default == "constant" else 0.0 for p in last.parameters
    ]
    values[:3] = camera.values[:3]
    return replace(
        camera, model=name, values=np.array(values), sigmas=None,
        before=(*camera.before, replace(camera, before=(), sigmas=None)),
    )  # fmt: skip


def pre_corrected(camera: Camera, pixels: Array) -> Array:
    """Return the pixels to which the camera's own model applies, from measured ones.

    Parameters
    ----------
    camera : Camera
    pixels : float64 (n, 2)
        Measured.

    Returns
    -------
    float64 (n, 2)
        The same pixels where `Camera.before` is empty; NaN where a pre-correction has no ray.
    """
    for earlier in camera.before:
        pixels = last_pixel_from_ray(without_distortion(earlier), last_ray_from_pixel(earlier, pixels))
    return pixels


def as_measured(camera: Camera, pixels: Array) -> Array:
    """Return the measured pixels from those to which the camera's own model applies: undoes `pre_corrected`.

    Parameters
    ----------
    camera : Camera
    pixels : float64 (n, 2)

    Returns
    -------
    float64 (n, 2)
    """
    for earlier in reversed(camera.before):
        pixels = last_pixel_from_ray(earlier, last_ray_from_pixel(without_distortion(earlier), pixels))
    return pixels
