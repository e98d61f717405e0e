"""The way from an ideal, distortion-free picture to the photo: which camera it has, and where its pixels lie."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from graphos_core.cameras.chain import without_distortion
from graphos_core.cameras.model import camera_model, pixel_from_ray, ray_from_pixel
from graphos_core.data import Array, Camera
from graphos_core.text import Text

CHECK_EVERY = 8
"""Whether the distortion is one to one is checked in every so many pixels of both axes."""

CLOSED = 1e-6
"""Largest deviation of a ray that went to the photo and back, in units of the ray."""


def ideal_camera(camera: Camera) -> Camera:
    """Return the camera of undistorted photos: same format, principal distance and principal point, no distortion.

    Of central perspective it has the model ``basic``; a fisheye or spherical photo keeps its projection.
    """
    ideal = replace(
        without_distortion(camera), focal_estimated=False,
        focal_source=Text("undistorted photos of {label}", label=camera.label or camera.model),
    )  # fmt: skip
    if camera_model(camera.model).projection != "central":
        return ideal
    return replace(ideal, model="basic", values=np.array([*ideal.values[:3], 0.0, 0.0]))


def positions_in_photo(camera: Camera, ideal: Camera) -> Array:
    """Return where each pixel of the ideal picture lies in the photo.

    Parameters
    ----------
    camera, ideal : Camera
        Calibrated camera of the photo, and `ideal_camera` of it.

    Returns
    -------
    float32 (h, w, 2)
        px of the photo; NaN where it shows nothing, or where the distortion is not one to one.
    """
    w, h = ideal.width, ideal.height
    x, y = np.meshgrid(np.arange(w, dtype=np.float64), np.arange(h, dtype=np.float64))
    rays = ray_from_pixel(ideal, np.stack([x, y], axis=-1).reshape(-1, 2))
    source = pixel_from_ray(camera, rays).reshape(h, w, 2)
    with np.errstate(invalid="ignore"):
        good = ((source >= 0) & (source <= (camera.width - 1, camera.height - 1))).all(axis=-1)
    good &= _one_to_one(camera, rays.reshape(h, w, 3), source)
    source[~good] = np.nan
    return source.astype(np.float32)


def _one_to_one(camera: Camera, rays: Array, source: Array) -> Array:
    h, w = source.shape[:2]
    pixels = source[::CHECK_EVERY, ::CHECK_EVERY]
    back = ray_from_pixel(camera, pixels.reshape(-1, 2)).reshape(*pixels.shape[:2], 3)
    off = np.abs(back - rays[::CHECK_EVERY, ::CHECK_EVERY]).max(axis=-1)
    good = (np.nan_to_num(off, nan=1.0) < CLOSED).astype(np.uint8)
    return cv2.resize(good, (w, h), interpolation=cv2.INTER_NEAREST).astype(bool)
