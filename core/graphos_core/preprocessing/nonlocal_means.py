r"""Non-local means: noise is averaged away among pixels whose surroundings look alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.grey import eight_bit, luma
from graphos_core.preprocessing.luminance import Levels, levels_of, on_luminance
from graphos_core.preprocessing.noise import noise_level
from graphos_core.preprocessing.parts import Place, odd_window, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/nonlocal-means"

NOISE_FACTOR = 1.0
"""Automatic strength, as a multiple of the measured noise."""


class NonlocalMeansParams(Params):
    """Parameters of non-local means."""

    strength: Annotated[
        float | None,
        About(
            label="Strength",
            symbol="h",
            unit="grey level",
            low=0.5,
            high=100.0,
            step=0.5,
            help="Difference of surroundings at which a pixel hardly counts any more; automatic: the measured noise.",
            effect="Higher: smoother, fine texture is lost. Lower: noise stays.",
            learn=LESSON,
            level="novice",
        ),
    ] = None
    patch: Annotated[
        int,
        About(
            label="Patch",
            unit="px",
            low=3,
            high=15,
            step=2,
            help="Side of the surroundings that are compared; an even number is rounded up to the next odd one.",
            effect="Higher: surer comparison, noise stays along edges. Lower: faster to be fooled by noise.",
            learn=LESSON,
            level="student",
        ),
    ] = 5
    search: Annotated[
        int,
        About(
            label="Search window",
            unit="px",
            low=5,
            high=51,
            step=2,
            help="Side of the square in which similar pixels are sought; an even number is rounded up.",
            effect="Higher: more similar pixels are found, slower with the square. Lower: faster.",
            learn=LESSON,
            level="student",
        ),
    ] = 15


@dataclass(frozen=True)
class Known:
    """Levels of a 16-bit photo, and the strength."""

    levels: Levels
    strength: float


def _learn(image: Array, params: NonlocalMeansParams, run: Run) -> Known:
    levels = levels_of(image)
    if params.strength is not None:
        return Known(levels, params.strength)
    grey = luma(eight_bit(image, levels))
    return Known(levels, max(0.5, NOISE_FACTOR * noise_level(np.ascontiguousarray(grey))))


def _apply(image: Array, params: NonlocalMeansParams, known: Known, place: Place) -> Array:
    return on_luminance(
        image,
        known.levels,
        lambda grey: cv2.fastNlMeansDenoising(
            grey, None, known.strength, params.patch | 1, params.search | 1
        ),
    )


def _margin(params: NonlocalMeansParams) -> int:
    return (params.patch | 1) // 2 + (params.search | 1) // 2


def _reduced(params: NonlocalMeansParams, factor: float) -> NonlocalMeansParams:
    return params.replace(
        patch=odd_window(params.patch, factor), search=max(5, odd_window(params.search, factor))
    )


@algorithm(
    stage="preprocessing",
    role="filter",
    name="nlm",
    label="Non-local means denoising",
    source="Buades, Coll and Morel 2005, A non-local algorithm for image denoising (CVPR), section 3",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply, margin=_margin, reduced=_reduced)
def nlm(image: Array, params: NonlocalMeansParams, *, run: Run) -> Array:
    r"""Average each pixel with those of the search window whose patches look like its own.

    .. math::
        g'(x) = \frac{\sum_y w(x, y)\,g(y)}{\sum_y w(x, y)},\qquad
        w(x, y) = e^{-\lVert P(x) - P(y) \rVert^2 / h^2}

    with the mean squared difference of the patches P. Of a colour photo the luma is filtered and the hue kept
    (coloured noise stays).

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : NonlocalMeansParams
    run : Run

    Returns
    -------
    uint8, of the shape of `image`
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
