"""Bad input on the command line: a clear sentence, exit code 1, no traceback, earlier results usable."""

from __future__ import annotations

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from graphos_core.cli import main
from graphos_core.errors import Stopped, UserError
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run
from graphos_core.steps import STEPS


def run(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str]:
    code = main([str(word) for word in words])
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err
    return code, captured.err


def photo(path: Path, seed: int, size: tuple[int, int] = (320, 240)) -> Path:
    """Write a picture with its own texture, which overlaps with no other."""
    rng = np.random.default_rng(seed)
    coarse = Image.fromarray(rng.integers(0, 255, (60, 80), dtype=np.uint8)).resize(
        size, Image.Resampling.BICUBIC
    )
    coarse.save(path)
    return path


def test_an_empty_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    code, said = run(capsys, "run", tmp_path / "in", "--out", tmp_path / "out")
    assert code == 1
    assert "no photos" in said.lower()


def test_a_folder_that_does_not_exist(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, said = run(capsys, "run", tmp_path / "missing", "--out", tmp_path / "out")
    assert code == 1
    assert "missing" in said


def test_a_text_file_named_jpg_and_a_truncated_one_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "Fotos mit Ümlaut"
    folder.mkdir()
    (folder / "notes.jpg").write_text("this is no picture")
    whole = photo(folder / "whole.jpg", 1).read_bytes()
    (folder / "cut.jpg").write_bytes(whole[: len(whole) // 3])
    code, said = run(capsys, "run", folder, "--out", tmp_path / "out")
    assert code == 1
    assert "notes.jpg" in said
    assert "cut.jpg" in said


def test_a_single_photo(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    photo(tmp_path / "in" / "a.jpg", 1)
    code, said = run(capsys, "run", tmp_path / "in", "--out", tmp_path / "out")
    assert code == 1
    assert "photo" in said


def test_photos_without_overlap(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    for seed in range(3):
        photo(tmp_path / "in" / f"{seed}.jpg", seed)
    code, said = run(capsys, "run", tmp_path / "in", "--out", tmp_path / "out")
    assert code == 1
    assert "overlap" in said
    assert "estimate" in said  # EXIF is missing: the principal distance is flagged


def test_two_unrelated_blocks_in_one_folder(
    small_simulation: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in").mkdir()
    for source in (small_simulation / "photos").iterdir():
        shutil.copy(source, tmp_path / "in")
    for seed in range(2):
        photo(tmp_path / "in" / f"other{seed}.jpg", 7)  # the same texture twice: a group of its own
        with Image.open(tmp_path / "in" / f"other{seed}.jpg") as picture:
            picture.rotate(3 * seed).save(tmp_path / "in" / f"other{seed}.jpg")
    code, _ = run(capsys, "run", tmp_path / "in", "--out", tmp_path / "out", "--until", "adjustment")
    assert code == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))
    assert report["images"]["oriented"] == 5
    assert {f["name"] for f in report["images"]["not_oriented"]} == {"other0.jpg", "other1.jpg"}
    assert all(f["reason"] for f in report["images"]["not_oriented"])


def test_identical_photos(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    photo(tmp_path / "in" / "a.jpg", 1)
    shutil.copy(tmp_path / "in" / "a.jpg", tmp_path / "in" / "b.jpg")
    code, said = run(capsys, "run", tmp_path / "in", "--out", tmp_path / "out")
    assert code == 1
    assert "same file as a.jpg" in said


def test_a_parameter_out_of_range_and_an_unknown_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in").mkdir()
    photo(tmp_path / "in" / "a.jpg", 1)
    base = ("run", tmp_path / "in", "--out", tmp_path / "out")
    code, said = run(capsys, *base, "--set", "preprocessing.wallis.target_mean=300")
    assert (code, "Target mean: 300" in said) == (1, True)
    (tmp_path / "r.toml").write_text("[features.sift]\nnonsense = 3\n")
    code, said = run(capsys, *base, "--recipe", tmp_path / "r.toml")
    assert (code, "nonsense" in said) == (1, True)


def test_wrong_usage_has_exit_code_2() -> None:
    with pytest.raises(SystemExit) as caught:
        main(["run"])
    assert caught.value.code == 2


def test_an_output_folder_that_cannot_be_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    photo(tmp_path / "in" / "a.jpg", 1)
    (tmp_path / "file").write_text("")
    code, said = run(capsys, "run", tmp_path / "in", "--out", tmp_path / "file" / "out")
    assert code == 1
    assert "could not be written" in said


class StopAt(Run):
    """Stops as soon as a step tells its first progress."""

    def __init__(self) -> None:
        super().__init__(threads=2)
        self.armed = False

    def progress(self, done: float, total: float, what: str) -> None:
        if self.armed:
            self.stop()


@pytest.mark.parametrize("step", list(STEPS))
def test_cancel_in_each_step_keeps_what_was_finished_before(
    step: str, small_project: Project, tmp_path: Path
) -> None:
    project = copy_of(small_project, tmp_path)
    recipe = Recipe.default().choose("preprocessing", "filter", ["wallis"])
    pipeline = Pipeline(project, recipe)
    names = list(STEPS)
    run = StopAt()
    compute = pipeline._compute

    def watched(wanted: Any, run: Any) -> None:
        run.armed = wanted.name == step
        if run.armed and step in ("pairs", "georeference", "quality"):  # over before they tell progress
            run.stop()
        compute(wanted, run)

    pipeline._compute = watched  # type: ignore[method-assign]
    with pytest.raises(Stopped):
        pipeline.run("quality", run)
    for name in names[: names.index(step)]:
        assert pipeline.has(name)
    assert not pipeline.has(step)


def copy_of(project: Project, folder: Path) -> Project:
    shutil.copytree(project.folder, folder / "project")
    return Project.open(folder / "project", photos=project.photos_folder)


@pytest.mark.parametrize("step", ["images", "matches", "georeference", "cloud"])
def test_a_full_disk_in_a_step_is_said_and_leaves_the_earlier_results(
    step: str, small_project: Project, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    project = copy_of(small_project, tmp_path)
    shutil.rmtree(project.store.folder / step)
    from graphos_core import store

    write = store._write_arrays

    def full(path: Path, arrays: Any) -> None:
        if path.parent.parent.name == step:
            raise OSError(errno.ENOSPC, "No space left on device")
        write(path, arrays)

    monkeypatch.setattr(store, "_write_arrays", full)
    pipeline = Pipeline(project, Recipe.default())
    if step == "images":
        monkeypatch.setattr(
            store.os,
            "fsync",
            lambda fd: (_ for _ in ()).throw(OSError(errno.ENOSPC, "No space left on device")),
        )
    with pytest.raises(UserError, match="disk is full"):
        pipeline.run("quality", Run(threads=2))
    names = list(STEPS)
    assert all(pipeline.has(name) for name in names[: names.index(step)])
    assert not list((project.store.folder / step).glob(".*.part"))


def test_a_disk_that_is_full_while_filtered_photos_are_written_is_said(
    small_project: Project, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    project = copy_of(small_project, tmp_path)
    write = Path.write_bytes

    def full(path: Path, content: bytes) -> int:
        if path.suffix == ".png":
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(path, content)

    monkeypatch.setattr(Path, "write_bytes", full)
    pipeline = Pipeline(project, Recipe.default().choose("preprocessing", "filter", ["wallis"]))
    with pytest.raises(UserError, match="disk is full"):
        pipeline.run("preprocessing", Run(threads=2))
    assert not list((project.store.folder / "images").glob(".*.part"))


def test_a_stored_result_cannot_name_files_outside_its_folder(small_project: Project, tmp_path: Path) -> None:
    project = copy_of(small_project, tmp_path)
    pipeline = Pipeline(project, Recipe.default())
    result = project.store.path("images", pipeline.key("images")) / "result.json"
    result.write_text(
        result.read_text("utf-8").replace('{"tuple": []}', '{"tuple": ["../../../secret.png"]}', 1)
    )
    with pytest.raises(UserError, match="outside its folder"):
        pipeline.result("preprocessing")


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_killed_run_continues_after_the_last_finished_step(small_project: Project, tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [
        sys.executable,
        "-m",
        "graphos_core.cli",
        "run",
        str(small_project.photos_folder),
        "--out",
        str(out),
    ]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    keypoints = out / "results" / "keypoints"
    for _ in range(600):
        if any(p for p in keypoints.glob("*") if not p.name.startswith(".")):
            break
        time.sleep(0.1)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    done = {p for p in keypoints.glob("*") if not p.name.startswith(".")}
    assert done
    stamps = {p: (p / "result.json").stat().st_mtime_ns for p in done}
    project = Project.open(out)
    pipeline = Pipeline(project, Recipe.default())
    pipeline.run("features", Run(threads=2))
    assert {p: (p / "result.json").stat().st_mtime_ns for p in done} == stamps
    assert not list((out / "results").glob("*/.*.part"))
