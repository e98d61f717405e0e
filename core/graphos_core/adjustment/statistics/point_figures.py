"""What is known of each object point of an adjusted block, as one figure per point."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Adjustment, Array, Block
from graphos_core.geometry.triangulation import intersection_angles

KINDS = ("precision", "rays", "angle", "residual")


def point_figure(adjustment: Adjustment, kind: str) -> Array:
    """Return a figure of every object point, float64 (p,).

    Parameters
    ----------
    adjustment : Adjustment
    kind : {"precision", "rays", "angle", "residual"}
        Largest standard deviation of a coordinate in the block's unit, number of photos that see the point, largest
        intersection angle of two rays in degrees, root mean square of the image residuals per coordinate in px.
    """
    block = adjustment.block
    if kind == "precision":
        return np.asarray(adjustment.sigma_points, dtype=np.float64).max(axis=1, initial=0.0)
    count = np.bincount(np.asarray(block.obs_point), minlength=len(block.points))
    if kind == "rays":
        return count.astype(np.float64)
    if kind == "angle":
        return np.degrees(largest_angles(block))
    squares = (np.asarray(adjustment.residuals) ** 2).sum(axis=1)
    total = np.bincount(np.asarray(block.obs_point), weights=squares, minlength=len(block.points))
    return np.sqrt(total / np.maximum(2 * count, 1))


def largest_angles(block: Block) -> Array:
    """Return the largest intersection angle of two rays of every object point (p,), radians."""
    point = np.asarray(block.obs_point)
    start = np.searchsorted(point, np.arange(len(block.points) + 1))
    used = np.ones(len(point), dtype=bool)
    return np.asarray(
        intersection_angles(start, np.asarray(block.obs_photo), used, block.centres, block.points)
    )
