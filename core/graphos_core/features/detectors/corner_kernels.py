"""Local maxima of an interest value, and the least-squares position of corners and circles."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from graphos_core.data import Array


@njit(cache=True, nogil=True, parallel=True)
def local_maxima(value: Array, radius: int, least: float) -> Array:
    """Mark the pixels that are larger than `least` and than everything within `radius` px in x and y.

    Of equal neighbours the first in reading order is the maximum. Pixels nearer than `radius` to the border of the
    image are compared with what is there.

    Parameters
    ----------
    value : float32 (h, w)
    radius : int
    least : float

    Returns
    -------
    bool (h, w)
    """
    height, width = value.shape
    found = np.zeros((height, width), np.bool_)
    for y in prange(height):
        for x in range(width):
            own = value[y, x]
            if own <= least:
                continue
            largest = True
            for v in range(max(0, y - radius), min(height, y + radius + 1)):
                for u in range(max(0, x - radius), min(width, x + radius + 1)):
                    other = value[v, u]
                    earlier = v < y or (v == y and u < x)
                    if other > own or (earlier and other == own):
                        largest = False
                        break
                if not largest:
                    break
            found[y, x] = largest
    return found


@njit(cache=True, nogil=True, parallel=True)
def intersections(right: Array, down: Array, rows: Array, columns: Array, weight: Array) -> Array:
    r"""Return corner and circle positions of windows with the sums of their squared residuals.

    With the gradient g at each pixel p of a window and weights w, the corner x minimises ``Σ w (gᵀ(p − x))²``: the
    point nearest to all tangents. The centre of a circle minimises ``Σ w (hᵀ(p − x))²`` with h the gradient turned by
    90°: the point nearest to all normals (Förstner and Gülch 1987, sections 2.1 and 2.2).

    Parameters
    ----------
    right, down : float32 (h, w)
        Gradient.
    rows, columns : int (n,)
        Window centres.
    weight : float64 (2r + 1, 2r + 1)

    Returns
    -------
    float64 (n, 6)
        Shift of corner (x, y) and circle (x, y) from the window centre, px, residual sum of corner and of circle;
        NaN where a window has no solution.
    """
    height, width = right.shape
    radius = weight.shape[0] // 2
    found = np.full((len(rows), 6), np.nan)
    for i in prange(len(rows)):
        xx = xy = yy = 0.0
        corner_x = corner_y = circle_x = circle_y = 0.0
        corner_square = circle_square = 0.0
        for v in range(-radius, radius + 1):
            y = rows[i] + v
            if y < 0 or y >= height:
                continue
            for u in range(-radius, radius + 1):
                x = columns[i] + u
                if x < 0 or x >= width:
                    continue
                w = weight[v + radius, u + radius]
                a, b = np.float64(right[y, x]), np.float64(down[y, x])
                xx += w * a * a
                xy += w * a * b
                yy += w * b * b
                along, across = a * u + b * v, a * v - b * u
                corner_x += w * a * along
                corner_y += w * b * along
                corner_square += w * along * along
                circle_x -= w * b * across
                circle_y += w * a * across
                circle_square += w * across * across
        determinant = xx * yy - xy * xy
        if determinant <= 1e-12 * (xx + yy) ** 2 or xx + yy <= 0.0:
            continue
        x = (yy * corner_x - xy * corner_y) / determinant
        y = (xx * corner_y - xy * corner_x) / determinant
        found[i, 0], found[i, 1] = x, y
        found[i, 4] = max(0.0, corner_square - corner_x * x - corner_y * y)
        x = (xx * circle_x + xy * circle_y) / determinant
        y = (xy * circle_x + yy * circle_y) / determinant
        found[i, 2], found[i, 3] = x, y
        found[i, 5] = max(0.0, circle_square - circle_x * x - circle_y * y)
    return found
