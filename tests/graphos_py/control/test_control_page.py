"""The control page: typing, pasting, undo, files, measuring with snap and keys, predicted places, the preview dialog."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QApplication

from graphos_core.adjustment.measuring.prediction import Prediction, project
from graphos_core.adjustment.measuring.sights import Sight
from graphos_core.data import Adjustment, Block, Camera, Georeference
from graphos_core.exchange.control import read_control
from graphos_core.exchange.control_sheet import ControlSheet, Mark, SheetDistance, SheetPoint
from graphos_core.project import Project
from graphos_core.results import AdjustmentResult
from graphos_py.control.import_dialog import ImportDialog
from graphos_py.control.measuring import next_photo
from graphos_py.control.page import ControlPage
from graphos_py.control.table_model import COLUMNS
from graphos_py.loading import load_engine
from graphos_py.session import Session

KEYS = [column.key for column in COLUMNS]
TARGET = (80.3, 60.6)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A project of two photos with one white disc each."""
    photos = tmp_path / "photos"
    photos.mkdir()
    y, x = np.mgrid[0:1200, 0:1600] / 10 - 0.45
    disc = 40.0 + 180.0 * (np.hypot(x - TARGET[0], y - TARGET[1]) < 5)
    image = cv2.GaussianBlur(cv2.resize(disc, (160, 120), interpolation=cv2.INTER_AREA), (0, 0), 0.8)
    for name in ("a.png", "b.png"):
        image[0, 0] += 1  # two photos with the same content would count as one
        cv2.imwrite(str(photos / name), image.astype(np.uint8))
    return Project.create(tmp_path / "project", photos).folder


@pytest.fixture
def page(qtbot, jobs, folder: Path) -> ControlPage:
    load_engine()
    session = Session(jobs)
    session.engine_ready()
    with qtbot.waitSignal(session.project_changed, timeout=10000):
        session.open(folder)
    made = ControlPage(session, "expert")
    qtbot.addWidget(made)
    made.resize(1000, 800)
    made.show()
    qtbot.waitUntil(lambda: made.measuring.canvas.array is not None, timeout=5000)
    return made


def type_into(page: ControlPage, row: int, key: str, text: str) -> bool:
    model = page.table.model
    return model.setData(model.index(row, KEYS.index(key)), text)


def press(page: ControlPage, key: Qt.Key, modifiers=Qt.KeyboardModifier.NoModifier) -> None:
    event = QKeyEvent(QEvent.Type.KeyPress, key, modifiers)
    page.measuring.eventFilter(page.measuring.canvas, event)


def test_typing_is_checked_saved_and_undone(qtbot, page: ControlPage, folder: Path) -> None:
    page.table.add()
    page.table.add()
    assert [p.name for p in page.desk.sheet.points] == ["P1", "P2"] and page.desk.point == "P2"
    for key, text in (("x0", "1,5"), ("x1", "-2"), ("x2", "3"), ("role", "check"), ("s0", "4")):
        assert type_into(page, 0, key, text)
    assert not type_into(page, 0, "x0", "much") and "number" in page.table.problem.text()
    assert not type_into(page, 1, "name", "P1") and "name" in page.table.problem.text()
    assert not type_into(page, 0, "s1", "-1")
    assert page.desk.sheet.points[0] == SheetPoint(
        "P1", (1.5, -2.0, 3.0), (0.004, *page.desk.sheet.points[0].sigma[1:]), "check"
    )
    page.desk.undo.undo()
    assert np.isnan(page.desk.sheet.points[0].sigma[0])
    page.desk.save()
    qtbot.waitUntil(
        lambda: (folder / "control.csv").is_file() and page.session.project.settings.control != ""
    )
    control, _ = read_control(folder / "control.csv")
    assert control is not None and control.names == ("P1",) and bool(control.check[0])
    assert Project.open(folder).settings.control == "control.csv"


def test_going_back_to_what_was_there_restores_the_files(qtbot, page: ControlPage, folder: Path) -> None:
    (folder / "control.csv").write_text("name,x,y,z,role\nA,1,2,3,control\n", "utf-8")
    before = (folder / "control.csv").read_bytes()
    page.session.project = page.session.project.with_control("control.csv")
    page.desk.load()
    key = page.session.project.control()[0].names
    page.table.take_text("B\t4\t5\t6")
    page.desk.save()
    qtbot.waitUntil(lambda: b"B,4" in (folder / "control.csv").read_bytes())
    assert (folder / "earlier" / "0001" / "control.csv").read_bytes() == before
    page.desk.undo.undo()
    page.desk.save()
    qtbot.waitUntil(lambda: (folder / "control.csv").read_bytes() == before)
    assert page.session.project.control()[0].names == key


