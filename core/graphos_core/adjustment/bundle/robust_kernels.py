"""Robust functions for compiled loops: ρ(s) and the weight ρ'(s) of the squared normalised length s of a residual."""

from __future__ import annotations

import numpy as np
from numba import njit

NONE, HUBER, CAUCHY, GEMAN_MCCLURE, TUKEY, L1, DANISH = range(7)
"""Codes of the robust functions; see `graphos_core.adjustment.bundle.robust`."""

ROUND = 1e-2
"""L1 is rounded within this share of its scale, so that its weight stays finite."""


@njit(cache=True, nogil=True, inline="always")
def robust(kind: int, scale: float, square: float) -> tuple[float, float]:
    """Return ρ(s) and the weight ρ'(s) of the squared length s of a residual; the scale is in the same unit."""
    if kind == NONE:
        return square, 1.0
    limit = scale * scale
    if kind == HUBER:
        if square <= limit:
            return square, 1.0
        length = np.sqrt(square)
        return 2.0 * scale * length - limit, scale / length
    if kind == CAUCHY:
        ratio = 1.0 + square / limit
        return limit * np.log(ratio), 1.0 / ratio
    if kind == GEMAN_MCCLURE:
        ratio = 1.0 / (1.0 + square / limit)
        return square * ratio, ratio * ratio
    if kind == TUKEY:
        if square >= limit:
            return limit / 3.0, 0.0
        rest = 1.0 - square / limit
        return limit / 3.0 * (1.0 - rest * rest * rest), rest * rest
    if kind == L1:
        small = ROUND * scale
        length = np.sqrt(square + small * small)
        return 2.0 * scale * (length - small), scale / length
    if square <= limit:
        return square, 1.0
    weight = np.exp(1.0 - square / limit)
    return limit * (2.0 - weight), weight
