r"""Contrast-preserving decolourisation: grey in which colours that differ stay different."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.grey import eight_bit
from graphos_core.preprocessing.kernels import normal_matrix, polynomial_grey, signed_sum
from graphos_core.preprocessing.luminance import Levels, levels_of
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/decolorization"

LAB_RANGE = 100.0
"""Colour differences are divided by the range of L, so that they compare with grey differences of 0 to 1."""

RANGE_PIXELS = 1_000_000
"""The range of the result is taken from at most about so many pixels, regularly spaced."""

START = np.array([1 / 3, 1 / 3, 1 / 3, 0, 0, 0, 0, 0, 0])
"""The mean of the channels."""


class DecolorParams(Params):
    """Parameters of contrast-preserving decolourisation."""

    sigma: Annotated[
        float,
        About(
            label="Tolerance",
            symbol=r"\sigma",
            low=0.001,
            high=1.0,
            step=0.005,
            help="How far a grey difference may be from the colour difference, as a part of the grey range.",
            effect="Higher: the sign of a difference stays undecided longer. Lower: it is decided at once.",
            learn=LESSON,
            level="expert",
        ),
    ] = 0.02
    iterations: Annotated[
        int,
        About(
            label="Iterations",
            symbol="n",
            unit="iterations",
            low=1,
            high=100,
            step=1,
            help="How often the weights are solved for.",
            effect="Higher: closer to the optimum, slower. Lower: nearer to the mean of the channels.",
            learn=LESSON,
            level="student",
        ),
    ] = 15
    fit_pixels: Annotated[
        int,
        About(
            label="Pixels for the fit",
            unit="px",
            low=1000,
            high=10_000_000,
            step=10_000,
            help="The weights are found on the photo reduced to so many pixels and applied at full size.",
            effect="Higher: small coloured details count, slower. Lower: faster.",
            learn=LESSON,
            level="expert",
        ),
    ] = 60_000
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
            level="expert",
        ),
    ] = 0.1


@dataclass(frozen=True)
class Mapping:
    """What decolourisation must know of the whole photo.

    Attributes
    ----------
    levels : (int, int) or None
        Values of a 16-bit photo that become 0 and 255.
    weights : float32 (9,)
        Of the monomials; empty for a grey photo.
    low, high : float
        Values of the polynomial that become 0 and 255.
    """

    levels: Levels
    weights: Array
    low: float
    high: float


def _learn(image: Array, params: DecolorParams, run: Run) -> Mapping:
    levels = levels_of(image)
    if image.ndim == 2:
        return Mapping(levels, np.zeros(0, np.float32), 0.0, 255.0)
    image = eight_bit(image, levels)
    weights = fit_weights(image, params, run).astype(np.float32)
    step = max(1, math.isqrt(image.shape[0] * image.shape[1] // RANGE_PIXELS))
    grey = polynomial_grey(np.ascontiguousarray(image[::step, ::step]), weights)
    low, high = np.percentile(grey, (params.clip, 100.0 - params.clip))
    return Mapping(levels, weights, float(low), float(high))


def _apply(image: Array, params: DecolorParams, mapping: Mapping, place: Place) -> Array:
    image = eight_bit(image, mapping.levels)
    if image.ndim == 2:
        return image
    if mapping.high - mapping.low < 1e-6:
        return cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    grey = polynomial_grey(np.ascontiguousarray(image), mapping.weights)
    scale = 255.0 / (mapping.high - mapping.low)
    return cv2.convertScaleAbs(
        np.maximum(grey, np.float32(mapping.low)), alpha=scale, beta=-mapping.low * scale
    )


@algorithm(
    stage="preprocessing",
    role="filter",
    name="decolor",
    label="Contrast-preserving grey",
    source="Lu, Xu, Jia 2012, Contrast preserving decolorization (ICCP), sections 2 and 3",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply)
def decolor(image: Array, params: DecolorParams, *, run: Run) -> Array:
    """Map colour to grey by the polynomial of second degree that best keeps the differences of neighbours.

    A photo without colour comes back as it is. The result is stretched to 0 … 255.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : DecolorParams
    run : Run

    Returns
    -------
    uint8 (h, w)
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))


