"""Suppression of points by better ones nearby."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data import Array

LEAST_CELL = 0.5
"""Px; finer cells would tell nothing more and cost memory."""


@njit(cache=True, nogil=True)
def cover(xy: Array, radius: float, width: int, height: int, enough: int) -> Array:
    """Return which points are not covered by an earlier one, ascending; the search ends after `enough`.

    A point covers all cells that reach within `radius` in x and y of its own cell; cells have half that side.

    Parameters
    ----------
    xy : float64 (n, 2)
        Best first, px.
    radius : float
        Px.
    width, height : int
        Of the photo, px.
    enough : int

    Returns
    -------
    int64 (m,)
    """
    cell = max(0.5 * radius, LEAST_CELL)
    reach = int(radius / cell)
    columns = int((width + 1) / cell) + 1
    rows = int((height + 1) / cell) + 1
    covered = np.zeros((rows, columns), np.bool_)
    kept = np.empty(min(len(xy), enough), np.int64)
    count = 0
    for i in range(len(xy)):
        column = min(max(int((xy[i, 0] + 0.5) / cell), 0), columns - 1)
        row = min(max(int((xy[i, 1] + 0.5) / cell), 0), rows - 1)
        if covered[row, column]:
            continue
        kept[count] = i
        count += 1
        if count == enough:
            break
        for v in range(max(0, row - reach), min(rows, row + reach + 1)):
            for u in range(max(0, column - reach), min(columns, column + reach + 1)):
                covered[v, u] = True
    return kept[:count]
