"""The page that hosts one simulator: the picture large, few controls, challenge and reset in one corner."""

from __future__ import annotations

import threading
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.data.record import Array
from graphos_core.errors import GraphosError
from graphos_core.params import Level, Params
from graphos_didactic.formula_outline import load_typesetter, typesetter_loaded
from graphos_didactic.scene import Handle
from graphos_didactic.scene_svg import scene_svg
from graphos_didactic.scene_text import html_text
from graphos_didactic.simulator import History, Setting, Simulator, drag
from graphos_didactic.simulator_files import State, data_csv, photo_fingerprint, read_state, state_text
from graphos_py.icons import bind_icon
from graphos_py.tabs.simulator_controls import SimulatorControls
from graphos_py.tabs.simulator_home import TakeHome
from graphos_py.tabs.simulator_quiz import SimulatorQuiz
from graphos_py.tabs.simulator_steps import SimulatorSteps
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.scene_view import SceneView

SIDE = 364


class SimulatorPage(QWidget):
    """Plays one simulator.

    Parameters
    ----------
    simulator : Simulator
    photo : uint8 (h, w) or (h, w, 3) RGB, optional
        A photo of the open project.
    photo_name : str
    level : {"novice", "student", "expert"}

    Signals
    -------
    left()
        The person wants back to the list.
    lesson_asked(name)
        The lesson about this simulator.
    """

    left = Signal()
    lesson_asked = Signal(str)

    def __init__(
        self,
        simulator: Simulator,
        photo: Array | None = None,
        photo_name: str = "",
        level: Level = "student",
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.simulator = simulator
        self.setting = Setting(photo, photo_name)
        self.history = History(simulator.params())
        self._moving: Params | None = None
        self._free: tuple[str, ...] | None = None
        self.view = SceneView()
        self.pinned = SceneView()
        self.pinned.hide()
        self.controls = SimulatorControls(self.history.present, level)
        self.quiz = SimulatorQuiz(simulator)
        self.steps = SimulatorSteps(simulator.steps)
        self._captions = (QLabel(tr("Kept, as it was")), QLabel(tr("Now")))
        self._says = QLabel()
        self._says.setWordWrap(True)
        self._says.setProperty("role", "heading")
        self._build()
        self._connect()
        self._dress()
        self._redraw()
        self._loading = QTimer(self, interval=60)
        self._loading.timeout.connect(self._formulas_ready)
        if not typesetter_loaded():  # takes a second: the picture appears at once, its formulas when they can
            for view in (self.view, self.pinned):
                view.set_look(replace(view.look, formulas=False))
            threading.Thread(target=load_typesetter, daemon=True).start()
            self._loading.start()

    # ------------------------------------------------------------------------------------------------ public

    @property
    def params(self) -> Params:
        """The parameters that are shown."""
        return self._moving or self.history.present

    def set_photo(self, photo: Array | None, name: str = "") -> None:
        """Take another photo of the project, or none."""
        self.setting = replace(self.setting, photo=photo, photo_name=name)
        self._redraw()

    def set_level(self, level: Level) -> None:
        """Show the controls of this level."""
        self.controls.set_level(level)

    def show_params(self, params: Params) -> None:
        """Show a sheet as one change that can be undone."""
        self._moving = None
        self.history.push(params)
        self._redraw()

    def show_preset(self, name: str) -> None:
        """Show a preset."""
        self.quiz.leave()
        self.show_params(self.simulator.preset(name))
        note = next(preset.note for preset in self.simulator.presets if preset.name == name)
        self._note.setText(tr(note))

    def reset(self) -> None:
        """Show the first picture again; can be undone."""
        self.quiz.leave()
        self.steps.show_all()
        self.show_params(self.simulator.params())
        self._note.setText(tr(self.simulator.first))

    def undo(self) -> None:
        """Go one change back."""
        self._moving = None
        self.history.undo()
        self._redraw()

    def redo(self) -> None:
        """Take the last undo back."""
        self._moving = None
        self.history.redo()
        self._redraw()

    def state(self) -> State:
        """Return what restores this page exactly."""
        return State(
            self.simulator,
            self.params,
            self.setting.step,
            self.view.look.truth,
            self.quiz.seed.value() if self.quiz.task is not None else None,
            self.setting.photo_name if self.setting.photo is not None else "",
            photo_fingerprint(self.setting.photo),
        )

    def restore(self, state: State) -> None:
        """Show a state of this simulator."""
        if state.seed is not None:
            self.quiz.seed.setValue(state.seed)
            self.quiz.start_challenge()
        else:
            self.quiz.leave()
        self.steps.show_step(state.step)
        self._truth.setChecked(state.truth)
        self.show_params(state.params)
        if state.photo_sha256 and state.photo_sha256 != photo_fingerprint(self.setting.photo):
            self._note.setText(
                tr("This state was saved with the photo “{name}”, which is not open here.", name=state.photo)
            )

    def set_pinned(self, on: bool) -> None:
        """Keep a copy of the picture beside the living one, to compare two sets of parameters."""
        if on and self.view.scene is not None:
            self.pinned.show_scene(self.view.scene)
            self.pinned.set_look(replace(self.view.look, handles=False, active=""))
        for widget in (self.pinned, *self._captions):
            widget.setVisible(on)
        self._dress()
        self._set_formulas()

    # --------------------------------------------------------------------------------------------- building

    def _build(self) -> None:
        page = QVBoxLayout(self)
        page.setContentsMargins(12, 8, 12, 8)
        page.setSpacing(6)
        page.addLayout(self._head())
        body = QHBoxLayout()
        body.setSpacing(10)
        play = QVBoxLayout()
        play.setSpacing(6)
        pictures = QVBoxLayout()
        pictures.setSpacing(6)
        for caption, view in zip(self._captions, (self.pinned, self.view), strict=True):
            caption.setProperty("role", "caption")
            caption.hide()
            pictures.addWidget(caption)
            pictures.addWidget(view, 1)
        play.addLayout(pictures, 1)
        play.addWidget(self._says)
        play.addWidget(self.steps)
        body.addLayout(play, 1)
        body.addWidget(self._side())
        page.addLayout(body, 1)

    def _head(self) -> QHBoxLayout:
        back = self._button("", tr("All simulators"), self.left.emit, "←")
        title = QLabel(tr(self.simulator.title))
        title.setProperty("role", "title")
        title.setWordWrap(True)
        self._note = QLabel(tr(self.simulator.first))
        self._note.setWordWrap(True)
        self._note.setMinimumWidth(theme().px(110))
        self._truth = QToolButton()
        self._truth.setCheckable(True)
        self._truth.setChecked(True)
        self._truth.setToolTip(tr("Show or hide what is really true, and the errors."))
        self._pin = QToolButton()
        self._pin.setText(tr("Compare"))
        self._pin.setCheckable(True)
        self._pin.setToolTip(tr("Keep this picture beside the next ones."))
        self._full = QToolButton()
        self._full.setText(tr("Full screen"))
        self._full.setToolTip(tr("Full screen, F11; Escape ends it."))
        self._full.clicked.connect(self.toggle_full_screen)
        self._undo = self._button("", tr("Undo"), self.undo, "↶", QKeySequence.StandardKey.Undo)
        self._redo = self._button("", tr("Redo"), self.redo, "↷", QKeySequence.StandardKey.Redo)
        line = QHBoxLayout()
        line.setSpacing(8)
        line.addWidget(back)
        line.addWidget(title, 3)
        line.addSpacing(4)
        line.addWidget(self._note, 2)
        self._lesson = QToolButton()
        self._lesson.setText(tr("Lesson"))
        self._lesson.setToolTip(tr("Read about it: formula, parameters, when it fails."))
        bind_icon(self._lesson, "explain")
        self._lesson.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self._lesson.setVisible(bool(self.simulator.learn))
        self._lesson.clicked.connect(lambda: self.lesson_asked.emit(self.simulator.learn))
        for widget in (
            self._undo,
            self._redo,
            self._truth,
            self._pin,
            self._lesson,
            self._full,
            TakeHome(self),
        ):
            line.addWidget(widget)
        return line

    def _button(
        self, icon: str, tip: str, act: object, text: str = "", key: QKeySequence.StandardKey | None = None
    ) -> QToolButton:
        button = QToolButton()
        action = QAction(text, self)
        action.setToolTip(tip)
        if key is not None:
            action.setShortcut(QKeySequence(key))
            action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
            self.addAction(action)
        action.triggered.connect(act)
        button.setDefaultAction(action)
        button.setAccessibleName(tip)
        if icon:
            bind_icon(action, icon)
        return button

    def _side(self) -> QWidget:
        side = QWidget()
        side.setFixedWidth(theme().px(SIDE))
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        heading = QLabel(tr("Situations"))
        heading.setProperty("role", "group")
        column.addWidget(heading)
        column.addLayout(self._presets())
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        scroll.setWidget(self.controls)
        column.addWidget(scroll, 1)
        column.addWidget(self.quiz)
        return side

    def _presets(self) -> QVBoxLayout:
        rows = QVBoxLayout()
        rows.setSpacing(4)
        line = QHBoxLayout()
        for i, preset in enumerate(self.simulator.presets):
            if i % 2 == 0:
                line = QHBoxLayout()
                line.setSpacing(4)
                rows.addLayout(line)
            mark = {"degenerate": "⚠ ", "photo": "▣ ", "plain": ""}[preset.kind]
            button = QPushButton(mark + tr(preset.label))
            button.setToolTip(tr(preset.note))
            button.clicked.connect(lambda _=False, name=preset.name: self.show_preset(name))
            line.addWidget(button, 1)
        return rows

    def _connect(self) -> None:
        self.view.dragged.connect(self._dragged)
        self.view.dropped.connect(self._settle)
        self.view.chosen.connect(self.pinned.choose)
        self.controls.changed.connect(self._changed)
        self.controls.settled.connect(self._settle)
        self.steps.shown.connect(self._step)
        self.quiz.begun.connect(self._begin)
        self.quiz.revealed.connect(self._reveal)
        self.quiz.ended.connect(self._end)
        self.quiz.reset_asked.connect(self.reset)
        self._truth.toggled.connect(self._dress)
        self._pin.toggled.connect(self.set_pinned)
        theme().changed.connect(self._dress)
        full = QAction(self)
        full.setShortcut(QKeySequence(Qt.Key.Key_F11))
        full.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        full.triggered.connect(self.toggle_full_screen)
        self.addAction(full)

    # --------------------------------------------------------------------------------------------- reacting

    def _dragged(self, handle: Handle, x: float, y: float) -> None:
        if self._free is not None and not set(handle.parameters) <= set(self._free):
            return
        self._changed(drag(self.params, handle, x, y))

    def _changed(self, params: Params) -> None:
        self._moving = params
        self._redraw()

    def _settle(self) -> None:
        if self._moving is not None:
            self.history.push(self._moving)
            self._moving = None
            self._redraw()

    def _step(self, step: int | None) -> None:
        self.setting = replace(self.setting, step=step)
        self._redraw()

    def _begin(self, params: Params, free: tuple[str, ...] | None) -> None:
        self._free = free
        self.controls.set_free(free)
        self._show_answers(False)
        self.show_params(params)

    def _reveal(self, params: Params) -> None:
        self._free = None
        self._show_answers(True)
        self.controls.set_free(None)
        self.show_params(params)

    def _formulas_ready(self) -> None:
        if typesetter_loaded():
            self._loading.stop()
            self._set_formulas()

    def _set_formulas(self) -> None:
        """Show formulas when they can be set; while two pictures share the height their numbers need the room."""
        shown = typesetter_loaded() and not self._pin.isChecked()
        for view in (self.view, self.pinned):
            view.set_look(replace(view.look, formulas=shown))

    def _show_answers(self, shown: bool) -> None:
        for view in (self.view, self.pinned):
            view.set_look(replace(view.look, answers=shown))

    def _end(self) -> None:
        self._free = None
        self.controls.set_free(None)
        self._show_answers(True)
        self._redraw()

    def _dress(self) -> None:
        self._truth.setText(tr("Truth shown") if self._truth.isChecked() else tr("Truth hidden"))
        look = theme()
        font = max(10.0, look.points() * self.logicalDpiY() / 72.0) if look.points() else 13.0
        if self._pin.isChecked():  # two pictures share the height
            font = max(11.0, 0.7 * font)
        for view in (self.view, self.pinned):
            view.set_look(replace(view.look, theme=look.name, font=font, truth=self._truth.isChecked()))

    def _redraw(self) -> None:
        params = self.params
        scene = self.simulator.scene(params, self.setting)
        self.view.show_scene(scene)
        self.controls.show_params(params)
        self.quiz.follow(params, self.setting)
        self._says.setText(html_text(tr(scene.says)) if self.view.look.answers else "")
        self._undo.defaultAction().setEnabled(self.history.can_undo)
        self._redo.defaultAction().setEnabled(self.history.can_redo)

    def toggle_full_screen(self) -> None:
        """Show the window that holds this page on the whole screen, or no longer."""
        window = self.window()
        if window.isFullScreen():
            window.showNormal()
        else:
            window.showFullScreen()

    # ---------------------------------------------------------------------------------------- taking home

    def save(self, path: Path) -> None:
        """Write picture, data or state, by the ending of `path`: png, svg, csv or toml."""
        scene = self.simulator.scene(self.params, self.setting)
        size = self.view.size()
        if path.suffix == ".png":
            if not self.view.image(size).save(str(path)):
                raise OSError(tr("The file {path} could not be written.", path=path))
        elif path.suffix == ".svg":
            text = scene_svg(scene, width=size.width(), height=size.height(), look=self.view.look)
            path.write_text(text, "utf-8")
        elif path.suffix == ".csv":
            path.write_text(data_csv(self.state(), scene), "utf-8")
        else:
            path.write_text(state_text(self.state()), "utf-8")

    def open_state(self, path: Path) -> None:
        """Restore a state from a file; a wrong one is refused in a sentence and changes nothing."""
        try:
            state = read_state(path.read_text("utf-8"))
        except (GraphosError, OSError, UnicodeDecodeError) as problem:
            self._note.setText(str(problem))
            return
        if state.simulator is not self.simulator:
            self._note.setText(
                tr("This is a state of the simulator “{title}”.", title=tr(state.simulator.title))
            )
            return
        self.restore(state)

    def sizeHint(self) -> QSize:
        """Prefer much room."""
        return QSize(1440, 860)
