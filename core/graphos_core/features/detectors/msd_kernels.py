"""Maximal self-dissimilarity: distances of patches by running sums, each computed once for both patches.

All distances are sums of squared differences of bytes, whole numbers below 2²⁴ for patches of up to 15 × 15 pixels,
hence exact in float32 in whatever order they are added.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from graphos_core.data import Array

STRIPES = 8
"""Stripes of rows computed side by side; their number does not depend on that of the threads."""

BLOCK = 256
"""Columns computed at a time, so that the running sums stay in the cache."""

TOGETHER = 4
"""Smallest distances that are updated in one pass."""

FAR = np.float32(3.0e38)
"""Distance of a patch that is not there."""


@njit(cache=True, nogil=True, parallel=True)
def nearest_distance_sums(image: Array, patch: int, search: int, neighbours: int) -> Array:
    """Return for every pixel the sum of the distances of its nearest patches.

    The distance of two patches is the sum of squared grey value differences of their (2 `patch` + 1)² pixels; those
    compared with a pixel's patch are shifted by up to `search` px in x and y (Tombari and Di Stefano 2014,
    section 2). Distances are symmetric: a shift and its opposite are computed once, for both patches.

    Parameters
    ----------
    image : float32 (h, w)
        Whole numbers 0 to 255.
    patch, search : int
        Radii of the patches and of the search area, px.
    neighbours : int
        k, how many nearest patches count.

    Returns
    -------
    float32 (h, w)
        Zero within `patch` + `search` of the border.
    """
    height, width = image.shape
    border = patch + search
    sums = np.zeros((height, width), np.float32)
    rows = height - 2 * border
    columns = width - 2 * border
    blocks = (columns + BLOCK - 1) // BLOCK if rows > 0 and columns > 0 else 0
    for task in prange(STRIPES * blocks):
        stripe = task // blocks
        left = border + (task % blocks) * BLOCK
        right = min(left + BLOCK, width - border)
        top = border + stripe * rows // STRIPES
        bottom = border + (stripe + 1) * rows // STRIPES
        if top < bottom:
            _block(image, patch, search, neighbours, (top, bottom, left, right), sums)
    return sums


@njit(cache=True, nogil=True)
def _block(
    image: Array, patch: int, search: int, neighbours: int, area: tuple[int, int, int, int], sums: Array
) -> None:
    """Fill one block of `nearest_distance_sums`.

    Rows are taken from `search` above the block downwards. The smallest distances of the next `search` + 1 rows are
    kept in a ring: those of row y to patches above it come in the turns of the rows above.
    """
    top, bottom, left, right = area
    kept = (neighbours + TOGETHER - 1) // TOGETHER * TOGETHER
    ring = np.full((search + 1, kept, right - left), FAR, np.float32)
    extent = right - left + search + 2 * patch
    running = np.zeros(((search + 1) * (2 * search + 1), extent), np.float32)
    scratch = np.empty((2, extent), np.float32)
    for y in range(top - search, bottom):
        for down in range(max(0, top - y), search + 1):
            for aside in range(-search if down > 0 else 1, search + 1):
                start = left - max(aside, 0)
                n = right - min(aside, 0) - start
                column = running[down * (2 * search + 1) + aside + search]
                _move_down(
                    image, patch, y, start - patch, down, aside, y == top - down, column, n + 2 * patch
                )
                _box(column, scratch, n, 2 * patch + 1)
                if y >= top:
                    _insert(ring[y % (search + 1)], scratch, left - start)
                if y + down < bottom:
                    _insert(ring[(y + down) % (search + 1)], scratch, left - aside - start)
        if y >= top:
            _finish(ring[y % (search + 1)], neighbours, sums[y, left:right])


@njit(cache=True, nogil=True)
def _move_down(
    image: Array, patch: int, y: int, x: int, down: int, aside: int, fresh: bool, column: Array, n: int
) -> None:
    """Sum the squared differences of columns: of all their rows, or by the row that enters and the one that leaves."""
    if fresh:
        column[:n] = 0.0
        for row in range(y - patch, y + patch + 1):
            a = image[row, x : x + n]
            b = image[row + down, x + aside : x + aside + n]
            for i in range(n):
                column[i] += (a[i] - b[i]) * (a[i] - b[i])
        return
    a = image[y + patch, x : x + n]
    b = image[y + patch + down, x + aside : x + aside + n]
    c = image[y - patch - 1, x : x + n]
    d = image[y - patch - 1 + down, x + aside : x + aside + n]
    for i in range(n):
        column[i] += (a[i] - b[i]) * (a[i] - b[i]) - (c[i] - d[i]) * (c[i] - d[i])


@njit(cache=True, nogil=True)
def _box(column: Array, scratch: Array, n: int, side: int) -> None:
    """Sum `side` neighbours into ``scratch[0]``, by sums of 1, 2, 4 … of them."""
    total, power = scratch[0], scratch[1]
    total[:n] = column[:n]
    length = n + side - 1
    power[:length] = column[:length]
    done, width = 1, 1
    while 2 * width <= side:
        for i in range(length - 2 * width + 1):
            power[i] = power[i] + power[i + width]
        width *= 2
        if side & width:
            shifted = power[done:]
            for i in range(n):
                total[i] += shifted[i]
            done += width


@njit(cache=True, nogil=True)
def _insert(smallest: Array, scratch: Array, offset: int) -> None:
    """Insert a distance into the sorted smallest ones of every pixel, without branches."""
    kept, n = smallest.shape
    values, larger = scratch[0, offset : offset + n], scratch[1, :n]
    for first in range(0, kept, TOGETHER):
        m0, m1, m2, m3 = smallest[first], smallest[first + 1], smallest[first + 2], smallest[first + 3]
        for i in range(n):
            v = values[i]
            a = m0[i]
            m0[i] = a if a < v else v
            v = v if a < v else a
            b = m1[i]
            m1[i] = b if b < v else v
            v = v if b < v else b
            c = m2[i]
            m2[i] = c if c < v else v
            v = v if c < v else c
            d = m3[i]
            m3[i] = d if d < v else v
            larger[i] = v if d < v else d
        values = larger


@njit(cache=True, nogil=True)
def _finish(smallest: Array, neighbours: int, sums: Array) -> None:
    for rank in range(neighbours):
        for i in range(len(sums)):
            sums[i] += smallest[rank, i]
    smallest[:] = FAR
