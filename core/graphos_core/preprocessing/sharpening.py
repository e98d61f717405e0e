r"""Sharpening: what a blur takes away is added once more (unsharp mask)."""

from __future__ import annotations

import math
from typing import Annotated

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.luminance import Levels, levels_of, on_luminance
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/sharpening"


class SharpeningParams(Params):
    """Parameters of the unsharp mask."""

    amount: Annotated[
        float,
        About(
            label="Amount",
            symbol="a",
            low=0.0,
            high=5.0,
            step=0.1,
            help="How many times the difference from the blurred photo is added.",
            effect="Higher: harder edges, more noise, bright seams beside dark edges. 0 changes nothing.",
            learn=LESSON,
            level="novice",
        ),
    ] = 1.0
    sigma: Annotated[
        float,
        About(
            label="Blur",
            symbol=r"\sigma",
            unit="px",
            low=0.3,
            high=20.0,
            step=0.1,
            help="Standard deviation of the Gaussian whose loss is given back; about that of the photo's own blur.",
            effect="Higher: broader edges are lifted. Lower: the finest detail only.",
            learn=LESSON,
            level="novice",
        ),
    ] = 1.5
    threshold: Annotated[
        float,
        About(
            label="Threshold",
            symbol="t",
            unit="grey level",
            low=0.0,
            high=50.0,
            step=0.5,
            help="Differences up to this size are left alone.",
            effect="Higher: noise in plain areas is not lifted. 0: everything is.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.0


def _radius(params: SharpeningParams) -> int:
    return math.ceil(4.0 * params.sigma)


def _learn(image: Array, params: SharpeningParams, run: Run) -> Levels:
    return levels_of(image)


def _apply(image: Array, params: SharpeningParams, levels: Levels, place: Place) -> Array:
    return on_luminance(image, levels, lambda grey: _sharper(grey, params))


def _sharper(grey: Array, params: SharpeningParams) -> Array:
    values = grey.astype(np.float32)
    side = 2 * _radius(params) + 1
    difference = values - cv2.GaussianBlur(
        values, (side, side), params.sigma, borderType=cv2.BORDER_REFLECT_101
    )
    if params.threshold > 0:
        difference[np.abs(difference) <= params.threshold] = 0.0
    return np.clip(np.rint(values + np.float32(params.amount) * difference), 0.0, 255.0).astype(np.uint8)


def _reduced(params: SharpeningParams, factor: float) -> SharpeningParams:
    return params.replace(sigma=max(0.3, params.sigma / factor))


@algorithm(
    stage="preprocessing",
    role="filter",
    name="sharpen",
    label="Sharpening (unsharp mask)",
    source="Gonzalez and Woods 2018, Digital Image Processing, section 3.6 (unsharp masking and highboost filtering)",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply, margin=_radius, reduced=_reduced, local=True)
def sharpen(image: Array, params: SharpeningParams, *, run: Run) -> Array:
    r"""Add the difference from a blurred copy: :math:`g' = g + a\,(g - G_\sigma * g)` where it exceeds t.

    The Gaussian is cut off at 4 σ; the photo is mirrored at its border. Of a colour photo the luma is sharpened and
    the hue kept.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : SharpeningParams
    run : Run

    Returns
    -------
    uint8, of the shape of `image`
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
