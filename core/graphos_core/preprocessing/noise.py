"""How noisy a photo is, and how its contrast is spread: what automatic choices are made of."""

from __future__ import annotations

import math

import cv2
import numpy as np

from graphos_core.data import Array

BLOCK = 16
"""Side of the blocks whose noise is measured one by one, px."""

QUIET_SHARE = 10.0
"""The noise is that of the block below which this share of the blocks lies, %: texture is no noise."""

_SECOND_DIFFERENCES = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)


def noise_level(image: Array) -> float:
    r"""Estimate the standard deviation of the noise of one photo, in its own units.

    The difference of two Laplacians N (weights 1, −2, 1; −2, 4, −2; 1, −2, 1) is blind to planes, ramps and
    straight edges along rows and columns. For white noise ``E|I * N| = 6 σ √(2/π)`` (Immerkær, eq. 3). The mean is
    taken block by block, and the block at the 10 % quantile counts, because in all others texture adds to the noise;
    saturated blocks say nothing and are passed over.

    Source: Immerkær 1996, Fast noise variance estimation, Computer Vision and Image Understanding 64(2).

    Parameters
    ----------
    image : uint8, uint16 or float32 (h, w)

    Returns
    -------
    float
        0 for photos smaller than a block.
    """
    rows, columns = image.shape[0] // BLOCK, image.shape[1] // BLOCK
    if rows == 0 or columns == 0:
        return 0.0
    values = image.astype(np.float32)
    answer = np.abs(cv2.filter2D(values, -1, _SECOND_DIFFERENCES, borderType=cv2.BORDER_REFLECT_101))
    size = (columns, rows)
    cut = (slice(0, rows * BLOCK), slice(0, columns * BLOCK))
    mean = cv2.resize(np.ascontiguousarray(answer[cut]), size, interpolation=cv2.INTER_AREA)
    low, high = float(values.min()), float(values.max())
    clipped = ((values <= low) | (values >= high)).astype(np.float32)
    share = cv2.resize(np.ascontiguousarray(clipped[cut]), size, interpolation=cv2.INTER_AREA)
    usable = mean[share < 0.05] if (share < 0.05).any() else mean.ravel()
    return float(math.sqrt(math.pi / 2) / 6.0 * np.percentile(usable, QUIET_SHARE))
