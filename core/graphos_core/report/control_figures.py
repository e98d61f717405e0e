"""What is known about the object against what was computed: control, check points, distances and the rest."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.data import Adjustment, Georeference, ObservationGroup
from graphos_core.report.values import rms_per_axis

IMAGE_KINDS = ("tie points", "control image points")
"""Groups whose observations are image coordinates, which residuals and reliability describe."""

MOST_ROWS = 300
"""So many observations of a group are listed one by one."""


def georeferencing(found: Georeference) -> dict[str, Any]:
    """Return the part ``georeferencing`` of the report."""
    return {
        "method": found.method,
        "scale": found.scale,
        "origin_m": found.origin,
        "rms_m": found.rms_m,
        "check_rms_m": found.check_rms_m,
        "points": [
            {"name": name, "check": bool(check), "residual_m": residual}
            for name, check, residual in zip(found.names, found.check, found.residuals, strict=True)
        ],
    }


def control(adjustment: Adjustment, placed: Georeference) -> dict[str, Any] | None:
    """Return the part ``control``: residuals of what took part; None without control points."""
    group = next((g for g in adjustment.groups if g.kind == "control coordinates"), None)
    if group is not None and group.labels:
        points = _weighted(group)
        how = "weighted observations"
    else:
        taken = [i for i in range(len(placed.names)) if not placed.check[i]]
        fixed = bool(adjustment.groups) and not _only_compared(adjustment, placed)
        points = [
            {"name": placed.names[i], "residual_m": np.zeros(3) if fixed else placed.residuals[i], "sigma_m": None,
             "w": None}
            for i in taken
        ]  # fmt: skip
        how = "held fixed" if fixed else "similarity"
    if not points:
        return None
    residuals = np.array([p["residual_m"] for p in points], dtype=np.float64)
    return {"how": how, "count": len(points), "rms_m": rms_per_axis(residuals), "points": points}


def _only_compared(adjustment: Adjustment, placed: Georeference) -> bool:
    """Say whether control points only placed the block and are compared with it afterwards."""
    if adjustment.check is None:
        return False
    return any(n in adjustment.check.names for n, c in zip(placed.names, placed.check, strict=True) if not c)


def _weighted(group: ObservationGroup) -> list[dict[str, Any]]:
    """Return the points of a group whose labels are ``"NAME X"``, one entry per point; NaN on axes not observed."""
    rows: dict[str, dict[str, Any]] = {}
    for i, label in enumerate(group.labels):
        name, _, axis = label.rpartition(" ")
        row = rows.setdefault(
            name, {"name": name} | {k: np.full(3, np.nan) for k in ("residual_m", "sigma_m", "w")}
        )
        k = "XYZ".find(axis)
        if k >= 0:
            row["residual_m"][k] = group.residuals[i]
            row["sigma_m"][k] = group.sigmas[i]
            row["w"][k] = group.standardised[i]
    return list(rows.values())


def check(adjustment: Adjustment, placed: Georeference) -> dict[str, Any] | None:
    """Return the part ``check``: accuracy against points that took no part; None without check points."""
    found = adjustment.check
    if found is not None:
        names, residuals, sigmas, given = found.names, found.residuals, found.sigmas, found.given_sigmas
    else:
        kept = np.flatnonzero(np.asarray(placed.check, dtype=bool))
        names = tuple(placed.names[i] for i in kept)
        residuals = np.asarray(placed.residuals).reshape(-1, 3)[kept]
        sigmas = given = np.full((len(kept), 3), np.nan)
    if not len(names):
        return None
    placing = {n for n, c in zip(placed.names, placed.check, strict=True) if not c}
    predicted = np.sqrt(sigmas**2 + np.nan_to_num(given) ** 2)
    return {
        "count": len(names),
        "mean_m": residuals.mean(axis=0),
        "rms_m": rms_per_axis(residuals),
        "predicted_m": rms_per_axis(predicted),
        "points": [
            {"name": names[i], "role": "placed" if names[i] in placing else "check", "residual_m": residuals[i],
             "sigma_m": sigmas[i], "given_sigma_m": given[i],
             "normalised": residuals[i] / np.where(predicted[i] > 0, predicted[i], np.nan)}
            for i in range(len(names))
        ],
    }  # fmt: skip


def other_groups(adjustment: Adjustment) -> list[dict[str, Any]]:
    """Return the part ``known``: every group beside image points and control coordinates, observation by observation."""
    return [
        {
            "kind": g.kind,
            "unit": g.unit,
            "count": g.count,
            "listed": min(len(g.labels), MOST_ROWS),
            "observations": [
                {"label": g.labels[i], "observed": g.observed[i], "residual": g.residuals[i], "sigma": g.sigmas[i],
                 "redundancy_number": g.redundancy_numbers[i], "w": g.standardised[i], "mdb": g.mdb[i]}
                for i in range(min(len(g.labels), MOST_ROWS))
            ],
        }
        for g in adjustment.groups
        if g.kind not in (*IMAGE_KINDS, "control coordinates")
    ]  # fmt: skip
