"""What the residuals of an absolute orientation say about wrong coordinates: blunders, axes, units, degrees."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, islice

import numpy as np
from scipy import special

from graphos_core.data import Array
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.run import Run
from graphos_core.text import Text

FALSE_ALARMS = 0.001
"""Probability that a point of good control is named."""

BAD_FIT = 0.02
"""Residuals beyond this share of the extent of the points are a wrong system rather than noise."""

BETTER = 0.1
"""Another reading of the coordinates is named when it lowers the residuals to this share."""

EXACT = 1e-6
"""Residuals below this share of the extent are not looked into."""

FLAT = 0.1
"""Points whose heights differ by less than this share of their extent lie in about a horizontal plane."""

DEGREE_M = 111_320.0
"""Length of a degree of latitude, m."""

READINGS = {
    1e-3: ("mm", "m"), 1e-2: ("cm", "m"), 0.3048: ("ft", "m"), 1.0 / 0.3048: ("m", "ft"), 1e2: ("m", "cm"),
    1e3: ("m", "mm"),
}  # fmt: skip
"""What some coordinates are multiplied by to agree with others: their unit, and that of the others."""

IN_DEGREES = Text(
    "they look like longitude and latitude in degrees beside heights in metres and fit the block badly. Give projected "
    "coordinates, or name the coordinate system of the table (EPSG code)."
)

MOST_TRIPLES = 300


def name_suspicions(
    names: Sequence[str], model: Array, world: Array, run: Run, *, origin: Array | None = None,
    what: str = "control points",
) -> None:  # fmt: skip
    """Warn of what looks wrong with the coordinates of points: the first of the readings that explains the misfit.

    Parameters
    ----------
    names : sequence of str
    model, world : float64 (n, 3)
        The same points in the block and as given.
    run : Run
    origin : float64 (3,), optional
        Local origin that was taken off `world`.
    what : str
        What the points are.
    """
    if _fit(model, world) < EXACT:
        return
    whole = world if origin is None else world + origin
    found = (
        _degrees(model, world)
        or _left_handed(model, world)
        or _unit_of_axis(model, world)
        or _unit_of_rows(names, model, whole)
        or _blunder(names, model, world)
    )
    if found is not None:
        run.warn(Text("{what}: {found}", what=what[:1].upper() + what[1:], found=found))
    elif _fit(model, world) > BAD_FIT:
        run.warn(Text(
            "The {what} do not fit the block: {now:.3g} m per coordinate at an extent of {extent:.3g} m. Names may be "
            "mixed up, or the coordinates belong to another object.", what=what, now=_fit(model, world) * _extent(world),
            extent=_extent(world),
        ))  # fmt: skip


def name_below(world: Array, centres: Array, run: Run) -> None:
    """Warn where all photos look at horizontally spread control points from below.

    Points in a plane fit their mirror image as well, so exchanged axes show nowhere but on which side the cameras are.

    Parameters
    ----------
    world : float64 (n, 3)
        Control points.
    centres : float64 (k, 3)
        Projection centres, in the same frame.
    run : Run
    """
    extent = np.ptp(world, axis=0)
    if extent[2] < FLAT * float(np.hypot(extent[0], extent[1])) and centres[:, 2].max() < world[:, 2].min():
        run.warn(
            "All photos lie below the control points, which are in about a horizontal plane. Unless it is a ceiling, X "
            "and Y are exchanged (surveyors write north first), or the sign of an axis is wrong."
        )


def _extent(world: Array) -> float:
    return float(np.linalg.norm(np.ptp(world, axis=0))) or 1.0


def _fit(model: Array, world: Array) -> float:
    """Return the RMS per coordinate that a similarity leaves, as a share of the extent."""
    rest = estimate_similarity(model, world).apply(model) - world
    return float(np.sqrt((rest**2).mean())) / _extent(world)


def _degrees(model: Array, world: Array) -> str | None:
    """Look whether the first two axes are degrees beside a height in metres."""
    now = _fit(model, world)
    if np.abs(world[:, :2]).max() > 180.0 or now < BAD_FIT:
        return None
    fits = []
    for lat in (0, 1):
        metres = DEGREE_M * np.ones(3)
        metres[1 - lat], metres[2] = DEGREE_M * np.cos(np.radians(world[:, lat].mean())), 1.0
        fits.append(_fit(model, world[:, [1 - lat, lat, 2]] * metres[[1 - lat, lat, 2]]))
    return IN_DEGREES if look_like_degrees(world) or (len(world) >= 4 and min(fits) < BETTER * now) else None


def look_like_degrees(world: Array) -> bool:
    """Say whether points (n, 3) differ so little in X and Y, beside their heights, that those may be degrees."""
    extent = np.ptp(world, axis=0)
    narrow = 0 < np.hypot(extent[0], extent[1]) < 1e-2 * max(extent[2], 1.0)
    return bool(np.abs(world[:, :2]).max() <= 180.0 and narrow)


def _left_handed(model: Array, world: Array) -> str | None:
    """Look whether the mirror image fits much better; which axes are exchanged, nothing can tell."""
    now, mirrored = _fit(model, world), _fit(model, world * [1.0, 1.0, -1.0])
    if len(world) < 4 or mirrored > BETTER * now:
        return None
    return Text(
        "they do not fit the block ({now:.3g} m per coordinate), but their mirror image does ({best:.3g} m): the table "
        "exchanges axes or is left-handed. Exchange X and Y (surveyors write north first), or turn the sign of one axis.",
        now=now * _extent(world), best=mirrored * _extent(world),
    )  # fmt: skip


def _unit_of_axis(model: Array, world: Array) -> str | None:
    """Look whether one axis is in another unit than the two others."""
    now = _fit(model, world)
    if len(world) < 4 or now < BAD_FIT:
        return None
    tried = []
    for axis in range(3):
        for factor in READINGS:
            scale = np.ones(3)
            scale[axis] = factor
            tried.append((_fit(model, world * scale), "XYZ"[axis], factor))
    best, name, factor = min(tried)
    if best > BETTER * now:
        return None
    unit, of = READINGS[factor]
    return Text("{axis} fits the other axes when multiplied by {factor:.4g}, as if it were in {unit} and they in {of}. "
                "Give all of them in m, or write the unit in the header, “{axis} [{unit}]”.", axis=name, factor=factor,
                unit=unit, of=of)  # fmt: skip


def _unit_of_rows(names: Sequence[str], model: Array, whole: Array) -> str | None:
    """Look whether some points are in another unit than most: three fit together, the rest fit multiplied by a factor."""
    best: tuple[int, list[str], float] = (0, [], 1.0)
    for triple in islice(combinations(range(len(names)), 3), MOST_TRIPLES):
        index = np.array(triple)
        spread = np.linalg.svd(model[index] - model[index].mean(axis=0), compute_uv=False)
        if spread[1] < 0.05 * spread[0]:
            continue
        there = estimate_similarity(model[index], whole[index]).apply(model)
        near = BAD_FIT * _extent(there)
        fit = np.linalg.norm(there - whole, axis=1) < near
        rest = np.flatnonzero(~fit)
        if fit.sum() < 3 or fit.sum() <= best[0] or len(rest) > fit.sum() or not len(rest):
            continue
        for factor in READINGS:
            if (np.linalg.norm(there[rest] - factor * whole[rest], axis=1) < near).all():
                best = int(fit.sum()), [names[int(i)] for i in rest], factor
    if not best[0]:
        return None
    unit, of = READINGS[best[2]]
    return Text("units are mixed: multiplied by {factor:.4g}, {points} would fit the others, as if given in {unit} and "
                "the others in {of}. Give all of them in m.", points=", ".join(best[1][:8]) + " …" * (len(best[1]) > 8),
                factor=best[2], unit=unit, of=of)  # fmt: skip


def _blunder(names: Sequence[str], model: Array, world: Array) -> str | None:
    """Look for the point without which the others fit significantly better.

    A shift of one point is three more unknowns: the fall of the sum of squares they bring, against what remains, follows
    F with 3 and 3 (n − 1) − 7 degrees of freedom where all points are good (mean shift model: Cook and
    Weisberg 1982, Residuals and Influence in Regression, section 2.2; Bonferroni for n points).
    """
    freedom = 3 * (len(names) - 1) - 7
    if len(names) < 5:
        return None  # too little is left over to tell a wrong point from bad luck
    whole = estimate_similarity(model, world).apply(model) - world
    found = []
    for i in range(len(names)):
        others = np.delete(np.arange(len(names)), i)
        rest = estimate_similarity(model[others], world[others]).apply(model) - world
        found.append((float((rest[others] ** 2).sum()), float(np.linalg.norm(rest[i])), names[i]))
    squares, miss, name = min(found)
    fall = max(float((whole**2).sum()) - squares, 0.0) / 3.0
    if fall <= special.fdtri(3.0, freedom, 1.0 - FALSE_ALARMS / len(names)) * squares / freedom:
        return None
    return Text(
        "{name} misses by {miss:.3g} m a similarity that fits the others to {rms:.2g} m per coordinate: its coordinates "
        "or measurements may be wrong.", name=name, miss=miss, rms=float(np.sqrt(squares / (3 * len(names) - 3))),
    )  # fmt: skip
