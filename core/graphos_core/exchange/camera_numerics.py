"""Fitting parameters to positions of a grid, and inverting a formula: the numerical side of camera conversion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from graphos_core.data import Array

ROUNDING_PX = 1e-8
"""What rounding the parameters of an exact conversion may cost, px."""

MANY = 20
"""Unknowns beyond which derivatives are taken one-sided: general polynomials, which are nearly linear in them."""

WRONG_PX = 1e4
"""Residual of a grid point that a trial camera gives no image, px."""


def fit(residual: Callable[[Array], Array], start: Array, free: Array) -> Array:
    """Return the values that make the residuals smallest, from `start`, by scipy's trust-region reflective method.

    Unknowns are scaled so that each moves the grid by about a pixel: coefficients of px⁻⁶ stand beside lengths in px.
    """
    from scipy.optimize import least_squares

    values = np.array(start, dtype=np.float64)

    def of_values(trial: Array) -> Any:
        out = residual(trial).ravel()
        return np.where(np.isfinite(out), np.clip(out, -WRONG_PX, WRONG_PX), WRONG_PX)

    which = np.flatnonzero(free)
    scale = np.array([_pixel_step(of_values, values, i) for i in which.tolist()])

    def of_unknowns(unknowns: Array) -> Any:
        trial = values.copy()
        trial[which] += scale * unknowns
        return of_values(trial)

    many = len(which) > MANY
    found = least_squares(
        of_unknowns, np.zeros(len(which)), jac="2-point" if many else "3-point",
        ftol=1e-10, xtol=1e-15, gtol=1e-15, max_nfev=15 if many else 60,
    )  # fmt: skip
    values[which] += scale * found.x
    return values


def rounded(residual: Callable[[Array], Array], values: Array) -> Array:
    """Return the values with nine significant digits where an exact fit stays exact: 1100 instead of 1099.9999999999."""
    worst = np.abs(residual(values)).max(initial=0.0)
    short = np.array([float(f"{v:.9g}") for v in values])
    kept = np.array([round(v) if abs(v) < WRONG_PX and abs(v - round(v)) < ROUNDING_PX else v for v in short])
    for trial in (kept, short):
        if np.abs(residual(trial)).max(initial=0.0) <= max(worst, ROUNDING_PX):
            return trial
    return values


def _pixel_step(residual: Callable[[Array], Array], values: Array, i: int) -> float:
    """Return the step of one unknown that moves the grid by 0.1 to 10 px RMS; 1 where nothing moves it."""
    before, step = residual(values), 1.0
    for _ in range(80):
        trial = values.copy()
        trial[i] += step
        moved = float(np.sqrt(((residual(trial) - before) ** 2).mean()))
        if 0.1 <= moved <= 10.0:
            return step
        if moved < 1e-12 and step >= 1e3:
            return 1.0
        step *= 10.0 if moved < 0.1 else 0.1
    return 1.0


def directions(a: Array, wide: bool) -> Array:
    """Return directions (n, 3) from two coordinates: x/z, y/z, or for a fish-eye the angle from the axis, radians."""
    if not wide:
        return np.column_stack([a, np.ones(len(a))])
    angle = np.hypot(a[:, 0], a[:, 1])
    scale = np.where(angle > 1e-12, np.sin(angle) / np.maximum(angle, 1e-300), 1.0)
    return np.column_stack([a * scale[:, None], np.cos(angle)])


def invert(
    function: Callable[[Array], Array], wanted: Array, *, around: Array | None = None, step: float = 1e-6
) -> Array:
    """Solve ``function(a) = wanted`` for every row by Newton's method with step halving; NaN where it fails."""
    here = (
        np.zeros_like(wanted)
        if around is None
        else np.broadcast_to(around, wanted.shape).astype(np.float64).copy()
    )
    along_x, along_y = np.array([step, 0.0]), np.array([0.0, step])
    scale = np.abs(wanted).max(initial=1.0)
    error = function(here) - wanted
    for _ in range(60):
        if np.nanmax(np.abs(error), initial=0.0) < 1e-13 * scale:
            break
        jx = (function(here + along_x) - function(here - along_x)) / (2 * step)
        jy = (function(here + along_y) - function(here - along_y)) / (2 * step)
        det = jx[:, 0] * jy[:, 1] - jx[:, 1] * jy[:, 0]
        move = np.column_stack(
            [jy[:, 1] * error[:, 0] - jy[:, 0] * error[:, 1], jx[:, 0] * error[:, 1] - jx[:, 1] * error[:, 0]]
        ) / np.where(det == 0, np.nan, det)[:, None]  # fmt: skip
        size = np.ones(len(here))
        for _ in range(8):
            trial = here - size[:, None] * move
            after = function(trial) - wanted
            worse = ~(np.abs(after).sum(axis=1) <= np.abs(error).sum(axis=1))
            if not worse.any():
                break
            size = np.where(worse, size / 2, size)
        keep = ~worse
        here[keep], error[keep] = trial[keep], after[keep]
        if not keep.any():
            break
    done = np.abs(error).max(axis=1) < 1e-9 * scale
    return np.where(done[:, None], here, np.nan)