def test_pasting_names_the_bad_line_and_takes_the_rest(page: ControlPage) -> None:
    page.table.take_text("A\t1\t2\t3\nB\t1\ttwo\t3\nC\t4\t5\t6")
    assert [p.name for p in page.desk.sheet.points] == ["A", "C"]
    assert "Line 2" in page.table.problem.text() and "two" in page.table.problem.text()
    page.table.take_text("hello")
    assert len(page.desk.sheet.points) == 2 and page.table.problem.text()


def test_what_is_copied_comes_back_alike_with_standard_deviations_in_mm(page: ControlPage) -> None:
    sheet = ControlSheet(
        (SheetPoint("A", (1.0, 2.0, 3.0), (0.004, 0.004, 0.008)), SheetPoint("B", (4.0, 5.0, 6.0)))
    )
    page.desk.edit(sheet, "test")
    page.table.copy()
    text = QApplication.clipboard().text()
    page.desk.edit(ControlSheet(), "empty")
    page.table.take_text(text)
    assert page.desk.sheet == sheet


def test_mixed_and_strange_units_are_said(qtbot, page: ControlPage, tmp_path: Path) -> None:
    text = "name,x [m],y [ft],z [m],sigma\nA,1,2,3,0.01\nB,4,5,6,-1\nC,7,8,9,much\nD,nan,1,2,\nE,1,2,3,\n"
    page.table.take_text(text)
    assert [p.name for p in page.desk.sheet.points] == ["A", "E"]
    said = page.table.problem.text()
    assert "y [ft]" in said and all(f"Line {n}" in said for n in (3, 4, 5))
    (tmp_path / "points.csv").write_text(text, "utf-8")
    dialog = ImportDialog(tmp_path / "points.csv")
    qtbot.addWidget(dialog)
    assert "y [ft]" in dialog.verdict.text() and [p.name for p in dialog.points()] == ["A", "E"]


def test_a_file_that_is_not_there_or_no_table_has_no_points(qtbot, tmp_path: Path) -> None:
    (tmp_path / "photo.jpg").write_bytes(bytes(range(256)) * 20)
    for path in (tmp_path / "absent.csv", tmp_path, tmp_path / "photo.jpg"):
        dialog = ImportDialog(path)
        qtbot.addWidget(dialog)
        assert not dialog.points() and not dialog.take.isEnabled() and dialog.verdict.text()


def test_a_bad_line_of_the_projects_table_is_named_and_the_rest_shown(
    page: ControlPage, folder: Path
) -> None:
    (folder / "control.csv").write_text("name,x,y,z\nA,1,2,3\nB,1,two,3\nC,4,5,6\n", "utf-8")
    (folder / "control_measurements.csv").write_text("photo,name,x,y\na.png,A,1,2\na.png,B,3,4\n", "utf-8")
    page.session.project = page.session.project.with_control("control.csv")
    page.desk.load()
    assert page.desk.problem is not None and "line 3" in page.table.problem.text()
    known = {p.name: p.xyz for p in page.desk.sheet.points if p.known}
    assert known == {"A": (1.0, 2.0, 3.0), "C": (4.0, 5.0, 6.0)}
    assert set(page.desk.sheet.marks) == {("A", "a.png"), ("B", "a.png")}


def test_a_click_snaps_and_keys_move_the_mark(page: ControlPage) -> None:
    page.measuring.measure(79, 62)
    assert not page.desk.sheet.marks, "no point is chosen"
    page.table.add()
    page.measuring.snapping.setCurrentIndex(page.measuring.snapping.findData("circle"))
    page.measuring.measure(79, 62)
    mark = page.desk.sheet.marks["P1", "a.png"]
    assert np.allclose(mark.xy, TARGET, atol=0.05) and mark.sigma_px == 0.05
    press(page, Qt.Key.Key_Right)
    press(page, Qt.Key.Key_Right)
    press(page, Qt.Key.Key_Up, Qt.KeyboardModifier.ShiftModifier)
    assert np.allclose(page.desk.sheet.marks["P1", "a.png"].xy, mark.xy + np.array([0.2, -1.0]))
    page.desk.undo.undo()  # nudges that follow each other are one edit
    assert page.desk.sheet.marks["P1", "a.png"] == mark
    page.measuring.measure(20, 20)
    assert page.desk.sheet.marks["P1", "a.png"] == mark and "no circular target" in page.measuring.said.text()
    press(page, Qt.Key.Key_Delete)
    assert not page.desk.sheet.marks


