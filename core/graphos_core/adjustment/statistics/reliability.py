"""Reliability: Baarda's test of every observation, Pope's τ, minimal detectable biases, the global test.

Sources: Baarda 1968, A testing procedure for use in geodetic networks; Pope 1976, The statistics of residuals and the
detection of outliers; Förstner and Wrobel 2016, Photogrammetric Computer Vision, sections 3.1.1 and 4.6.
"""

from __future__ import annotations

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from graphos_core.data import Array, GlobalTest, Reliability

SMALLEST = 1e-9
"""A redundancy number below this is zero: nothing controls the observation."""


def critical_value(alpha: float) -> float:
    """Return the limit of |w| of the two-sided test of one normal variable at error probability `alpha`."""
    return float(stats.norm.isf(alpha / 2.0))


def non_centrality(alpha: float, power: float) -> float:
    """Return δ0: the shift of a standard normal variable that the two-sided test finds with probability `power`."""
    limit = critical_value(alpha)

    def missing(shift: float) -> float:
        return float(stats.norm.sf(limit - shift) + stats.norm.cdf(-limit - shift)) - power

    return float(brentq(missing, 0.0, limit + 10.0, xtol=1e-12))


def tau_limit(alpha: float, redundancy: int) -> float:
    """Return the limit of |τ|: ``√(r t² / (r − 1 + t²))`` with Student's t of r − 1 degrees of freedom (Pope 1976)."""
    if redundancy < 2:
        return float("nan")
    t = float(stats.t.isf(alpha / 2.0, redundancy - 1))
    return float(np.sqrt(redundancy * t * t / (redundancy - 1 + t * t)))


def standardised(residuals: Array, sigma: Array, redundancy: Array) -> Array:
    """Return w = v / (σ √r), 0 where nothing controls the observation; arrays are broadcast."""
    controlled = redundancy > SMALLEST
    root = np.sqrt(np.where(controlled, redundancy, 1.0))
    return np.asarray(np.where(controlled, residuals / (sigma * root), 0.0))


def detectable(sigma: Array, redundancy: Array, delta0: float) -> Array:
    """Return the minimal detectable bias δ0 σ / √r, infinite where nothing controls the observation."""
    controlled = redundancy > SMALLEST
    root = np.sqrt(np.where(controlled, redundancy, 1.0))
    return np.asarray(np.where(controlled, delta0 * sigma / root, np.inf))


def reliability(
    residuals: Array, sigma: Array, redundancy: Array, effect: Array, sigma0: float, alpha: float, power: float
) -> Reliability:  # fmt: skip
    """Return the reliability of image observations.

    Parameters
    ----------
    residuals : float64 (m, 2)
        px.
    sigma : float64 (m,)
        A priori standard deviations, px.
    redundancy, effect : float64 (m, 2)
        See `graphos_core.adjustment.bundle.statistics_kernels`; `effect` for the non-centrality of `alpha`, `power`.
    sigma0 : float
        A posteriori, without unit.
    alpha, power : float
    """
    delta0 = non_centrality(alpha, power)
    w = standardised(residuals, sigma[:, None], redundancy)
    return Reliability(
        redundancy=redundancy, standardised=w, studentised=w / sigma0 if sigma0 > 0 else np.zeros_like(w),
        mdb_px=detectable(sigma[:, None], redundancy, delta0), effect=effect, alpha=alpha, power=power,
        critical=critical_value(alpha), delta0=delta0,
    )  # fmt: skip


def global_test(squares: float, redundancy: int, alpha: float) -> GlobalTest | None:
    """Test vᵀPv against χ² of the redundancy, two-sided; None without redundancy."""
    if redundancy < 1:
        return None
    lower, upper = (float(stats.chi2.ppf(p, redundancy)) for p in (alpha / 2.0, 1.0 - alpha / 2.0))
    return GlobalTest(
        statistic=squares, lower=lower, upper=upper, alpha=alpha, passed=bool(lower <= squares <= upper)
    )
