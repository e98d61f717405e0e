"""Running a project again, and the demo with another seed: what was asked for is what is computed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from graphos_core.cli import build_parser
from graphos_core.commands import _recipe, make_project
from graphos_core.demo import is_simulated
from graphos_core.errors import ParamError
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run


@pytest.fixture
def project(tmp_path: Path) -> Project:
    (tmp_path / "photos").mkdir()
    rng = np.random.default_rng(1)
    for name in ("a.png", "b.png"):
        Image.fromarray(rng.integers(0, 255, (48, 64, 3), dtype=np.uint8)).save(tmp_path / "photos" / name)
    return Project.create(tmp_path / "p", tmp_path / "photos", seed=7)


def options(*words: object) -> tuple[Recipe, Project]:
    parsed = build_parser().parse_args(["run", *(str(word) for word in words)])
    recipe = _recipe(parsed)
    return recipe, make_project(parsed, recipe.seed, Run())


def test_a_project_keeps_its_seed_and_the_recipe_of_its_last_run(project: Project) -> None:
    recipe, again = options(project.folder, "--out", project.folder)
    assert (recipe.seed, again.seed) == (7, 7)
    Recipe.default(7).set("features.sift.contrast=0.04").save(project.folder / "recipe.toml")
    recipe, _ = options(project.folder, "--out", project.folder)
    assert recipe.params("features", "sift").to_dict()["contrast"] == 0.04
    recipe, again = options(project.folder, "--out", project.folder, "--seed", 9)
    assert (recipe.seed, again.seed) == (9, 9)


@pytest.mark.parametrize(
    "words", [("--principal-point", "nan,3"), ("--focal-px", "nan"), ("--distance", "A,B,inf")]
)
def test_numbers_that_are_none_are_refused(project: Project, words: tuple[str, str]) -> None:
    with pytest.raises(ParamError):
        options(project.folder, "--out", project.folder, *words)


def test_the_demo_takes_an_earlier_simulation_only_for_the_same_seed_and_photos(tmp_path: Path) -> None:
    assert not is_simulated(tmp_path, 12, 0)
    (tmp_path / "truth").mkdir()
    index = {"seed": 3, "photos": [{}] * 5}
    (tmp_path / "truth" / "cameras.json").write_text(json.dumps(index))
    assert is_simulated(tmp_path, 5, 3)
    assert not is_simulated(tmp_path, 5, 0)
    assert not is_simulated(tmp_path, 12, 3)


@pytest.mark.parametrize(
    "words",
    [
        ("demo", "--seed", "-1"),
        ("simulate", "couple", "--out", "x", "--seed", "3000000000"),
        ("simulate", "couple", "--out", "x", "--width", "0"),
        ("run", "x", "--out", "y", "--distance", "A,B,long"),
        ("run", "x", "--out", "y", "--principal-point", "a,b"),
    ],
)
def test_wrong_numbers_are_wrong_usage_in_words(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as caught:
        build_parser().parse_args(words)
    assert caught.value.code == 2
    assert "needs" in capsys.readouterr().err
