"""Putting a new luminance into a colour image without touching the hue."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data import Array


@njit(cache=True, nogil=True)
def with_luminance(image: Array, old: Array, new: Array) -> Array:
    """Return the image with luminance `new`, the differences of the channels kept or shrunk alike.

    Each channel becomes ``new + k·(channel − old)``, with k = 1 where that fits into 0 … 255 and the largest k that
    fits elsewhere: the differences between the channels keep their ratios, hence hue stays, colour pales at most.

    Parameters
    ----------
    image : uint8 (h, w, 3) RGB
    old, new : uint8 (h, w)
    """
    height, width, _ = image.shape
    out = np.empty_like(image)
    for i in range(height):
        for j in range(width):
            level = np.float32(new[i, j])
            k = np.float32(1.0)
            for c in range(3):
                apart = np.float32(image[i, j, c]) - np.float32(old[i, j])
                if apart * k > np.float32(255.0) - level:
                    k = (np.float32(255.0) - level) / apart
                elif apart * k < -level:
                    k = -level / apart
            for c in range(3):
                apart = np.float32(image[i, j, c]) - np.float32(old[i, j])
                value = level + k * apart + np.float32(0.5)
                out[i, j, c] = np.uint8(min(max(value, np.float32(0.0)), np.float32(255.0)))
    return out


@njit(cache=True, nogil=True)
def interpolate_tables(
    image: Array, tables: Array, left: int, top: int, tile_width: int, tile_height: int
) -> Array:
    """Map grey values by tables that belong to the middles of tiles, bilinearly between them.

    Parameters
    ----------
    image : uint8 (h, w)
        A piece whose first pixel is (left, top) of the whole.
    tables : uint8 (rows, columns, 256)
    """
    height, width = image.shape
    rows, columns, _ = tables.shape
    out = np.empty((height, width), np.uint8)
    one = np.float32(1.0)
    for i in range(height):
        y = np.float32(i + top) / np.float32(tile_height) - np.float32(0.5)
        y0 = int(np.floor(y))
        wy = y - np.float32(y0)
        upper = min(max(y0, 0), rows - 1)
        lower = min(max(y0 + 1, 0), rows - 1)
        for j in range(width):
            x = np.float32(j + left) / np.float32(tile_width) - np.float32(0.5)
            x0 = int(np.floor(x))
            wx = x - np.float32(x0)
            first = min(max(x0, 0), columns - 1)
            second = min(max(x0 + 1, 0), columns - 1)
            g = image[i, j]
            above = tables[upper, first, g] * (one - wx) + tables[upper, second, g] * wx
            below = tables[lower, first, g] * (one - wx) + tables[lower, second, g] * wx
            out[i, j] = np.uint8(above * (one - wy) + below * wy + np.float32(0.5))
    return out
