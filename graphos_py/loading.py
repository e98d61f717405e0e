"""What is read outside the window's thread: the engine, projects, stored results."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from graphos_core.errors import GraphosError
from graphos_core.registry import Stage
from graphos_core.run import Run
from graphos_core.text import Text

if TYPE_CHECKING:
    from graphos_core.pipeline import Pipeline
    from graphos_core.project import Project
    from graphos_core.recipe import Recipe

DRAFT = "recipe_in_work.toml"
"""The recipe as it stands in the window; ``recipe.toml`` beside it belongs to the last report."""


def load_engine() -> None:
    """Import the engine with all its algorithms; slow the first time, so never called in the window's thread."""
    import graphos_core.pipeline
    import graphos_core.results  # noqa: F401  the store finds record classes by name
    from graphos_core import registry

    registry.algorithms()


def open_project(folder: Path, photos: Path | None, run: Run) -> tuple[Project, Recipe]:
    """Open a project with its recipe; `photos` says where the photos are now, when they moved."""
    load_engine()
    from graphos_core.project import Project
    from graphos_core.recipe import Recipe

    project = Project.open(folder, photos=photos, run=run)
    files = (project.folder / name for name in (DRAFT, "recipe.toml"))
    file = next((file for file in files if file.is_file()), None)
    try:
        return project, Recipe.load(file) if file is not None else Recipe.default(project.seed)
    except GraphosError as problem:  # of another version: the results stay, the parameters start anew
        run.warn(Text("The project's recipe is not used, the defaults are. {why}", why=problem))
        return project, Recipe.default(project.seed)


def create_project(folder: Path, photos: Path, run: Run, **settings: Any) -> tuple[Project, Recipe]:
    """Make a project, with the default recipe."""
    load_engine()
    from graphos_core.project import Project
    from graphos_core.recipe import Recipe

    project = Project.create(folder, photos, run=run, **settings)
    return project, Recipe.default(project.seed)


def read_latest(pipeline: Pipeline, stages: Sequence[Stage], run: Run) -> None:
    """Show the last complete result of each stage; one that cannot be read counts as none."""
    for stage in stages:
        run.check()
        try:
            run.show(stage, (pipeline, pipeline.latest(stage)))
        except GraphosError:  # the stage's state says why
            run.show(stage, (pipeline, None))
