"""Contextual self-dissimilarity: how different a patch is from those around it, over a pyramid of images.

Source: Tombari and Di Stefano 2014, Interest points via maximal self-dissimilarities; what the paper leaves open
follows its authors' implementation in OpenCV (``xfeatures2d::MSDDetector``), against which the tests compare.
"""

from __future__ import annotations

import math

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.features.detectors.msd_kernels import nearest_distance_sums

FARTHEST_REFINEMENT = 5.0
"""A maximum whose fitted paraboloid peaks farther away, in px of its level, is dropped."""

DIRECTIONS = 36
"""Patches on the circle of the search radius that give the orientation."""


def pyramid(grey: Array, factor: float, levels: int) -> list[Array]:
    """Return the photo and its reductions by the powers of a factor, each made from the photo by area averages.

    Parameters
    ----------
    grey : uint8 (h, w)
    factor : float
        Above 1.
    levels : int
        Levels wanted, at least 1.
    """
    made = [grey]
    for level in range(1, levels):
        scale = np.float32(1.0) / np.float32(factor) ** np.float32(level)
        size = (round(float(grey.shape[1] * scale)), round(float(grey.shape[0] * scale)))
        if min(size) < 1:
            break
        made.append(cv2.resize(grey, size, interpolation=cv2.INTER_AREA))
    return made


def possible_levels(shape: tuple[int, ...], patch: int, search: int, factor: float) -> int:
    """Return how many levels are at least as high and wide as a patch with its search area; 0 where none is."""
    side = 2 * (patch + search) + 1
    return max(0, math.floor(math.log(max(min(shape[:2]), 1) / side) / math.log(factor)))


def saliency(image: Array, patch: int, search: int, neighbours: int) -> Array:
    """Return the self-dissimilarity of every pixel: the mean of the k smallest patch distances.

    A distance is the mean squared difference of the grey values of two patches, as many as its pixels; the formula is
    ``λ = 1/k Σ δᵢ`` (Tombari and Di Stefano 2014, equation 3).

    Parameters
    ----------
    image : uint8 (h, w)
    patch, search : int
        Radii of the patches and of the search area, px.
    neighbours : int
        k.

    Returns
    -------
    float32 (h, w)
        Squared grey values; zero within `patch` + `search` of the border.
    """
    sums = nearest_distance_sums(image.astype(np.float32), patch, search, neighbours)
    return sums / np.float32(neighbours * (2 * patch + 1) ** 2)


