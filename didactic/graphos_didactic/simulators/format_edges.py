"""Where a line leaves the format of a photo."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Camera
from graphos_core.data.record import Array


def line_in_format(line: Array, camera: Camera) -> Array | None:
    """Return the two points (2, 2) where a line ``l₀x + l₁y + l₂ = 0`` leaves a camera's format; None outside."""
    left, top, right, bottom = -0.5, -0.5, camera.width - 0.5, camera.height - 0.5
    found = []
    if abs(line[1]) > 1e-12:
        found += [(x, -(line[0] * x + line[2]) / line[1]) for x in (left, right)]
    if abs(line[0]) > 1e-12:
        found += [(-(line[1] * y + line[2]) / line[0], y) for y in (top, bottom)]
    inside = sorted(
        (x, y) for x, y in found if left - 1e-6 <= x <= right + 1e-6 and top - 1e-6 <= y <= bottom + 1e-6
    )
    return np.array([inside[0], inside[-1]]) if len(inside) > 1 else None
