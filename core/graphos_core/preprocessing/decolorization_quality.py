r"""How much colour contrast a grey version keeps: CCPR, CCFR and E-score.

Source: Lu, Xu and Jia 2014, Contrast preserving decolorization with perception-based quality metrics, International
Journal of Computer Vision 110(2), section 5.
"""

from __future__ import annotations

import math

import cv2
import numpy as np

from graphos_core.data import Array, record
from graphos_core.preprocessing.decolorization import cielab
from graphos_core.preprocessing.grey import eight_bit

PIXELS = 60_000
"""Both versions are reduced (by area) to at most about so many pixels: edges count, not the noise of single pixels."""

PAIRS = 100_000
"""So many pairs of pixels are drawn at random."""

THRESHOLDS = np.arange(1, 41)
"""Contrasts τ that are looked at; below some 6 units a difference can hardly be seen."""

USUAL = 15
"""The means over τ = 1 … 15 are the numbers usually published."""


@record
class DecolorizationQuality:
    """What a grey version kept of the colour contrast, for each contrast threshold.

    Attributes
    ----------
    thresholds : int64 (t,)
        τ, in units of CIELAB; grey values are scaled to 0 … 100, the range of L.
    ccpr : float64 (t,)
        Colour contrast preserving ratio: of the pairs whose colours differ by at least τ, the share whose grey
        values do, too. NaN where there are none.
    ccfr : float64 (t,)
        Colour content fidelity ratio: of the pairs whose grey values differ by more than τ, the share whose colours
        really differ by more than τ. NaN where there are none.
    e_score : float64 (t,)
        Harmonic mean of both.
    pairs : int
    """

    thresholds: Array
    ccpr: Array
    ccfr: Array
    e_score: Array
    pairs: int

    def means(self, largest: int = USUAL) -> tuple[float, float, float]:
        """Return the means of CCPR, CCFR and E-score over τ = 1 … `largest`; NaN where nothing has a contrast."""
        chosen = self.thresholds <= largest
        found = [values[chosen] for values in (self.ccpr, self.ccfr, self.e_score)]
        ccpr, ccfr, e_score = (float(np.nanmean(v)) if np.isfinite(v).any() else math.nan for v in found)
        return ccpr, ccfr, e_score


def decolorization_quality(
    colour: Array, grey: Array, seed: int = 0, pairs: int = PAIRS
) -> DecolorizationQuality:
    r"""Compare the contrast of pixel pairs in colour and in grey.

    With the CIELAB distance δ and the grey difference d of a pair (d in L units),

    .. math::
        \mathrm{CCPR} = \frac{\#\{\delta \ge \tau,\ d \ge \tau\}}{\#\{\delta \ge \tau\}},\qquad
        \mathrm{CCFR} = 1 - \frac{\#\{d > \tau,\ \delta \le \tau\}}{\#\{d > \tau\}},\qquad
        E = \frac{2\,\mathrm{CCPR}\,\mathrm{CCFR}}{\mathrm{CCPR} + \mathrm{CCFR}}

    The paper takes all pairs; here `PAIRS` random ones, drawn from `seed`, stand for them: a ratio is then known to
    ± 0.003 or better (binomial, one σ, where at least 30 000 pairs have the contrast).

    Parameters
    ----------
    colour : uint8 or uint16 (h, w, 3) RGB
    grey : uint8 (h, w)
    seed : int
    pairs : int
        How many pairs are drawn.

    Returns
    -------
    DecolorizationQuality
    """
    factor = max(1.0, math.sqrt(grey.size / PIXELS))
    size = (max(1, round(grey.shape[1] / factor)), max(1, round(grey.shape[0] / factor)))
    small = cv2.resize(eight_bit(colour), size, interpolation=cv2.INTER_AREA)
    lab = cielab(small).reshape(-1, 3)
    level = cv2.resize(grey.astype(np.float32), size, interpolation=cv2.INTER_AREA).ravel()
    first, second = np.random.default_rng(seed).integers(0, len(level), (2, pairs))
    in_colour = np.sqrt(((lab[first] - lab[second]) ** 2).sum(axis=1))
    in_grey = np.abs(level[first] - level[second]) * np.float32(100.0 / 255.0)
    ccpr, ccfr = np.full(len(THRESHOLDS), np.nan), np.full(len(THRESHOLDS), np.nan)
    for i, tau in enumerate(THRESHOLDS):
        differs, seen = in_colour >= tau, in_grey > tau
        if differs.any():
            ccpr[i] = float((in_grey[differs] >= tau).mean())
        if seen.any():
            ccfr[i] = 1.0 - float((in_colour[seen] <= tau).mean())
    both = ccpr + ccfr
    e_score = np.where(both > 0, 2.0 * ccpr * ccfr / np.where(both > 0, both, 1.0), both)
    return DecolorizationQuality(thresholds=THRESHOLDS, ccpr=ccpr, ccfr=ccfr, e_score=e_score, pairs=pairs)
