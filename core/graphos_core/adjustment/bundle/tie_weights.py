"""How precise tie points are against each other: coarse keypoints are placed less precisely than fine ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from graphos_core.data import Array, Block, Features, Tracks

GROWTH = 0.2
"""Standard deviations grow with this power of the keypoint's scale. Residuals freed from redundancy of SIFT keypoints,
in eight classes of scale from 5 to 40 px, follow it (docs/benchmarks.md); proportional growth would be 1."""

RANGE = 0.5, 2.0
"""Bounds of the relative standard deviation."""


def with_scale_sigma(block: Block, tracks: Tracks, features: Sequence[Features]) -> Block:
    """Return the block with `Block.obs_sigma_px` relative to a keypoint of median scale.

    Parameters
    ----------
    block : Block
        Its `Block.point_track` names the tracks its points come from; observations without track count as median.
    tracks : Tracks
    features : sequence of Features
        Of every photo.
    """
    photos = max(len(block.names), 1)
    key = np.asarray(tracks.track, dtype=np.int64) * photos + tracks.photo
    scale = np.concatenate([[np.nan], *(f.scale for f in features)])
    first = np.cumsum([1, *(len(f.scale) for f in features)])[:-1]
    wanted = np.asarray(block.point_track, dtype=np.int64)[block.obs_point] * photos + block.obs_photo
    place = np.minimum(np.searchsorted(key, wanted), max(len(key) - 1, 0))
    known = (np.asarray(block.point_track)[block.obs_point] >= 0) & (key[place] == wanted)
    own = np.where(known, first[tracks.photo[place]] + tracks.feature[place], 0)
    return replace(block, obs_sigma_px=relative_sigma(scale[own]))


def relative_sigma(scale: Array) -> Array:
    """Return the relative standard deviation (m,) of keypoints of a scale (m,); NaN and all alike give 1."""
    known = scale[np.isfinite(scale) & (scale > 0)]
    if not len(known):
        return np.ones(len(scale))
    relative = (scale / np.median(known)) ** GROWTH
    return np.clip(np.where(np.isfinite(relative), relative, 1.0), *RANGE)
