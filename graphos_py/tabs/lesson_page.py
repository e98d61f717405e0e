"""A lesson with what there is to try: the text wide, parameter sets and the simulator beside it."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from graphos_core.registry import candidate_stage, find
from graphos_didactic.lessons import Lesson, Trial, default_text, trial_sheet
from graphos_py.icons import bind_icon
from graphos_py.session import STAGE_LABELS, Session
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.lesson_view import LessonView


class LessonPage(QWidget):
    """Shows one lesson.

    Signals
    -------
    left
        Back to the first page.
    lesson_asked, simulator_asked, stage_asked : str
    simulator_tried : str, object
        A simulator with the values of some of its parameters.
    """

    left = Signal()
    lesson_asked = Signal(str)
    simulator_asked = Signal(str)
    stage_asked = Signal(str)
    simulator_tried = Signal(str, object)

    def __init__(self, session: Session, lesson: Lesson, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.session = session
        self.lesson = lesson
        self.view = LessonView(session.jobs)
        self.view.asked.connect(self._asked)
        self.tries: list[QPushButton] = []
        self.said = QLabel()
        self.said.setWordWrap(True)
        page = QVBoxLayout(self)
        page.setContentsMargins(12, 8, 12, 8)
        page.setSpacing(8)
        page.addLayout(self._head())
        body = QHBoxLayout()
        body.setSpacing(12)
        body.addWidget(self.view, 1)
        body.addWidget(self._side())
        page.addLayout(body, 1)
        self.view.show_lesson(lesson)

    def _head(self) -> QHBoxLayout:
        line = QHBoxLayout()
        line.setSpacing(8)
        back = QPushButton("←")
        back.setToolTip(tr("All lessons"))
        back.setAccessibleName(tr("All lessons"))
        back.clicked.connect(self.left)
        title = QLabel(tr(self.lesson.title))
        title.setProperty("role", "title")
        room = QLabel(tr(STAGE_LABELS[candidate_stage(self.lesson.room)]))
        room.setProperty("role", "caption")
        line.addWidget(back)
        line.addWidget(title)
        line.addWidget(room, 1, Qt.AlignmentFlag.AlignBottom)
        return line

    def _side(self) -> QWidget:
        side = QWidget()
        side.setFixedWidth(theme().px(300))
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        if self.lesson.simulator:
            column.addWidget(_group(tr("Play with it")))
            play = QPushButton(tr("Open the simulator"))
            play.setProperty("role", "primary")
            bind_icon(play, "run", "on_accent")
            play.clicked.connect(lambda: self.simulator_asked.emit(self.lesson.simulator))
            column.addWidget(play)
        for own, heading in (
            (False, tr("Try this in the simulator")),
            (True, tr("Try this on your own photos")),
        ):
            trials = [trial for trial in self.lesson.trials if trial.simulator is not own]
            if trials:
                column.addWidget(_group(heading))
            for trial in trials:
                column.addWidget(self._card(trial))
        self.go = QPushButton()
        self.go.hide()
        self.go.clicked.connect(lambda: self.stage_asked.emit(self.lesson.algorithm.partition(".")[0]))
        column.addWidget(self.said)
        column.addWidget(self.go)
        column.addStretch(1)
        if self.lesson.fails and "When it fails" not in self.lesson.text:
            column.addWidget(_group(tr("When it fails, and how one sees it")))
            fails = QLabel(tr(self.lesson.fails))
            fails.setWordWrap(True)
            column.addWidget(fails)
        return side

    def _card(self, trial: Trial) -> QFrame:
        card = QFrame()
        card.setProperty("role", "card")
        column = QVBoxLayout(card)
        column.setContentsMargins(10, 8, 10, 8)
        column.setSpacing(4)
        what = QLabel(_sentence(tr(trial.what)))
        what.setWordWrap(True)
        change = QLabel(self._change(trial))
        change.setWordWrap(True)
        change.setProperty("role", "caption")
        button = QPushButton(tr("Show it") if trial.simulator else tr("Set it"))
        button.clicked.connect(partial(self.try_it, trial))
        self.tries.append(button)
        for widget in (what, change):
            column.addWidget(widget)
        column.addWidget(button, 0, Qt.AlignmentFlag.AlignLeft)
        return card

    def _change(self, trial: Trial) -> str:
        """Return which parameters are set, with what they normally are."""
        sheet = trial_sheet(self.lesson, trial)
        declarations = sheet.declarations() if sheet else {}
        lines = []
        for name, value in trial.values.items():
            declaration = declarations[name]
            shown = (
                str(value).lower()
                if isinstance(value, bool)
                else f"{value:g}"
                if isinstance(value, float)
                else f"{value}"
            )
            unit = declaration.about.unit
            lines.append(
                tr("{label}: {value} (normally {default})", label=tr(declaration.about.label),
                   value=f"{shown} {unit}".strip(), default=default_text(declaration))
            )  # fmt: skip
        return "\n".join(lines)

    def try_it(self, trial: Trial) -> None:
        """Put the parameter set into the recipe, or open the simulator with it; choose the algorithm if not in use."""
        if trial.simulator:
            self.simulator_tried.emit(self.lesson.simulator, trial.values)
            return
        recipe = self.session.recipe
        if recipe is None:
            self.said.setText(tr("The engine is still being loaded; try again in a moment."))
            return
        room, name = self.lesson.algorithm.split(".", 1)
        stage, algorithm = candidate_stage(room), find(room, name)
        if name not in recipe.chosen(stage, algorithm.role):
            self.session.choose(stage, algorithm.role, (name,))
        self.session.set_params(stage, name, recipe.params(stage, name).replace(**trial.values))
        label = tr(STAGE_LABELS[stage])
        self.said.setText(tr("Set. Run {stage} and compare with the result before.", stage=label))
        self.go.setText(tr("Go to {stage}", stage=label))
        self.go.show()

    def _asked(self, kind: str, name: str) -> None:
        (self.lesson_asked if kind == "lesson" else self.simulator_asked).emit(name)


def _group(text: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", "group")
    return label


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]
