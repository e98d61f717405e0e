r"""Principal component: the one mixture of the bands in which the photo differs most from itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/principal-component"

SAMPLE = 1_000_000
"""At most about so many pixels, regularly spaced, are looked at for the statistics."""


class PrincipalComponentParams(Params):
    """Parameters of the principal component."""

    clip: Annotated[
        float,
        About(
            label="Cut off",
            unit="%",
            low=0.0,
            high=10.0,
            step=0.1,
            help="This share of the pixels becomes black, and this share white, when the result is stretched.",
            effect="Higher: more contrast, details lost at both ends. 0: darkest and brightest pixel decide.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.1


@dataclass(frozen=True)
class Mixture:
    """Weights of the bands, float32 (n,), and the mixtures that become 0 and 255."""

    weights: Array
    low: float
    high: float


def principal_mixture(image: Array, clip: float) -> Mixture:
    """Return the first principal component of the bands of uint8 or uint16 (h, w, n), the brighter end white."""
    step = max(1, math.isqrt(image.shape[0] * image.shape[1] // SAMPLE))
    pixels = image[::step, ::step].reshape(-1, image.shape[2]).astype(np.float64)
    centred = pixels - pixels.mean(axis=0)
    # sums of products in a fixed order: no threaded product, so the result is the same on any number of threads
    covariance = np.array([[(a * b).mean() for b in centred.T] for a in centred.T])
    weights = np.linalg.eigh(covariance)[1][:, -1]
    weights = -weights if weights.sum() < 0.0 else weights
    low, high = np.percentile(mixed(image[::step, ::step], weights.astype(np.float32)), (clip, 100.0 - clip))
    return Mixture(weights.astype(np.float32), float(low), float(high))


def mixed(image: Array, weights: Array) -> Array:
    """Return the mixture of the bands, float32 (h, w), added in the order of the bands."""
    total = image[:, :, 0].astype(np.float32) * weights[0]
    for band in range(1, image.shape[2]):
        total += image[:, :, band].astype(np.float32) * weights[band]
    return total


def mixture_grey(image: Array, mixture: Mixture) -> Array:
    """Return the mixture of the bands stretched to uint8 (h, w); middle grey where nothing differs."""
    span = mixture.high - mixture.low
    if span < 1e-6:
        return np.full(image.shape[:2], 127, np.uint8)
    levels = (mixed(image, mixture.weights) - np.float32(mixture.low)) * np.float32(255.0 / span)
    return np.clip(np.rint(levels), 0.0, 255.0).astype(np.uint8)


def _learn(image: Array, params: PrincipalComponentParams, run: Run) -> Mixture:
    bands = image[:, :, None] if image.ndim == 2 else image
    return principal_mixture(bands, params.clip)


def _apply(image: Array, params: PrincipalComponentParams, mixture: Mixture, place: Place) -> Array:
    if image.ndim == 2 and image.dtype == np.uint8:
        return image
    return mixture_grey(image[:, :, None] if image.ndim == 2 else image, mixture)


@algorithm(
    stage="preprocessing",
    role="filter",
    name="principal",
    label="Principal component grey",
    source="Hotelling 1933, Analysis of a complex of statistical variables into principal components; "
    "Jolliffe 2002, Principal Component Analysis, section 1.1",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply)
def principal(image: Array, params: PrincipalComponentParams, *, run: Run) -> Array:
    r"""Mix the bands so that the variance of the grey values is largest.

    With the covariance matrix C of the bands over all pixels the weights are its eigenvector w of the largest
    eigenvalue, ``g = wᵀ (r, g, b)``, turned so that the sum of the weights is positive (brighter stays brighter on
    the whole), and stretched to 0 … 255. An 8-bit photo without colour comes back as it is.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, n)
    params : PrincipalComponentParams
    run : Run

    Returns
    -------
    uint8 (h, w)
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
