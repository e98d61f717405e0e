"""A lab: steps on the left, what to do in the middle, and always where one is and what is next."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSize, Qt, Signal, Slot
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QProgressBar,
    QPushButton,
    QScrollArea,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from graphos_core.params import Level
from graphos_didactic.lab_session import LabSession
from graphos_didactic.labs import Lab
from graphos_py.icons import bind_icon, icon
from graphos_py.session import Session
from graphos_py.tabs.lab_start import LabStart
from graphos_py.tabs.lab_step import LabStep, set_role
from graphos_py.theme import theme
from graphos_py.translation import tr


class LabPage(QWidget):
    """Plays one lab.

    Signals
    -------
    left
        Back to the first page.
    lesson_asked, simulator_asked, stage_asked : str
    placed : str
        Where one is, in a line; empty when no session of the lab is open.
    """

    left = Signal()
    lesson_asked = Signal(str)
    simulator_asked = Signal(str)
    stage_asked = Signal(str)
    placed = Signal(str)

    def __init__(self, session: Session, lab: Lab, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.session = session
        self.lab = lab
        self.student: LabSession | None = None
        self.shown = 0
        self.place = QLabel()
        self.place.setProperty("role", "heading")
        self.bar = QProgressBar()
        self.bar.setTextVisible(False)
        self.bar.setRange(0, len(lab.steps))
        self.bar.setFixedWidth(theme().px(180))
        self.steps = QListWidget()
        self.steps.setAccessibleName(tr("Steps of the lab"))
        self.steps.setWordWrap(True)
        self.steps.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.steps.setFixedWidth(theme().px(250))
        self.steps.setIconSize(QSize(18, 18))
        self.step = LabStep(session)
        self.start = LabStart(session, lab)
        self.stack = QStackedWidget()
        self.stack.addWidget(self._first_page())
        self.stack.addWidget(self._play())
        page = QVBoxLayout(self)
        page.setContentsMargins(12, 8, 12, 8)
        page.setSpacing(8)
        page.addLayout(self._head())
        page.addWidget(self.stack, 1)
        self._connect()
        self.set_level("student")
        self._update()

    # --------------------------------------------------------------------------------------------- building

    def _head(self) -> QHBoxLayout:
        line = QHBoxLayout()
        line.setSpacing(10)
        back = QPushButton("←")
        back.setToolTip(tr("First page"))
        back.setAccessibleName(tr("First page"))
        back.clicked.connect(self.left)
        title = QLabel(tr(self.lab.title))
        title.setProperty("role", "title")
        line.addWidget(back)
        line.addWidget(title)
        line.addSpacing(12)
        line.addWidget(self.place, 1)
        line.addWidget(self.bar)
        self.hand_in = QPushButton(tr("Hand in"))
        bind_icon(self.hand_in, "save")
        self.hand_in.setToolTip(tr("Write your answers, figures and parameters into one page, and open it"))
        self.key = QPushButton(tr("Key"))
        self.key.setToolTip(tr("The instructor's key, computed from these results and the truth"))
        for button in (self.hand_in, self.key):
            line.addWidget(button)
        return line

    def _first_page(self) -> QWidget:
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        page = QWidget()
        page.setProperty("role", "paper")
        self._column = QVBoxLayout(page)
        self._column.setContentsMargins(24, 24, 24, 24)
        self._column.setSpacing(12)
        goal = QLabel(tr(self.lab.goal))
        goal.setWordWrap(True)
        goal.setProperty("role", "heading")
        about = QLabel(
            tr("{n} steps · about {minutes} minutes · predict, do, compare, explain",
               n=len(self.lab.steps), minutes=self.lab.minutes)
        )  # fmt: skip
        about.setProperty("role", "caption")
        self._begun = QVBoxLayout()
        for widget in (goal, about):
            self._column.addWidget(widget)
        self._column.addLayout(self._begun)
        self._column.addWidget(self.start)
        self._column.addStretch(1)
        scroll.setWidget(page)
        self._list_begun()
        return scroll

    def _list_begun(self) -> None:
        """Offer the sessions that were begun before."""
        resumable = self.start.resumable()
        if resumable:
            self._begun.addWidget(
                QLabel(tr("Go on where you stopped, or start anew with another name below."))
            )
        for found in resumable:
            button = QPushButton(
                tr("Go on: {student}, {done} of {total} steps done", student=found.student,
                   done=len(found.passed), total=len(self.lab.steps))
            )  # fmt: skip
            bind_icon(button, "run")
            button.clicked.connect(partial(self.start.prepare, found))
            self._begun.addWidget(button, 0, Qt.AlignmentFlag.AlignLeft)

    def _play(self) -> QWidget:
        page = QWidget()
        row = QHBoxLayout(page)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(10)
        row.addWidget(self.steps)
        row.addWidget(self.step, 1)
        return page

    def _connect(self) -> None:
        self.start.started.connect(self.play)
        self.steps.currentRowChanged.connect(self._chosen)
        self.step.judged.connect(self._update)
        self.step.next_asked.connect(self.go_on)
        self.step.lesson_asked.connect(self.lesson_asked)
        self.step.simulator_asked.connect(self.simulator_asked)
        self.step.stage_asked.connect(self.stage_asked)
        self.hand_in.clicked.connect(self.step.hand_in)
        self.key.clicked.connect(self.step.show_key)
        theme().changed.connect(self._update)

    # ----------------------------------------------------------------------------------------------- public

    @Slot(object)
    def play(self, student: LabSession) -> None:
        """Begin or go on: open the student's project and show the first step that is not done."""
        self.student = student
        self.step.begin(student)
        self.stack.setCurrentIndex(1)
        self.show_step(min(student.current, len(self.lab.steps) - 1))

    def show_step(self, index: int) -> None:
        """Show a step; every step can be looked at any time."""
        self.shown = index
        self.step.show_step(index)
        self._update()

    def go_on(self) -> None:
        """Show the next step that is not done, or the one after this."""
        if self.student is not None:
            after = [i for i in range(self.shown + 1, len(self.lab.steps)) if i not in self.student.passed]
            self.show_step(after[0] if after else min(self.student.current, len(self.lab.steps) - 1))

    def set_level(self, level: Level) -> None:
        """Show the key to experts only."""
        self.key.setVisible(level == "expert" and self.student is not None)
        self._expert = level == "expert"

    # ------------------------------------------------------------------------------------------- where am I

    def _chosen(self, row: int) -> None:
        if row >= 0 and row != self.shown:
            self.show_step(row)

    def where(self) -> str:
        """Return where one is and what is next."""
        total = len(self.lab.steps)
        if self.student is None:
            return tr("Next: type your name and start")
        current = self.student.current
        if current >= total:
            return tr("All {total} steps are done. Next: hand in", total=total)
        return tr(
            "Step {n} of {total} · next: {title}", n=current + 1, total=total,
            title=tr(self.lab.steps[current].title),
        )  # fmt: skip

    def _update(self) -> None:
        student = self.student
        self.place.setText(self.where())
        self.bar.setVisible(student is not None)
        self.hand_in.setVisible(student is not None)
        self.key.setVisible(student is not None and self._expert)
        if student is None:
            return
        self.bar.setValue(len(student.passed))
        set_role(self.hand_in, "primary" if student.current >= len(self.lab.steps) else "")
        self.placed.emit(tr("Lab “{title}”: {place}", title=tr(self.lab.title), place=self.where()))
        self.steps.blockSignals(True)
        self.steps.clear()
        for i, step in enumerate(self.lab.steps):
            symbol, colour, state = "not yet", "muted", tr("open")
            if i in student.passed:
                symbol, colour, state = "done", "good", tr("done")
            elif i == student.current:
                symbol, colour, state = "next", "accent", tr("next")
            item = QListWidgetItem(icon(symbol, colour), f"{i + 1}  {tr(step.title)}")
            item.setToolTip(f"{tr(step.kind)} · {state}")
            item.setData(Qt.ItemDataRole.AccessibleTextRole, f"{i + 1} {tr(step.title)}: {state}")
            self.steps.addItem(item)
        self.steps.setCurrentRow(self.shown)
        self.steps.blockSignals(False)
