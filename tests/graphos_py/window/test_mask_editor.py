"""Masks in the Photos tab: drawn, moved, deleted, copied and imported with mouse and keys, and saved at once."""

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from graphos_core.masks import PhotoMask, Polygon, polygon_inside, read_masks, write_masks
from graphos_py.masks.shapes import edge_at, masked_share, polygon_at, without_corner

LEFT = Qt.MouseButton.LeftButton
SQUARE = Polygon(((20, 20), (120, 20), (120, 100), (20, 100)))


@pytest.fixture
def editor(qtbot, window, photo_folder, tmp_path):
    window.resize(1300, 850)
    window.show()
    window.engine_loaded([])
    window.session.bug.connect(lambda problem: pytest.fail(repr(problem)))
    window.session.create(tmp_path / "out", photo_folder)
    qtbot.waitUntil(lambda: not window.jobs.running, timeout=10000)
    window.show_tab("images")
    tab = window.tabs["images"]
    qtbot.waitUntil(
        lambda: tab._made and tab.image.canvas.array is not None and not window.jobs.running, timeout=10000
    )
    return tab.masks


def at(editor, x: float, y: float) -> QPoint:
    sx, sy = editor.canvas.to_screen(np.array([[x, y]]))[0]
    return QPoint(round(sx), round(sy))


def click(editor, *places: tuple[float, float]) -> None:
    for place in places:
        QTest.mouseClick(editor.canvas, LEFT, pos=at(editor, *place))


def saved(editor) -> tuple[Polygon, ...]:
    return read_masks(editor.folder).get(editor.photo.name, PhotoMask()).polygons


def test_a_drawn_polygon_is_saved_at_once_and_makes_results_stale(editor, window):
    key = window.session.pipeline.key("keypoints")
    editor.excluding.click()
    click(editor, (20, 20), (120, 20), (120, 100), (20, 100), (20, 20))
    (polygon,) = saved(editor)
    assert polygon.kind == "excluded" and len(polygon.points) == 4
    pixel = 0.6 / editor.canvas.zoom + 0.01  # a click hits a whole pixel of the screen
    assert np.abs(np.array(polygon.points) - np.array(SQUARE.points)).max() <= pixel
    assert window.session.pipeline.key("keypoints") != key
    assert "%" in editor.said.text() and not editor.excluding.isChecked()


def test_enter_closes_escape_gives_up_and_two_corners_are_no_polygon(editor):
    editor.keeping.click()
    click(editor, (20, 20), (120, 20))
    QTest.keyClick(editor.canvas, Qt.Key.Key_Return)
    assert not saved(editor) and editor.keeping.isChecked()
    QTest.keyClick(editor.canvas, Qt.Key.Key_Escape)
    assert not editor.layer.drawing and not editor.keeping.isChecked()
    QTest.keyClick(editor.canvas, Qt.Key.Key_K)
    click(editor, (20, 20), (120, 20), (60, 90), (61, 140))
    QTest.keyClick(editor.canvas, Qt.Key.Key_Backspace)
    QTest.keyClick(editor.canvas, Qt.Key.Key_Return)
    assert [(p.kind, len(p.points)) for p in saved(editor)] == [("kept", 3)]


