"""Two adjustments of one block side by side: what was done differently, and what difference it makes.

Differences are always **B − A**. Where the two blocks are not in the same frame, B is moved onto A by a similarity
first, and that is said: only shape and relative position can then be compared.
"""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array, Block
from graphos_core.errors import UserError
from graphos_core.number_format import format_number
from graphos_core.run_comparison.cameras import calibration_difference, camera_differences
from graphos_core.run_comparison.geometry import (
    common_frame,
    photo_differences,
    photo_pairs,
    point_differences,
    point_pairs,
    triple,
)
from graphos_core.run_comparison.loading import ComparedRun, load_compared_run
from graphos_core.run_comparison.numbers import (
    information,
    number_differences,
    same_weights,
    weighted_squares,
)
from graphos_core.run_comparison.recipes import recipe_difference
from graphos_core.run_comparison.records import CheckDifference, Comparison
from graphos_core.run_comparison.statement import statement
from graphos_core.text import Text


def compare(a: ComparedRun, b: ComparedRun) -> Comparison:
    """Compare two adjustments of one block.

    Parameters
    ----------
    a, b : ComparedRun
        From `load_compared_run`, or made of what the window holds.

    Raises
    ------
    UserError
        When the two have no oriented photo in common.
    """
    first, second = a.adjustment, b.adjustment
    pairs = photo_pairs(first.block, second.block)
    if not pairs:
        raise UserError(
            Text("{a} and {b} cannot be compared.", a=a.label, b=b.label),
            "No photo is oriented in both: they are not adjustments of one block.",
            "Choose two runs over the same photos.",
        )
    points = point_pairs(first.block, second.block)
    frame, a_from_b = common_frame(a, b, pairs, points)
    cameras, calibrations = camera_differences(first.block, second.block, pairs)
    names_a, names_b = _oriented_names(first.block), _oriented_names(second.block)
    numbers = number_differences(first, second)
    moved, check = point_differences(first, second, points, a_from_b), _check(a, b)
    return Comparison(
        a=a.label,
        b=b.label,
        recipe=recipe_difference(a.recipe, b.recipe) if a.recipe and b.recipe else (),
        numbers=numbers,
        cameras=cameras,
        calibrations=calibrations,
        frame=frame,
        photos=photo_differences(first, second, pairs, a_from_b),
        only_a=tuple(n for n in names_a if n not in set(names_b)),
        only_b=tuple(n for n in names_b if n not in set(names_a)),
        points=moved,
        check=check,
        notes=_notes(a, b),
        statement=statement(numbers, cameras, frame, moved, check),
    )


def _oriented_names(block: Block) -> list[str]:
    return [block.names[i] for i in np.flatnonzero(block.oriented)]


def _check(a: ComparedRun, b: ComparedRun) -> CheckDifference:
    one, two = check_residuals(a), check_residuals(b)
    return CheckDifference(len(one), len(two), *(
        triple(np.sqrt((r**2).mean(axis=0))) if len(r) else None for r in (one, two)
    ))  # fmt: skip


def check_residuals(run: ComparedRun) -> Array:
    """Return the residuals of the check points, computed − given, m; float64 (k, 3)."""
    if run.adjustment.check is not None:
        return np.asarray(run.adjustment.check.residuals)
    found = run.georeference
    return np.asarray(found.residuals).reshape(-1, 3)[np.asarray(found.check, dtype=bool)]


def _notes(a: ComparedRun, b: ComparedRun) -> tuple[str, ...]:
    one, two = a.adjustment, b.adjustment
    notes: list[str] = []
    if not (a.recipe and b.recipe):
        notes.append(Text("The recipe of a stored result is not known: recipes were not compared."))
    if one.observations != two.observations:
        notes.append(Text(
            "The two adjusted different observations ({a} and {b} scalars): AIC and BIC do not decide between them.",
            a=one.observations, b=two.observations))  # fmt: skip
    elif not same_weights(one, two):
        notes.append(Text(
            "The two weighted image points against the other observations differently ({a} px and {b} px a priori): AIC "
            "and BIC do not decide between them.", a=format_number(one.prior_px, digits=3),
            b=format_number(two.prior_px, digits=3)))  # fmt: skip
    for label, adjustment in ((a.label, one), (b.label, two)):
        if not adjustment.converged:
            notes.append(Text("{label} did not converge: {why}.", label=label, why=adjustment.stop_reason))
    return tuple(notes)


__all__ = [
    "ComparedRun",
    "Comparison",
    "calibration_difference",
    "compare",
    "information",
    "load_compared_run",
    "recipe_difference",
    "weighted_squares",
]
