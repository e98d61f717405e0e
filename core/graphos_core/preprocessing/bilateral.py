r"""Bilateral filter: noise is averaged away among neighbours of similar brightness, edges stay."""

from __future__ import annotations

import math
from typing import Annotated

import cv2

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.luminance import Levels, levels_of, on_luminance
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/bilateral"


class BilateralParams(Params):
    """Parameters of the bilateral filter."""

    sigma_space: Annotated[
        float,
        About(
            label="Reach",
            symbol=r"\sigma_d",
            unit="px",
            low=0.5,
            high=10.0,
            step=0.5,
            help="Standard deviation of the weight by distance; pixels up to twice as far are averaged.",
            effect="Higher: smoother, slower. Lower: noise stays.",
            learn=LESSON,
            level="novice",
        ),
    ] = 2.0
    sigma_range: Annotated[
        float,
        About(
            label="Tolerance",
            symbol=r"\sigma_r",
            unit="grey level",
            low=1.0,
            high=255.0,
            step=1.0,
            help="Standard deviation of the weight by difference of brightness; two to three times the noise.",
            effect="Higher: weak edges are blurred too. Lower: strong noise stays.",
            learn=LESSON,
            level="novice",
        ),
    ] = 15.0


def _radius(params: BilateralParams) -> int:
    return math.ceil(2.0 * params.sigma_space)


def _learn(image: Array, params: BilateralParams, run: Run) -> Levels:
    return levels_of(image)


def _apply(image: Array, params: BilateralParams, levels: Levels, place: Place) -> Array:
    return on_luminance(
        image,
        levels,
        lambda grey: cv2.bilateralFilter(
            grey,
            2 * _radius(params) + 1,
            params.sigma_range,
            params.sigma_space,
            borderType=cv2.BORDER_REFLECT_101,
        ),
    )


def _reduced(params: BilateralParams, factor: float) -> BilateralParams:
    return params.replace(sigma_space=max(0.5, params.sigma_space / factor))


@algorithm(
    stage="preprocessing",
    role="filter",
    name="bilateral",
    label="Bilateral denoising",
    source="Tomasi and Manduchi 1998, Bilateral filtering for gray and color images, section 2",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply, margin=_radius, reduced=_reduced, local=True)
def bilateral(image: Array, params: BilateralParams, *, run: Run) -> Array:
    r"""Average each pixel with neighbours that are near and of similar brightness.

    .. math::
        g'(x) = \frac{\sum_y e^{-|x-y|^2/2\sigma_d^2}\; e^{-(g(x)-g(y))^2/2\sigma_r^2}\; g(y)}
                     {\sum_y e^{-|x-y|^2/2\sigma_d^2}\; e^{-(g(x)-g(y))^2/2\sigma_r^2}}

    over the disc of radius 2 σ_d. Of a colour photo the luma is filtered and the hue kept (coloured noise stays).

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : BilateralParams
    run : Run

    Returns
    -------
    uint8, of the shape of `image`
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
