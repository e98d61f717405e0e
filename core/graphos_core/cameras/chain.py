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


def without_distortion(camera: Camera) -> Camera:
    """Return the camera with every term set to 0 but the interior and the constants of the formula."""
    values = [
        value if parameter.group == "interior" or parameter.default == "constant" else 0.0
        for parameter, value in zip(camera_model(camera.model).parameters, camera.values, strict=True)
    ]
    return replace(camera, values=np.array(values), sigmas=None, before=())


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
