"""Statistics of distances, each with its definition."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from graphos_core.data import Array
from graphos_core.text import Text

DEFINITIONS: Mapping[str, Text] = MappingProxyType(
    {
        "count": Text("Number of distances that are known."),
        "mean": Text("Mean of the signed distances: a shift of the cloud along the reference normal."),
        "std": Text("Standard deviation about the mean, n − 1 in the denominator."),
        "rmse": Text("Root of the mean of the squared distances: shift and spread together."),
        "median": Text("Median of the signed distances: a shift that outliers do not change."),
        "nmad": Text(
            "1.4826 times the median of the absolute differences from the median: for normal errors equal to the "
            "standard deviation, but outliers do not change it (Höhle and Höhle 2009)."
        ),
        "q68": Text("68.3 % of the distances are smaller than this, sign left out."),
        "q95": Text("95 % of the distances are smaller than this, sign left out."),
    }
)
"""What each number of `distance_statistics` means."""


def distance_statistics(distances: Array) -> dict[str, float]:
    """Return the statistics of signed distances named in `DEFINITIONS`.

    Parameters
    ----------
    distances : float64 (n,)
        Any unit; NaN is left out.

    Returns
    -------
    dict of str to float
        In the unit of the distances; NaN where there are too few of them.
    """
    known = np.asarray(distances, dtype=np.float64)
    known = known[np.isfinite(known)]
    found = dict.fromkeys(DEFINITIONS, float("nan"))
    found["count"] = float(len(known))
    if len(known) == 0:
        return found
    absolute = np.abs(known)
    found["mean"] = float(known.mean())
    found["std"] = float(known.std(ddof=1)) if len(known) > 1 else float("nan")
    found["rmse"] = float(np.sqrt((known**2).mean()))
    found["median"] = float(np.median(known))
    found["nmad"] = nmad(known)
    found["q68"], found["q95"] = (float(q) for q in np.quantile(absolute, [0.683, 0.95]))
    return found


def nmad(values: Array) -> float:
    """Return ``1.4826 · median(|v − median(v)|)``, the robust spread; same unit as the values."""
    values = np.asarray(values, dtype=np.float64)
    return float(1.4826 * np.median(np.abs(values - np.median(values))))
