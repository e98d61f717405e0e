"""The page of a simulator: presets, undo, steps, prediction, challenge, taking home."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage
from pytestqt.qtbot import QtBot

from graphos_didactic.simulator import find_simulator, simulators
from graphos_didactic.simulators.adjustment.intersection_model import IntersectionParams
from graphos_py.tabs.simulator_page import SimulatorPage


@pytest.fixture
def page(qtbot: QtBot) -> SimulatorPage:
    page = SimulatorPage(find_simulator("adjustment/intersection"))
    qtbot.addWidget(page)
    page.resize(1300, 800)
    page.show()
    return page


def test_a_drag_is_one_step_of_undo(page: SimulatorPage) -> None:
    first = page.params
    handle = next(h for h in page.view.scene.handles if h.name == "camera_b")  # type: ignore[union-attr]
    for x in (1.6, 1.8, 2.4):
        page.view.dragged.emit(handle, x, 9.0)
    page.view.dropped.emit()
    assert isinstance(page.params, IntersectionParams)
    assert (page.params.b_x, page.params.b_z) == (2.4, 9.0)
    page.undo()
    assert page.params == first
    page.redo()
    assert page.params.b_x == 2.4  # type: ignore[attr-defined]


def test_a_control_changes_the_picture_and_follows_the_handle(page: SimulatorPage) -> None:
    page.controls.controls["sigma_px"].changed.emit(1.0)
    page.controls.controls["sigma_px"].settled.emit()
    assert page.params.sigma_px == 1.0  # type: ignore[attr-defined]
    handle = next(h for h in page.view.scene.handles if h.name == "camera_a")  # type: ignore[union-attr]
    page.view.dragged.emit(handle, -3.0, 7.0)
    assert page.controls.controls["a_x"]._field.text() == "-3"


def test_reset_brings_the_first_picture_back(page: SimulatorPage) -> None:
    first = page.params
    page.show_preset("short")
    assert page.params != first
    page.reset()
    assert page.params == first


def test_steps_go_forward_and_back_and_play(page: SimulatorPage, qtbot: QtBot) -> None:
    page.steps.step()
    assert page.setting.step == 0
    page.steps.step()
    assert page.setting.step == 1
    page.steps.step_back()
    assert page.setting.step == 0
    page.steps.toggle()
    page.steps._timer.setInterval(10)
    qtbot.waitUntil(lambda: page.setting.step == len(page.simulator.steps) - 1, timeout=5000)
    page.steps.show_all()
    assert page.setting.step is None


def test_the_prediction_hides_the_answer_until_it_is_guessed(page: SimulatorPage) -> None:
    page.quiz.ask_prediction()
    assert not page.view.look.answers
    assert not page.quiz._act.isEnabled()
    assert page._says.text() == ""
    before = page.params
    handle = next(h for h in page.view.scene.handles if h.name == "camera_b")  # type: ignore[union-attr]
    page.view.dragged.emit(handle, 3.0, 5.0)  # nothing can be tried out before the guess
    assert page.params == before
    page.quiz._group.button(1).setChecked(True)
    page.quiz._act.click()
    assert page.view.look.answers
    assert page.params != before
    assert page.quiz._verdict.text().startswith("<b>✓")


def test_predictions_can_be_switched_off(page: SimulatorPage) -> None:
    page.quiz.allow_guessing(False)
    assert not page.quiz._guess.isVisible()


def test_the_challenge_locks_what_is_fixed_and_checks(page: SimulatorPage) -> None:
    page.quiz.seed.setValue(3)
    page.quiz.start_challenge()
    task = page.quiz.task
    assert task is not None
    assert not page.controls.controls["focal_px"].isEnabled()
    assert not page.view.look.answers
    page.quiz._act.click()
    assert page.quiz._verdict.text().startswith("<b>✗")
    page.show_params(task.solution)  # type: ignore[arg-type]
    page.quiz._act.click()
    assert page.quiz._verdict.text().startswith("<b>✓")
    assert page.controls.controls["focal_px"].isEnabled()


def test_a_locked_handle_does_not_move(page: SimulatorPage) -> None:
    page.quiz.start_challenge()
    assert page.quiz.task is not None
    before = page.params
    handle = next(h for h in page.view.scene.handles if h.name == "camera_b")  # type: ignore[union-attr]
    page.view.dragged.emit(handle, 3.0, 5.0)  # its height is fixed
    assert page.params == before


def test_everything_can_be_taken_home_and_the_state_restores(page: SimulatorPage, tmp_path: Path) -> None:
    page.show_preset("right_angle")
    page.steps.show_step(2)
    for ending in ("png", "svg", "csv", "toml"):
        page.save(tmp_path / f"größe.{ending}")
    assert not QImage(str(tmp_path / "größe.png")).isNull()
    ET.parse(tmp_path / "größe.svg")
    assert "σ_Z" in (tmp_path / "größe.csv").read_text("utf-8")
    shown = page.params
    page.reset()
    page.open_state(tmp_path / "größe.toml")
    assert page.params == shown
    assert page.setting.step == 2


def test_a_broken_state_is_refused_in_a_sentence_and_changes_nothing(
    page: SimulatorPage, tmp_path: Path
) -> None:
    (tmp_path / "bad.toml").write_bytes(b"\xff\xfe\x00")
    before = page.params
    page.open_state(tmp_path / "bad.toml")
    page.open_state(tmp_path / "missing.toml")
    assert page.params == before
    assert page._note.text()


def test_two_sets_of_parameters_stand_side_by_side(page: SimulatorPage) -> None:
    page.set_pinned(True)
    kept = page.pinned.scene
    page.show_preset("short")
    assert page.pinned.isVisible()
    assert page.pinned.scene is kept
    assert page.view.scene is not kept


def test_every_simulator_has_a_page_with_every_preset(qtbot: QtBot) -> None:
    for simulator in simulators():
        page = SimulatorPage(simulator)
        qtbot.addWidget(page)
        for preset in simulator.presets:
            page.show_preset(preset.name)
        page.quiz.start_challenge()
        page.quiz.leave()


def test_the_keyboard_undoes(page: SimulatorPage, qtbot: QtBot) -> None:
    page.show_preset("short")
    short = page.params
    page.view.setFocus()
    qtbot.keyClick(page.view, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert page.params != short


def test_the_lesson_about_a_simulator_is_one_click_away(page: SimulatorPage, qtbot: QtBot) -> None:
    with qtbot.waitSignal(page.lesson_asked) as asked:
        page._lesson.click()
    assert asked.args == ["adjustment/intersection"]
