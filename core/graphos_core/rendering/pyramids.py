"""Cameras as people draw them: a pyramid from the projection centre to the photo."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array


@dataclass(frozen=True, eq=False)
class Quads:
    """Photos hung up in space.

    Attributes
    ----------
    corners : float64 (k, 3, 3)
        Top-left corner, edge to the right, edge down, in the object frame.
    textures : tuple of uint8 (h, w, 3)
        RGB, upright.
    opacity : float
        0 to 1.
    """

    corners: Array
    textures: tuple[Array, ...]
    opacity: float = 1.0


def camera_pyramids(
    rotations: Array, centres: Array, cameras: Sequence[Camera], size: float
) -> tuple[Array, Array, Array]:
    """Return the edges of camera pyramids and the photo planes at their base.

    Parameters
    ----------
    rotations : float64 (n, 3, 3)
        ``cam_from_world``.
    centres : float64 (n, 3)
        Projection centres, object frame.
    cameras : sequence of n Camera
        The camera of each photo; distortion is not drawn.
    size : float
        Length of the longer side of the photo, in the unit of the object frame.

    Returns
    -------
    starts, ends : float64 (n, 8, 3)
        Four edges from the centre, then four around the photo.
    corners : float64 (n, 3, 3)
        As in `Quads`.
    """
    rotations = np.asarray(rotations, np.float64).reshape(-1, 3, 3)
    centres = np.asarray(centres, np.float64).reshape(-1, 3)
    starts = np.empty((len(centres), 8, 3))
    ends = np.empty_like(starts)
    corners = np.empty((len(centres), 3, 3))
    for i, camera in enumerate(cameras):
        f, x0, y0 = (float(v) for v in camera.values[:3])
        w, h = camera.width, camera.height
        outline = np.array([[-0.5, -0.5], [w - 0.5, -0.5], [w - 0.5, h - 0.5], [-0.5, h - 0.5]])
        local = np.column_stack([outline - [x0, y0], np.full(4, f)]) * (size / max(w, h))
        placed = local @ rotations[i] + centres[i]
        starts[i, :4], ends[i, :4] = centres[i], placed
        starts[i, 4:], ends[i, 4:] = placed, np.roll(placed, -1, axis=0)
        corners[i] = placed[0], placed[1] - placed[0], placed[3] - placed[0]
    return starts, ends, corners
