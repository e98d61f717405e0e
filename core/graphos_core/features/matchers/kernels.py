"""The scan of the similarity matrix: best and second best of every row and column in one pass."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data import Array

LANES = 64


@njit(cache=True, nogil=True)
def scan_rows(
    scores: Array,
    first_row: int,
    row_best: Array,
    row_second: Array,
    row_index: Array,
    column_best: Array,
    column_second: Array,
    column_index: Array,
) -> None:
    """Update best score, second score and index of the best for the rows of a tile and for all columns.

    Rows are scanned in `LANES` interleaved lanes so that the inner loop has no branch; of equal scores the first
    index wins.

    Parameters
    ----------
    scores : float32 (t, m)
        Tile of t rows; larger is better.
    first_row : int
        Row number of the tile's first row.
    row_best, row_second : float32 (n,), row_index : int32 (n,)
        Written for the tile's rows.
    column_best, column_second : float32 (m,), column_index : int32 (m,)
        Updated; start with −∞ and −1.
    """
    rows, columns = scores.shape
    best = np.empty(LANES, np.float32)
    second = np.empty(LANES, np.float32)
    index = np.empty(LANES, np.int32)
    whole = columns // LANES * LANES
    for i in range(rows):
        row = first_row + i
        best[:] = -np.inf
        second[:] = -np.inf
        index[:] = -1
        for start in range(0, whole, LANES):
            tile = scores[i, start : start + LANES]
            c_best = column_best[start : start + LANES]
            c_second = column_second[start : start + LANES]
            c_index = column_index[start : start + LANES]
            for lane in range(LANES):
                value = tile[lane]
                known = best[lane]
                second[lane] = max(second[lane], min(known, value))
                index[lane] = start + lane if value > known else index[lane]
                best[lane] = max(known, value)
                known = c_best[lane]
                c_second[lane] = max(c_second[lane], min(known, value))
                c_index[lane] = row if value > known else c_index[lane]
                c_best[lane] = max(known, value)
        r_best = np.float32(-np.inf)
        r_second = np.float32(-np.inf)
        r_index = -1
        for lane in range(LANES):
            if best[lane] > r_best or (best[lane] == r_best and index[lane] < r_index):
                r_second = max(r_best, second[lane])
                r_best = best[lane]
                r_index = index[lane]
            else:
                r_second = max(r_second, best[lane])
        for j in range(whole, columns):
            value = scores[i, j]
            if value > r_best:
                r_second = r_best
                r_best = value
                r_index = j
            elif value > r_second:
                r_second = value
            if value > column_best[j]:
                column_second[j] = column_best[j]
                column_best[j] = value
                column_index[j] = row
            elif value > column_second[j]:
                column_second[j] = value
        row_best[row] = r_best
        row_second[row] = r_second
        row_index[row] = r_index
