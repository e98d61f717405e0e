"""Features of a whole project: out to files and in again, guided by its orientation, thinned; keys follow the inputs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from graphos_core.cli import main
from graphos_core.data import Block
from graphos_core.errors import UserError
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run


def computed(folder: Path, photos: Path, *settings: str, given: Block | None = None) -> Pipeline:
    project = Project.open(folder) if folder.exists() else Project.create(folder, photos)
    if given is not None:
        project = project.with_orientation(given, "test")
    recipe = Recipe.default()
    for setting in settings:
        recipe = recipe.set(setting)
    pipeline = Pipeline(project, recipe)
    pipeline.run("features", Run(threads=2))
    return pipeline


@pytest.fixture
def photos(small_simulation: Path) -> Path:
    return small_simulation / "photos"


def test_exported_features_come_back_as_the_same_tracks(
    small_project: Project, photos: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "exported ä"
    assert main(["convert", "features", str(small_project.folder), str(out), "--to", "npz"]) == 0
    assert "5 photos" in capsys.readouterr().out
    before = Pipeline(small_project, Recipe.default()).result("features")
    settings = [
        f"features.imported.source={out}", "features.detector=imported",
        f"features.imported-matches.source={out}", "features.matcher=imported-matches",
    ]  # fmt: skip
    pipeline = computed(tmp_path / "project", photos, *settings)
    after = pipeline.result("features")
    assert [len(f.xy) for f in after.features] == [len(f.xy) for f in before.features]
    assert after.tracks.count > 0.97 * before.tracks.count
    key = pipeline.key("keypoints")
    (out / "extra.npz").write_bytes(b"something else")
    assert computed_key(pipeline, "keypoints") != key


def computed_key(pipeline: Pipeline, step: str) -> str:
    return Pipeline(pipeline.project, pipeline.recipe).key(step)


def test_guided_matching_takes_the_given_orientation_and_finds_more(
    small_project: Project, photos: Path, tmp_path: Path
) -> None:
    block = Pipeline(small_project, Recipe.default()).result("adjustment").adjustment.block
    before = Pipeline(small_project, Recipe.default()).result("features")
    guided = computed(
        tmp_path / "project", photos, "features.matcher=guided", "features.pairs=all", given=block
    )
    after = guided.result("features")
    counts = [sum(len(p.matches) for p in found.pairs) for found in (before, after)]
    assert counts[1] > 1.1 * counts[0]
    key = guided.key("matches")
    moved = guided.project.with_orientation(_moved(block), "another")
    assert Pipeline(moved, guided.recipe).key("matches") != key
    assert Pipeline(moved, guided.recipe).key("keypoints") == guided.key("keypoints")


def _moved(block: Block) -> Block:
    from dataclasses import replace

    return replace(block, centres=np.asarray(block.centres) + 0.01)


def test_guided_matching_without_an_orientation_says_what_to_do(photos: Path, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="needs an orientation of an earlier result"):
        computed(tmp_path / "project", photos, "features.matcher=guided")


def test_a_thinned_block_has_fewer_points_in_the_same_funnel(
    small_project: Project, photos: Path, tmp_path: Path
) -> None:
    from graphos_core.features.funnel import funnel

    thin = computed(tmp_path / "project", photos, "features.thinning=cells", "features.cells.each=1",
                    "features.cells.cells=12", "features.cells.quality=residual").result("features")  # fmt: skip
    whole = Pipeline(small_project, Recipe.default()).result("features")
    counts = dict(funnel(thin).total)
    assert counts["kept"] < 0.5 * counts["verified"] == 0.5 * dict(funnel(whole).total)["verified"]
    assert counts["tracks"] < dict(funnel(whole).total)["tracks"]
