"""What is compared: detectors, each with every combination of the parameter values that were asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from graphos_core import registry
from graphos_core.errors import UserError
from graphos_core.params import unknown_name
from graphos_core.recipe import CHAINS, DEFAULTS, Recipe
from graphos_core.text import Text

ANY_DETECTOR = "detector"
"""In an assignment the name that stands for every detector: ``features.detector.maximum=2000``."""

PRESETS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "arpenteur": (
        ("sift", "akaze", "fast"),
        ("features.detector.reduction=1", "features.detector.maximum=100000"),
    ),
}
"""Ready comparisons: detectors and assignments. ARPENTEUR compared SIFT, SURF and FAST by number and time; SURF is in no
free build of OpenCV, and AKAZE takes its place: like SURF it looks for maxima of the determinant of the Hessian."""


@dataclass(frozen=True)
class Variant:
    """One row of a comparison.

    Attributes
    ----------
    label : str
        Name of the detector and what was set: ``"sift contrast=0.02"``.
    detector : str
    recipe : Recipe
        With everything else that is used: filters, matcher, verification.
    changes : tuple of (str, str)
        What was set, as parameter and value.
    """

    label: str
    detector: str
    recipe: Recipe
    changes: tuple[tuple[str, str], ...] = ()


def detectors() -> list[str]:
    """Return the names of all detectors."""
    return [algorithm.name for algorithm in registry.algorithms("features", "detector")]


def variants(
    names: Sequence[str], assignments: Sequence[str] = (), seed: int = 0, base: Recipe | None = None
) -> tuple[Variant, ...]:
    """Return what is compared: every detector with every combination of values.

    Parameters
    ----------
    names : sequence of str
        Detectors; one that is named twice counts once.
    assignments : sequence of str
        ``features.sift.contrast=0.02,0.04`` gives SIFT two rows; ``features.detector.maximum=2000`` concerns every
        detector; ``features.mutual.ratio=0.7,0.8`` and ``features.matcher=mutual,robust`` concern all rows.
        Values are separated by commas, the two numbers of a pair by a semicolon, filters of one chain by ``+``.
    seed : int
        Of the recipe.
    base : Recipe, optional
        Choices and parameters where nothing is assigned; the default recipe without it.

    Raises
    ------
    UserError
        For an unknown detector, and for an assignment that concerns nothing that is compared.
    ParamError
        For an unknown parameter or a value out of its declaration.
    """
    names = list(dict.fromkeys(name.strip().lower() for name in names if name.strip()))
    if not names:
        raise UserError(
            "There is nothing to compare.", "No detector is named.", "Name detectors, such as sift,orb."
        )
    for name in names:
        if name not in detectors():
            raise UserError(unknown_name(name, detectors(), "detector"))
    split = [_split(assignment) for assignment in assignments]
    used: set[str] = set()
    base = (base or Recipe.default()).with_seed(seed)
    found = [variant for name in names for variant in _of_detector(name, split, base, used)]
    for path, _ in split:
        if path not in used:
            raise UserError(
                Text("{path} changes nothing here.", path=path),
                "It belongs to an algorithm that is not compared.",
                "Add the algorithm to the comparison, or leave the assignment out.",
            )
    return tuple(found)


def _split(assignment: str) -> tuple[str, tuple[str, ...]]:
    path, equals, text = assignment.partition("=")
    values = tuple(value.strip() for value in text.split(",") if value.strip())
    if not equals or path.count(".") not in (1, 2) or not values:
        raise UserError(
            Text("“{text}” is not an assignment.", text=assignment),
            todo="Write features.algorithm.parameter=value[,value…], such as features.sift.contrast=0.02,0.04.",
        )
    return path.strip(), values


def _of_detector(
    name: str, split: Sequence[tuple[str, tuple[str, ...]]], base: Recipe, used: set[str]
) -> list[Variant]:
    """Return the rows of one detector; `used` collects the assignments that concern it."""
    base = base.choose("features", "detector", name)
    choices = [item for item in split if item[0].count(".") == 1]
    sheets = [item for item in split if item[0].count(".") == 2]
    found = []
    for values in product(*(v for _, v in choices)):
        recipe = base
        for (path, _), value in zip(choices, values, strict=True):
            recipe = _choose(recipe, path, value)
            used.add(path)
        fitting = [(path, v) for path, v in sheets if _concerns(path, recipe)]
        used.update(path for path, _ in fitting)
        for combination in product(*(v for _, v in fitting)):
            found.append(_variant(name, recipe, choices, values, fitting, combination))
    unique = {variant.label: variant for variant in found}
    return list(unique.values())


def _choose(recipe: Recipe, path: str, value: str) -> Recipe:
    stage, role = path.split(".")
    if (stage, role) == ("features", "detector"):
        raise UserError(
            "The detectors are not set, they are compared.",
            todo="Name them as algorithms of the comparison.",
        )
    if stage not in ("preprocessing", "features"):
        raise UserError(
            Text("{path} changes nothing here.", path=path),
            "Only preprocessing and features are part of the comparison.",
            "Leave the assignment out.",
        )
    return recipe.choose(stage, role, value.split("+") if role in CHAINS else value)


def _concerns(path: str, recipe: Recipe) -> bool:
    stage, name, _ = path.split(".")
    if stage == "features" and name == ANY_DETECTOR:
        return True
    registry.find(stage, name)
    return any(
        name in recipe.chosen(s, role)
        for s in ("preprocessing", "features")
        if s == stage
        for role in DEFAULTS[s]
    )


def _variant(
    name: str,
    recipe: Recipe,
    choices: Sequence[tuple[str, tuple[str, ...]]],
    chosen: Sequence[str],
    sheets: Sequence[tuple[str, tuple[str, ...]]],
    values: Sequence[str],
) -> Variant:
    changes, said = [], []
    for (path, options), value in zip(choices, chosen, strict=True):
        changes.append((path.partition(".")[2], value))
        said += [value] if len(options) > 1 else []
    for (path, options), value in zip(sheets, values, strict=True):
        stage, algorithm, parameter = path.split(".")
        algorithm = name if algorithm == ANY_DETECTOR else algorithm
        recipe = recipe.set(f"{stage}.{algorithm}.{parameter}={value}")
        changes.append((f"{algorithm}.{parameter}", value))
        said += [f"{parameter}={value}"] if len(options) > 1 else []
    return Variant(" ".join([name, *said]), name, recipe, tuple(changes))
