"""``graphos adjust`` starts from stored features, computes none again, and leaves the source alone."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from graphos_core import registry
from graphos_core.cli import main
from graphos_core.project import Project
from graphos_core.recipe import Recipe


def files(folder: Path) -> dict[str, int]:
    """Every file with its time of change, without the photo headers that opening a project keeps."""
    found = {str(p.relative_to(folder)): p.stat().st_mtime_ns for p in folder.rglob("*") if p.is_file()}
    return {name: time for name, time in found.items() if not name.startswith("results/photos")}


def test_adjust_reuses_features_and_orientation_and_keeps_the_source(
    small_project: Project, tmp_path: Path
) -> None:
    before = files(small_project.folder)
    out = tmp_path / "again ä"
    assert main(["adjust", str(small_project.folder), "--out", str(out), "--calibration", "fixed"]) == 0
    assert files(small_project.folder) == before
    for step in ("keypoints", "matches", "orientation"):
        (key,) = (p.name for p in (out / "results" / step).iterdir())
        old = small_project.folder / "results" / step / key / "about.json"
        assert (out / "results" / step / key / "about.json").read_bytes() == old.read_bytes()
    report = json.loads((out / "report.json").read_text("utf-8"))
    assert report["images"]["oriented"] == 5
    assert all(p["sigma"] is None for p in report["cameras"][0]["parameters"])
    assert report["georeferencing"]["method"] == "control points", "control of the source is kept"
    assert Recipe.load(out / "recipe.toml").params("adjustment", "schur").to_dict()["calibration"] == "fixed"


def test_only_the_adjustment_room_of_a_recipe_is_used(small_project: Project, tmp_path: Path) -> None:
    recipe = Recipe.default().set("features.sift.contrast=0.05").set("adjustment.schur.robust=cauchy")
    recipe.save(tmp_path / "r.toml")
    out = tmp_path / "o"
    assert (
        main(["adjust", str(small_project.folder), "--out", str(out), "--recipe", str(tmp_path / "r.toml")])
        == 0
    )
    used = Recipe.load(out / "recipe.toml")
    assert used.params("adjustment", "schur").to_dict()["robust"] == "cauchy"
    assert used.params("features", "sift") == Recipe.default().params("features", "sift")


def test_an_unknown_calibration_lists_what_is_declared(
    small_project: Project, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["adjust", str(small_project.folder), "--out", str(tmp_path), "--calibration", "magic"])
    told = capsys.readouterr().err
    declared = registry.find("adjustment", "schur").params.declarations()["calibration"].options
    assert declared
    assert all(name in told for name in declared)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--set", "features.sift.contrast=0.05"], "not of the adjustment room"),
        (["--seed", "77"], "no features"),
        (["--control", "nowhere.csv"], "does not exist"),
        (["--recipe", "nowhere.toml"], "cannot be read"),
    ],
)
def test_what_cannot_be_adjusted_is_said_in_words(
    small_project: Project, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    assert main(["adjust", str(small_project.folder), "--out", str(tmp_path / "o"), *words]) == 1
    assert told in capsys.readouterr().err


def test_a_folder_without_project_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["adjust", str(tmp_path), "--out", str(tmp_path / "o")]) == 1
    assert "not a GRAPHOS project" in capsys.readouterr().err
