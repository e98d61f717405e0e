r"""Moravec points: windows that differ from themselves when shifted in any of four directions."""

from __future__ import annotations

from typing import Annotated

import cv2
import numpy as np

from graphos_core.data import Array, Features
from graphos_core.features.detectors.corner_params import CornerParams
from graphos_core.features.detectors.corners import Corners, corner_features, strongest
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/moravec"

DIRECTIONS = ((0, 1), (1, 0), (1, 1), (1, -1))
"""Steps in rows and columns to the neighbour: right, down and the two diagonals."""


class MoravecParams(CornerParams):
    """Parameters of Moravec points."""

    threshold: Annotated[
        float,
        About(
            label="Least interest",
            symbol="f_V",
            low=0.0,
            high=50.0,
            step=0.5,
            help="The interest value of a point must be at least this many times the mean one of its level.",
            effect="Higher: only strongly textured places. Lower: more points, also in noise.",
            learn=LESSON,
            level="novice",
        ),
    ] = 1.0
    window: Annotated[
        int,
        About(
            label="Window",
            symbol="m",
            unit="px",
            low=3,
            high=31,
            step=1,
            help="Side of the square window over which squared differences are summed; Moravec took 4 to 8.",
            effect="Higher: steadier, coarser points. Lower: finer points, more noise.",
            learn=LESSON,
            level="student",
        ),
    ] = 5


@algorithm(
    stage="features",
    role="detector",
    name="moravec",
    label="Moravec points",
    source="Moravec 1980, Obstacle avoidance and navigation in the real world by a seeing robot rover, chapter 4 "
    "(interest operator); SIFT descriptor: Lowe 2004, section 6",
    learn=LESSON,
)
def moravec(
    grey: Array, colour: Array, params: MoravecParams, *, run: Run, mask: Array | None = None
) -> Features:
    """Find the local maxima of Moravec's interest value on several sizes of the photo.

    Fractions of a pixel (a parabola through the interest values) are an addition: the published operator gives whole
    windows.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : MoravecParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Descriptors uint8 (n, 128).
    """

    def seek(levels: list[Array]) -> list[Corners]:
        found = [interest_value(level, params.window) for level in levels]
        least = [params.threshold * float(v.mean(dtype=np.float64)) for v in found]
        middle = 0.5 if params.window % 2 == 0 else 0.0
        return [
            (xy - middle, value)
            for xy, value in (strongest(v, params.radius, t) for v, t in zip(found, least, strict=True))
        ]

    return corner_features(grey, colour, params, seek, run, mask)


def interest_value(grey: Array, window: int) -> Array:
    """Return the smallest of four sums of squared differences of adjacent pixels of a window, float32 (h, w).

    The differences are taken in the horizontal, the vertical and both diagonal directions, between pixels that both
    lie in the window (Moravec 1980, chapter 4). An edge has no differences along itself: the smallest of the four is
    small there, and large only where the photo changes in every direction.

    Parameters
    ----------
    grey : uint8 (h, w)
    window : int
        Side m of the window, px; it reaches from ``m // 2`` px before a pixel to ``(m − 1) // 2`` px after it.
    """
    height, width = grey.shape
    image = cv2.copyMakeBorder(grey.astype(np.float32), 1, 1, 1, 1, cv2.BORDER_REPLICATE)
    before = window // 2
    least = np.full((height, width), np.inf, np.float32)
    for down, right in DIRECTIONS:
        there = image[1 + down : 1 + down + height, 1 + right : 1 + right + width]
        pairs = (window - abs(right), window - down)
        first = (before - (right < 0), before)  # the pair is stored at its upper pixel
        square = (image[1:-1, 1:-1] - there) ** 2
        summed = cv2.boxFilter(
            square, -1, pairs, anchor=first, normalize=False, borderType=cv2.BORDER_REPLICATE
        )
        np.minimum(least, summed, out=least)
    return least
