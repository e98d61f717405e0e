"""A plane that carries a photo, and what a camera sees of it: by the camera model's own rays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Self

import cv2
import numpy as np

from graphos_core.cameras import ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.simulated_photo import simulated_photo

BESIDE = (128, 134, 142)
"""Colour where the camera does not see the plane, RGB."""
LARGEST = 640
"""Longer side of a project's photo in a simulator, px."""


@dataclass(frozen=True, eq=False)
class Plane:
    """A rectangle in space.

    Attributes
    ----------
    corner : float64 (3,)
        Outer corner of the picture's first pixel, object frame.
    right, down : float64 (3,)
        From there along the picture's first row and first column, over its whole width and height.
    """

    corner: Array
    right: Array
    down: Array

    @classmethod
    def centred(cls, centre: Array, right: Array, down: Array, width: float, picture: Array) -> Self:
        """Return the rectangle of a picture: unit vectors `right` and `down`, `width` in object units."""
        height = width * picture.shape[0] / picture.shape[1]
        return cls(centre - right * width / 2 - down * height / 2, right * width, down * height)

    def at(self, u: float, v: float) -> Array:
        """Return the place at parts u of the width and v of the height, float64 (3,)."""
        return self.corner + u * self.right + v * self.down


def photograph(
    camera: Camera, rotation: Array, centre: Array, plane: Plane, picture: Array, *, columns: int
) -> Array:
    """Return what a camera sees of a pictured plane, uint8 (h, `columns`, 3) RGB; plain grey beside the plane.

    Every pixel's ray is intersected with the plane: ``n · (C + t d − P) = 0``. The photo is `columns` wide, its
    pixels are spread evenly over the camera's format.
    """
    rays = _rays(camera.model, camera.width, camera.height, tuple(camera.values.tolist()), columns)
    normal, offset = np.cross(plane.right, plane.down), plane.corner - centre
    height, width = picture.shape[:2]
    across = plane.right * (width / (plane.right @ plane.right))
    along = plane.down * (height / (plane.down @ plane.down))
    # found = C + t d − P with t = n·(P − C) / n·d; its parts along the picture's sides, in pixels
    seen = rays @ (rotation @ np.stack([normal, across, along], axis=1)).astype(np.float32)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.float32(normal @ offset) / seen[..., 0]
        u = distance * seen[..., 1] - np.float32(offset @ across + 0.5)
        v = distance * seen[..., 2] - np.float32(offset @ along + 0.5)
    u[~(distance > 0)] = -1e4
    return np.asarray(
        cv2.remap(rgb(picture), u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=BESIDE)
    )


@lru_cache(maxsize=8)
def _rays(model: str, width: int, height: int, values: tuple[float, ...], columns: int) -> Array:
    """Return the camera's rays at the pixels of the small photo, float32 (rows, columns, 3)."""
    camera = Camera(model=model, width=width, height=height, values=np.array(values))
    rows = round(columns * height / width)
    step = width / columns
    x, y = (np.arange(columns) + 0.5) * step - 0.5, (np.arange(rows) + 0.5) * step - 0.5
    pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return ray_from_pixel(camera, pixels).reshape(rows, columns, 3).astype(np.float32)


def rgb(picture: Array) -> Array:
    """Return a grey or colour picture, uint8, as (h, w, 3)."""
    return np.repeat(picture[..., None], 3, axis=2) if picture.ndim == 2 else np.ascontiguousarray(picture)


def photo_or_simulated(setting: Setting) -> tuple[Array, str]:
    """Return the project's photo, made smaller for quick drawing, or one of the simulated block; and its name."""
    if setting.photo is None:
        return reduced(simulated_photo()), "simulated façade"
    return reduced(setting.photo), setting.photo_name or "photo of the project"


_reduced: tuple[Array, Array] | None = None


def reduced(photo: Array) -> Array:
    """Return `photo` with its longer side at most `LARGEST` px, by area means; the last one is kept."""
    global _reduced
    if _reduced is not None and _reduced[0] is photo:
        return _reduced[1]
    scale = LARGEST / max(photo.shape[:2])
    small = photo
    if scale < 1:
        size = (max(1, round(photo.shape[1] * scale)), max(1, round(photo.shape[0] * scale)))
        small = cv2.resize(photo, size, interpolation=cv2.INTER_AREA)
    _reduced = (photo, small)
    return small
