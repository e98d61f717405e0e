"""Matching cost of a photo and its neighbours along inverse depth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.dense.kernels import sweep_band
from graphos_core.dense.undistort import OUTSIDE, View
from graphos_core.run import Run

BAND = 24
"""Rows of one compiled call."""


@dataclass(frozen=True)
class Sweep:
    """The hypotheses of every pixel: ``surface + (first + k)·step`` for k = 0 … count − 1.

    Attributes
    ----------
    surface : float32 (h, w)
        Inverse depth, 1 / block unit.
    first, count : int
    step : float
        Inverse depth, 1 / block unit.
    """

    surface: Array
    first: int
    count: int
    step: float

    @property
    def starts(self) -> Array:
        """Where the range of each pixel starts, in steps; float32 (h, w)."""
        return (self.surface / np.float32(self.step)).astype(np.float32)


def transfer(reference: View, other: View) -> tuple[Array, Array]:
    """Return A (3, 3) and b (3,): the pixel of `other` is ``A (x, y, 1) + w b`` for inverse depth w."""
    turn = other.rotation @ reference.rotation.T
    return other.matrix @ turn @ np.linalg.inv(reference.matrix), other.matrix @ other.rotation @ (
        reference.centre - other.centre
    )


def parallax_per_inverse_depth(reference: View, other: View, inverse_depth: float) -> float:
    """Return how far (px of `other`) a point moves per unit of inverse depth, median over a grid of the picture."""
    a, b = transfer(reference, other)
    h, w = reference.grey.shape
    x, y = np.meshgrid(np.linspace(0.1, 0.9, 5) * w, np.linspace(0.1, 0.9, 5) * h)
    p = np.stack([x.ravel(), y.ravel(), np.ones(x.size)]).T @ a.T + inverse_depth * b
    p = p[p[:, 2] > 1e-9]
    if len(p) == 0:
        return 0.0
    slope = (b[:2] - p[:, :2] / p[:, 2:] * b[2]) / p[:, 2:]
    return float(np.median(np.hypot(slope[:, 0], slope[:, 1])))


def matching_cost(
    reference: View,
    others: Sequence[View],
    sweep: Sweep,
    *,
    window: int,
    noise: float,
    census: bool,
    run: Run,
) -> Array:
    """Return the matching cost of every pixel and hypothesis.

    The score of a hypothesis is the mean of the better half of its scores with the neighbours: ZNCC over a window,
    or census agreement. The window follows the sweep surface, so slanted surfaces are not seen as steps.

    Parameters
    ----------
    reference : View
    others : sequence of View
    sweep : Sweep
    window : int
        Side of the window, px, odd.
    noise : float
        Image noise, grey levels, standard deviation: ZNCC adds its square to the variances, census takes smaller
        differences as equal.
    census : bool
        Census instead of ZNCC.
    run : Run

    Returns
    -------
    uint16 (h, w, count)
        ``1000·(1 − max(score, 0))``; 1000 where no neighbour shows the point.
    """
    r = window // 2
    grey = reference.grey
    centred = grey.astype(np.float32) - np.float32(128.0)
    mean = cv2.boxFilter(centred, cv2.CV_32F, (window, window))
    square = cv2.boxFilter(centred * centred, cv2.CV_32F, (window, window))
    inverse = (1.0 / np.sqrt(np.maximum(square - mean * mean, 0.0) + np.float32(noise**2))).astype(np.float32)
    hidden = cv2.dilate((grey == OUTSIDE).astype(np.uint8), np.ones((window, window), np.uint8))
    inverse[hidden > 0] = 0.0
    images, sizes = _stack([other.grey for other in others])
    pairs = [transfer(reference, other) for other in others]
    a, b = np.stack([p[0] for p in pairs]), np.stack([p[1] for p in pairs])
    height, width = grey.shape
    cost = np.empty((height, width, sweep.count), np.uint16)
    for top in range(0, height, BAND):
        run.check()
        sweep_band(
            centred, mean, inverse, images, sizes, a, b, sweep.surface, sweep.first, sweep.step, r,
            noise**2, census, top, min(top + BAND, height), cost,
        )  # fmt: skip
    return cost


def _stack(pictures: Sequence[Array]) -> tuple[Array, Array]:
    """Return the pictures padded to one size, uint8 (n, H, W), and their sizes, int64 (n, 2)."""
    sizes = np.array([p.shape for p in pictures], dtype=np.int64)
    out = np.full((len(pictures), *sizes.max(axis=0)), OUTSIDE, np.uint8)
    for i, picture in enumerate(pictures):
        out[i, : picture.shape[0], : picture.shape[1]] = picture
    return out, sizes
