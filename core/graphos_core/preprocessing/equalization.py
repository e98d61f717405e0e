r"""Histogram equalisation: every grey value becomes the share of pixels that are darker."""

from __future__ import annotations

from typing import Annotated

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.luminance import Levels, levels_of, luma_histogram, on_luminance
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/equalization"


class EqualizationParams(Params):
    """Parameters of histogram equalisation."""

    strength: Annotated[
        float,
        About(
            label="Strength",
            symbol="a",
            low=0.0,
            high=1.0,
            step=0.05,
            help="How far grey values move to their equalised ones.",
            effect="Higher: all grey values become equally frequent. Lower: nearer to the photo; 0 changes nothing.",
            learn=LESSON,
            level="novice",
        ),
    ] = 1.0


def equalizing_table(counts: Array, strength: float) -> Array:
    """Return the new value of each grey value, uint8 (256,), from its frequencies (256,)."""
    below = np.cumsum(counts).astype(np.float64)
    first = below[np.flatnonzero(counts)[0]] if counts.any() else 0.0
    span = below[-1] - first
    levels = np.arange(256.0)
    if span <= 0:
        return levels.astype(np.uint8)
    equal = np.clip((below - first) * (255.0 / span), 0.0, 255.0)
    return np.rint(strength * equal + (1.0 - strength) * levels).astype(np.uint8)


def _learn(image: Array, params: EqualizationParams, run: Run) -> tuple[Levels, Array]:
    levels = levels_of(image)
    return levels, luma_histogram(image, levels)


def _apply(image: Array, params: EqualizationParams, known: tuple[Levels, Array], place: Place) -> Array:
    table = equalizing_table(known[1], params.strength)
    return on_luminance(image, known[0], lambda grey: cv2.LUT(grey, table))


@algorithm(
    stage="preprocessing",
    role="filter",
    name="equalize",
    label="Histogram equalisation",
    source="Gonzalez and Woods 2018, Digital Image Processing, section 3.3",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply)
def equalize(image: Array, params: EqualizationParams, *, run: Run) -> Array:
    r"""Make all grey values about equally frequent.

    With F(g) pixels of N not brighter than g, and F₀ those of the darkest value,

    .. math::
        g' = a\,255\,\frac{F(g) - F_0}{N - F_0} + (1 - a)\,g

    Of a colour photo the luma is equalised and the hue kept.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : EqualizationParams
    run : Run

    Returns
    -------
    uint8, of the shape of `image`
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
