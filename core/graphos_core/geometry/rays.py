r"""Measured rays of any camera, each with a small image plane of its own in which errors are counted in pixels.

A central-perspective photo has one ideal image plane for all its rays; a fish-eye or panorama has none, so each ray
gets the plane through its tip that follows the camera's own scale there. Both are written alike: a matrix M per ray
takes a point p of the camera frame to ``q = M p``; the point lies before the camera where ``q₃ > 0``, and
``(q₁, q₂)/q₃`` is its distance from the ray in px.

- central: ``M = [[f, 0, −f u], [0, f, −f v], [0, 0, 1]]``, the distance in the ideal image plane, without distortion;
- wide: ``M = [∂x/∂d; dᵀ]`` with the direction d and the derivative of the camera model at d, the distance in the
  photo to first order. An error of one pixel so means an angle by the local scale of the camera.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from graphos_core.cameras import camera_model, ray_from_pixel
from graphos_core.cameras.model import derivatives
from graphos_core.data import Array, Camera


@dataclass(frozen=True)
class Rays:
    """Measured rays in the camera frames of their photos.

    Attributes
    ----------
    directions : float64 (m, 3)
        Unit vectors; NaN where a pixel has no ray.
    frames : float64 (m, 3, 3)
        M of each ray, px.
    central : bool
        Whether every ray comes from a central-perspective camera (all lie before it).
    """

    directions: Array
    frames: Array
    central: bool = True

    def __len__(self) -> int:
        return len(self.directions)

    def __getitem__(self, index: Any) -> Rays:
        return Rays(self.directions[index], self.frames[index], self.central)

    @property
    def valid(self) -> Array:
        """Which rays exist, bool (m,)."""
        return np.asarray(np.isfinite(self.directions).all(axis=1))

    @property
    def plane(self) -> Array:
        """Ideal image coordinates x/z, y/z (m, 2); only for central rays."""
        return np.asarray(self.directions[:, :2] / self.directions[:, 2:])

    def tips(self) -> tuple[Array, Array]:
        """Return the tip of each ray (m, 3) in its plane, and how the tip moves per px, (m, 3, 2): M⁻¹ by columns."""
        inverse = np.linalg.inv(self.frames)
        return inverse[:, :, 2], inverse[:, :, :2]


def ideal_rays(plane: Array, focal: Array | float = 1.0) -> Rays:
    """Return central rays from ideal image coordinates x/z, y/z (m, 2); `focal` in px turns distances into pixels."""
    plane = np.asarray(plane, dtype=np.float64)
    frames = np.zeros((len(plane), 3, 3))
    frames[:, 0, 0] = frames[:, 1, 1] = focal
    frames[:, :2, 2] = -plane * np.reshape(np.broadcast_to(focal, len(plane)), (-1, 1))
    frames[:, 2, 2] = 1.0
    directions = np.column_stack([plane, np.ones(len(plane))])
    return Rays(directions / np.linalg.norm(directions, axis=1, keepdims=True), frames)


def rays_of(camera: Camera, pixels: Array) -> Rays:
    """Return the rays of pixels (m, 2) of one camera; NaN where a pixel has none."""
    found = ray_from_pixel(camera, pixels)
    if not camera_model(camera.model).wide:
        return ideal_rays(found[:, :2], camera.focal_px)
    slopes = np.full((len(found), 2, 3), np.nan)
    there = np.isfinite(found).all(axis=1)
    slopes[there] = derivatives(camera, found[there])[1]
    return Rays(found, np.concatenate([slopes, found[:, None]], axis=1), central=False)


def as_rays(rays: Rays | Array) -> Rays:
    """Return rays from `Rays`, from ideal image coordinates (n, 2), or from directions (n, 3) of any length.

    Distances of coordinates then count in their own unit, those of directions in radians.
    """
    if isinstance(rays, Rays):
        return rays
    rays = np.asarray(rays, dtype=np.float64)
    return ideal_rays(rays) if rays.shape[1] == 2 else direction_rays(rays)


def direction_rays(directions: Array, scale: float = 1.0) -> Rays:
    """Return rays of any field angle from directions (n, 3), with the same scale in px per radian everywhere."""
    unit = np.asarray(directions, dtype=np.float64)
    unit = unit / np.linalg.norm(unit, axis=1, keepdims=True)
    across, down = tangents(unit)
    return Rays(unit, np.stack([scale * across, scale * down, unit], axis=1), central=False)


def tangents(directions: Array) -> tuple[Array, Array]:
    """Return two unit vectors (n, 3) at right angles to unit directions (n, 3) and to each other (Duff et al. 2017)."""
    x, y, z = np.asarray(directions).T
    side = np.where(z >= 0.0, 1.0, -1.0)
    a = -1.0 / (side + z)
    b = x * y * a
    first = np.column_stack([1.0 + side * x * x * a, side * b, -side * x])
    return first, np.column_stack([b, side + y * y * a, -y])


def joined(parts: list[tuple[Array, Rays]], count: int) -> Rays:
    """Return `count` rays from parts (index, rays); rays in no part are NaN."""
    directions, frames = np.full((count, 3), np.nan), np.full((count, 3, 3), np.nan)
    for index, rays in parts:
        directions[index], frames[index] = rays.directions, rays.frames
    return Rays(directions, frames, all(rays.central for _, rays in parts))


def in_turn(sides: list[Rays]) -> Rays:
    """Return corresponding rays one after the other: those of the first point, of the second, and so on."""
    return Rays(
        np.stack([side.directions for side in sides], axis=1).reshape(-1, 3),
        np.stack([side.frames for side in sides], axis=1).reshape(-1, 3, 3),
        all(side.central for side in sides),
    )