def test_page_down_goes_to_the_next_photo(qtbot, page: ControlPage) -> None:
    page.table.add()
    assert page.measuring.photo == "a.png"
    press(page, Qt.Key.Key_PageDown)
    qtbot.waitUntil(lambda: page.measuring.photo == "b.png")
    assert page.session.photo == 1


def test_next_photo_leaves_out_those_without_the_point() -> None:
    def sight(photo: str, state: str) -> Sight:
        return Sight(photo, state, None, Prediction(None, ""), None)  # type: ignore[arg-type]

    found = [
        sight("a", "measured"),
        sight("b", "out of sight"),
        sight("c", "predicted"),
        sight("d", "not oriented"),
    ]
    assert (
        next_photo(found, "a", 1) == "c"
        and next_photo(found, "c", 1) == "a"
        and next_photo(found, "a", -1) == "c"
    )
    assert next_photo(found[1:2], "b", 1) == "b" and next_photo([], "x", 1) == "x"


def test_removing_points_takes_their_measurements_and_comes_back(page: ControlPage) -> None:
    sheet = ControlSheet(
        (SheetPoint("A"), SheetPoint("B")), {("A", "a.png"): Mark(1, 2), ("B", "a.png"): Mark(3, 4)}
    )
    page.desk.edit(sheet, "test")
    page.table.table.selectRow(0)
    page.table.remove()
    assert set(page.desk.sheet.marks) == {("B", "a.png")}
    page.desk.undo.undo()
    assert page.desk.sheet == sheet


def test_the_preview_shows_how_a_file_is_understood(qtbot, tmp_path: Path) -> None:
    path = tmp_path / "points.txt"
    path.write_text(
        "Nr;Hochwert;Rechtswert;Hoehe\n1;5812345,6;500123,4;101,2\n2;5812346,0;x;101,0\n", "utf-8"
    )
    dialog = ImportDialog(path)
    qtbot.addWidget(dialog)
    assert dialog.format.decimal == "," and [p.name for p in dialog.points()] == ["1"]
    assert "Line 3" in dialog.verdict.text()
    dialog.columns[1].setCurrentIndex(dialog.columns[1].findData("y"))
    dialog.columns[1].activated.emit(0)
    dialog.columns[2].setCurrentIndex(dialog.columns[2].findData("x"))
    dialog.columns[2].activated.emit(0)
    assert dialog.points()[0].xyz == (500123.4, 5812345.6, 101.2)
    dialog.epsg.setText("25832")
    assert dialog.crs() == "EPSG:25832" and dialog.take.isEnabled()
    dialog.epsg.setText("UTM")
    assert not dialog.take.isEnabled()


def test_geographic_control_says_that_it_is_shown_in_a_local_frame(page: ControlPage, folder: Path) -> None:
    heard: list[str] = []
    page.session.message.connect(lambda kind, text: heard.append(str(text)))
    text = "# crs: EPSG:4326\nname,x,y,z,role\nA,9.0,48.0,300,control\nB,9.001,48.0,301,check\n"
    (folder / "control.csv").write_text(text, "utf-8")
    page.session.project = page.session.project.with_control("control.csv")
    page.desk.load()
    assert any("local frame" in line for line in heard)
    assert np.hypot(
        *np.subtract(page.desk.sheet.points[0].xyz, page.desk.sheet.points[1].xyz)[:2]
    ) == pytest.approx(74.6, abs=0.2)  # 0.001° of longitude at 48°


def test_off_points_and_standard_deviations_survive_the_file(page: ControlPage, folder: Path, qtbot) -> None:
    nan = float("nan")
    sheet = ControlSheet(
        (SheetPoint("A", (1.0, 2.0, nan), (0.01, 0.02, nan), "off"), SheetPoint("B", (4.0, 5.0, 6.0), role="check")),
        {("A", "a.png"): Mark(1.0, 2.0, 0.3)}, "EPSG:25832",
    )  # fmt: skip
    page.desk.edit(sheet, "test")
    page.desk.save()
    qtbot.waitUntil(lambda: (folder / "control.csv").is_file() and not page.session.jobs.running)
    assert ControlSheet.from_known(*read_control(folder / "control.csv")) == sheet


