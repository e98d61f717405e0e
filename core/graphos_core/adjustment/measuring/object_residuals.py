"""Residuals of control and check points in object space by name, whichever way the block was placed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphos_core.data import Adjustment, Array, Georeference

AXES = "XYZ"


def object_residuals(adjustment: Adjustment, georeference: Georeference) -> Mapping[str, Array]:
    """Return computed − given by name of the point, float64 (3,), m; NaN on an axis without a given coordinate.

    Coordinates that were observations of the adjustment come first, then its check points, then what the similarity
    that placed the block left over.
    """
    found: dict[str, Array] = {
        name: np.asarray(residual, dtype=np.float64)
        for name, residual in zip(georeference.names, georeference.residuals, strict=True)
    }
    if adjustment.check is not None:
        found.update(zip(adjustment.check.names, np.asarray(adjustment.check.residuals), strict=True))
    for group in adjustment.groups:
        if group.kind == "control coordinates":
            found.update(_by_point(group.labels, np.asarray(group.residuals)))
    return found


def _by_point(labels: tuple[str, ...], residuals: Array) -> dict[str, Array]:
    """Gather ``"T01 X"``, ``"T01 Y"`` … by point; residuals of observations are adjusted − observed."""
    found: dict[str, Array] = {}
    for label, residual in zip(labels, residuals, strict=True):
        name, _, axis = label.rpartition(" ")
        if axis in AXES and name:
            found.setdefault(name, np.full(3, np.nan))[AXES.index(axis)] = residual
    return found
