"""The command line is a contract: files, keys and exit codes of ``run``, ``list``, ``describe``, ``simulate``."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from graphos_core.cli import main
from graphos_core.exchange.colmap import read_colmap
from graphos_core.exchange.ply import read_ply
from graphos_core.project import Project
from graphos_core.recipe import Recipe

FILES = ("report.html", "report.json", "recipe.toml", "sparse.ply", "dense.ply",
         "colmap/cameras.txt", "colmap/images.txt", "colmap/points3D.txt")  # fmt: skip


@pytest.fixture(scope="module")
def out(small_project: Project) -> Path:
    """A finished run through the command line; the stages come from the store."""
    control = small_project.folder / small_project.settings.control
    code = main(
        ["run", str(small_project.folder), "--out", str(small_project.folder), "--control", str(control)]
    )
    assert code == 0
    return small_project.folder


def test_run_writes_every_promised_file_at_the_top_and_in_its_own_folder(out: Path) -> None:
    for folder in (out, sorted((out / "runs").iterdir())[-1]):
        for name in FILES:
            assert (folder / name).is_file(), name


def test_report_has_the_documented_keys(out: Path) -> None:
    report = json.loads((out / "report.json").read_text("utf-8"))
    assert report["images"]["total"] == report["images"]["oriented"] == 5
    assert {"model", "width", "height", "focal_px", "parameters"} <= set(report["cameras"][0])
    assert {"value", "sigma"} <= set(report["cameras"][0]["parameters"][0])
    assert {
        "points",
        "observations",
        "reprojection_rms_px",
        "sigma0_px",
        "mean_rays_per_point",
        "unit",
    } <= set(report["orientation"])
    assert report["orientation"]["unit"] == "m"
    assert report["dense"]["depth_maps"] == 5
    assert set(report["timings_s"]) == {"preprocessing", "features", "adjustment", "dense", "quality"}
    for key in ("quality", "peak_memory_mb", "seed", "version", "warnings"):
        assert key in report


def test_report_agrees_with_the_exported_model(out: Path) -> None:
    from graphos_core.cameras import pixel_from_ray

    report, block = json.loads((out / "report.json").read_text("utf-8")), read_colmap(out / "colmap")
    squares = []
    for i in range(len(block.names)):
        mine = block.obs_photo == i
        local = (block.points[block.obs_point[mine]] - block.centres[i]) @ block.rotations[i].T
        pixels = pixel_from_ray(block.cameras[block.camera_of_photo[i]], local)
        squares.append((pixels - block.obs_xy[mine]) ** 2)
    rms = float(np.sqrt(np.concatenate(squares).mean()))
    assert report["orientation"]["reprojection_rms_px"] == pytest.approx(rms, abs=1e-4)
    assert report["orientation"]["points"] == len(read_ply(out / "sparse.ply").points)  # type: ignore[union-attr]


def test_report_page_is_self_contained(out: Path) -> None:
    page = (out / "report.html").read_text("utf-8")
    assert "data:image/" in page
    for outside in ('src="http', 'href="http', "<script", "url(http"):
        assert outside not in page


def test_the_written_recipe_repeats_the_run(out: Path) -> None:
    recipe = Recipe.load(out / "recipe.toml")
    assert recipe.to_toml(complete=True) == Recipe.default().to_toml(complete=True)


def test_until_stops_there_and_says_what_was_not_computed(small_project: Project, tmp_path: Path) -> None:
    code = main(
        ["run", str(small_project.photos_folder), "--out", str(tmp_path / "o"), "--until", "preprocessing"]
    )
    report = json.loads((tmp_path / "o" / "report.json").read_text("utf-8"))
    assert code == 0
    assert report["orientation"] is None
    assert report["dense"]["points"] == 0


def test_list_and_describe_name_every_algorithm(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    assert "sift" in capsys.readouterr().out
    assert main(["describe", "preprocessing.wallis"]) == 0
    assert "0 to 255 grey level" in capsys.readouterr().out
    assert main(["describe", "nothing"]) == 1
    assert "Valid" in capsys.readouterr().err


def test_simulate_refuses_an_unknown_template_and_parameter(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["simulate", "castle", "--out", str(tmp_path)]) == 1
    assert "facade" in capsys.readouterr().err
    assert main(["simulate", "couple", "--out", str(tmp_path), "--set", "nonsense=1"]) == 1
    assert "base" in capsys.readouterr().err
