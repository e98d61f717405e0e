"""A small simulated block, run once through the whole pipeline, for the tests that need results."""

from __future__ import annotations

from pathlib import Path

import pytest

from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run
from graphos_core.simulation.photo_block import simulate_photos


@pytest.fixture(scope="session")
def small_simulation(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five photos of the façade, 640 × 480, with truth."""
    folder = tmp_path_factory.mktemp("simulation ä")
    simulate_photos("facade", folder, width=640, height=480, photos=5, seed=1, run=Run(threads=2))
    return folder


@pytest.fixture(scope="session")
def small_project(small_simulation: Path, tmp_path_factory: pytest.TempPathFactory) -> Project:
    """The small block with all five steps done with the default recipe."""
    project = Project.create(
        tmp_path_factory.mktemp("project") / "model", small_simulation / "photos",
        control=small_simulation / "control.csv", reference="",
    )  # fmt: skip
    Pipeline(project, Recipe.default()).run("quality", Run(threads=2))
    return project
