"""From an interest value to features: levels of the photo, local maxima, fractions of a pixel, descriptors."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from graphos_core.data import Array, Features
from graphos_core.features.detectors.assembling import FoundPoints, assemble, working_image
from graphos_core.features.detectors.corner_kernels import local_maxima
from graphos_core.features.detectors.corner_params import CornerParams
from graphos_core.features.detectors.sift import hellinger
from graphos_core.features.detectors.sift_description import CELLS_ACROSS, sift_descriptors, sift_directions
from graphos_core.run import Run

LEAST_LEVEL = 24
"""A level whose shorter side would have fewer pixels is left out."""

Corners = tuple[Array, Array]
"""Positions float64 (n, 2), px of the level, and interest values float64 (n,)."""

Described = tuple[Array, Array, Array, Array, Array]
"""Position, diameter, angle, strength and descriptor of points, px of the working image, as in `FoundPoints`."""

Seeker = Callable[[list[Array]], list[Corners]]
"""Finds the corners of all levels, each uint8 (h, w)."""


def corner_features(
    grey: Array, colour: Array, params: CornerParams, seek: Seeker, run: Run, mask: Array | None
) -> Features:
    """Find corners on every level, describe each by SIFT and return them as features of the photo.

    On all levels a corner is found and described with the same number of pixels, so on a level reduced by s it stands
    for a region s times as large. Corners of different levels at one place all stay, as in Rublee et al. 2011.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
    params : CornerParams
    seek : callable
        The detector.
    run : Run
    mask : bool (h, w) or None
        True where points may be.
    """
    working = working_image(grey, params.reduction)
    levels = reduced_levels(working, params.levels, params.scale_factor)
    parts = []
    for level, (xy, strength) in zip(levels, seek(levels), strict=True):
        run.check()
        parts.append(_described(level, working.shape, xy, strength, params))
    return assemble(joined(parts, "l2"), working.shape, colour, params, mask)


def joined(parts: list[Described], metric: str) -> FoundPoints:
    """Return the described points of all levels together."""
    xy, scale, angle, response, descriptors = (np.concatenate(column) for column in zip(*parts, strict=True))
    return FoundPoints(xy, scale, angle, response, descriptors, metric)


def reduced_levels(working: Array, count: int, factor: float) -> list[Array]:
    """Return the working image and smaller ones, each reduced from it by ``factor**i`` with area averaging."""
    height, width = working.shape
    levels = [working]
    for i in range(1, count):
        size = (round(width / factor**i), round(height / factor**i))
        if min(size) < LEAST_LEVEL:
            break
        levels.append(cv2.resize(working, size, interpolation=cv2.INTER_AREA))
    return levels


def strongest(interest: Array, radius: int, least: float) -> Corners:
    """Return the local maxima of an interest value above `least`, with fractions of a pixel.

    A parabola through a maximum and its neighbours gives its place between the pixels, in x and in y.

    Parameters
    ----------
    interest : float32 (h, w)
    radius : int
        Everything within it, px, must be less.
    least : float
    """
    rows, columns = np.nonzero(local_maxima(interest, radius, least))
    value = interest.astype(np.float64)
    shift = []
    for rows_by, columns_by in ((0, 1), (1, 0)):
        before = value[np.maximum(rows - rows_by, 0), np.maximum(columns - columns_by, 0)]
        after = value[
            np.minimum(rows + rows_by, value.shape[0] - 1), np.minimum(columns + columns_by, value.shape[1] - 1)
        ]  # fmt: skip
        bend = before - 2.0 * value[rows, columns] + after
        shift.append(np.where(bend < 0.0, 0.5 * (before - after) / np.where(bend < 0.0, bend, 1.0), 0.0))
    xy = np.stack([columns, rows], axis=1) + np.clip(np.stack(shift, axis=1), -0.5, 0.5)
    return xy, value[rows, columns]


def _described(
    level: Array, working: tuple[int, ...], xy: Array, strength: Array, params: CornerParams
) -> Described:
    """Return position, diameter, angle, strength and descriptor of a level's corners, px of the working image."""
    sigma = params.patch / CELLS_ACROSS
    if params.upright:
        index, angle = np.arange(len(xy)), np.zeros(len(xy))
    else:
        index, angle = sift_directions(level, xy, sigma)
    descriptors = sift_descriptors(level, xy[index], angle, sigma)
    factors = np.array([working[1] / level.shape[1], working[0] / level.shape[0]])
    scale = np.full(len(index), 2.0 * sigma * np.sqrt(factors.prod()))
    return (
        (xy[index] + 0.5) * factors - 0.5, scale, angle, strength[index],
        hellinger(descriptors) if params.hellinger else descriptors,
    )  # fmt: skip
