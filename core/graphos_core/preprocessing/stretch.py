r"""Radiometric stretch: 16-bit, thermal and infrared photos made so that keypoints find their texture."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.bands import one_band
from graphos_core.preprocessing.parts import Place, odd_window, partwise
from graphos_core.preprocessing.stretch_choice import (
    LARGEST_BLUR,
    TARGET,
    StretchChoice,
    Wishes,
    choose_stretch,
)
from graphos_core.preprocessing.wallis import WallisParams, wallis_with_limits
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/stretch"

WORKING_LEVELS = 65535.0


class StretchParams(Params):
    """Parameters of the radiometric stretch."""

    clip: Annotated[
        float,
        About(
            label="Cut off",
            unit="%",
            low=0.0,
            high=20.0,
            step=0.1,
            help="This share of the pixels becomes black, and this share white: hot spots and dead pixels.",
            effect="Higher: more contrast for the rest. 0: the hottest and the coldest pixel decide.",
            learn=LESSON,
            level="novice",
        ),
    ] = 0.1
    local: Annotated[
        Literal["auto", "yes", "no"],
        About(
            label="Local equalisation",
            help="Pull the contrast of every small window to the same value.",
            effect="Automatic: where the texture is weak. Yes: always. No: one stretch for the whole photo.",
            choices={"auto": "automatic", "yes": "yes", "no": "no"},
            learn=LESSON,
            level="novice",
        ),
    ] = "auto"
    smooth: Annotated[
        Literal["auto", "yes", "no"],
        About(
            label="Noise suppression",
            help="Smooth by a small Gaussian before.",
            effect="Automatic: as much as the lifted noise needs. Yes: always. No: every pixel counts, noise too.",
            choices={"auto": "automatic", "yes": "yes", "no": "no"},
            learn=LESSON,
            level="novice",
        ),
    ] = "auto"
    window: Annotated[
        int | None,
        About(
            label="Window",
            symbol="w",
            unit="px",
            low=3,
            high=201,
            step=2,
            help="Side of the window of the local equalisation; an even number is rounded up to the next odd one.",
            effect="Higher: only slow changes are levelled. Lower: the finest texture is lifted, and noise.",
            learn=LESSON,
            level="student",
        ),
    ] = None


def stretch_choice(image: Array, params: StretchParams) -> StretchChoice:
    """Return what the stretch does with a photo, and why; arguments as in `stretch`."""
    wish = {"auto": None, "yes": True, "no": False}
    window = None if params.window is None else params.window | 1
    return choose_stretch(
        one_band(image), Wishes(params.clip, wish[params.local], wish[params.smooth], window)
    )


def _learn(image: Array, params: StretchParams, run: Run) -> StretchChoice:
    return stretch_choice(image, params)


def _apply(image: Array, params: StretchParams, choice: StretchChoice, place: Place) -> Array:
    if choice.high <= choice.low:
        return np.full(image.shape[:2], 127, np.uint8)
    values: Array = one_band(image).astype(np.float32)
    if choice.blur:
        side = 2 * math.ceil(4.0 * choice.blur) + 1
        values = cv2.GaussianBlur(values, (side, side), choice.blur, borderType=cv2.BORDER_REFLECT_101)
    levels = (values - np.float32(choice.low)) * np.float32(255.0 / (choice.high - choice.low))
    if not choice.window:
        return np.clip(np.rint(levels), 0.0, 255.0).astype(np.uint8)
    # what was cut off keeps its texture: the window is equalised before anything becomes black or white
    first, last = _span(image.dtype.type, choice)
    scale = WORKING_LEVELS / (last - first)
    working = np.rint((levels - np.float32(first)) * np.float32(scale)).astype(np.uint16)
    equalised = WallisParams(
        window=choice.window, target_std=TARGET, contrast=0.99, maximum_gain=min(choice.gain, 1000.0)
    )
    return wallis_with_limits(working, (np.float32(-first * scale), np.float32(1.0 / scale)), equalised)


def _span(kind: type, choice: StretchChoice) -> tuple[float, float]:
    """Grey levels of the smallest and largest value that the photo's type can have."""
    scale = 255.0 / (choice.high - choice.low)
    return -choice.low * scale, (float(np.iinfo(kind).max) - choice.low) * scale


def _margin(params: StretchParams) -> int:
    return (params.window or 11) // 2 + math.ceil(4.0 * LARGEST_BLUR)


def _reduced(params: StretchParams, factor: float) -> StretchParams:
    return params if params.window is None else params.replace(window=odd_window(params.window, factor))


@algorithm(
    stage="preprocessing",
    role="filter",
    name="stretch",
    label="Radiometric stretch",
    source="Local equalisation: Wallis 1976, with the gain limited by the noise; noise: Immerkær 1996, Fast noise "
    "variance estimation, eq. 3",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply, margin=_margin, reduced=_reduced)
def stretch(image: Array, params: StretchParams, *, run: Run) -> Array:
    """Stretch the values of a photo to 0 … 255 so that weak texture can be seen by detectors.

    Between the values that `clip` cuts off the stretch is linear. What is automatic follows from the noise and the
    texture measured in the photo itself, see `choose_stretch`; the reason is told to `run`. Colour is made grey first.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, n)
    params : StretchParams
    run : Run

    Returns
    -------
    uint8 (h, w)
    """
    choice = _learn(image, params, run)
    run.say(choice.reason)
    return _apply(image, params, choice, Place.whole(image))
