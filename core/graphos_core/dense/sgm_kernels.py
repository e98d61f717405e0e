"""Compiled semi-global aggregation with a range of hypotheses of its own for every pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from graphos_core.data.record import Array

FAR = np.float32(1e6)
"""Cost of a hypothesis outside the range of the previous pixel."""


@njit(cache=True, nogil=True, fastmath=True)
def extend_path(
    cost: Array, y: int, x: int, paths: Array, old: int, path: int, px: int, least: float, shift: int,
    p1: float, p2: float, now: int, total: Array,
) -> Any:  # fmt: skip
    """Extend one path by one pixel and add its costs to the total; return the smallest.

    ``L(k) = C(k) + min(L'(k'), L'(k' ± 1) + P1, min L' + P2) − min L'`` with ``k' = k + shift``
    (Hirschmüller 2008, equation 13; `shift` accounts for the different ranges of the two pixels).

    Parameters
    ----------
    cost : uint16 (h, w, d)
    y, x : int
        This pixel.
    paths : float32 (2, 4, w, d + 2)
        Path costs: ``paths[old, path, px]`` of the previous, ``paths[now, path, x]`` of this pixel, with one
        outer hypothesis at either end.
    old, path, px, now : int
    least : float
        Smallest path cost of the previous pixel.
    shift : int
    p1, p2 : float
    total : float32 (h, w, d)
    """
    count = cost.shape[2]
    jump = np.float32(p2)
    one = np.float32(p1)
    base = np.float32(least)
    smallest = FAR
    if shift == 0:
        for k in range(count):
            best = min(paths[old, path, px, k], paths[old, path, px, k + 2]) + one
            best = min(min(best, paths[old, path, px, k + 1]) - base, jump)
            value = np.float32(cost[y, x, k]) + best
            paths[now, path, x, k + 1] = value
            total[y, x, k] += value
            smallest = min(smallest, value)
        return smallest
    for k in range(count):
        best = jump
        q = k + shift + 1
        if 0 < q <= count:
            best = min(best, paths[old, path, px, q] - base)
        if 0 < q - 1 <= count:
            best = min(best, paths[old, path, px, q - 1] - base + one)
        if 0 < q + 1 <= count:
            best = min(best, paths[old, path, px, q + 1] - base + one)
        value = np.float32(cost[y, x, k]) + best
        paths[now, path, x, k + 1] = value
        total[y, x, k] += value
        smallest = min(smallest, value)
    return smallest


@njit(cache=True, nogil=True, fastmath=True)
def begin_path(cost: Array, y: int, x: int, paths: Array, now: int, path: int, total: Array) -> Any:
    """Begin a path at the border of the picture; arguments as in `extend_path`."""
    smallest = FAR
    for k in range(cost.shape[2]):
        value = np.float32(cost[y, x, k])
        paths[now, path, x, k + 1] = value
        total[y, x, k] += value
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
    if abs(difference) > count:  # nothing in common, not even with a change by one step
        return count + 1
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
    paths : float32 (2, 4, w, d + 2)
        Path costs of the last row and this row (of the path along the row only index 0 is used); the outer
        hypotheses are `FAR`. Kept between calls.
    least : float32 (2, 4, w)
        Their minima.
    total : float32 (h, w, d)
        Aggregated cost, added to.
    """
    height, width, count = cost.shape
    for step in range(start, stop):
        y = step if direction > 0 else height - 1 - step
        for column in range(width):
            x = column if direction > 0 else width - 1 - column
            g = np.float32(grey[y, x])
            for path in range(4):
                px = x - direction if path == 3 else x + path - 1
                py = y if path == 3 else y - direction
                now = 0 if path == 3 else step & 1
                old = 0 if path == 3 else 1 - now
                if px < 0 or px >= width or py < 0 or py >= height:
                    least[now, path, x] = begin_path(cost, y, x, paths, now, path, total)
                    continue
                shift = range_shift(starts[y, x], starts[py, px], follow, count)
                contrast = abs(g - np.float32(grey[py, px])) / edge_grey
                jump = max(float(p2 / (1.0 + contrast)), 1.5 * p1)
                least[now, path, x] = extend_path(
                    cost,
                    y,
                    x,
                    paths,
                    old,
                    path,
                    px,
                    least[old, path, px],
                    shift,
                    p1,
                    np.rint(jump),
                    now,
                    total,
                )
