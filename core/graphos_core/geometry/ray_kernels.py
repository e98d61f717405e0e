"""Compiled frames of the rays of wide cameras; used by `graphos_core.geometry.rays` only."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.cameras.kernels import project
from graphos_core.data.record import Array


@njit(cache=True, nogil=True)
def wide_frames(code: int, values: Array, directions: Array) -> Array:
    """Return ``[∂x/∂d; dᵀ]`` (n, 3, 3) for unit directions (n, 3); NaN where there is no image."""
    n = directions.shape[0]
    out = np.full((n, 3, 3), np.nan)
    pixel = np.empty(2)
    d_point = np.empty((2, 3))
    d_values = np.empty((2, values.shape[0]))
    for i in range(n):
        x = directions[i, 0]
        y = directions[i, 1]
        z = directions[i, 2]
        if not np.isfinite(x + y + z):
            continue
        if project(code, values, x, y, z, pixel, d_point, d_values):
            for k in range(3):
                out[i, 0, k] = d_point[0, k]
                out[i, 1, k] = d_point[1, k]
                out[i, 2, k] = directions[i, k]
    return out
