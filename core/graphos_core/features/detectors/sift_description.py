"""The SIFT descriptor at points that another detector found, all of one size, on one image."""

from __future__ import annotations

import math

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.features.descriptor import FLAT, PEAK_SHARE
from graphos_core.features.detectors.description_kernels import gradient_directions
from graphos_core.features.detectors.scale_space import CAMERA_BLUR, layer_of

LAYERS, FIRST_BLUR = 3, 1.6

CELLS_ACROSS = 12.0
"""Side of the described square in units of σ: 4 cells of 3 σ."""


def sift_directions(grey: Array, xy: Array, sigma: float) -> tuple[Array, Array]:
    """Return the directions of points: one for every peak of the histogram of gradients (Lowe 2004, section 5).

    Parameters
    ----------
    grey : uint8 (h, w)
    xy : float64 (n, 2)
        Points, px.
    sigma : float
        Their σ, px.

    Returns
    -------
    index : int (m,)
        Point of each direction, ascending; a point without texture has none.
    angle : float64 (m,)
        Radians from x towards y, −π to π, the highest peak of a point first.
    """
    missing = math.sqrt(max(sigma**2 - CAMERA_BLUR**2, 0.01))
    blurred = cv2.GaussianBlur(grey.astype(np.float32), (0, 0), missing)
    angles = gradient_directions(blurred, np.ascontiguousarray(xy, np.float64), sigma, PEAK_SHARE, FLAT)
    index, peak = np.nonzero(np.isfinite(angles))
    return index, angles[index, peak]


def sift_descriptors(grey: Array, xy: Array, angle: Array, sigma: float) -> Array:
    """Return OpenCV's SIFT descriptors of points, uint8 (n, 128); all of them, also at the border.

    Parameters
    ----------
    grey : uint8 (h, w)
    xy : float64 (n, 2)
        Points, px.
    angle : float64 (n,)
        Their directions, radians from x towards y.
    sigma : float
        Their σ, px: the descriptor covers 4 × 4 cells of 3 σ.
    """
    if len(xy) == 0:
        return np.zeros((0, 128), np.uint8)
    octave, layer = layer_of(sigma, layers=LAYERS, sigma=FIRST_BLUR)
    packed = ((octave - 1) & 255) | (layer << 8)
    points = [
        cv2.KeyPoint(float(x), float(y), 2.0 * sigma, float(turn), 0.0, packed)
        for (x, y), turn in zip(xy, np.degrees(angle) % 360.0, strict=True)
    ]
    extractor = cv2.SIFT_create(  # type: ignore[attr-defined]
        0, LAYERS, 0.04, 10.0, FIRST_BLUR, cv2.CV_8U, True
    )
    return np.asarray(extractor.compute(grey, points)[1])
