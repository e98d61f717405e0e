"""What two recipes do differently."""

from __future__ import annotations

from graphos_core.recipe import DEFAULTS, Recipe
from graphos_core.registry import STAGES
from graphos_core.run_comparison.records import ParameterDifference


def recipe_difference(a: Recipe, b: Recipe) -> tuple[ParameterDifference, ...]:
    """Return every choice and every parameter of a chosen algorithm that differs, in the order of the rooms."""
    found = []
    if a.seed != b.seed:
        found.append(ParameterDifference("recipe", "seed", "Seed", "", a.seed, b.seed))
    for stage in STAGES:
        for role in DEFAULTS[stage]:
            one, two = a.chosen(stage, role), b.chosen(stage, role)
            if one != two:
                found.append(
                    ParameterDifference(stage, role, role.capitalize(), "", ", ".join(one), ", ".join(two))
                )
            for name in dict.fromkeys((*one, *two)):
                found += _sheet_difference(a, b, stage, name, name in one, name in two)
    return tuple(found)


def _sheet_difference(
    a: Recipe, b: Recipe, stage: str, name: str, in_a: bool, in_b: bool
) -> list[ParameterDifference]:
    if not (in_a and in_b):
        return []
    one, two = a.params(stage, name), b.params(stage, name)
    values_a, values_b = one.to_dict(), two.to_dict()
    return [
        ParameterDifference(f"{stage}.{name}", key, d.about.label, d.about.unit, values_a[key], values_b[key])
        for key, d in one.declarations().items()
        if values_a[key] != values_b[key]
    ]
