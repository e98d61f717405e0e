"""Projects: photos stay where they are, moved photos are asked for, and strangers' projects are only data."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from graphos_core.errors import ParamError, UserError
from graphos_core.project import PhotosMoved, Project
from graphos_core.recipe import Recipe


@pytest.fixture
def photos(tmp_path: Path) -> Path:
    folder = tmp_path / "Fotos ä ü"
    folder.mkdir()
    rng = np.random.default_rng(1)
    for name in ("eins 1.png", "zwei.png"):
        Image.fromarray(rng.integers(0, 255, (48, 64, 3), dtype=np.uint8)).save(folder / name)
    return folder


def test_paths_are_relative_and_a_project_can_move_with_its_photos(tmp_path: Path, photos: Path) -> None:
    Project.create(tmp_path / "Projekt", photos, seed=3)
    assert str(tmp_path) not in (tmp_path / "Projekt" / "project.toml").read_text("utf-8")
    (tmp_path / "weg").mkdir()
    (tmp_path / "Projekt").rename(tmp_path / "weg" / "Projekt")
    photos.rename(tmp_path / "weg" / photos.name)
    project = Project.open(tmp_path / "weg" / "Projekt")
    assert [p.name for p in project.photo_set.photos] == ["eins 1.png", "zwei.png"]
    assert project.seed == 3


def test_moved_photos_are_asked_for_and_found_again(tmp_path: Path, photos: Path) -> None:
    Project.create(tmp_path / "p", photos)
    photos.rename(tmp_path / "elsewhere")
    with pytest.raises(PhotosMoved) as caught:
        Project.open(tmp_path / "p")
    assert caught.value.missing == ("eins 1.png", "zwei.png")
    Project.open(tmp_path / "p", photos=tmp_path / "elsewhere")
    assert len(Project.open(tmp_path / "p").photo_set.photos) == 2


def test_a_folder_of_another_project_is_not_taken_over(tmp_path: Path, photos: Path) -> None:
    Project.create(tmp_path / "p", photos)
    other = tmp_path / "other"
    other.mkdir()
    Image.new("RGB", (64, 48)).save(other / "x.png")
    with pytest.raises(UserError, match="other photos"):
        Project.create(tmp_path / "p", other)


def test_excluded_photos_are_left_out(tmp_path: Path, photos: Path) -> None:
    project = Project.create(tmp_path / "p", photos).change(excluded=("zwei.png",))
    assert [p.name for p in project.photo_set.photos] == ["eins 1.png"]
    assert [p.name for p in Project.open(tmp_path / "p").photo_set.photos] == ["eins 1.png"]


@pytest.mark.parametrize("name", ["../secret.png", "/etc/passwd", "a/../../b.png"])
def test_a_project_that_names_photos_outside_its_folder_is_refused(
    tmp_path: Path, photos: Path, name: str
) -> None:
    Project.create(tmp_path / "p", photos)
    file = tmp_path / "p" / "project.toml"
    file.write_text(file.read_text("utf-8").replace("zwei.png", name), "utf-8")
    with pytest.raises(UserError, match="damaged"):
        Project.open(tmp_path / "p")


def test_control_outside_the_project_folder_is_refused(tmp_path: Path, photos: Path) -> None:
    Project.create(tmp_path / "p", photos)
    (tmp_path / "control.csv").write_text("name,x,y,z\na,1,2,3\n")
    file = tmp_path / "p" / "project.toml"
    text = file.read_text("utf-8")
    assert "[known]" in text
    file.write_text(text.replace("[known]", '[known]\ncontrol = "../control.csv"'), "utf-8")
    with pytest.raises(UserError, match="outside its folder"):
        Project.open(tmp_path / "p").control()


@pytest.mark.parametrize("text", ["", "schema = 99", "schema = 1", "not toml ["])
def test_a_damaged_project_file_is_a_sentence(tmp_path: Path, text: str) -> None:
    (tmp_path / "project.toml").write_text(text)
    with pytest.raises(UserError, match=r"cannot be read|another version"):
        Project.open(tmp_path)


def test_a_folder_that_is_no_project_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="not a GRAPHOS project"):
        Project.open(tmp_path)


def test_a_senseless_principal_distance_is_refused(tmp_path: Path, photos: Path) -> None:
    with pytest.raises(ParamError, match="Principal distance"):
        Project.create(tmp_path / "p", photos, focal_px=-5.0)


@pytest.mark.parametrize(
    "line",
    ["focal_px = nan", "focal_px = -5.0", "principal_point = [inf, 0.0]"],
)
def test_impossible_values_in_a_strangers_project_are_refused(
    tmp_path: Path, photos: Path, line: str
) -> None:
    Project.create(tmp_path / "p", photos)
    file = tmp_path / "p" / "project.toml"
    file.write_text(file.read_text("utf-8").replace("[camera]", f"[camera]\n{line}"), "utf-8")
    with pytest.raises(UserError, match="cannot be read"):
        Project.open(tmp_path / "p")


def test_measurements_of_an_earlier_control_file_are_not_taken_for_the_new_one(
    tmp_path: Path, photos: Path
) -> None:
    (tmp_path / "old.csv").write_text("name,x,y,z\nA,1,2,3\n")
    (tmp_path / "old_measurements.csv").write_text("photo,name,x,y\nzwei.png,A,1,2\n")
    (tmp_path / "new.csv").write_text("name,x,y,z\nA,1,2,3\n")
    project = Project.create(tmp_path / "p", photos, control=tmp_path / "old.csv")
    assert project.control()[1] is not None
    assert project.change(control=tmp_path / "new.csv").control()[1] is None


def test_nesting_without_end_is_refused_and_not_a_fault(tmp_path: Path, photos: Path) -> None:
    Project.create(tmp_path / "p", photos)
    (tmp_path / "p" / "project.toml").write_text("schema = " + "[" * 9000 + "]" * 9000)
    with pytest.raises(UserError, match="cannot be read"):
        Project.open(tmp_path / "p")
    with pytest.raises(UserError, match="not valid TOML"):
        Recipe.from_toml("features = " + "[" * 9000 + "]" * 9000)
