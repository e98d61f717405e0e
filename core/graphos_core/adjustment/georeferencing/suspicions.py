"""What the residuals of an absolute orientation say about wrong control points: blunders, axes, units, degrees."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import numpy as np

from graphos_core.data import Array
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.run import Run
from graphos_core.text import Text

OUTLIER = 5.0
"""A control point that misses by more than this many times the point RMS of the others is named."""

BAD_FIT = 0.02
"""Residuals beyond this share of the extent of the control points are a wrong system rather than noise."""

BETTER = 0.1
"""Another order of the axes is named when it lowers the residuals to this share."""


def name_suspicions(names: Sequence[str], model: Array, world: Array, run: Run) -> None:
    """Warn of what looks wrong with the coordinates of control points.

    Parameters
    ----------
    names : sequence of str
    model, world : float64 (n, 3)
        The same points in the block and as given.
    run : Run
    """
    if _degrees(world, model, run) or _axes(model, world, run):
        return
    _blunder(names, model, world, run)


def _fit(model: Array, world: Array) -> float:
    rest = estimate_similarity(model, world).apply(model) - world
    return float(np.sqrt((rest**2).mean()))


def _degrees(world: Array, model: Array, run: Run) -> bool:
    """Say whether the first two axes look like degrees beside a height in metres."""
    small = np.abs(world[:, :2]).max() <= 180.0
    extent = np.ptp(world, axis=0)
    flat = 0 < np.hypot(extent[0], extent[1]) < 1e-2 * max(extent[2], 1.0)
    if not (small and flat and _fit(model, world) > BAD_FIT * np.linalg.norm(extent)):
        return False
    run.warn(Text(
        "The control points look like longitude and latitude in degrees beside heights in metres: they fit the block "
        "badly. Give projected coordinates, or name the coordinate system of the table (EPSG code)."
    ))  # fmt: skip
    return True


def _axes(model: Array, world: Array, run: Run) -> bool:
    """Say whether the points fit much better with axes exchanged or turned round."""
    extent = float(np.linalg.norm(np.ptp(world, axis=0)))
    now = _fit(model, world)
    if len(world) < 4 or now < BAD_FIT * extent:
        return False
    tried = []
    for order in permutations(range(3)):
        for signs in ((1, 1, 1), (1, 1, -1)):  # one sign: the others are rotations of these
            if (order, signs) != ((0, 1, 2), (1, 1, 1)):
                tried.append((_fit(model, world[:, order] * signs), order, signs))
    best, order, signs = min(tried)
    if best > BETTER * now:
        return False
    axes = ", ".join(
        f"{'−' if sign < 0 else ''}{'XYZ'[axis]}" for axis, sign in zip(order, signs, strict=True)
    )
    run.warn(Text(
        "The control points do not fit the block ({now:.3g} m per coordinate), but would with the axes {axes} in place "
        "of X, Y, Z ({best:.3g} m): the table exchanges axes or is left-handed.", now=now, axes=axes, best=best,
    ))  # fmt: skip
    return True


def _blunder(names: Sequence[str], model: Array, world: Array, run: Run) -> None:
    """Warn of the control point without which the others fit much better, if it misses them by far."""
    if len(names) < 5:
        return  # too little is left over to tell a wrong point from bad luck
    found = []
    for i in range(len(names)):
        others = np.delete(np.arange(len(names)), i)
        rest = estimate_similarity(model[others], world[others]).apply(model) - world
        spread = float(np.sqrt((rest[others] ** 2).mean()))
        found.append((spread, float(np.linalg.norm(rest[i])), names[i]))
    others_rms, miss, name = min(found)
    if miss > max(OUTLIER * np.sqrt(3.0) * others_rms, 1e-9):
        run.warn(Text(
            "Control point {name} misses by {miss:.3g} m a similarity that fits the others to {rms:.2g} m per "
            "coordinate: its coordinates or measurements may be wrong.", name=name, miss=miss, rms=others_rms,
        ))  # fmt: skip
