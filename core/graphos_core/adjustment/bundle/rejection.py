"""What leaves the adjustment: observations with too large residuals, photos that hardly see a point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.data import Adjustment, Array, Block
from graphos_core.errors import ItemFailure, UserError
from graphos_core.text import Text

FEWEST_OBSERVATIONS = 4
"""A photo with fewer observed points than this is not adjusted."""


def normalised(adjustment: Adjustment) -> Array:
    """Return the residuals (m, 2) divided by their a priori standard deviations."""
    sigma = adjustment.block.obs_sigma_px
    return adjustment.residuals if sigma is None else np.asarray(adjustment.residuals / sigma[:, None])


def robust_spread(adjustment: Adjustment, part: Array) -> float:
    """Return the robust standard deviation of the observations `part` (bool), in units of the a priori one.

    The NMAD of the residuals, freed from redundancy.
    """
    v = np.abs(normalised(adjustment)[part])
    share = adjustment.observations / max(adjustment.redundancy, 1)
    return max(float(1.4826 * np.median(v) * np.sqrt(min(share, 10.0))), 1e-6) if v.size else 1.0


def without_long(block: Block, length: Array, limit: float, spared: Array) -> tuple[Block, int]:
    """Return the block without observations longer than `limit`, and how many they are.

    Of each point only the worst goes at a time: one blunder makes the other rays of its point look bad.

    Parameters
    ----------
    block : Block
    length : float64 (m,)
        Normalised length of each residual vector.
    limit : float
    spared : bool (m,)
        Observations that stay whatever their length.
    """
    worst = np.zeros(len(block.points))
    np.maximum.at(worst, block.obs_point, length)
    keep: Array = np.asarray((length <= limit) | (length < worst[block.obs_point]) | spared)
    dropped = int((~keep).sum())
    return (block, 0) if dropped == 0 else (without_weak_photos(chosen(block, keep)), dropped)


def chosen(block: Block, keep: Array) -> Block:
    """Return the block with the observations `keep` (bool) only."""
    sigma = None if block.obs_sigma_px is None else block.obs_sigma_px[keep]
    return replace(block, obs_photo=block.obs_photo[keep], obs_point=block.obs_point[keep], obs_xy=block.obs_xy[keep],
                   obs_sigma_px=sigma)  # fmt: skip


def without_weak_photos(block: Block) -> Block:
    """Return the block with photos that hardly see a point set aside, with the reason."""
    oriented = np.array(block.oriented)
    failures = list(block.failures)
    while True:
        used = oriented[block.obs_photo]
        rays = np.bincount(block.obs_point[used], minlength=len(block.points))
        used &= rays[block.obs_point] >= 2
        seen = np.bincount(block.obs_photo[used], minlength=len(oriented))
        weak = oriented & (seen < FEWEST_OBSERVATIONS)
        if not weak.any():
            break
        failures += [ItemFailure(block.names[n], Text(
            "Only {count} of its points are seen by other photos.", count=int(seen[n]))) for n in np.flatnonzero(weak)]  # fmt: skip
        oriented &= ~weak
    if oriented.sum() < 2:
        raise UserError(
            "The block cannot be adjusted.", "Fewer than two photos share enough points.",
            "Take photos with more overlap, or keep more observations.", learn="adjustment/overlap",
        )  # fmt: skip
    return replace(block, oriented=oriented, failures=tuple(failures))
