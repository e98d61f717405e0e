"""Object points as figures: rays, intersection angles, precision."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.data import Adjustment, Array
from graphos_core.quality.internal import widest_angles
from graphos_core.report.values import spread


def object_points(adjustment: Adjustment) -> dict[str, Any]:
    """Return the part ``object_points`` of the report."""
    rays = rays_per_point(adjustment)
    sigmas = adjustment.sigma_points
    finite = np.isfinite(sigmas).all(axis=1)
    numbers, counts = np.unique(rays, return_counts=True)
    return {
        "count": len(rays),
        "unit": adjustment.block.unit,
        "rays": {int(n): int(c) for n, c in zip(numbers, counts, strict=True)},
        "intersection_angle_deg": spread(np.degrees(widest_angles(adjustment.block))),
        "sigma": {axis: spread(sigmas[finite, k]) for k, axis in enumerate("xyz")} if finite.any() else None,
        "undetermined": int(len(sigmas) - finite.sum()),
    }


def rays_per_point(adjustment: Adjustment) -> Array:
    """Return the number of rays of each object point that has any; int (p,)."""
    counts = np.bincount(adjustment.block.obs_point, minlength=len(adjustment.block.points))
    return np.asarray(counts[counts > 0])
