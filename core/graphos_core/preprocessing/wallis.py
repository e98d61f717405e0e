r"""Wallis filter: every neighbourhood gets nearly the same brightness and contrast."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.grey import luma, stretch_range
from graphos_core.preprocessing.kernels import node_values, statistics_rows, wallis_nodes, wallis_rows
from graphos_core.preprocessing.parts import Place, odd_window, partwise
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
    minimum_gain: Annotated[
        float,
        About(
            label="Least gain",
            symbol="r_{min}",
            low=0.0,
            high=10.0,
            step=0.1,
            help="The contrast of a neighbourhood is multiplied by at least this.",
            effect="Higher: strong contrast is not reduced (1), or even raised. 0: it is pulled to its target.",
            learn=LESSON,
            level="expert",
        ),
    ] = 0.0
    maximum_gain: Annotated[
        float | None,
        About(
            label="Largest gain",
            symbol="r_{max}",
            low=0.1,
            high=1000.0,
            step=1.0,
            help="The contrast of a neighbourhood is multiplied by at most this; automatic: c / (1 − c), as the "
            "formula has it for a window without contrast.",
            effect="Higher: weak texture is lifted more, and noise. Lower: plain areas stay plain.",
            learn=LESSON,
            level="expert",
        ),
    ] = None
    spacing: Annotated[
        int,
        About(
            label="Grid",
            symbol="d",
            unit="px",
            low=1,
            high=500,
            step=1,
            help="Gain and shift are computed at every d-th pixel and interpolated bilinearly between; 1 is every pixel.",
            effect="Higher: as older programs work with blocks, slightly less local. 1: exact at every pixel.",
            learn=LESSON,
            level="expert",
        ),
    ] = 1


Levels = tuple[np.float32, np.float32]
"""Low and scale of ``level = (value − low) · scale``."""


def _learn(image: Array, params: WallisParams, run: Run) -> Levels:
    return _levels(luma(image))


def _apply(image: Array, params: WallisParams, levels: Levels, place: Place) -> Array:
    grey = np.ascontiguousarray(luma(image))
    rows, columns = mirrored(grey.shape, params.window)
    if params.spacing == 1 and params.minimum_gain == 0.0 and params.maximum_gain is None:
        return wallis_rows(grey, rows, columns, *levels, targets_of(params))
    return _at_nodes(grey, params, levels, place)


def _at_nodes(grey: Array, params: WallisParams, levels: Levels, place: Place) -> Array:
    mean, variance = statistics_rows(grey, *mirrored(grey.shape, params.window), *levels)
    y, first_row, row_weight = _nodes(place.top, grey.shape[0], params.spacing)
    x, first_column, column_weight = _nodes(place.left, grey.shape[1], params.spacing)
    if params.spacing > 1:
        mean, variance = mean[np.ix_(y, x)], variance[np.ix_(y, x)]
    gain, shift = node_values(mean, variance, targets_of(params))
    return wallis_nodes(grey, gain, shift, first_row, row_weight, first_column, column_weight, *levels)


def wallis_with_limits(grey: Array, levels: Levels, params: WallisParams) -> Array:
    """Filter uint8 or uint16 (h, w) with the limits of the gain kept at every pixel."""
    every = params.replace(spacing=1)
    return _at_nodes(grey, every, levels, Place.whole(grey))


def _nodes(start: int, length: int, spacing: int) -> tuple[Array, Array, Array]:
    """Pixels of a piece that are nodes, and for each pixel the node before it and the weight of the one after.

    Nodes are the multiples of the spacing in the whole photo, and the first and last pixel of the piece.
    """
    nodes = np.arange(-(-start // spacing) * spacing, start + length, spacing) - start
    nodes = np.unique(np.concatenate([[0], nodes, [length - 1]]))
    pixels = np.arange(length)
    before = np.minimum(np.searchsorted(nodes, pixels, side="right") - 1, max(len(nodes) - 2, 0))
    after = np.minimum(before + 1, len(nodes) - 1)
    span = np.maximum(nodes[after] - nodes[before], 1)
    return nodes, before, ((pixels - nodes[before]) / span).astype(np.float32)


def _margin(params: WallisParams) -> int:
    return params.window // 2 + (params.spacing if params.spacing > 1 else 0)


def _reduced(params: WallisParams, factor: float) -> WallisParams:
    spacing = max(1, round(params.spacing / factor))
    return params.replace(window=odd_window(params.window, factor), spacing=spacing)


@algorithm(
    stage="preprocessing",
    role="filter",
    name="wallis",
    label="Wallis filter",
    source="Wallis 1976, An approach to the space variant restoration and enhancement of images; "
    "in the form of Baltsavias 1991, Multiphoto geometrically constrained matching; "
    "limits of the gain: Pratt 2007, Digital Image Processing, section 10.5",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply, margin=_margin, reduced=_reduced, local=True)
def wallis(image: Array, params: WallisParams, *, run: Run) -> Array:
    r"""Pull the mean and the standard deviation of every neighbourhood towards target values.

    With the mean m and standard deviation s of the window round a pixel of grey value g

    .. math::
        g' = r_1\,(g - m) + b\,m_t + (1 - b)\,m,\qquad
        r_1 = \frac{c\,s_t}{c\,s + (1 - c)\,s_t}

    For c = b = 1 the window gets exactly m_t and s_t; for c = ½ the gain is s_t / (s + s_t). The gain of a window
    without contrast is limited to s_t (as for s = 1 grey level), to c / (1 − c) by the formula itself (the largest gain
    A of Pratt's form ``A s_t / (A s + s_t)``), and to the limits given. With a grid, r₁ and ``b m_t + (1 − b − r₁) m``
    are computed at its nodes and interpolated bilinearly, as programs do that work block by block. Colour is made grey first; 16 bit is scaled, not
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
    return _apply(image, params, _learn(image, params, run), Place.whole(image))


def targets_of(params: WallisParams) -> Array:
    """Return the filter's numbers as its kernels take them, float32 (6,)."""
    largest = np.inf if params.maximum_gain is None else params.maximum_gain
    numbers = [params.target_mean, params.target_std, params.contrast, params.brightness]
    return np.array([*numbers, params.minimum_gain, max(largest, params.minimum_gain)], dtype=np.float32)


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
    grey = np.ascontiguousarray(luma(image))
    mean, variance = statistics_rows(grey, *mirrored(grey.shape, window), *_levels(grey))
    return mean, np.sqrt(np.maximum(variance, 0.0))


def _levels(grey: Array) -> Levels:
    if grey.dtype == np.uint8:
        return np.float32(0.0), np.float32(1.0)
    low, high = stretch_range(grey)
    return np.float32(low), np.float32(255.0 / (high - low))


def mirrored(shape: tuple[int, ...], window: int) -> tuple[Array, Array]:
    """For rows and columns, the indices of the image continued by mirroring about the edge pixels."""
    half = window // 2
    found = []
    for length in shape:
        period = max(1, 2 * (length - 1))
        steps = np.abs(np.arange(-half, length + half + 1)) % period
        found.append(np.minimum(steps, period - steps) if length > 1 else np.zeros_like(steps))
    return found[0], found[1]
