r"""Gamma: mid-tones lifted or lowered, black and white kept."""

from __future__ import annotations

from typing import Annotated

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.luminance import Levels, levels_of, on_luminance
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/gamma"


class GammaParams(Params):
    """Parameters of gamma."""

    gamma: Annotated[
        float,
        About(
            label="Gamma",
            symbol=r"\gamma",
            low=0.1,
            high=10.0,
            step=0.1,
            help="Power by which grey values from 0 to 1 are taken the root.",
            effect="Higher: shadows open, lights are pressed together. Lower than 1: the other way round.",
            learn=LESSON,
            level="novice",
        ),
    ] = 1.5


def _learn(image: Array, params: GammaParams, run: Run) -> Levels:
    return levels_of(image)


def _apply(image: Array, params: GammaParams, levels: Levels, place: Place) -> Array:
    table = np.rint(255.0 * (np.arange(256.0) / 255.0) ** (1.0 / params.gamma)).astype(np.uint8)
    return on_luminance(image, levels, lambda grey: cv2.LUT(grey, table))


@algorithm(
    stage="preprocessing",
    role="filter",
    name="gamma",
    label="Gamma",
    source="Gonzalez and Woods 2018, Digital Image Processing, section 3.2 (power-law transformations)",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply, local=True)
def gamma(image: Array, params: GammaParams, *, run: Run) -> Array:
    r"""Map grey values by :math:`g' = 255\,(g / 255)^{1/\gamma}`.

    Of a colour photo the luma is mapped and the hue kept.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : GammaParams
    run : Run

    Returns
    -------
    uint8, of the shape of `image`
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
