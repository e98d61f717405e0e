"""Which observations of a block can take part in an adjustment, and the block without the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.data import Array, Block


def usable(block: Block, single: Array) -> Array:
    """Say which observations can take part: oriented photo, first of its point and photo, point with two rays.

    Parameters
    ----------
    block : Block
    single : bool (p,)
        Points for which one ray is enough: those held fixed, and those that other observations concern.

    Returns
    -------
    bool (m,)
        In the order of the block's observations.
    """
    keep = np.asarray(block.oriented)[block.obs_photo] & np.isfinite(block.obs_xy).all(axis=1)
    key = block.obs_point.astype(np.int64) * len(block.names) + block.obs_photo
    if np.any(np.diff(key) <= 0):  # not sorted, or twice: keep the first of each
        first = np.zeros(len(key), dtype=bool)
        candidates = np.flatnonzero(keep)
        first[candidates[np.unique(key[candidates], return_index=True)[1]]] = True
        keep &= first
    rays = np.bincount(block.obs_point[keep], minlength=len(block.points))
    return keep & ((rays >= 2) | single)[block.obs_point]


def select(block: Block, keep: Array) -> tuple[Block, Array]:
    """Keep some observations, sorted by point and photo, and drop the points that lose all of theirs.

    Returns
    -------
    Block
    int64 (p,)
        Old index of each remaining point.
    """
    key = block.obs_point.astype(np.int64) * len(block.names) + block.obs_photo
    rays = np.bincount(block.obs_point[keep], minlength=len(block.points))
    in_order = bool((np.diff(key) > 0).all())
    if in_order and keep.all() and (rays > 0).all():
        return block, np.arange(len(block.points))
    index = np.flatnonzero(keep)
    if not in_order:
        index = index[np.lexsort((block.obs_photo[index], block.obs_point[index]))]
    points = np.flatnonzero(rays > 0)
    obs_point = (np.cumsum(rays > 0) - 1)[block.obs_point[index]]
    return replace(
        block,
        points=block.points[points],
        colours=block.colours[points],
        point_track=block.point_track[points],
        obs_photo=block.obs_photo[index],
        obs_point=obs_point.astype(np.int32),
        obs_xy=block.obs_xy[index],
        obs_sigma_px=None if block.obs_sigma_px is None else block.obs_sigma_px[index],
    ), points
