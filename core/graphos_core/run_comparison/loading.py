"""One side of a run comparison: a project, one of its runs, or a result of its store, read from disk."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from graphos_core.data import Adjustment, Georeference
from graphos_core.errors import UserError
from graphos_core.project_file import FILE
from graphos_core.recipe import Recipe
from graphos_core.results import AdjustmentResult
from graphos_core.steps import steps_of
from graphos_core.store import Store
from graphos_core.text import Text

LAST_STEP = steps_of("adjustment")[-1].name
"""Step whose result is the adjusted block in its frame."""


@dataclass(frozen=True)
class ComparedRun:
    """An adjustment with what produced it.

    Attributes
    ----------
    label : str
        Name for people: ``"model, run 2"``.
    adjustment : Adjustment
    georeference : Georeference
    recipe : Recipe or None
        None where it is not known any more.
    """

    label: str
    adjustment: Adjustment
    georeference: Georeference
    recipe: Recipe | None = None


def load_compared_run(path: Path) -> ComparedRun:
    """Read one side of a comparison.

    Parameters
    ----------
    path : Path
        A project folder (its newest run), a run's folder (``MODEL/runs/0001``), or the folder of a stored result
        of the last step of the adjustment (``MODEL/results/adjustment/KEY``).

    Raises
    ------
    UserError
        When there is no such adjustment, or it cannot be read.
    """
    path = path.parent if path.name == FILE else path
    if not path.is_dir():
        raise UserError(
            Text("{name} does not exist.", name=path),
            todo="Name a project folder, the folder of one of its runs, or a stored result.",
        )
    path = path.resolve()
    if path.parent.name == LAST_STEP:
        return _stored(path.parents[2], path.name, f"{path.parents[2].name}, result {path.name[:6]}", None)
    if (path / FILE).is_file():
        runs = sorted(p for p in (path / "runs").glob("[0-9]*") if (p / "report.json").is_file())
        if not runs:
            raise _nothing(path)
        path = runs[-1]
    return _run(path)


def _run(folder: Path) -> ComparedRun:
    project = folder.parent.parent
    if not (project / FILE).is_file() or not (folder / "recipe.toml").is_file():
        raise UserError(
            Text("{name} is not a run of a project.", name=folder),
            "A run's folder lies below “runs” in the folder of its project.",
            "Name a project folder, or a folder such as MODEL/runs/0001.",
        )
    recipe = Recipe.load(folder / "recipe.toml")
    number = folder.name.lstrip("0") or folder.name
    return _stored(project, result_key(folder, project, recipe), f"{project.name}, run {number}", recipe)


def result_key(folder: Path, project: Path, recipe: Recipe) -> str:
    """Return the key of a run's adjustment, as its report says; of a run without it, as its recipe gives it now.

    Raises
    ------
    UserError
        When the run did not adjust.
    """
    try:
        report = json.loads((folder / "report.json").read_text("utf-8"))
        key = report.get("results", {}).get(LAST_STEP, "")
    except (OSError, ValueError, AttributeError, RecursionError):
        key = ""
    if isinstance(key, str) and key and key.isalnum():
        return key
    from graphos_core.pipeline import Pipeline
    from graphos_core.project import Project

    return Pipeline(Project.open(project), recipe).key(LAST_STEP)


def _stored(project: Path, key: str, label: str, recipe: Recipe | None) -> ComparedRun:
    store = Store(project / "results")
    if not store.has(LAST_STEP, key):
        raise _nothing(project)
    found = store.load(LAST_STEP, key)
    if not isinstance(found, AdjustmentResult):
        raise _nothing(project)
    return ComparedRun(label, found.adjustment, found.georeference, recipe)


def _nothing(folder: Path) -> UserError:
    return UserError(
        Text("{name} has no adjustment to compare.", name=folder),
        "It was never run as far as the adjustment, or its stored results were deleted.",
        "Run it until the adjustment, then compare.",
    )
