"""Same seed: the same result bit for bit, with one thread and with two."""

from __future__ import annotations

from pathlib import Path

import pytest

from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run
from graphos_core.steps import STEPS


def stored(project: Project) -> dict[str, bytes]:
    """Return the bytes of every stored result but what tells times."""
    return {
        f"{path.parent.parent.name}/{path.parent.name}/{path.name}": path.read_bytes()
        for step in STEPS
        for path in sorted((project.store.folder / step).glob("*/*"))
        if path.name != "about.json"
    }


@pytest.mark.parametrize("threads", [1])
def test_one_thread_gives_the_same_bits_as_two(
    threads: int, small_project: Project, small_simulation: Path, tmp_path: Path
) -> None:
    control = small_simulation / "control.csv"
    again = Project.create(tmp_path / "again", small_simulation / "photos", control=control)
    Pipeline(again, Recipe.default()).run("quality", Run(threads=threads))
    assert stored(again) == stored(small_project)
