"""The sheet of control points a person edits: edits, files, versions, and tables from elsewhere."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.errors import UserError
from graphos_core.exchange.control import read_control
from graphos_core.exchange.control_sheet import ControlSheet, Mark, SheetDistance, SheetPoint
from graphos_core.exchange.control_writing import keep_version, write_sheet
from graphos_core.exchange.distance_table import read_distances
from graphos_core.exchange.table_preview import guess, read_points
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe

SHEET = ControlSheet(
    points=(
        SheetPoint("T1", (500123.4567, 5812345.6789, 101.25)),
        SheetPoint("T 2", (500133.0, 5812340.5, 99.0), role="check"),
    ),
    marks={
        ("T1", "a.jpg"): Mark(10.25, 20.5),
        ("tie", "a.jpg"): Mark(1.0, 2.0),
        ("tie", "b.jpg"): Mark(3.0, 4.0),
    },
)


def test_files_read_back_as_the_sheet_to_the_nanometre(tmp_path: Path) -> None:
    write_sheet(tmp_path, SHEET)
    control, measured = read_control(tmp_path / "control.csv")
    assert control is not None and np.abs(control.origin).max() > 1e5  # large coordinates were shifted
    again = ControlSheet.from_known(control, measured)
    assert [p.name for p in again.points] == ["T1", "T 2", "tie"]
    for old, new in zip(SHEET.points, again.points):
        assert np.allclose(old.xyz, new.xyz, atol=1e-8) and old.role == new.role
    assert again.marks == SHEET.marks or repr(sorted(again.marks.items())) == repr(
        sorted(SHEET.marks.items())
    )
    assert not again.points[2].known


def test_versions_are_kept_once_each(tmp_path: Path) -> None:
    write_sheet(tmp_path, SHEET)
    first = keep_version(tmp_path)
    assert first is not None and keep_version(tmp_path) is None
    write_sheet(tmp_path, SHEET.without(["T1"]))
    assert keep_version(tmp_path) is not None
    assert "T1" in (first / "control.csv").read_text("utf-8")


def test_edits_leave_the_old_sheet_and_measurements_follow_a_new_name() -> None:
    renamed = SHEET.with_point(0, replace(SHEET.points[0], name="N1"))
    assert set(renamed.marks_of("N1")) == {"a.jpg"} and not renamed.marks_of("T1")
    assert SHEET.points[0].name == "T1" and set(SHEET.marks_in("a.jpg")) == {"T1", "tie"}
    with pytest.raises(ValueError, match="taken"):
        SHEET.with_point(0, replace(SHEET.points[0], name="T 2"))
    assert SHEET.marked("T1", "a.jpg", None).marks_of("T1") == {}
    assert SHEET.without(["tie"]).marks_in("b.jpg") == {}
    assert ControlSheet(points=SHEET.points, marks=dict(SHEET.marks)) == SHEET
    assert renamed != SHEET


TABLES = {
    "comma, header, mm": "name,x [mm],y [mm],z [mm],role\nA,1000,2000,3000,check\nB,1500,2500,3500,\n",
    "semicolon, decimal comma": "Point;Easting;Northing;Height\nA;1,0;2,0;3,0\nB;1,5;2,5;3,5\n",
    "spreadsheet, no header": "A\t1.0\t2.0\t3.0\nB\t1.5\t2.5\t3.5\n",
    "blanks and a title": "Survey of 2026\nA 1.0 2.0 3.0\nB   1.5 2.5 3.5\n",
    "swapped columns": "id,north,east,up\nA,2.0,1.0,3.0\nB,2.5,1.5,3.5\n",
}


@pytest.mark.parametrize("name", TABLES)
def test_format_is_guessed(name: str) -> None:
    points, bad = read_points(TABLES[name], guess(TABLES[name]))
    assert not bad
    assert [p.name for p in points] == ["A", "B"]
    assert np.allclose([p.xyz for p in points], [[1, 2, 3], [1.5, 2.5, 3.5]])


def test_standard_deviations_come_per_axis_or_alike() -> None:
    points, _ = read_points(
        "name;x;y;z;sx;sy;sz\nA;1;2;3;0,01;0,02;0,03\n",
        guess("name;x;y;z;sx;sy;sz\nA;1;2;3;0,01;0,02;0,03\n"),
    )
    assert points[0].sigma == (0.01, 0.02, 0.03)
    points, _ = read_points("name,x,y,z,sigma\nA,1,2,3,0.005\n", guess("name,x,y,z,sigma\nA,1,2,3,0.005\n"))
    assert points[0].sigma == (0.005, 0.005, 0.005)
    assert math.isnan(read_points("name,x,y,z\nA,1,2,3\n", guess("name,x,y,z\nA,1,2,3\n"))[0][0].sigma[0])


def test_bad_lines_are_named_and_the_rest_is_read() -> None:
    text = "name,x,y,z,role\nA,1,2,3,control\nB,1,two,3,\nC,4,5,6,maybe\nA,7,8,9,\nD,1,2,,check\n"
    points, bad = read_points(text, guess(text))
    assert [p.name for p in points] == ["A", "D"] and math.isnan(points[1].xyz[2])
    assert [problem.line for problem in bad] == [3, 4, 5]
    assert "two" in bad[0].why and "maybe" in bad[1].why and "twice" in bad[2].why


DISTANCES = ControlSheet(
    distances=(SheetDistance("A", "B", 2.5, 0.001), SheetDistance("a.jpg", "b.jpg", 1.0, check=True))
)


def test_distances_read_back_and_follow_renamed_points(tmp_path: Path) -> None:
    write_sheet(tmp_path, DISTANCES)
    read = read_distances(tmp_path / "control_distances.csv")
    assert ControlSheet.from_known(None, None, read) == DISTANCES
    write_sheet(tmp_path, ControlSheet())  # the last one was removed
    assert read_distances(tmp_path / "control_distances.csv") == ()
    sheet = replace(SHEET, distances=(SheetDistance("T1", "tie", 1.0),))
    assert sheet.with_point(0, replace(SHEET.points[0], name="N")).distances[0].a == "N"
    assert not sheet.without(["T1"]).distances


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("A,A,1", "different"),
        ("A,B,-1", "more than 0"),
        ("A,B,long", "long"),
        ("A,B,1,-2", "sigma"),
        ("A,B,1,,x", "role"),
    ],
)
def test_a_bad_distance_is_named_with_its_line(tmp_path: Path, line: str, word: str) -> None:
    path = tmp_path / "control_distances.csv"
    path.write_text(f"from,to,distance [mm],sigma,role\nA,C,2500,1,\n{line}\n", "utf-8")
    with pytest.raises(UserError, match=f"(?s)line 3.*{word}"):
        read_distances(path)
    path.write_text("from,to,distance [mm]\nA,C,2500\n", "utf-8")
    assert read_distances(path)[0].metres == 2.5


def test_a_distance_of_the_table_gives_a_project_its_scale_and_changes_its_key(tmp_path: Path) -> None:
    photos = tmp_path / "photos"
    photos.mkdir()
    for i in range(2):
        noise = np.random.default_rng(i).integers(0, 255, (40, 60, 3), dtype=np.uint8)
        cv2.imwrite(str(photos / f"{i}.png"), noise)
    project = Project.create(tmp_path / "project", photos)
    before = Pipeline(project, Recipe.default()).key("georeference")
    assert project.known().distances == ()
    write_sheet(project.folder, ControlSheet(distances=(SheetDistance("0.png", "1.png", 2.0),)))
    (found,) = project.known().distances
    assert (found.a, found.b, found.metres) == ("0.png", "1.png", 2.0)
    assert Pipeline(project, Recipe.default()).key("georeference") != before


def test_taking_another_control_file_keeps_the_edited_one(tmp_path: Path) -> None:
    photos = tmp_path / "photos"
    photos.mkdir()
    cv2.imwrite(str(photos / "a.png"), np.random.default_rng(0).integers(0, 255, (40, 60), dtype=np.uint8))
    project = Project.create(tmp_path / "project", photos)
    write_sheet(project.folder, SHEET)
    (tmp_path / "other.csv").write_text("name,x,y,z\nN,1,2,3\n", "utf-8")
    changed = project.change(control=tmp_path / "other.csv")
    assert changed.control()[0].names == ("N",)
    kept, _ = read_control(project.folder / "earlier" / "0001" / "control.csv")
    assert kept is not None and "T1" in kept.names
