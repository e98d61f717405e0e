"""Prediction and challenge of a simulator, and the reset: always in the same corner of the page."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QButtonGroup,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QRadioButton,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from graphos_core.params import Params
from graphos_didactic.scene_text import html_text
from graphos_didactic.simulator import Setting, Simulator, Task, Verdict
from graphos_py.icons import bind_icon
from graphos_py.theme import theme
from graphos_py.translation import tr


class SimulatorQuiz(QFrame):
    """The corner with “Guess”, “Challenge” and “Reset”.

    ``begun(params, free)``: show these parameters, hide answers, only `free` may change (None: all, () : none).
    ``revealed(params)``: show these parameters and the answers. ``ended()``: everything is free again.
    ``reset_asked()``.
    """

    begun = Signal(object, object)
    revealed = Signal(object)
    ended = Signal()
    reset_asked = Signal()

    def __init__(self, simulator: Simulator, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setProperty("role", "card")
        self._simulator = simulator
        self._params: Params = simulator.params()
        self._setting = Setting()
        self.task: Task | None = None
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 10, 12, 10)
        column.setSpacing(6)
        self._text = QLabel()
        self._text.setWordWrap(True)
        self._choices = QWidget()
        self._group = QButtonGroup(self)
        rows = QVBoxLayout(self._choices)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.setSpacing(3)
        for i, choice in enumerate(simulator.prediction.choices):
            button = QRadioButton(tr(choice))
            self._group.addButton(button, i)
            rows.addWidget(button)
        self._group.idToggled.connect(self._chosen)
        self._answer = QWidget()
        self._number = QLineEdit()
        self._number.setAccessibleName(tr("Your answer"))
        self._unit = QLabel()
        self._number.returnPressed.connect(self._confirm)
        line = QHBoxLayout(self._answer)
        line.setContentsMargins(0, 0, 0, 0)
        line.addWidget(self._number, 1)
        line.addWidget(self._unit)
        self._verdict = QLabel()
        self._verdict.setWordWrap(True)
        self._act = QPushButton()
        self._act.setProperty("role", "primary")
        self._act.clicked.connect(self._confirm)
        self._leave = QPushButton(tr("Back to playing"))
        self._leave.clicked.connect(self.leave)
        for widget in (self._text, self._choices, self._answer, self._verdict, self._act, self._leave):
            column.addWidget(widget)
        column.addLayout(self._buttons())
        self.leave()

    def _buttons(self) -> QHBoxLayout:
        self._guess = QPushButton(tr("Guess"))
        self._guess.setToolTip(tr("Predict first, then see."))
        self._guess.clicked.connect(self.ask_prediction)
        self._start = QPushButton(tr("Challenge"))
        self._start.setToolTip(tr("A task with an automatic check; its numbers come from the seed."))
        self._start.clicked.connect(self.start_challenge)
        self.seed = QSpinBox()
        self.seed.setRange(0, 9999)
        self.seed.setValue(1)
        self.seed.setToolTip(tr("Seed of the challenge: the same number gives the same task."))
        self.seed.setFixedWidth(theme().px(64))
        self.seed.setAccessibleName(tr("Seed of the challenge"))
        self.reset = QPushButton(tr("Reset"))
        bind_icon(self.reset, "recent")
        self.reset.setToolTip(tr("Back to the first picture."))
        self.reset.clicked.connect(self.reset_asked)
        line = QHBoxLayout()
        line.setSpacing(6)
        line.addWidget(self._guess)
        line.addWidget(self._start)
        line.addWidget(self.seed)
        line.addStretch(1)
        line.addWidget(self.reset)
        return line

    def _chosen(self, _: int, on: bool) -> None:
        if on:
            self._act.setEnabled(True)

    def allow_guessing(self, allowed: bool) -> None:
        """Offer the prediction, or not, as in a demonstration."""
        self._guess.setVisible(allowed)

    def follow(self, params: Params, setting: Setting) -> None:
        """Know what the page shows now."""
        self._params, self._setting = params, setting

    def ask_prediction(self) -> None:
        """Ask the question; the answers are hidden until the person has chosen."""
        self.task = None
        self._group.setExclusive(False)
        for button in self._group.buttons():
            button.setChecked(False)
        self._group.setExclusive(True)
        self._show(tr(self._simulator.prediction.question), choices=True, act=tr("Reveal"))
        self._act.setEnabled(False)
        self.begun.emit(self._params, ())

    def start_challenge(self) -> None:
        """Draw the task of the visible seed."""
        self.task = self._simulator.challenge(self.seed.value())
        self._unit.setText(tr(self.task.unit or ""))
        self._number.clear()
        self._show(tr(self.task.text), number=self.task.unit is not None, act=tr("Check"))
        self.begun.emit(self.task.start, self.task.free)

    def leave(self) -> None:
        """Back to playing."""
        self.task = None
        self._show("", act="")
        self.ended.emit()

    def _confirm(self) -> None:
        if self.task is None:
            self._reveal()
            return
        number: float | None = None
        if self.task.unit is not None:
            try:
                number = float(self._number.text().replace(",", ".").replace("−", "-"))
            except ValueError:
                self._judge(Verdict(False, tr("Type a number first.")))
                return
        verdict = self.task.check(self._params, number)
        self._judge(verdict)
        if verdict.right:
            self._act.hide()
            self.revealed.emit(self._params)

    def _reveal(self) -> None:
        prediction = self._simulator.prediction
        right = prediction.answer(self._params, self._setting)
        guess = self._group.checkedId()
        text = prediction.explain(self._params, self._setting)
        if guess != right:
            text = tr("The answer is “{answer}”.", answer=tr(prediction.choices[right])) + " " + text
        self._choices.setEnabled(False)
        self._judge(Verdict(guess == right, text))
        self._act.hide()
        self.revealed.emit(prediction.change(self._params))

    def _judge(self, verdict: Verdict) -> None:
        mark = "✓" if verdict.right else "✗"
        name = f"<b>{tr(verdict.misconception)}.</b> " if verdict.misconception else ""
        self._verdict.setText(f"<b>{mark}</b> {name}{html_text(tr(verdict.text))}")
        self._verdict.show()

    def _show(self, text: str, *, act: str, choices: bool = False, number: bool = False) -> None:
        asked = bool(text)
        self._text.setText(html_text(text))
        self._text.setVisible(asked)
        self._choices.setVisible(choices)
        self._choices.setEnabled(True)
        self._answer.setVisible(number)
        self._verdict.hide()
        self._act.setText(act)
        self._act.setVisible(bool(act))
        self._act.setEnabled(True)
        self._leave.setVisible(asked)
