"""Semi-global aggregation of matching costs over eight directions (Hirschmüller 2008)."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array
from graphos_core.dense.sgm_kernels import FAR, aggregate_rows
from graphos_core.run import Run

ROWS_PER_CALL = 64
"""Rows between two looks at whether the work should stop."""

FOLLOW = 1.5
"""Differences of two ranges, in steps, that are taken as slope of the surface and not as a jump."""


def aggregate(
    cost: Array, starts: Array, grey: Array, *, p1: float, p2: float, edge_grey: float, run: Run
) -> Array:
    """Return the sum of the path costs over eight directions.

    Parameters
    ----------
    cost : uint16 (h, w, d)
        Matching cost of d hypotheses of every pixel.
    starts : float32 (h, w)
        Where the range of each pixel starts, in steps; zeros where all are the same. Two hypotheses of neighbouring
        pixels are the same when ``starts + k`` is, to the nearest step; differences of up to `FOLLOW` steps belong
        to the slope of the surface and count as none (as the orientation priors of Scharstein et al. 2017).
    grey : uint8 (h, w)
    p1, p2 : float
        Penalty of a change by one step, and by more, in units of the stored cost; whole numbers keep the sums exact.
    edge_grey : float
        Grey difference at which P2 is halved.
    run : Run

    Returns
    -------
    float32 (h, w, d)
        Exact whole numbers, so independent of the order of summation.
    """
    height, width, count = cost.shape
    total = np.zeros(cost.shape, np.float32)
    for direction in (1, -1):
        paths = np.full((2, 4, width, count + 2), FAR, np.float32)
        least = np.zeros((2, 4, width), np.float32)
        for start in range(0, height, ROWS_PER_CALL):
            run.check()
            stop = min(start + ROWS_PER_CALL, height)
            aggregate_rows(
                cost, starts, grey, p1, p2, edge_grey, FOLLOW, start, stop, direction, paths, least, total
            )
    return total
