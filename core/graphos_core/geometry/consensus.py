"""Random sample consensus: how many samples a search needs."""

from __future__ import annotations

import math


def samples_needed(good_share: float, sample_size: int, confidence: float) -> float:
    """Return how many random samples give at least one without a wrong observation.

    ``n = ln(1 − p) / ln(1 − wˢ)``, rounded up (Fischler and Bolles 1981, section II.B).

    Parameters
    ----------
    good_share : float
        w, share of good observations, 0 to 1.
    sample_size : int
        s, observations in a sample.
    confidence : float
        p, wished probability, 0 to below 1.

    Returns
    -------
    float
        Whole and at least 1; infinite where there are no good observations.

    Examples
    --------
    >>> samples_needed(0.5, 5, 0.99)
    146.0
    """
    clean = good_share**sample_size
    if clean >= 1.0 or confidence <= 0.0:
        return 1.0
    if clean <= 0.0:
        return math.inf
    return max(1.0, math.ceil(math.log1p(-confidence) / math.log1p(-clean)) * 1.0)
