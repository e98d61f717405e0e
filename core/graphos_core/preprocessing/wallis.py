r"""Wallis filter: every neighbourhood gets nearly the same brightness and contrast."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.grey import luma, stretch_range
from graphos_core.preprocessing.kernels import statistics_rows, wallis_rows
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/wallis"


class WallisParams(Params):
    """Parameters of the Wallis filter."""

    target_mean: Annotated[
        float,
        About(
            label="Target mean",
            symbol="m_t",
            unit="grey level",
            low=0,
            high=255,
            step=1,
            help="Brightness every neighbourhood is pulled towards.",
            effect="Higher: brighter image. Lower: darker image.",
            learn=LESSON,
            level="novice",
        ),
    ] = 127.0
    target_std: Annotated[
        float,
        About(
            label="Target standard deviation",
            symbol="s_t",
            unit="grey level",
            low=1,
            high=127,
            step=1,
            help="Contrast every neighbourhood is pulled towards.",
            effect="Higher: more contrast, until grey values are cut off at 0 and 255. Lower: flatter image.",
            learn=LESSON,
            level="novice",
        ),
    ] = 60.0
    window: Annotated[
        int,
        About(
            label="Window",
            symbol="w",
            unit="px",
            low=3,
            high=501,
            step=2,
            help="Side of the square neighbourhood; an even number is rounded up to the next odd one.",
            effect="Higher: only slow changes of brightness are levelled. Lower: fine texture is lifted, and noise.",
            learn=LESSON,
            level="novice",
        ),
    ] = 41
    contrast: Annotated[
        float,
        About(
            label="Contrast weight",
            symbol="c",
            low=0.0,
            high=1.0,
            step=0.05,
            help="How far the contrast is pulled to its target.",
            effect="Higher: all neighbourhoods get the target contrast, empty ones show their noise. "
            "Lower: weak contrast is lifted less; 0 leaves the local mean only.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.8
    brightness: Annotated[
        float,
        About(
            label="Brightness weight",
            symbol="b",
            low=0.0,
            high=1.0,
            step=0.05,
            help="How far the brightness is pulled to its target.",
            effect="Higher: light and shadow are levelled. Lower: the brightness of the photo stays.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.9


@algorithm(
    stage="preprocessing",
    role="filter",
    name="wallis",
    label="Wallis filter",
    source="Wallis 1976, An approach to the space variant restoration and enhancement of images; "
    "in the form of Baltsavias 1991, Multiphoto geometrically constrained matching",
    learn=LESSON,
)
def wallis(image: Array, params: WallisParams, *, run: Run) -> Array:
    r"""Pull the mean and the standard deviation of every neighbourhood towards target values.

    With the mean m and standard deviation s of the window round a pixel of grey value g

    .. math::
        g' = r_1\,(g - m) + b\,m_t + (1 - b)\,m,\qquad
        r_1 = \frac{c\,s_t}{c\,s + (1 - c)\,s_t}

    For c = b = 1 the window gets exactly m_t and s_t; for c = ½ the gain is s_t / (s + s_t). The gain of a window
    without contrast is limited to s_t (as for s = 1 grey level). Colour is made grey first; 16 bit is scaled, not
    rounded, to 0 … 255 before; the image is mirrored at its border.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : WallisParams
    run : Run

    Returns
    -------
    uint8 (h, w)
    """
    grey, low, scale = _levels(image)
    rows, columns = _mirrored(grey.shape, params.window)
    targets = np.array(
        [params.target_mean, params.target_std, params.contrast, params.brightness], dtype=np.float32
    )
    return wallis_rows(grey, rows, columns, low, scale, targets)


def local_statistics(image: Array, window: int) -> tuple[Array, Array]:
    """Return the mean and the standard deviation of the window round every pixel, as the filter uses them.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    window : int
        Side, px; made odd.

    Returns
    -------
    mean, std : float32 (h, w)
        Grey levels; the variance is that of the window's pixels (divided by their number).
    """
    grey, low, scale = _levels(image)
    mean, variance = statistics_rows(grey, *_mirrored(grey.shape, window), low, scale)
    return mean, np.sqrt(np.maximum(variance, 0.0))


def _levels(image: Array) -> tuple[Array, np.float32, np.float32]:
    """Grey image with the low and scale of ``level = (value − low) · scale``."""
    grey = np.ascontiguousarray(luma(image))
    if grey.dtype == np.uint8:
        return grey, np.float32(0.0), np.float32(1.0)
    low, high = stretch_range(grey)
    return grey, np.float32(low), np.float32(255.0 / (high - low))


def _mirrored(shape: tuple[int, ...], window: int) -> tuple[Array, Array]:
    """For rows and columns, the indices of the image continued by mirroring about the edge pixels."""
    half = window // 2
    found = []
    for length in shape:
        period = max(1, 2 * (length - 1))
        steps = np.abs(np.arange(-half, length + half + 1)) % period
        found.append(np.minimum(steps, period - steps) if length > 1 else np.zeros_like(steps))
    return found[0], found[1]