def fit_weights(image: Array, params: DecolorParams, run: Run) -> Array:
    r"""Find the weights of the polynomial.

    The grey value is ``g = Σ ω_i m_i`` with the monomials r, g, b, rg, rb, gb, r², g², b². For each pair of
    neighbours with colour difference δ (in CIELAB, divided by 100) and differences l of the monomials, the grey
    difference should be +δ or −δ:

    .. math::
        \max_\omega \prod \alpha\,N(l^T\omega;\, \delta, \sigma^2) + (1 - \alpha)\,N(l^T\omega;\, -\delta, \sigma^2)

    with α = 1 where one pixel is brighter in all three channels (the sign of δ is then known) and ½ elsewhere
    (eq. 7 of the paper). Iteration: with the present ω the probability β of the positive sign follows, then
    ``(Σ l lᵀ) ω = Σ l (2β − 1) δ`` (eqs. 12 to 14). Neighbours are taken right and below, in the reduced photo and
    once more at half its size, so that edges wider than a pixel count.

    Parameters
    ----------
    image : uint8 (h, w, 3) RGB
    params : DecolorParams
    run : Run

    Returns
    -------
    float64 (9,)
        Weights for r, g, b from 0 to 1.
    """
    factor = max(1.0, math.sqrt(image.shape[0] * image.shape[1] / params.fit_pixels))
    size = (max(8, round(image.shape[1] / factor)), max(8, round(image.shape[0] / factor)))
    fine = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    coarse = cv2.resize(fine, (max(4, size[0] // 2), max(4, size[1] // 2)), interpolation=cv2.INTER_AREA)
    parts = [_differences(fine), _differences(coarse)]
    slopes = np.concatenate([part[0] for part in parts])
    target = np.concatenate([part[1] for part in parts])
    known = np.concatenate([part[2] for part in parts])
    # a breath of Tikhonov keeps photos of one hue, whose monomials depend on each other, solvable
    normal = normal_matrix(slopes)
    normal += np.eye(9) * (1e-6 * max(float(np.trace(normal)), 1e-12))
    inverse = np.linalg.inv(normal)
    weights = START.copy()
    for _ in range(params.iterations):
        run.check()
        weights = (inverse * signed_sum(slopes, target, known, weights, params.sigma)).sum(axis=1)
    return weights


def cielab(image: Array) -> Array:
    """Return CIELAB of an sRGB image uint8 (h, w, 3), float32 (h, w, 3): L from 0 to 100, a and b alike in size."""
    return cv2.cvtColor(image.astype(np.float32) / np.float32(255.0), cv2.COLOR_RGB2LAB)


def _differences(image: Array) -> tuple[Array, Array, Array]:
    """Differences of the monomials (p, 9), signed colour differences (p,), and whether the sign is known (p,)."""
    rgb = image.astype(np.float32) / np.float32(255.0)
    lab = cielab(image).astype(np.float64) / LAB_RANGE
    r, g, b = (rgb[:, :, channel].astype(np.float64) for channel in range(3))
    monomials = np.stack([r, g, b, r * g, r * b, g * b, r * r, g * g, b * b], axis=2)
    slopes, colours = (_neighbours(values) for values in (monomials, lab))
    brighter = (slopes[:, :3] >= 0.0).all(axis=1)
    darker = (slopes[:, :3] <= 0.0).all(axis=1)
    distance = np.sqrt((colours**2).sum(axis=1))
    return slopes, np.where(darker & ~brighter, -distance, distance), np.asarray(brighter | darker)


def _neighbours(values: Array) -> Array:
    right = (values[:, 1:] - values[:, :-1]).reshape(-1, values.shape[2])
    below = (values[1:] - values[:-1]).reshape(-1, values.shape[2])
    return np.concatenate([right, below])
