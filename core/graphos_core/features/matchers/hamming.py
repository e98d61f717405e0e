"""Nearest binary descriptors: exact, by counting the bits that differ."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array
from graphos_core.features.matchers.hamming_kernels import half_squares
from graphos_core.features.matchers.kernels import scan_rows

TILE = 64
"""Rows of the table of distances computed at a time; it stays in the cache."""

Nearest = tuple[Array, Array, Array]


def nearest_two_binary(a: Array, b: Array) -> tuple[Nearest, Nearest]:
    """Return for each row of `a` among `b`, and for each of `b` among `a`, the nearest and second nearest.

    The distance h of two binary descriptors is the number of bits in which they differ (Hamming 1950). It is
    returned as −½ h², so that the ratio test is that of descriptors of numbers. Of equally near ones the first wins.

    Parameters
    ----------
    a, b : uint8 (n, d), (m, d)
        Eight bits per byte.

    Returns
    -------
    two triples (float32 (n,), float32 (n,), int32 (n,))
        −½ h² of the nearest and of the second nearest (−∞ where there is no second), and the index of the nearest.
    """
    n, m = len(a), len(b)
    left, right = words_of(a), np.ascontiguousarray(words_of(b).T)
    row = (np.empty(n, np.float32), np.empty(n, np.float32), np.empty(n, np.int32))
    column = (
        np.full(m, -np.inf, np.float32),
        np.full(m, -np.inf, np.float32),
        np.full(m, -1, np.int32),
    )
    buffer = np.empty((min(TILE, n), m), np.float32)
    for start in range(0, n, TILE):
        tile = left[start : start + TILE]
        scores = buffer[: len(tile)]
        half_squares(tile, right, scores)
        scan_rows(scores, start, *row, *column)
    return row, column


def words_of(descriptors: Array) -> Array:
    """Return the descriptors as uint32 (n, ceil(d / 4)); missing bytes are zero in both photos and never differ."""
    n, size = descriptors.shape
    padded = np.zeros((n, -(-size // 4) * 4), np.uint8)
    padded[:, :size] = descriptors
    return padded.view(np.uint32)
