"""Compiled semi-global aggregation with a range of hypotheses of its own for every pixel."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data.record import Array

FAR = np.float32(1e6)
"""Cost of a hypothesis outside the range of the previous pixel."""


@njit(cache=True, nogil=True, fastmath=True)
def extend_path(
    cost: Array, before: Array, least: float, shift: int, p1: float, p2: float, now: Array, total: Array
) -> float:
    """Extend one path by one pixel and add its costs to the total; return the smallest.

    ``L(k) = C(k) + min(L'(k'), L'(k' ± 1) + P1, min L' + P2) − min L'`` with ``k' = k + shift``
    (Hirschmüller 2008, equation 13; `shift` accounts for the different ranges of the two pixels).

    Parameters
    ----------
    cost : uint16 (d,)
    before, now : float32 (d + 2,)
        Path costs of the previous and this pixel, with one outer hypothesis at either end.
    least : float
        Smallest of `before`.
    shift : int
    p1, p2 : float
    total : float32 (d,)
    """
    count = cost.shape[0]
    jump = np.float32(p2)
    one = np.float32(p1)
    base = np.float32(least)
    smallest = FAR
    if shift == 0:
        for k in range(count):
            best = min(before[k + 1] - base, jump)
            best = min(best, min(before[k], before[k + 2]) - base + one)
            value = np.float32(cost[k]) + best
            now[k + 1] = value
            total[k] += value
            smallest = min(smallest, value)
    else:
        for k in range(count):
            best = jump
            q = k + shift + 1
            if 0 < q <= count:
                best = min(best, before[q] - base)
            if 0 < q - 1 <= count:
                best = min(best, before[q - 1] - base + one)
            if 0 < q + 1 <= count:
                best = min(best, before[q + 1] - base + one)
            value = np.float32(cost[k]) + best
            now[k + 1] = value
            total[k] += value
            smallest = min(smallest, value)
    return smallest


@njit(cache=True, nogil=True)
def range_shift(here: float, there: float, follow: float, count: int) -> int:
    """Return ``k' − k`` of equal inverse depth in two pixels whose ranges start at `here` and `there` (in steps).

    Differences up to `follow` steps belong to the slope of the surface and are followed without a shift.
    """
    difference = here - there
    if abs(difference) <= follow:
        return 0
    if difference > count:
        return count
    if difference < -count:
        return -count
    return int(np.rint(difference))


@njit(cache=True, nogil=True)
def aggregate_rows(
    cost: Array, starts: Array, grey: Array, p1: float, p2: float, edge_grey: float, follow: float,
    start: int, stop: int, direction: int, paths: Array, least: Array, total: Array,
) -> None:  # fmt: skip
    """Aggregate over four paths (along the row, and three from the row before) for some rows.

    Parameters
    ----------
    cost : uint16 (h, w, d)
    starts : float32 (h, w)
        Inverse depth of the first hypothesis of each pixel, in steps.
    grey : uint8 (h, w)
    p1, p2 : float
        Penalties of a change by one step and of a larger one, in units of the stored cost.
    edge_grey : float
        Grey difference at which P2 is halved: ``P2' = max(P2 / (1 + |Δg| / edge_grey), 1.5·P1)``.
    follow : float
        See `range_shift`.
    start, stop : int
        Rows in the order of the direction.
    direction : int
        1: downwards and to the right; −1: upwards and to the left.
    paths : float32 (2, 3, w, d + 2)
        Path costs of the last row and this row; the outer hypotheses are `FAR`. Kept between calls.
    least : float32 (2, 3, w)
        Their minima.
    total : float32 (h, w, d)
        Aggregated cost, added to.
    """
    height, width, count = cost.shape
    along = np.full((2, count + 2), FAR, np.float32)
    for step in range(start, stop):
        y = step if direction > 0 else height - 1 - step
        now = step & 1
        old = 1 - now
        along_least = np.float32(0.0)
        for column in range(width):
            x = column if direction > 0 else width - 1 - column
            flip = column & 1
            g = np.float32(grey[y, x])
            for path in range(4):
                if path == 0:
                    px, py = x - direction, y
                else:
                    px, py = x + path - 2, y - direction
                first = px < 0 or px >= width or py < 0 or py >= height
                into = along[flip] if path == 0 else paths[now, path - 1, x]
                if first:
                    smallest = FAR
                    for k in range(count):
                        value = np.float32(cost[y, x, k])
                        into[k + 1] = value
                        total[y, x, k] += value
                        smallest = min(smallest, value)
                else:
                    shift = range_shift(starts[y, x], starts[py, px], follow, count)
                    jump = max(p2 / (1.0 + abs(g - np.float32(grey[py, px])) / edge_grey), 1.5 * p1)
                    jump = np.rint(jump)
                    before = along[1 - flip] if path == 0 else paths[old, path - 1, px]
                    low = along_least if path == 0 else least[old, path - 1, px]
                    smallest = extend_path(cost[y, x], before, low, shift, p1, jump, into, total[y, x])
                if path == 0:
                    along_least = np.float32(smallest)
                else:
                    least[now, path - 1, x] = smallest
