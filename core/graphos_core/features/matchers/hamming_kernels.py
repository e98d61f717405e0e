"""Numbers of differing bits, counted by the processor's own instruction."""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

from graphos_core.data import Array


@intrinsic
def ones_in(context: Any, word: Any) -> Any:
    """Return the number of ones of an unsigned whole number of 32 bits."""

    def generate(_: Any, builder: ir.IRBuilder, __: Any, arguments: Any) -> Any:
        return builder.ctpop(arguments[0])

    return types.uint32(types.uint32), generate


@njit(cache=True, nogil=True)
def half_squares(a: Array, b_columns: Array, scores: Array) -> None:
    """Write −½ h² of the Hamming distance h of each row of `a` to each column of `b_columns`.

    Parameters
    ----------
    a : uint32 (t, w)
        Descriptors in words.
    b_columns : uint32 (w, m)
        The others, one per column.
    scores : float32 (t, m)
        Written. Exact, since h² of up to 4096 bits is below 2²⁴.
    """
    rows, words = a.shape
    columns = b_columns.shape[1]
    different = np.empty(columns, np.uint32)
    for i in range(rows):
        different[:] = 0
        for w in range(words):
            mine = a[i, w]
            theirs = b_columns[w]
            for j in range(columns):
                different[j] += ones_in(mine ^ theirs[j])
        for j in range(columns):
            h = np.float32(different[j])
            scores[i, j] = np.float32(-0.5) * h * h
