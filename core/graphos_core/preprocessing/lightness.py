r"""Lightness: grey values that are equally far apart where the eye sees equal steps."""

from __future__ import annotations

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.params import Params
from graphos_core.preprocessing.grey import eight_bit
from graphos_core.preprocessing.luminance import Levels, levels_of
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/lightness"


class LightnessParams(Params):
    """Lightness has no parameters."""


def _learn(image: Array, params: LightnessParams, run: Run) -> Levels:
    return levels_of(image)


def _apply(image: Array, params: LightnessParams, levels: Levels, place: Place) -> Array:
    image = eight_bit(image, levels)
    if image.ndim == 2:
        return image
    return np.ascontiguousarray(cv2.cvtColor(image, cv2.COLOR_RGB2LAB)[:, :, 0])


@algorithm(
    stage="preprocessing",
    role="filter",
    name="lightness",
    label="Lightness (CIE L*)",
    source="CIE 15:2004, Colorimetry, section 8.2.1; linear values as in IEC 61966-2-1 (sRGB)",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply, local=True)
def lightness(image: Array, params: LightnessParams, *, run: Run) -> Array:
    r"""Turn colour into the lightness L* of CIELAB, 0 … 100 as 0 … 255.

    The channels are made linear first, Y is the luminance relative to white (D65), and

    .. math::
        L^* = 116\,(Y/Y_n)^{1/3} - 16 \quad (Y/Y_n > 0.008856), \qquad L^* = 903.3\,Y/Y_n \text{ below}

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : LightnessParams
    run : Run

    Returns
    -------
    uint8 (h, w)
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
