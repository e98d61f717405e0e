"""The image view: coordinates, zoom at the cursor, crisp pixels, keypoints, residuals, comparison."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from graphos_core.data import Features
from graphos_py.views.export import array_from_image
from graphos_py.views.image_view import ImageView


@pytest.fixture
def view(qtbot: QtBot, photo: np.ndarray) -> ImageView:
    made = ImageView()
    qtbot.addWidget(made)
    made.resize(500, 420)
    made.show()
    qtbot.waitExposed(made)
    made.set_image(photo)
    return made


def features(xy: np.ndarray, scale: float = 12.0) -> Features:
    n = len(xy)
    return Features(
        xy=xy.astype(np.float32), scale=np.full(n, scale, np.float32), angle=np.zeros(n, np.float32),
        response=np.ones(n, np.float32), descriptors=np.zeros((n, 128), np.uint8),
        colour=np.zeros((n, 3), np.uint8), width=400, height=300,
    )  # fmt: skip


def wheel(view: ImageView, x: float, y: float, delta: int) -> None:
    event = QWheelEvent(
        QPointF(x, y), QPointF(x, y), QPoint(), QPoint(0, delta), Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    view.canvas.wheelEvent(event)


def test_the_centre_of_the_top_left_pixel_is_zero_zero(view: ImageView) -> None:
    canvas = view.canvas
    x, y = canvas.to_screen(np.array([[0.0, 0.0]]))[0]
    assert x == pytest.approx(canvas.left + 0.5 * canvas.zoom)
    assert y == pytest.approx(canvas.top + 0.5 * canvas.zoom)
    assert canvas.to_image(canvas.left, canvas.top) == pytest.approx((-0.5, -0.5))


def test_the_wheel_keeps_the_pixel_under_the_cursor(view: ImageView) -> None:
    before = view.canvas.to_image(310.0, 120.0)
    for delta in (120, 120, -240, 360):
        wheel(view, 310.0, 120.0, delta)
        assert view.canvas.to_image(310.0, 120.0) == pytest.approx(before, abs=1e-9)


def test_zoomed_pixels_are_crisp_and_where_the_coordinates_say(view: ImageView, photo: np.ndarray) -> None:
    view.canvas.focus_on(57.0, 83.0, 16.0)
    shot = array_from_image(view.canvas.grab().toImage())
    for x, y in ((57, 83), (60, 80), (50, 90)):
        sx, sy = view.canvas.to_screen(np.array([[x, y]]))[0]
        for dx, dy in ((0, 0), (-7, 0), (7, 7)):
            assert tuple(shot[int(sy + dy), int(sx + dx)]) == tuple(photo[y, x])


def test_the_readout_names_position_and_value(view: ImageView, photo: np.ndarray) -> None:
    text = view.readout(57.3, 82.6)
    assert "x 57.3" in text
    assert "y 82.6" in text
    assert "RGB 57 83 0" in text
    assert view.readout(-0.6, 5) == ""
    view.set_image(photo[:, :, 0])
    assert "grey 57" in view.readout(57.4, 82.6)


def test_a_click_tells_image_coordinates_and_a_drag_does_not(view: ImageView, qtbot: QtBot) -> None:
    x, y = view.canvas.to_screen(np.array([[100.0, 50.0]]))[0]
    with qtbot.waitSignal(view.clicked) as caught:
        QTest.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
    assert caught.args == pytest.approx([100.0, 50.0], abs=1.0)
    left = view.canvas.left
    with qtbot.assertNotEmitted(view.clicked):
        QTest.mousePress(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(100, 100))
        QTest.mouseMove(view.canvas, QPoint(130, 90))
        QTest.mouseRelease(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(130, 90))
    assert view.canvas.left == pytest.approx(left + 30)


def test_f_fits_and_one_shows_single_pixels(view: ImageView) -> None:
    QTest.keyClick(view.canvas, Qt.Key.Key_1)
    assert view.canvas.zoom == pytest.approx(1.0)
    QTest.keyClick(view.canvas, Qt.Key.Key_F)
    width, height = view.canvas.image_size
    assert view.canvas.zoom == pytest.approx(min(view.canvas.width() / width, view.canvas.height() / height))


def test_every_keypoint_in_sight_is_drawn_with_its_circle_and_orientation(view: ImageView) -> None:
    xy = np.array([[50.0, 60.0], [200.0, 150.0], [390.0, 290.0]])
    view.set_keypoints(features(xy))
    view.canvas.grab()
    assert view.keypoints.drawn == 3
    mask, _ = view.keypoints.mask()
    for centre in view.canvas.to_screen(xy):
        radius = 6.0 * view.canvas.zoom
        assert (
            mask[round(centre[1] - radius - 1.5) : round(centre[1] - radius + 1.5), round(centre[0])].max()
            > 120
        )
        assert (
            mask[round(centre[1] - 0.5), round(centre[0] + radius / 2)] > 100
        )  # angle 0 points to the right
        assert mask[round(centre[1] - 0.5), round(centre[0] - radius / 2)] == 0
    view.canvas.focus_on(50, 60, 10.0)
    view.canvas.grab()
    assert view.keypoints.drawn == 1


def test_clicking_a_keypoint_selects_it(view: ImageView, qtbot: QtBot) -> None:
    xy = np.array([[50.0, 60.0], [200.0, 150.0]])
    view.set_keypoints(features(xy))
    x, y = view.canvas.to_screen(xy)[1]
    with qtbot.waitSignal(view.keypoint_selected) as caught:
        QTest.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(x) + 2, round(y)))
    assert caught.args == [1]
    assert view.keypoints.selected == 1


def test_residuals_are_exaggerated_by_a_round_number_that_makes_them_visible(view: ImageView) -> None:
    rng = np.random.default_rng(0)
    view.set_overlay(rng.uniform(20, 280, (100, 2)), rng.normal(0, 0.3, (100, 2)), label="residual")
    drawn = view.vectors.exaggeration * view.canvas.zoom * 0.35
    assert 8 < drawn < 60
    assert view.vectors.exaggeration in {a * b for a in (1, 2, 5) for b in (10, 100)}
    view.canvas.grab()


def test_compare_shows_before_left_and_after_right_of_the_divider(view: ImageView, photo: np.ndarray) -> None:
    view.compare(photo, 255 - photo)
    view.canvas.split = 0.5
    view.canvas.focus_on(200.0, 150.0, 20.0)
    shot = array_from_image(view.canvas.grab().toImage())
    for x, expected in ((196, photo[153, 196]), (204, 255 - photo[153, 204])):
        sx, sy = view.canvas.to_screen(np.array([[x, 153]]))[0]
        assert tuple(shot[int(sy), int(sx)]) == tuple(expected)
    divider = round(view.canvas.split_position())
    QTest.mousePress(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(divider, 100))
    QTest.mouseMove(view.canvas, QPoint(divider + 60, 100))
    QTest.mouseRelease(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(divider + 60, 100))
    assert view.canvas.split_position() == pytest.approx(divider + 60, abs=1.5)


def test_exports_write_readable_files(view: ImageView, tmp_path: Path) -> None:
    view.set_keypoints(features(np.array([[50.25, 60.0]])))
    for ending, write in view.exports().items():
        write(tmp_path / f"out.{ending}")
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "out.svg").read_text("utf-8")
    header, row = (tmp_path / "out.csv").read_text("utf-8").splitlines()
    assert header.startswith("x [px],y [px]")
    assert row.startswith("50.25,60,12,0")


def test_an_empty_view_paints_its_two_lines(qtbot: QtBot) -> None:
    empty = ImageView()
    qtbot.addWidget(empty)
    empty.resize(400, 300)
    shot = array_from_image(empty.canvas.grab().toImage())
    assert len(np.unique(shot.reshape(-1, 3), axis=0)) > 2
