"""Plain values for the report: what JSON knows, and statistics with names."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from graphos_core.data import Array


def plain(value: Any) -> Any:
    """Return `value` with only what JSON knows: numpy becomes plain, NaN and infinity become null."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def rms(values: Array) -> float:
    """Return the root mean square per coordinate; NaN of nothing."""
    return float(np.sqrt(np.mean(np.square(values)))) if np.size(values) else math.nan


def rms_per_axis(values: Array) -> list[float] | None:
    """Return the root mean square of each column of (k, n), over its finite values; None where there are no rows."""
    if not len(values):
        return None
    return [rms(column[np.isfinite(column)]) for column in np.asarray(values).T]


def spread(values: Array) -> dict[str, float | int | None]:
    """Return ``count, mean, rms, median, q05, q95, least, largest`` of the finite values; null where there are none."""
    good = np.asarray(values, dtype=np.float64).ravel()
    good = good[np.isfinite(good)]
    if not len(good):
        return {"count": 0} | dict.fromkeys(("mean", "rms", "median", "q05", "q95", "least", "largest"))
    low, middle, high = np.quantile(good, (0.05, 0.5, 0.95))
    return {
        "count": len(good), "mean": float(good.mean()), "rms": rms(good), "median": float(middle), "q05": float(low),
        "q95": float(high), "least": float(good.min()), "largest": float(good.max()),
    }  # fmt: skip


def nmad(values: Array) -> float:
    """Return 1.4826 · median(|d − median(d)|) of finite values; NaN of nothing."""
    if not np.size(values):
        return math.nan
    return 1.4826 * float(np.median(np.abs(values - np.median(values))))
