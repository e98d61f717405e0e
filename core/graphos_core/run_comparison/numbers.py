"""Figures of two adjustments side by side, and the information criteria that weigh fit against unknowns."""

from __future__ import annotations

import math

from graphos_core.data import Adjustment
from graphos_core.run_comparison.records import NumberDifference
from graphos_core.text import Text


def weighted_squares(adjustment: Adjustment) -> float:
    """Return vᵀPv of an adjustment without unit: of all groups of observations, else ``sigma0² r``."""
    if adjustment.groups:
        return float(sum(group.squares for group in adjustment.groups))
    sigma0 = adjustment.sigma0
    if not math.isfinite(sigma0):
        sigma0 = adjustment.sigma0_px / adjustment.prior_px
    return float(sigma0**2 * adjustment.redundancy)


def information(adjustment: Adjustment) -> tuple[float, float]:
    """Return Akaike's and the Bayesian information criterion (AIC, BIC), for comparing models of the same observations.

    ``AIC = n ln(vᵀPv / n) + 2 k`` and ``BIC = n ln(vᵀPv / n) + k ln n`` with n observations and k = n − r + 1
    estimated quantities: the unknowns less the datum defect, and the variance (Burnham and Anderson 2002, section
    2.2, least squares case; Schwarz 1978). vᵀPv is taken in px², so that a common factor on all weights does not matter. The lower the better; only differences mean something.
    """
    n = adjustment.observations
    k, squares = n - adjustment.redundancy + 1, weighted_squares(adjustment) * adjustment.prior_px**2
    if n < 1 or not squares > 0:
        return math.nan, math.nan
    fit = n * math.log(squares / n)
    return fit + 2.0 * k, fit + k * math.log(n)


def same_weights(a: Adjustment, b: Adjustment) -> bool:
    """Say whether both weighted their observations alike: where there are image points alone a factor does not matter."""
    kinds = {group.kind for adjustment in (a, b) for group in adjustment.groups}
    return kinds <= {"tie points", "control image points"} or math.isclose(
        a.prior_px, b.prior_px, rel_tol=0.01
    )


def number_differences(a: Adjustment, b: Adjustment) -> tuple[NumberDifference, ...]:
    """Return the figures of both; AIC and BIC judge only where both adjusted the same number of observations."""
    information_a, information_b = information(a), information(b)
    same = a.observations == b.observations and same_weights(a, b)

    def row(
        key: str, label: str, unit: str, one: float, two: float, definition: str, judged: bool = False
    ) -> NumberDifference:
        known = math.isfinite(one) and math.isfinite(two)
        better = "" if not (judged and known) or math.isclose(one, two, rel_tol=1e-9) else "ab"[two < one]
        return NumberDifference(key, label, unit, one, two, definition, better)

    return (
        row("sigma0", "sigma0", "", _sigma0(a), _sigma0(b), Text(
            "A posteriori standard deviation of unit weight, √(vᵀPv / r), against the a priori one: 1 when that "
            "was right.")),
        row("sigma0_px", "sigma0 of an image coordinate", "px", a.sigma0_px, b.sigma0_px, Text(
            "The same in px: times the a priori standard deviation of an image coordinate of unit weight.")),
        row("rms_px", "Reprojection RMS", "px", a.rms_px, b.rms_px, Text(
            "Root mean square of the image residuals per coordinate, over all observations of the final model.")),
        row("observations", "Observations", "", a.observations, b.observations, Text(
            "Scalars: two per image point, one per other observation.")),
        row("unknowns", "Unknowns", "", a.unknowns, b.unknowns, Text("Datum defect not subtracted.")),
        row("redundancy", "Redundancy", "", a.redundancy, b.redundancy, Text(
            "Observations − unknowns + datum conditions.")),
        row("photos", "Photos oriented", "", int(a.block.oriented.sum()), int(b.block.oriented.sum()), ""),
        row("points", "Object points", "", len(a.block.points), len(b.block.points), ""),
        row("aic", "AIC", "", information_a[0], information_b[0], Text(
            "Akaike's criterion, n ln(vᵀPv/n) + 2k with k = n − r + 1; the lower the better, and only where both "
            "adjusted the same observations with the same weights."), same),
        row("bic", "BIC", "", information_a[1], information_b[1], Text(
            "Bayesian criterion, n ln(vᵀPv/n) + k ln n; it punishes unknowns more than AIC does."), same),
    )  # fmt: skip


def _sigma0(adjustment: Adjustment) -> float:
    if math.isfinite(adjustment.sigma0):
        return float(adjustment.sigma0)
    return float(adjustment.sigma0_px / adjustment.prior_px)