def test_an_oriented_block_predicts_places_and_measures_distances(qtbot, page: ControlPage) -> None:
    camera = Camera(model="pinhole", width=160, height=120, values=np.array([150.0, 79.5, 59.5]))
    xyz = np.array([[0.0, 0.0, 5.0], [1.0, 0.5, 5.0]])
    centres = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    block = Block(
        cameras=(camera,), names=("a.png", "b.png"), camera_of_photo=np.zeros(2, np.int32), oriented=np.ones(2, bool),
        rotations=np.repeat(np.eye(3)[None], 2, axis=0), centres=centres, points=xyz,
        colours=np.zeros((2, 3), np.uint8), point_track=np.zeros(2, np.int32),
        obs_photo=np.array([0, 1, 0, 1], np.int32), obs_point=np.array([0, 0, 1, 1], np.int32),
        obs_xy=np.zeros((4, 2)), unit="m",
    )  # fmt: skip
    places = {(p, q): project(block, q, xyz[p]) for p in (0, 1) for q in (0, 1)}
    marks = {(f"P{p}", block.names[q]): Mark(*places[p, q].tolist()) for p, q in places}
    del marks["P1", "b.png"]
    sheet = ControlSheet(
        (SheetPoint("P0"), SheetPoint("P1", tuple(xyz[1].tolist()))), marks,
        distances=(SheetDistance("P0", "P1", 1.0), SheetDistance("a.png", "b.png", 1.002)),
    )  # fmt: skip
    page.desk.edit(sheet, "test")
    unknown = np.full(4, np.nan)
    adjustment = Adjustment(
        block=block, sigma0_px=1.0, redundancy=1, observations=8, unknowns=7, datum="", rms_px=0.0,
        residuals=np.zeros((4, 2)), weights=np.ones(4), sigma_rotations=np.zeros((2, 3)), sigma_centres=np.zeros((2, 3)),
        sigma_points=np.zeros((2, 3)), iterations=(), converged=True, stop_reason="",
    )  # fmt: skip
    placed = Georeference(
        method="control points", scale=1.0, rotation=np.eye(3), translation=np.zeros(3), names=("P1",),
        check=np.array([True]), residuals=np.array([[0.003, 0.0, 0.004]]), rms_m=float(unknown[0]), check_rms_m=0.0,
        origin=np.zeros(3),
    )  # fmt: skip
    page.show_result(AdjustmentResult(adjustment=adjustment, georeference=placed))
    page.desk.choose("P1")
    page.session.select_photo(1)
    page.show_photo(1)
    qtbot.waitUntil(lambda: [s.state for s in page._sights] == ["measured", "predicted"], timeout=60000)
    prediction = page.measuring.sight.prediction
    assert prediction.source == "coordinates" and np.allclose(prediction.xy, places[1, 1], atol=1e-6)
    press(page, Qt.Key.Key_Space)  # takes the expected place
    assert np.allclose(page.desk.sheet.marks["P1", "b.png"].xy, places[1, 1], atol=1e-3)
    qtbot.waitUntil(lambda: page.table.model.image_rms.get("P1", 1.0) < 1e-3, timeout=20000)
    cells = [page.table.model.text(page.desk.sheet.points[1], key) for key in ("r0", "r2", "r")]
    assert cells == ["3.00", "4.00", "5.00"]
    qtbot.waitUntil(lambda: "mm" in page.distances.table.item(1, 6).text(), timeout=20000)
    assert page.distances.table.item(0, 5).text().startswith(f"{np.linalg.norm(xyz[1] - xyz[0]):.4f}"[:6])
    assert page.distances.table.item(1, 6).text().startswith("\u22122.00")


def test_mouse_and_keys_reach_the_photo_and_undo_works_from_there(qtbot, page: ControlPage) -> None:
    page.table.add()
    canvas = page.measuring.canvas
    x, y = canvas.to_screen(np.array([TARGET]))[0]
    qtbot.mouseClick(canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
    mark = page.desk.sheet.marks["P1", "a.png"]
    assert np.allclose(mark.xy, TARGET, atol=1.0)
    qtbot.keyClick(canvas, Qt.Key.Key_Right)
    assert page.desk.sheet.marks["P1", "a.png"].x == pytest.approx(mark.x + 0.1, abs=1e-3)
    qtbot.keyClick(canvas, Qt.Key.Key_S)
    assert page.measuring.snapping.currentData() == "circle"
    page.activateWindow()
    canvas.setFocus()
    qtbot.waitUntil(canvas.hasFocus)
    qtbot.keyClick(canvas, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert page.desk.sheet.marks["P1", "a.png"] == mark
    qtbot.keyClick(canvas, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert not page.desk.sheet.marks


def test_an_edit_is_not_lost_when_the_window_closes_at_once(page: ControlPage, folder: Path) -> None:
    page.desk.edit(ControlSheet((SheetPoint("A", (1.0, 2.0, 3.0)),)), "test")
    assert page.desk.unsaved
    page.desk.flush()
    assert not page.desk.unsaved
    assert Project.open(folder).control()[0].names == ("A",)
