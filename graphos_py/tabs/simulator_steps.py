"""The steps of a simulator's algorithm: play, step, step back."""

from __future__ import annotations

from PySide6.QtCore import QTimer, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from graphos_didactic.simulator import Step
from graphos_py.theme import theme
from graphos_py.translation import tr

PAUSE_MS = 1800


class SimulatorSteps(QWidget):
    """A bar with back, play, forward and one button per step; below it what happens in the step.

    ``shown(step)``: number of the last step to show, None for all.
    """

    shown = Signal(object)

    def __init__(self, steps: tuple[Step, ...], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._steps = steps
        self._now: int | None = None
        self._timer = QTimer(self, interval=PAUSE_MS)
        self._timer.timeout.connect(self._tick)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        line = QHBoxLayout()
        line.setSpacing(4)
        column.addLayout(line)
        caption = QLabel(tr("Step by step"))
        caption.setProperty("role", "group")
        line.addWidget(caption)
        self.back = self._button("◀", tr("One step back"), self.step_back)
        self.play = self._button("▶▶", tr("Play all steps"), self.toggle)
        self.forward = self._button("▶", tr("One step forward"), self.step)
        for button in (self.back, self.play, self.forward):
            line.addWidget(button)
        self._buttons = []
        for i, step in enumerate(steps):
            button = self._button(
                f"{i + 1} {tr(step.title)}", tr(step.text), lambda _=False, n=i: self.show_step(n)
            )
            button.setCheckable(True)
            button.setMinimumWidth(theme().px(32))  # on a small screen its end is cut, the tip has it all
            line.addWidget(button)
            self._buttons.append(button)
        self._text = QLabel()
        self._text.setWordWrap(True)
        line.addStretch(1)
        column.addWidget(self._text)
        self._mark()

    def _button(self, text: str, tip: str, act: object) -> QToolButton:
        button = QToolButton()
        button.setText(text)
        button.setToolTip(tip)
        button.setAccessibleName(tip)
        button.clicked.connect(act)
        return button

    @property
    def now(self) -> int | None:
        """The last step that is shown; None when all are."""
        return self._now

    def show_step(self, step: int | None) -> None:
        """Show the steps up to this one, None for all."""
        self._now = step
        self._mark()
        self.shown.emit(step)

    def show_all(self) -> None:
        """Show the whole algorithm and stop playing."""
        self._timer.stop()
        self.show_step(None)

    def step(self) -> None:
        """Show one step more; after the last the whole."""
        now = len(self._steps) - 1 if self._now is None else self._now
        self.show_step((now + 1) % len(self._steps))

    def step_back(self) -> None:
        """Show one step less."""
        now = len(self._steps) - 1 if self._now is None else self._now
        self.show_step(max(now - 1, 0))

    def toggle(self) -> None:
        """Play from the first step, or stop."""
        if self._timer.isActive():
            self._timer.stop()
        else:
            self.show_step(0)
            self._timer.start()
        self._mark()

    def _tick(self) -> None:
        if self._now is None or self._now >= len(self._steps) - 1:
            self._timer.stop()
            self._mark()
        else:
            self.show_step(self._now + 1)

    def _mark(self) -> None:
        for i, button in enumerate(self._buttons):
            button.setChecked(i == self._now)
        self.play.setText("■" if self._timer.isActive() else "▶▶")
        self._text.setText("" if self._now is None else tr(self._steps[self._now].text))
        self._text.setVisible(self._now is not None)
