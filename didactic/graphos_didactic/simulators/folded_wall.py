"""A folded wall, the object of several simulators: flat without a fold, two halves of a corner with one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_didactic.simulators.pictured_plane import BESIDE, Plane, photograph

NEAR, HALF_WIDTH, HALF_HEIGHT = 5.0, 2.3, 1.7
"""Distance of the fold from the origin along Y, half the width and half the height of the wall, m."""


@dataclass(frozen=True)
class FoldedWall:
    """A wall across the Y axis, its edges `fold` metres farther away than its middle.

    Attributes
    ----------
    fold : float
        m, ≥ 0.
    """

    fold: float

    def points(self, count: int, seed: int) -> Array:
        """Return points on the wall, float64 (count, 3), m; the first is near the middle."""
        draw = np.random.default_rng(seed)
        across = draw.uniform(-HALF_WIDTH, HALF_WIDTH, count)
        up = draw.uniform(-HALF_HEIGHT, HALF_HEIGHT, count)
        across[0], up[0] = 0.4 * across[0], 0.4 * up[0]
        return np.stack([across, NEAR + self.fold * np.abs(across) / HALF_WIDTH, up], axis=1)

    def outline(self) -> Array:
        """Return border and fold, float64 (10, 3), m, parts separated by a row of NaN."""
        far, w, h = NEAR + self.fold, HALF_WIDTH, HALF_HEIGHT
        top = [[-w, far, h], [0, NEAR, h], [w, far, h]]
        bottom = [[w, far, -h], [0, NEAR, -h], [-w, far, -h]]
        return np.array([*top, *bottom, [-w, far, h], [np.nan] * 3, [0, NEAR, h], [0, NEAR, -h]])

    def photographed(
        self, camera: Camera, rotation: Array, centre: Array, picture: Array, columns: int
    ) -> Array:
        """Return what a camera sees of a picture on the wall, uint8 (h, `columns`, 3) RGB."""
        half, far = picture.shape[1] // 2, NEAR + self.fold
        down, w, h = np.array([0.0, 0.0, -2.0 * HALF_HEIGHT]), HALF_WIDTH, HALF_HEIGHT
        left = Plane(np.array([-w, far, h]), np.array([w, NEAR - far, 0.0]), down)
        right = Plane(np.array([0.0, NEAR, h]), np.array([w, far - NEAR, 0.0]), down)
        halves = np.ascontiguousarray(picture[:, :half]), np.ascontiguousarray(picture[:, half:])
        seen, other = (
            photograph(camera, rotation, centre, plane, side, columns=columns)
            for plane, side in zip((left, right), halves, strict=True)
        )
        hit = (other != np.array(BESIDE, dtype=np.uint8)).any(axis=2)
        return np.where(hit[..., None], other, seen)
