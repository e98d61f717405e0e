"""The painter of scenes: what is dragged, chosen and drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QSize, Qt
from PySide6.QtGui import QImage
from pytestqt.qtbot import QtBot

from graphos_didactic.scene import Handle
from graphos_didactic.scene_drawing import Look, frames
from graphos_didactic.scene_svg import SvgCanvas
from graphos_didactic.simulator import find_simulator, simulators
from graphos_py.views.scene_canvas import QtCanvas, dashes
from graphos_py.views.scene_view import SceneView


def pixels(image: QImage) -> np.ndarray:
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).copy()


@pytest.fixture
def view(qtbot: QtBot) -> SceneView:
    view = SceneView()
    qtbot.addWidget(view)
    view.resize(1000, 640)
    simulator = find_simulator("adjustment/intersection")
    view.show_scene(simulator.scene(simulator.params()))
    view.show()
    return view


def place_of(view: SceneView, name: str) -> QPoint:
    assert view.scene is not None
    handle = next(h for h in view.scene.handles if h.name == name)
    frame = frames(view.scene, view.width(), view.height(), view.look.font)[handle.panel]
    x, y = frame.to_canvas(np.array([handle.at]))[0]
    return QPoint(round(x), round(y))


def test_a_drag_tells_the_handle_and_the_place(view: SceneView, qtbot: QtBot) -> None:
    moves: list[tuple[Handle, float, float]] = []
    view.dragged.connect(lambda h, x, y: moves.append((h, x, y)))
    start = place_of(view, "camera_b")
    with qtbot.waitSignal(view.dropped):
        qtbot.mousePress(view, Qt.MouseButton.LeftButton, pos=start)
        qtbot.mouseMove(view, start + QPoint(40, 0))
        qtbot.mouseRelease(view, Qt.MouseButton.LeftButton, pos=start + QPoint(40, 0))
    handle, x, y = moves[-1]
    assert handle.name == "camera_b"
    assert x > handle.at[0] + 0.2
    assert y == pytest.approx(handle.at[1], abs=0.05)


def test_tab_and_arrows_move_handles(view: SceneView, qtbot: QtBot) -> None:
    moves: list[tuple[str, float]] = []
    view.dragged.connect(lambda h, x, y: moves.append((h.name, x - h.at[0])))
    view.setFocus()
    qtbot.keyClick(view, Qt.Key.Key_Tab)
    qtbot.keyClick(view, Qt.Key.Key_Right)
    qtbot.keyClick(view, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    qtbot.keyClick(view, Qt.Key.Key_Tab)
    qtbot.keyClick(view, Qt.Key.Key_Right)
    names, steps = zip(*moves, strict=True)
    assert names == ("camera_a", "camera_a", "camera_b")
    assert steps == pytest.approx((0.1, -1.0, 0.1))
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert view.active_handle() is None


def test_a_click_marks_the_thing_in_every_panel(view: SceneView, qtbot: QtBot) -> None:
    before = pixels(view.image(QSize(1000, 640), 1.0, clean=False))
    assert view.scene is not None
    frame = frames(view.scene, 1000, 640, view.look.font)["zoom"]
    x, y = frame.to_canvas(np.array([[0.0, 8.0]]))[0]
    with qtbot.waitSignal(view.chosen):
        qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
    chosen = view.look.chosen
    assert chosen in ("ellipse", "draws")
    changed = np.any(pixels(view.image(QSize(1000, 640), 1.0, clean=False)) != before, axis=2)
    assert not changed.all()
    view.choose("camera_a")
    changed = np.any(pixels(view.image(QSize(1000, 640), 1.0, clean=False)) != before, axis=2)
    assert changed[:, :470].any()


def test_truth_and_answers_are_hidden_on_demand(view: SceneView) -> None:
    size = QSize(1000, 640)
    shown = pixels(view.image(size, 1.0))
    view.set_look(replace(view.look, truth=False))
    without_truth = pixels(view.image(size, 1.0))
    view.set_look(replace(view.look, answers=False))
    without_answers = pixels(view.image(size, 1.0))
    assert (shown != without_truth).any()
    assert (without_truth != without_answers).any()


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("font", [13.0, 26.0])
def test_every_scene_is_drawn_in_both_themes_and_sizes(qtbot: QtBot, theme: str, font: float) -> None:
    view = SceneView()
    qtbot.addWidget(view)
    for simulator in simulators():
        view.show_scene(simulator.scene(simulator.params()))
        view.set_look(Look(theme=theme, font=font))  # type: ignore[arg-type]
        image = pixels(view.image(QSize(1100, 700), 1.0, clean=False))
        packed = image.astype(np.int32) @ np.array([65536, 256, 1])
        assert len(np.unique(packed)) > 50
        corner = image[1, 1].mean()
        assert corner > 200 if theme == "light" else corner < 60


def test_both_canvases_understand_the_same_words() -> None:
    words = {name for name in vars(SvgCanvas) if not name.startswith("_")} - {"body"}
    assert words == {name for name in vars(QtCanvas) if not name.startswith("_")}


def test_the_exported_picture_has_no_handles(view: SceneView) -> None:
    clean = pixels(view.image(QSize(1000, 640), 1.0))
    full = pixels(view.image(QSize(1000, 640), 1.0, clean=False))
    at = place_of(view, "base")
    assert (
        clean[at.y() - 9 : at.y() + 9, at.x() - 9 : at.x() + 9]
        != full[at.y() - 9 : at.y() + 9, at.x() - 9 : at.x() + 9]
    ).any()


def test_dashes_have_their_lengths_along_a_bent_line_and_a_solid_line_is_whole() -> None:
    bent = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 20.0]])
    length = lambda pieces: float(np.hypot(*(pieces[:, 2:] - pieces[:, :2]).T).sum())  # noqa: E731
    assert length(dashes(bent, ())) == pytest.approx(30.0)
    pieces = dashes(bent, (4.0, 2.0))
    assert length(pieces) == pytest.approx(20.0)
    assert pieces[0].tolist() == pytest.approx([0.0, 0.0, 4.0, 0.0])
    middles = (pieces[:, :2] + pieces[:, 2:]) / 2
    assert np.all((middles[:, 1] == 0) | (middles[:, 0] == 10))
