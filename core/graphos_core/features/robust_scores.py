r"""What a robust search minimises: each estimator's cost of the squared residuals of a model.

With the residual e of a match, an inlier threshold t and n matches, smaller is better in all of them:

============  =====================================================================  ==============================
estimator     cost                                                                   source
============  =====================================================================  ==============================
RANSAC        Σ [e > t], the number of outliers                                      Fischler and Bolles 1981
MSAC          Σ min(e²/t², 1)                                                        Torr and Zisserman 2000, sec. 4
LMedS         med e²; needs no t, breaks down at half outliers                       Rousseeuw 1984
MAGSAC++      Σ ρ(e) / ρ(t), ρ marginalised over a noise σ uniform in (0, t/k)       Barath et al. 2020, sec. 3.2
============  =====================================================================  ==============================

The search itself is `graphos_core.features.robust.search`.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from scipy.special import gammainc, gammaincc

from graphos_core.data import Array

DEGREES = 4
"""Degrees of freedom of the residual in MAGSAC++: a match is a point in four dimensions, two in each photo."""

QUANTILE = 3.64
"""k: 0.99 quantile of the χ distribution with four degrees of freedom; a residual beyond k σ is an outlier."""

CONSISTENT = 1.4826
"""Median of |e| to standard deviation, for a normal distribution."""


def ransac_loss(squares: Array, threshold: float) -> Array:
    """Return 0 for inliers and 1 for outliers; shape as `squares`, px², with the threshold in px."""
    return (np.asarray(squares) > threshold**2).astype(np.float64)


def msac_loss(squares: Array, threshold: float) -> Array:
    """Return ``min(e²/t², 1)``; inliers are told apart by how well they fit."""
    return np.asarray(np.minimum(np.asarray(squares) / threshold**2, 1.0))


def magsac_loss(squares: Array, threshold: float) -> Array:
    r"""Return MAGSAC++'s marginalised loss, scaled to 1 for outliers.

    With ``s = e²/2σ²``, the largest noise ``σ = t/k`` and ν degrees of freedom (the integral of e·w(e), with
    `magsac_weight`; Barath et al. 2020, section 3.2), up to a constant factor:

    ``ρ = σ²/2 · γ((ν+1)/2, s) + e²/4 · (Γ((ν−1)/2, s) − Γ((ν−1)/2, k²/2))``
    """
    sigma = threshold / QUANTILE
    inside = np.minimum(np.asarray(squares, dtype=np.float64), threshold**2)
    s, top = inside / (2.0 * sigma**2), QUANTILE**2 / 2.0
    low, high = (DEGREES - 1) / 2.0, (DEGREES + 1) / 2.0
    gamma_low, gamma_high = math.gamma(low), math.gamma(high)
    lower = gamma_high * gammainc(high, s)
    upper = gamma_low * (gammaincc(low, s) - gammaincc(low, top))
    loss = sigma**2 / 2.0 * lower + inside / 4.0 * upper
    outside = sigma**2 / 2.0 * gamma_high * float(gammainc(high, top))
    return np.asarray(loss / outside)


def magsac_weight(squares: Array, threshold: float) -> Array:
    """Return MAGSAC++'s weight of each residual for reweighted least squares: 1 for e = 0, 0 beyond the threshold.

    ``w = (Γ((ν−1)/2, e²/2σ²) − Γ((ν−1)/2, k²/2)) / (Γ((ν−1)/2) − Γ((ν−1)/2, k²/2))`` with ``σ = t/k``
    (Barath et al. 2020, equation 4, up to a constant factor).
    """
    low, top = (DEGREES - 1) / 2.0, QUANTILE**2 / 2.0
    s = np.asarray(squares, dtype=np.float64) * top / threshold**2
    rest = float(gammaincc(low, top))
    return np.asarray(np.maximum(gammaincc(low, s) - rest, 0.0) / (1.0 - rest))


def ransac_cost(squares: Array, threshold: float) -> Array:
    """Return the number of outliers over the last axis of `squares` (…, n): float64 (…)."""
    return np.asarray(ransac_loss(squares, threshold).sum(axis=-1))


def msac_cost(squares: Array, threshold: float) -> Array:
    """Return the truncated sum of squares ``Σ min(e²/t², 1)`` over the last axis."""
    return np.asarray(msac_loss(squares, threshold).sum(axis=-1))


def lmeds_cost(squares: Array, threshold: float = math.inf) -> Array:
    """Return the median of the squares over the last axis, px²; the threshold plays no part."""
    return np.asarray(np.median(squares, axis=-1))


def magsac_cost(squares: Array, threshold: float) -> Array:
    """Return the sum of the marginalised losses over the last axis, from a table as in the source; exact to 1e-6."""
    table = _magsac_table()
    place = np.minimum(np.asarray(squares) / threshold**2, 1.0) * (len(table) - 2)
    below = place.astype(np.int64)
    return np.asarray((table[below] + (place - below) * (table[below + 1] - table[below])).sum(axis=-1))


@cache
def _magsac_table() -> Array:
    """Return the loss at equal steps of e²/t² from 0 to 1, and once more at the end."""
    loss = magsac_loss(np.linspace(0.0, 1.0, 4096), 1.0)
    return np.append(loss, loss[-1])


COSTS = {
    "ransac": ransac_cost,
    "msac": msac_cost,
    "prosac": ransac_cost,
    "lmeds": lmeds_cost,
    "magsac": magsac_cost,
}
"""The cost of each named method; PROSAC changes the order of the samples, not what is minimised."""


def robust_sigma(squares: Array, parameters: int) -> float:
    """Return the standard deviation of the good residuals, px, from the median of the squares.

    ``1.4826 (1 + 5/(n − p)) √(med e²)`` (Rousseeuw and Leroy 1987, section 5.1); residuals of one dimension.

    Parameters
    ----------
    squares : float64 (n,)
        px².
    parameters : int
        p, size of the minimal sample.
    """
    spare = max(len(squares) - parameters, 1)
    return float(CONSISTENT * (1.0 + 5.0 / spare) * np.sqrt(np.median(squares)))
