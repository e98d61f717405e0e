r"""Harris corners: places where the photo changes in every direction, described by SIFT."""

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

LESSON = "features/harris"


class HarrisParams(CornerParams):
    """Parameters of Harris corners."""

    threshold: Annotated[
        float,
        About(
            label="Least response",
            symbol="t",
            low=0.0,
            high=0.5,
            step=0.001,
            help="A corner must have at least this share of the response of the photo's strongest one.",
            effect="Higher: only corners of strong contrast. Lower: more corners, also weak ones.",
            learn=LESSON,
            level="novice",
        ),
    ] = 0.0005
    k: Annotated[
        float,
        About(
            label="Edge weight",
            symbol="k",
            low=0.0,
            high=0.24,
            step=0.01,
            help="How much the trace counts against the determinant in R = det − k·trace².",
            effect="Higher: only corners whose two directions are alike. Lower: points on edges come in.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.04
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
            effect="Higher: larger, smoother corners, fewer and less affected by noise. Lower: finer ones.",
            learn=LESSON,
            level="student",
        ),
    ] = 1.5


@algorithm(
    stage="features",
    role="detector",
    name="harris",
    label="Harris corners",
    source="Harris and Stephens 1988, A combined corner and edge detector; SIFT descriptor: Lowe 2004, section 6",
    learn=LESSON,
)
def harris(
    grey: Array, colour: Array, params: HarrisParams, *, run: Run, mask: Array | None = None
) -> Features:
    """Find the local maxima of Harris and Stephens' response on several sizes of the photo.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : HarrisParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Descriptors uint8 (n, 128).
    """

    def seek(levels: list[Array]) -> list[Corners]:
        found = [harris_response(level, params.k, params.window) for level in levels]
        least = params.threshold * max(float(r.max()) for r in found)
        return [strongest(r, params.radius, max(least, 0.0)) for r in found]

    return corner_features(grey, colour, params, seek, run, mask)


def harris_response(grey: Array, k: float, window: float) -> Array:
    r"""Return ``R = det M − k (tr M)²`` of the autocorrelation matrix M, float32 (h, w).

    ``M = [A C; C B]`` with ``A = G * I_x²``, ``B = G * I_y²``, ``C = G * I_x I_y``; derivatives by the mask (−1, 0, 1),
    G a Gaussian window (Harris and Stephens 1988, equations 5 to 11). Grey values count from 0 to 1.

    Parameters
    ----------
    grey : uint8 (h, w)
    k : float
    window : float
        Standard deviation of G, px.
    """
    xx, xy, yy = structure(*differences(grey), window)
    return np.asarray(xx * yy - xy * xy - np.float32(k) * (xx + yy) ** 2)


def differences(grey: Array) -> tuple[Array, Array]:
    """Return the derivatives to the right and down by the mask (−1, 0, 1), float32 (h, w), grey from 0 to 1."""
    image = grey.astype(np.float32) / np.float32(255.0)
    mask = np.array([[-1.0, 0.0, 1.0]], np.float32)
    border = cv2.BORDER_REPLICATE
    return cv2.filter2D(image, -1, mask, borderType=border), cv2.filter2D(
        image, -1, mask.T, borderType=border
    )


def structure(right: Array, down: Array, window: float) -> tuple[Array, Array, Array]:
    """Return the products of the gradient, summed under a Gaussian window of standard deviation `window`, px."""
    xx, xy, yy = (
        cv2.GaussianBlur(product, (0, 0), window, borderType=cv2.BORDER_REPLICATE)
        for product in (right * right, right * down, down * down)
    )
    return xx, xy, yy
