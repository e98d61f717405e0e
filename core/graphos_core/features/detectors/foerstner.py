r"""Förstner points: corners and centres of circular features with the precision they can be measured with."""

from __future__ import annotations

from typing import Annotated, Literal

import cv2
import numpy as np

from graphos_core.data import Array, Features
from graphos_core.features.detectors.corner_kernels import intersections
from graphos_core.features.detectors.corner_params import CornerParams
from graphos_core.features.detectors.corners import Corners, corner_features, strongest
from graphos_core.features.detectors.harris import differences, structure
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/foerstner"


class FoerstnerParams(CornerParams):
    """Parameters of Förstner points."""

    weight: Annotated[
        float,
        About(
            label="Least weight",
            symbol="f_w",
            low=0.0,
            high=20.0,
            step=0.1,
            help="The weight w of a window must be at least this many times the mean weight of its level.",
            effect="Higher: only points that can be measured precisely. Lower: more points, less precise ones.",
            learn=LESSON,
            level="novice",
        ),
    ] = 0.5
    roundness: Annotated[
        float,
        About(
            label="Least roundness",
            symbol="q_{min}",
            low=0.0,
            high=1.0,
            step=0.05,
            help="Roundness q of the error ellipse: 1 is a circle, 0 an edge, along which a point slides.",
            effect="Higher: only points equally precise in all directions. Lower: points on edges come in.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.5
    window: Annotated[
        float,
        About(
            label="Window",
            symbol=r"\sigma_w",
            unit="px",
            low=0.5,
            high=10.0,
            step=0.1,
            help="Standard deviation of the Gaussian window over which products of the gradient are summed.",
            effect="Higher: more pixels determine a position, structure nearby disturbs it. Lower: finer points.",
            learn=LESSON,
            level="student",
        ),
    ] = 1.5
    kind: Annotated[
        Literal["best", "corner", "circle"],
        About(
            label="Position",
            help="What a window is taken for: crossing of edges, centre of a circular feature, or what fits better.",
            effect="Best: blobs get their centre, corners their tip.",
            choices={
                "best": "whichever fits better",
                "corner": "corner",
                "circle": "centre of a circle",
            },
            learn=LESSON,
            level="student",
        ),
    ] = "best"


@algorithm(
    stage="features",
    role="detector",
    name="foerstner",
    label="Förstner points",
    source="Förstner and Gülch 1987, A fast operator for detection and precise location of distinct points, corners "
    "and centres of circular features; SIFT descriptor: Lowe 2004, section 6",
    learn=LESSON,
)
def foerstner(
    grey: Array, colour: Array, params: FoerstnerParams, *, run: Run, mask: Array | None = None
) -> Features:
    """Find windows of large weight and roundness, and the point in each by least squares.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : FoerstnerParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        The response is w. Descriptors uint8 (n, 128).
    """
    return corner_features(
        grey, colour, params, lambda levels: [_points(level, params) for level in levels], run, mask
    )


def weight_and_roundness(right: Array, down: Array, window: float) -> tuple[Array, Array]:
    r"""Return ``w = det N / tr N`` and ``q = 4 det N / (tr N)²`` of the normal matrix N, float32 (h, w).

    N sums the products of the gradient over a window. Its inverse is the cofactor matrix of the window's position: w
    is the inverse of that ellipse's mean squared axes, q tells how round it is (Förstner and Gülch 1987, section 3).

    Parameters
    ----------
    right, down : float32 (h, w)
        Gradient.
    window : float
        Standard deviation of the Gaussian window, px.
    """
    xx, xy, yy = structure(right, down, window)
    trace = xx + yy
    determinant = np.maximum(xx * yy - xy * xy, np.float32(0.0))
    safe = np.maximum(trace, np.float32(1e-12))
    return determinant / safe, np.float32(4.0) * determinant / (safe * safe)


def _points(level: Array, params: FoerstnerParams) -> Corners:
    right, down = differences(level)
    w, q = weight_and_roundness(right, down, params.window)
    least = params.weight * float(w.mean(dtype=np.float64))
    good = np.where(q >= params.roundness, w, np.float32(0.0))
    start, strength = strongest(good, params.radius, max(least, 1e-9))
    columns, rows = np.rint(start).astype(np.int64).T
    xy, fits = precise_positions(right, down, rows, columns, params.window, params.kind)
    return xy[fits], strength[fits]


def precise_positions(
    right: Array, down: Array, rows: Array, columns: Array, window: float, kind: str = "best"
) -> tuple[Array, Array]:
    """Return the points of windows by least squares, float64 (n, 2), and which of them lie in their window.

    A corner is nearest to all tangents of the edges in the window, a circle's centre to all normals; of the two the
    one with the smaller sum of squared residuals is taken with ``kind="best"``. A point more than 2 σ of the
    window from its middle does not belong to it.

    Parameters
    ----------
    right, down : float32 (h, w)
        Gradient.
    rows, columns : int (n,)
        Middles of the windows.
    window : float
        Standard deviation of the Gaussian window, px.
    kind : {"best", "corner", "circle"}
    """
    radius = max(1, round(3.0 * window))
    one = cv2.getGaussianKernel(2 * radius + 1, window)
    found = intersections(right, down, rows, columns, np.ascontiguousarray(one @ one.T))
    circle = found[:, 5] < found[:, 4] if kind == "best" else np.full(len(found), kind == "circle")
    shift = np.where(circle[:, None], found[:, 2:4], found[:, :2])
    inside = np.isfinite(shift).all(axis=1) & (np.hypot(*shift.T) <= 2.0 * window)
    return np.stack([columns, rows], axis=1) + shift, inside
