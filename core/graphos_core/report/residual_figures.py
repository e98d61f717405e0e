"""Residuals and reliability as figures: is the noise normal, how well is it controlled, which observations stand out."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.special import ndtri

from graphos_core.data import Adjustment, Array
from graphos_core.report.values import nmad, spread

SUSPECTS = 20
"""So many of the observations with the largest |w| are listed."""

WEAK = 0.1
"""An observation with a redundancy number below this is hardly controlled."""

FULL_WEIGHT = 0.999
"""Observations with a smaller robust weight have lost weight."""


def residuals(adjustment: Adjustment) -> dict[str, Any] | None:
    """Return the part ``residuals`` of the report; None without residuals."""
    v = adjustment.residuals
    if not len(v):
        return None
    scaled = standardised(adjustment)
    return {
        "count": int(v.size),
        "mean_px": v.mean(axis=0),
        "std_px": v.std(axis=0),
        "nmad_px": nmad(v.ravel()),
        "largest_px": float(np.abs(v).max()),
        "longest_px": float(np.hypot(v[:, 0], v[:, 1]).max()),
        "down_weighted": int((adjustment.weights < FULL_WEIGHT).sum()),
        "kurtosis_excess": kurtosis_excess(scaled),
        "normal_correlation": normal_correlation(scaled),
    }


def standardised(adjustment: Adjustment) -> Array:
    """Return residuals as free of their own geometry as is known: Pope's τ, else divided by their standard deviation."""
    if adjustment.reliability is not None:
        tau, r = adjustment.reliability.studentised.ravel(), adjustment.reliability.redundancy.ravel()
        return np.asarray(tau[(r > 1e-6) & np.isfinite(tau)])
    v = adjustment.residuals.ravel()
    return np.asarray(v / (v.std() or 1.0))


def normal_correlation(values: Array) -> float:
    """Return the correlation of ordered values with normal quantiles (Filliben 1975): 1 for perfectly normal noise."""
    if len(values) < 3 or not np.ptp(values):
        return float("nan")
    return float(np.corrcoef(normal_quantiles(len(values)), np.sort(values))[0, 1])


def normal_quantiles(count: int) -> Array:
    """Return the medians of `count` ordered standard normal values (Filliben 1975, equation 5)."""
    if count < 2:
        return np.zeros(count)
    share = (np.arange(1, count + 1) - 0.3175) / (count + 0.365)
    share[-1] = 0.5 ** (1.0 / count)
    share[0] = 1.0 - share[-1]
    return np.asarray(ndtri(share))


def kurtosis_excess(values: Array) -> float:
    """Return the fourth moment over the squared second moment, less 3; NaN where all values are alike."""
    d = values - values.mean() if len(values) else values
    square = float((d**2).mean()) if len(d) else 0.0
    return float((d**4).mean()) / square**2 - 3.0 if square > 0 else float("nan")


def reliability(adjustment: Adjustment) -> dict[str, Any] | None:
    """Return the part ``reliability`` of the report; None where it was not computed."""
    found = adjustment.reliability
    if found is None:
        return None
    w = np.abs(found.standardised)
    tested = int((found.redundancy > 1e-6).sum())
    return {
        "alpha": found.alpha,
        "power": found.power,
        "critical": found.critical,
        "delta0": found.delta0,
        "redundancy_numbers": spread(found.redundancy),
        "weakly_controlled": int((found.redundancy < WEAK).sum()),
        "mdb_px": spread(found.mdb_px),
        "effect": spread(found.effect),
        "unit": adjustment.block.unit,
        "tested": tested,
        "beyond_critical": int((w > found.critical).sum()),
        "expected_beyond": tested * found.alpha,
        "suspects": suspects(adjustment),
    }


def suspects(adjustment: Adjustment, most: int = SUSPECTS) -> list[dict[str, Any]]:
    """Return the image points with the largest |w| of a coordinate, the worst first, each once."""
    found, block = adjustment.reliability, adjustment.block
    if found is None:
        return []
    w = np.round(np.nan_to_num(np.abs(found.standardised)), 6)
    worst = np.argsort(-w.max(axis=1), kind="stable")[:most]
    rows = []
    for i in worst:
        alike = (
            w[i] == w[i].max()
        )  # of two rays only one combination is controlled, so both coordinates are alike
        axis = int(np.argmax(np.where(alike, found.redundancy[i], -1.0)))
        rows.append({
            "photo": block.names[block.obs_photo[i]],
            "point": point_name(adjustment, int(block.obs_point[i])),
            "coordinate": "xy"[axis],
            "position_px": block.obs_xy[i],
            "residual_px": adjustment.residuals[i, axis],
            "w": found.standardised[i, axis],
            "tau": found.studentised[i, axis],
            "redundancy_number": found.redundancy[i, axis],
            "mdb_px": found.mdb_px[i, axis],
            "effect": found.effect[i, axis],
        })  # fmt: skip
    return rows


def point_name(adjustment: Adjustment, point: int) -> str:
    """Return the name of an object point, or its number among the object points."""
    names = adjustment.point_names
    return (names[point] if point < len(names) else "") or f"#{point}"
