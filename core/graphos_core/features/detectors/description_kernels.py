"""Directions of given points: peaks of the histogram of gradients, and the centroid of grey values."""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

from graphos_core.data import Array

BINS = 36
MOST = 4
"""Directions that one point can have at most."""


@njit(cache=True, nogil=True, parallel=True)
def gradient_directions(image: Array, xy: Array, sigma: float, share: float, least: float) -> Array:
    """Return the directions of the peaks of each point's histogram of gradients, highest first.

    The histogram is that of `graphos_core.features.descriptor.orientation_histogram`; this is its twin for many
    points of one image.

    Parameters
    ----------
    image : float32 (h, w)
        Grey 0 to 255, blurred as much as `sigma` says.
    xy : float64 (n, 2)
        Points, px of the image.
    sigma : float
        Their σ, px of the image.
    share : float
        A peak must have at least this share of the highest.
    least : float
        Histograms of less have no direction.

    Returns
    -------
    float64 (n, 4)
        Radians from x towards y, −π to π; NaN after the last.
    """
    height, width = image.shape
    window = 1.5 * sigma
    radius = int(np.rint(3.0 * window))
    found = np.full((len(xy), MOST), np.nan)
    for i in prange(len(xy)):
        raw = np.zeros(BINS)
        column, row = int(np.rint(xy[i, 0])), int(np.rint(xy[i, 1]))
        for y in range(max(1, row - radius), min(height - 1, row + radius + 1)):
            for x in range(max(1, column - radius), min(width - 1, column + radius + 1)):
                right = np.float64(image[y, x + 1]) - np.float64(image[y, x - 1])
                down = np.float64(image[y + 1, x]) - np.float64(image[y - 1, x])
                away = (x - column) ** 2 + (y - row) ** 2
                size = math.sqrt(right * right + down * down) * math.exp(-away / (2.0 * window * window))
                place = int(np.rint(math.atan2(down, right) * (BINS / (2.0 * math.pi)))) % BINS
                raw[place] += size
        smooth = np.empty(BINS)
        for b in range(BINS):
            smooth[b] = (
                6.0 * raw[b] + 4.0 * (raw[b - 1] + raw[(b + 1) % BINS]) + raw[b - 2] + raw[(b + 2) % BINS]
            ) / 16.0
        needed = max(share * smooth.max(), least)
        for k in range(MOST):
            best = -1
            for b in range(BINS):
                before, own, after = smooth[b - 1], smooth[b], smooth[(b + 1) % BINS]
                if own > before and own > after and own >= needed and (best < 0 or own > smooth[best]):
                    known = False
                    for earlier in range(k):
                        turned = abs(found[i, earlier] * (BINS / (2.0 * math.pi)) - b) % BINS
                        known = known or min(turned, BINS - turned) <= 0.5
                    if not known:
                        best = b
            if best < 0:
                break
            before, own, after = smooth[best - 1], smooth[best], smooth[(best + 1) % BINS]
            angle = (best + 0.5 * (before - after) / (before - 2.0 * own + after)) * (2.0 * math.pi / BINS)
            found[i, k] = (angle + math.pi) % (2.0 * math.pi) - math.pi
    return found


@njit(cache=True, nogil=True, parallel=True)
def centroid_directions(image: Array, xy: Array, radius: int) -> Array:
    """Return the direction from each point to the centroid of the grey values in a disc around it.

    Rosin 1999 and Rublee et al. 2011, section 3.2: ``atan2(m₀₁, m₁₀)`` with the first moments of the disc.

    Parameters
    ----------
    image : uint8 (h, w)
    xy : float64 (n, 2)
        Points, px of the image.
    radius : int
        Of the disc, px; pixels up to half a pixel farther belong to it.

    Returns
    -------
    float64 (n,)
        Radians from x towards y, −π to π.
    """
    height, width = image.shape
    found = np.empty(len(xy))
    for i in prange(len(xy)):
        column, row = int(np.rint(xy[i, 0])), int(np.rint(xy[i, 1]))
        across = down = np.int64(0)
        for v in range(-radius, radius + 1):
            half = int(math.sqrt((radius + 0.5) ** 2 - v * v))
            y = min(max(row + v, 0), height - 1)
            for u in range(-half, half + 1):
                value = np.int64(image[y, min(max(column + u, 0), width - 1)])
                across += u * value
                down += v * value
        found[i] = math.atan2(np.float64(down), np.float64(across))
    return found
