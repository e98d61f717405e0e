"""Bad input in the window: each is a sentence (what, why, what to try), never a bug dialog; what was done stays."""

import errno
import shutil
from pathlib import Path

import pytest

from graphos_py.main_window import MainWindow


def make(qtbot, window: MainWindow, photos: Path, out: Path) -> None:
    window.engine_loaded([])
    window.session.bug.connect(lambda problem: pytest.fail(repr(problem)))
    window.session.create(out, photos)
    qtbot.waitUntil(lambda: not window.jobs.running, timeout=10000)


def run(qtbot, window: MainWindow, stage: str) -> None:
    window.session.run(stage)
    qtbot.waitUntil(lambda: window.session.running is None and not window.jobs.running, timeout=60000)


def sentences(window: MainWindow, kind: str) -> list[str]:
    return window.messages.texts(kind)


def test_an_empty_folder_is_named_and_photos_are_asked_for(qtbot, window, tmp_path):
    (tmp_path / "empty").mkdir()
    make(qtbot, window, tmp_path / "empty", tmp_path / "out")
    what, why, todo = sentences(window, "error")[0].split("\n")
    assert "no photos" in what and "empty" in why and "JPEG" in todo
    assert window.session.project is None


def test_texts_and_damaged_photos_are_left_out_by_name(qtbot, window, photo_folder, tmp_path):
    (photo_folder / "text.jpg").write_text("no picture", "utf-8")
    whole = (photo_folder / "p0.png").read_bytes()
    (photo_folder / "cut.png").write_bytes(whole[: len(whole) // 3])
    make(qtbot, window, photo_folder, tmp_path / "out")
    told = "\n".join(sentences(window, "warning"))
    assert "text.jpg: It is no JPEG, PNG or TIFF" in told and "cut.png: It is damaged" in told
    assert [photo.name for photo in window.session.project.photo_set.photos] == ["p0.png", "p1.png", "p2.png"]


def test_a_single_photo_and_copies_of_it_cannot_be_oriented(qtbot, window, photo_folder, tmp_path):
    for name in ("p1.png", "p2.png"):
        shutil.copy(photo_folder / "p0.png", photo_folder / name)
    make(qtbot, window, photo_folder, tmp_path / "out")
    assert "p1.png: It is the same file as p0.png" in sentences(window, "warning")[0]
    run(qtbot, window, "adjustment")
    assert "at least two photos" in sentences(window, "error")[0]
    assert window.ribbon.step("adjustment").state.status == "failed"
    assert window.ribbon.step("features").state.status == "done"


def test_photos_without_overlap_say_what_would_help(qtbot, window, photo_folder, tmp_path):
    make(qtbot, window, photo_folder, tmp_path / "out")
    run(qtbot, window, "adjustment")
    what, _, todo = sentences(window, "error")[0].split("\n")
    assert what == "No photo can be oriented."
    assert "overlap" in todo


def test_photos_that_were_left_out_are_named_with_their_reason(qtbot, window):
    from types import SimpleNamespace

    from graphos_core.errors import ItemFailure

    reason = "It shares no points with the others."
    block = SimpleNamespace(failures=(ItemFailure("a.jpg", reason), ItemFailure("b.jpg", reason)))
    window.session._tell_left_out("adjustment", SimpleNamespace(adjustment=SimpleNamespace(block=block)))
    assert sentences(window, "warning") == [f"Not oriented: a.jpg, b.jpg. {reason}"]


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("schema = 1\n[features.sift]\ncontrast = 99\n", "needs 0 to 0.5"),
        ("schema = 1\n[features.sift]\ncontrst = 0.1\n", "Did you mean “contrast”?"),
        ("no recipe ][", "not valid TOML"),
    ],
)
def test_a_wrong_recipe_is_refused_and_the_old_one_stays(qtbot, window, project_folder, tmp_path, text, part):
    window.engine_loaded([])
    before = window.session.recipe
    recipe = tmp_path / "wrong.toml"
    recipe.write_text(text, "utf-8")
    window.actions_of_project.dropped([recipe])
    assert part in sentences(window, "error")[0]
    assert window.session.recipe is before


def test_a_folder_that_cannot_be_written_is_a_sentence(qtbot, window, photo_folder, tmp_path):
    (tmp_path / "file").write_text("in the way", "utf-8")
    make(qtbot, window, photo_folder, tmp_path / "file" / "out")
    what, why, todo = sentences(window, "error")[0].split("\n")
    assert "could not be written" in what and why and "Choose a folder" in todo


def test_a_full_disk_fails_one_step_and_keeps_the_ones_before(
    qtbot, window, photo_folder, tmp_path, monkeypatch
):
    make(qtbot, window, photo_folder, tmp_path / "out")
    window.session.choose("preprocessing", "filter", ("grey",))
    run(qtbot, window, "preprocessing")

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("graphos_core.store._write_arrays", full)
    run(qtbot, window, "features")
    assert "The disk is full." in sentences(window, "error")[0]
    assert window.ribbon.step("features").state.status == "failed"
    monkeypatch.undo()
    assert window.ribbon.step("preprocessing").state.status == "done"
    assert len(window.session.results["preprocessing"].files) == 3


def test_a_photo_that_vanished_is_named_when_it_is_needed(qtbot, window, photo_folder, tmp_path):
    make(qtbot, window, photo_folder, tmp_path / "out")
    (photo_folder / "p1.png").unlink()
    run(qtbot, window, "features")
    assert "p1.png cannot be read" in sentences(window, "error")[0]