def nearest_patches(
    image: Array, x: int, y: int, patch: int, search: int, neighbours: int
) -> tuple[Array, Array]:
    """Return the patches most similar to that of one pixel.

    Parameters
    ----------
    image : uint8 (h, w)
        A level of the pyramid.
    x, y : int
        Pixel, at least `patch` + `search` from the border.
    patch, search, neighbours : int
        As in `saliency`.

    Returns
    -------
    shift : int (k, 2)
        From the pixel to the centres of the k nearest patches, x and y, px, nearest first.
    distance : float64 (k,)
        Mean squared differences; their mean is the saliency.
    """
    reach = patch + search
    window = image[y - reach : y + reach + 1, x - reach : x + reach + 1].astype(np.float64)
    side = 2 * patch + 1
    patches = np.lib.stride_tricks.sliding_window_view(window, (side, side))
    distance = ((patches - patches[search, search]) ** 2).mean(axis=(2, 3))
    distance[search, search] = np.inf
    order = np.argsort(distance.ravel(), kind="stable")[:neighbours]
    shift = np.stack([order % (2 * search + 1), order // (2 * search + 1)], axis=1) - search
    return shift, distance.ravel()[order]


def maxima(
    levels: list[Array], level: int, threshold: float, radius: int, scale_radius: int, factor: float
) -> Array:
    """Return the pixels of one level that no neighbour in place or scale exceeds.

    Parameters
    ----------
    levels : list of float32 (h_l, w_l)
        Saliency of all levels.
    level : int
    threshold : float
        Only pixels above it.
    radius : int
        Of the square neighbourhood, px of the level.
    scale_radius : int
        Levels compared to either side, each at the pixel that lies at the same place.
    factor : float
        Between levels.

    Returns
    -------
    int (n, 2)
        Column and row, sorted by row, then column.
    """
    own = levels[level]
    largest = cv2.dilate(own, np.ones((2 * radius + 1, 2 * radius + 1), np.uint8))
    rows, columns = np.nonzero((own > threshold) & (own >= largest))
    for other in range(max(0, level - scale_radius), min(len(levels), level + scale_radius + 1)):
        if other == level or len(rows) == 0:
            continue
        to_other = factor ** (level - other)
        r = np.clip(np.rint(rows * to_other).astype(np.intp), 0, levels[other].shape[0] - 1)
        c = np.clip(np.rint(columns * to_other).astype(np.intp), 0, levels[other].shape[1] - 1)
        stays = own[rows, columns] >= levels[other][r, c]
        rows, columns = rows[stays], columns[stays]
    return np.stack([columns, rows], axis=1)


def refined(own: Array, pixels: Array) -> tuple[Array, Array]:
    """Return maxima to a fraction of a pixel: the peak of the second-order Taylor polynomial of the saliency.

    Parameters
    ----------
    own : float32 (h, w)
        Saliency of the level.
    pixels : int (n, 2)
        Column and row of the maxima, not on the border.

    Returns
    -------
    float64 (n, 2), bool (n,)
        Positions in the level, px; whether the peak lies within `FARTHEST_REFINEMENT` of the pixel. Where the
        polynomial has none, the pixel itself.
    """
    c, r = pixels[:, 0], pixels[:, 1]
    value = own.astype(np.float64)
    dx, dy = (value[r, c + 1] - value[r, c - 1]) / 2, (value[r + 1, c] - value[r - 1, c]) / 2
    dxx = value[r, c + 1] + value[r, c - 1] - 2 * value[r, c]
    dyy = value[r + 1, c] + value[r - 1, c] - 2 * value[r, c]
    dxy = (value[r + 1, c + 1] - value[r + 1, c - 1] - value[r - 1, c + 1] + value[r - 1, c - 1]) / 4
    determinant = dxx * dyy - dxy * dxy
    safe = np.where(determinant == 0.0, np.inf, determinant)
    shift = np.stack([dxy * dy - dyy * dx, dxy * dx - dxx * dy], axis=1) / safe[:, None]
    return pixels + shift, np.abs(shift).max(axis=1, initial=0.0) <= FARTHEST_REFINEMENT


def circle_directions(image: Array, pixels: Array, patch: int, search: int) -> Array:
    """Return the direction in which each pixel's surroundings are most like it.

    36 patches with centres on the circle of the search radius are compared with the pixel's own; each adds, between 0
    for the least similar and 1 for the most similar one, to the bin of its direction and, by half of it, to both
    neighbours. The highest bin, refined by a parabola, is the direction (Tombari and Di Stefano 2014, section 3).

    Parameters
    ----------
    image : uint8 (h, w)
        Level of the pyramid.
    pixels : int (n, 2)
        Column and row, at least `patch` + `search` from the border.
    patch, search : int
        Radii, px.

    Returns
    -------
    float64 (n,)
        Radians from x towards y, −π to π; 0 where all patches are alike.
    """
    turn = 2 * math.pi / DIRECTIONS
    around = np.arange(DIRECTIONS) * turn
    offsets = np.rint(search * np.stack([np.cos(around), np.sin(around)], axis=1)).astype(int)
    value = image.astype(np.float32)
    distance = np.zeros((len(pixels), DIRECTIONS))
    for v in range(-patch, patch + 1):
        for u in range(-patch, patch + 1):
            c, r = pixels[:, :1] + u, pixels[:, 1:] + v
            distance += (value[r + offsets[:, 1], c + offsets[:, 0]] - value[r, c]) ** 2
    low, high = distance.min(axis=1, keepdims=True), distance.max(axis=1, keepdims=True)
    alike = (high == low)[:, 0]
    weight = (high - distance) / np.where(high == low, 1.0, high - low)
    histogram = weight / 2 + (np.roll(weight, 1, axis=1) + np.roll(weight, -1, axis=1)) / 4
    best = histogram.argmax(axis=1)
    every = np.arange(len(pixels))
    before, peak, after = (histogram[every, (best + step) % DIRECTIONS] for step in (-1, 0, 1))
    curvature = before - 2 * peak + after
    angle = (best + 0.5 * (before - after) / np.where(curvature == 0.0, -1.0, curvature)) * turn
    return np.where(alike, 0.0, (angle + math.pi) % (2 * math.pi) - math.pi)
