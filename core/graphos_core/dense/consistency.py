"""Do the depth maps agree? A depth that other photos do not confirm is not a measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array
from graphos_core.dense.consistency_kernels import count_consistent
from graphos_core.dense.cost import transfer
from graphos_core.dense.undistort import View
from graphos_core.run import Run

ROWS_PER_CALL = 128
"""Rows between two looks at whether the work should stop."""


@dataclass(frozen=True)
class InverseMap:
    """One map of inverse depths with its camera.

    Attributes
    ----------
    view : View
        Its grey picture is not used.
    inverse_depth : float32 (h, w)
        1 / block unit; 0 where unknown.
    pixel : float
        Inverse depth that moves a point by one px in the matched neighbour with the longest base.
    """

    view: View
    inverse_depth: Array
    pixel: float


@dataclass(frozen=True)
class Others:
    """Other maps as arrays for compiled code; see `graphos_core.dense.consistency_kernels.count_consistent`."""

    a: Array
    b: Array
    back_a: Array
    back_b: Array
    depths: Array
    sizes: Array
    reaches: Array


def gather(own: InverseMap, others: Sequence[InverseMap]) -> Others:
    """Return the arrays of the other maps as seen from `own`; at least one is needed."""
    sizes = np.array([o.inverse_depth.shape for o in others], dtype=np.int64)
    depths = np.zeros((len(others), *sizes.max(axis=0)), np.float32)
    for i, other in enumerate(others):
        depths[i, : sizes[i, 0], : sizes[i, 1]] = other.inverse_depth
    there = [transfer(own.view, other.view) for other in others]
    back = [transfer(other.view, own.view) for other in others]
    return Others(
        np.stack([t[0] for t in there]),
        np.stack([t[1] for t in there]),
        np.stack([t[0] for t in back]),
        np.stack([t[1] for t in back]),
        depths,
        sizes,
        np.array([1.5 * other.pixel for other in others]),
    )


def consistent_views(own: InverseMap, others: Sequence[InverseMap], threshold_px: float, run: Run) -> Array:
    """Return in how many other maps each pixel of `own` has the same depth; uint8 (h, w).

    The point of a pixel is looked up in the other map, and the depth found there is brought back: the two are the
    same when they differ by less than `threshold_px` of parallax in the matched neighbour with the longest base.
    """
    count: Array = np.zeros(own.inverse_depth.shape, np.uint8)
    if not others:
        return count
    o = gather(own, others)
    for top in range(0, count.shape[0], ROWS_PER_CALL):
        run.check()
        bottom = min(top + ROWS_PER_CALL, count.shape[0])
        count_consistent(
            own.inverse_depth, top, bottom, o.a, o.b, o.back_a, o.back_b, o.depths, o.sizes, o.reaches,
            threshold_px * own.pixel, count,
        )  # fmt: skip
    return count