def test_corners_and_polygons_are_dragged_and_deleted_and_it_can_be_undone(editor):
    editor._change((SQUARE,))
    start, end = at(editor, 120, 100), at(editor, 150, 110)
    QTest.mousePress(editor.canvas, LEFT, pos=start)
    QTest.mouseMove(editor.canvas, end)
    assert saved(editor) == (SQUARE,)  # only what is let go is saved
    QTest.mouseRelease(editor.canvas, LEFT, pos=end)
    assert np.allclose(saved(editor)[0].points[2], (150, 110), atol=1.1 / editor.canvas.zoom)
    assert saved(editor)[0].points[0] == (20, 20)
    QTest.keyClick(editor.canvas, Qt.Key.Key_Delete)
    assert len(saved(editor)[0].points) == 3
    QTest.keyClick(editor.canvas, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    QTest.keyClick(editor.canvas, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert saved(editor) == (SQUARE,)
    QTest.keyClick(editor.canvas, Qt.Key.Key_Y, Qt.KeyboardModifier.ControlModifier)
    assert len(saved(editor)[0].points) == 4 and saved(editor) != (SQUARE,)
    editor.undo()
    editor.layer.selected = editor.layer.corner = -1
    click(editor, (70, 60))
    assert editor.layer.selected == 0
    QTest.mousePress(editor.canvas, LEFT, pos=at(editor, 70, 60))
    QTest.mouseMove(editor.canvas, at(editor, 80, 60))
    QTest.mouseRelease(editor.canvas, LEFT, pos=at(editor, 80, 60))
    assert np.allclose(
        np.array(saved(editor)[0].points) - SQUARE.points, (10, 0), atol=1.1 / editor.canvas.zoom
    )
    QTest.keyClick(editor.canvas, Qt.Key.Key_Delete)
    assert not saved(editor)


def test_a_double_click_on_a_line_adds_a_corner(editor):
    editor._change((SQUARE,))
    QTest.mouseDClick(editor.canvas, LEFT, pos=at(editor, 70, 20))
    assert len(saved(editor)[0].points) == 5 and saved(editor)[0].points[0] == (20, 20)
    assert np.allclose(saved(editor)[0].points[1], (70, 20), atol=1.1 / editor.canvas.zoom)


def test_polygons_go_to_all_photos_of_the_size_and_each_photo_keeps_its_own(editor, window):
    photos = window.session.project.photo_set.photos
    own = Polygon(((1, 1), (9, 1), (9, 9)))
    write_masks(editor.folder, {photos[2].name: PhotoMask((own,))})
    editor.show_photo(photos[0])
    editor._change((SQUARE,))
    editor.copying.click()
    masks = read_masks(editor.folder)
    assert [masks[p.name].polygons for p in photos] == [(SQUARE,), (SQUARE,), (own, SQUARE)]
    assert "2 photos" in editor.said.text()
    editor.copy_to_all()
    assert read_masks(editor.folder) == masks


def test_a_mask_that_covers_everything_is_told_and_pictures_are_imported(editor, window, tmp_path):
    editor._change((Polygon(((-1, -1), (9999, -1), (9999, 9999), (-1, 9999))),))
    assert "covers the whole photo" in editor.said.text()
    photo = editor.photo
    (tmp_path / "m").mkdir()
    free = np.full((photo.height, photo.width), 255, np.uint8)
    free[:20] = 0
    cv2.imwrite(str(tmp_path / "m" / f"{photo.name}.mask.png"), free)
    editor._change(())
    editor.import_from(tmp_path / "m")
    assert read_masks(editor.folder)[photo.name].picture == f"{photo.name}.png"
    assert photo.name in editor.said.text() or "1 photos" in editor.said.text()
    editor.delete()
    assert not read_masks(editor.folder)


def test_a_damaged_file_is_told_and_not_written_over(editor, window):
    (editor.folder / "masks.toml").write_text("schema = [", "utf-8")
    editor.show_photo(editor.photo)
    assert any("masks.toml cannot be read" in text for text in window.messages.texts("error"))
    assert not editor.excluding.isEnabled()
    editor._change((SQUARE,))
    assert (editor.folder / "masks.toml").read_text("utf-8") == "schema = ["


def test_shapes_without_a_window():
    assert polygon_at([SQUARE], 70, 60) == 0 and polygon_at([SQUARE], 10, 60) == -1
    assert edge_at([SQUARE], 70, 22, 3) == (0, 0) and edge_at([SQUARE], 70, 60, 3) is None
    assert without_corner(Polygon(((0, 0), (1, 0), (0, 1))), 0) is None
    exact = polygon_inside(SQUARE.points, 400, 300).mean()
    assert masked_share([SQUARE], 400, 300) == pytest.approx(exact)
    assert abs(masked_share([SQUARE], 400, 300, side=100) - exact) < 0.005
