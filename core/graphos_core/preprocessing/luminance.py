"""Filters of brightness on colour photos: the luminance is filtered, the hue stays."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.preprocessing.grey import eight_bit, luma, stretch_range
from graphos_core.preprocessing.luminance_kernels import with_luminance

Levels = tuple[int, int] | None
"""Values of a 16-bit photo that become 0 and 255; None for 8 bit."""


def levels_of(image: Array) -> Levels:
    """Return the values of a 16-bit photo that become 0 and 255; None for 8 bit."""
    return stretch_range(image) if image.dtype == np.uint16 else None


def on_luminance(image: Array, levels: Levels, change: Callable[[Array], Array]) -> Array:
    """Change the grey values of a photo; of a colour photo the luma, with the hue kept (`with_luminance`).

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    levels : Levels
        Of the whole photo, from `levels_of`.
    change : callable
        Takes and returns uint8 (h, w).

    Returns
    -------
    uint8, of the shape of `image`
    """
    image = eight_bit(image, levels)
    if image.ndim == 2:
        return change(np.ascontiguousarray(image))
    old = luma(image)
    return with_luminance(np.ascontiguousarray(image), old, change(old))


def histogram(image: Array) -> Array:
    """Return how often each value of uint8 (h, w) occurs, int64 (256,)."""
    if image.size == 0:
        return np.zeros(256, np.int64)
    counted = cv2.calcHist([image], [0], None, [256], [0, 256]).ravel()
    return (
        np.rint(counted).astype(np.int64) if image.size < 2**24 else np.bincount(image.ravel(), minlength=256)
    )


def luma_histogram(image: Array, levels: Levels) -> Array:
    """Return the histogram of the luma of a photo, int64 (256,); arguments as in `on_luminance`."""
    return histogram(np.ascontiguousarray(luma(eight_bit(image, levels))))
