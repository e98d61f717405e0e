r"""Plain grey, and 16 bit made 8 bit: what every other filter starts from."""

from __future__ import annotations

from typing import Annotated, Literal

import cv2
import numpy as np

from graphos_core.bands import visible
from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/grey"

STRETCH_SHARES = (0.001, 0.999)
"""Shares of the values of a 16-bit photo that become 0 and 255."""


class GreyParams(Params):
    """Parameters of plain grey."""

    weights: Annotated[
        Literal["luma", "mean", "red", "green", "blue"],
        About(
            label="Channels",
            help="How red, green and blue become one grey value.",
            effect="Luma: as bright as it looks (0.299 R + 0.587 G + 0.114 B). Mean: all alike. "
            "One channel: where two colours differ only in it.",
            choices={
                "luma": "luma",
                "mean": "mean of the channels",
                "red": "red only",
                "green": "green only",
                "blue": "blue only",
            },
            learn=LESSON,
            level="novice",
        ),
    ] = "luma"


def _learn(image: Array, params: GreyParams, run: Run) -> tuple[int, int] | None:
    return stretch_range(image) if image.dtype == np.uint16 else None


def _apply(image: Array, params: GreyParams, levels: tuple[int, int] | None, place: Place) -> Array:
    image = eight_bit(image, levels)
    if image.ndim == 2:
        return image
    if params.weights == "luma":
        return luma(image)
    if params.weights == "mean":
        return cv2.transform(image, np.full((1, 3), 1.0 / 3.0, np.float32))
    return np.ascontiguousarray(image[:, :, ("red", "green", "blue").index(params.weights)])


@algorithm(
    stage="preprocessing",
    role="filter",
    name="grey",
    label="Plain grey",
    source="ITU-R BT.601, section 2.5.1 (luma)",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply, local=True)
def grey(image: Array, params: GreyParams, *, run: Run) -> Array:
    """Weigh the channels into one grey value.

    Colours that are equally bright fall together; see `graphos_core.preprocessing.decolorization` for the remedy.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : GreyParams
    run : Run

    Returns
    -------
    uint8 (h, w)
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))


def luma(image: Array) -> Array:
    """Return ``0.299 R + 0.587 G + 0.114 B`` of an RGB image (h, w, 3) in its own bit depth; grey stays grey.

    Of other numbers of bands that of their false colours, see `graphos_core.bands`.
    """
    image = visible(image)
    return image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)


def eight_bit(image: Array, levels: tuple[int, int] | None = None) -> Array:
    """Return 8-bit pixels, grey or RGB; 16 bit is stretched so that its 0.1 % and 99.9 % quantiles become 0 and 255.

    The quantiles are of all channels together, so colours keep their hue. 8 bit is returned as it is. Of many bands the
    false colours are returned, see `graphos_core.bands`: a filter that knows no bands sees what people see.

    Parameters
    ----------
    image : uint8 or uint16 (h, w), (h, w, 3) or (h, w, n)
    levels : (int, int), optional
        The values that become 0 and 255 instead, where `image` is a piece of a larger photo.
    """
    image = visible(image)
    if image.dtype == np.uint8:
        return image
    low, high = stretch_range(image) if levels is None else levels
    table = np.clip(np.rint((np.arange(65536.0) - low) * (255.0 / (high - low))), 0, 255).astype(np.uint8)
    return table[image]


def stretch_range(image: Array) -> tuple[int, int]:
    """Return the values of a uint16 image between which it is stretched, the second larger than the first."""
    below = np.cumsum(np.bincount(visible(image).ravel(), minlength=65536))
    low, high = np.searchsorted(below, [share * below[-1] for share in STRETCH_SHARES])
    return int(low), max(int(high), int(low) + 1)
