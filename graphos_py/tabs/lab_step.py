"""One step of a lab: its text, the answer, the check, hints in two grades, and what helps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QTimer, QUrl, Signal, Slot
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.errors import GraphosError, UserError
from graphos_core.run import Run
from graphos_core.store import write_text
from graphos_didactic.lab_check import Outcome
from graphos_didactic.lab_session import LabSession, hand_in, key_page
from graphos_didactic.labs import Step
from graphos_py.icons import bind_icon
from graphos_py.jobs import Job
from graphos_py.session import STAGE_LABELS, Session, load_engine
from graphos_py.tabs.lab_detectors import DetectorTable
from graphos_py.tabs.lab_hand_in import REPORT, write_pdf
from graphos_py.tabs.lab_target import CalibrationResults
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.lesson_view import LessonView

PLACES: dict[str, str] = {"images": "Images", **{str(key): label for key, label in STAGE_LABELS.items()}}
KIND_TEXTS = {
    "read": "Read",
    "predict": "Predict: a guess before you know; it is never marked wrong, and it stays as you give it",
    "do": "Do",
    "choose": "Choose control and check points",
    "calibrate": "Calibrate",
    "detect": "Run a detector on all photos, match and verify",
    "measure": "Measure: a number from your own results, right within three standard deviations",
    "compare": "Compare your result with the truth",
    "explain": "Explain in words",
}
LONG = {"calibrate": "Calibrating …", "detect": "Running the detector …"}
"""Steps whose check tells its progress."""
CHECK_TEXTS = {
    "calibrate": "Calibrate",
    "detect": "Run it",
    "read": "Read, go on",
    "predict": "Keep my prediction",
    "explain": "Keep my answer",
}


class LabStep(QWidget):
    """Shows a step of a student's session.

    Signals
    -------
    judged
        A check has ended; the session's progress may have changed.
    next_asked
    lesson_asked, simulator_asked, stage_asked : str
    """

    judged = Signal()
    next_asked = Signal()
    lesson_asked = Signal(str)
    simulator_asked = Signal(str)
    stage_asked = Signal(str)

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.session = session
        self.student: LabSession | None = None
        self.index = 0
        self.checking = False
        self.title, self.kind, self.result, self.hint_text = QLabel(), QLabel(), QLabel(), QLabel()
        self.title.setProperty("role", "title")
        self.kind.setProperty("role", "caption")
        self.text = LessonView(session.jobs)
        self.number = QLineEdit()
        self.number.setPlaceholderText(tr("a number"))
        self.number.setMaximumWidth(theme().px(180))
        self.words = QPlainTextEdit()
        self.words.setPlaceholderText(tr("your answer"))
        self.words.setFixedHeight(theme().px(130))
        self.check_button = QPushButton()
        self.check_button.setProperty("role", "primary")
        self.next_button = QPushButton(tr("Next step"))
        self.hint_button = QPushButton()
        bind_icon(self.hint_button, "explain")
        self.open_button = QPushButton(tr("Open the project of this lab"))
        self.go_button, self.lesson_button, self.play_button = QPushButton(), QPushButton(), QPushButton()
        self.calibrations = CalibrationResults()
        self.detectors = DetectorTable()
        self._typed = QTimer(self, singleShot=True, interval=400)
        self._lay()
        self._connect()

    def _lay(self) -> None:
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        for label in (self.title, self.kind):
            column.addWidget(label)
        column.addWidget(self.text)
        helps = QHBoxLayout()
        for button in (self.open_button, self.go_button, self.lesson_button, self.play_button):
            helps.addWidget(button)
        helps.addStretch(1)
        column.addLayout(helps)
        column.addWidget(self.words)
        row = QHBoxLayout()
        for widget in (self.number, self.check_button, self.hint_button):
            row.addWidget(widget)
        row.addWidget(self.next_button)
        row.addStretch(1)
        column.addLayout(row)
        for label in (self.result, self.hint_text):
            label.setWordWrap(True)
            column.addWidget(label)
        column.addWidget(self.calibrations)
        column.addWidget(self.detectors)
        column.addStretch(1)

    def _connect(self) -> None:
        self.text.document().documentLayout().documentSizeChanged.connect(self._fit_text)
        self.text.asked.connect(lambda kind, name: self._help(kind, name))
        self.number.textEdited.connect(self._edited)
        self.number.returnPressed.connect(self.check)
        self.words.textChanged.connect(self._edited)
        self._typed.timeout.connect(self.keep)
        self.check_button.clicked.connect(self.check)
        self.hint_button.clicked.connect(self.hint)
        self.next_button.clicked.connect(self._next)
        self.open_button.clicked.connect(self.open_project)
        self.go_button.clicked.connect(lambda: self.stage_asked.emit(self.step.stage or ""))
        self.lesson_button.clicked.connect(lambda: self.lesson_asked.emit(self.step.lesson))
        self.play_button.clicked.connect(lambda: self.simulator_asked.emit(self.step.simulator))
        self.session.results_changed.connect(self._results)
        self.session.project_changed.connect(self._refresh)
        self.session.run_changed.connect(self._refresh)

    # ----------------------------------------------------------------------------------------------- public

    @property
    def step(self) -> Step:
        """The step that is shown."""
        assert self.student is not None
        return self.student.lab.steps[self.index]

    def begin(self, student: LabSession) -> None:
        """Show the steps of a student, and open the project."""
        self.student = student
        if not self.project_is_open():
            self.open_project()

    def project_is_open(self) -> bool:
        """Return whether the project of this lab is the one that is open; a lab with a test field has none."""
        if self.student is not None and self.student.lab.target:
            return True
        project = self.session.project
        if project is None or self.student is None:
            return False
        return Path(project.folder).resolve() == self.student.project_folder.resolve()

    def open_project(self) -> None:
        """Open the project of this lab."""
        if self.student is not None and self.session.running is None and not self.student.lab.target:
            self.session.open(self.student.project_folder)

    def show_step(self, index: int) -> None:
        """Show a step."""
        self.keep()
        self.index = index
        step, student = self.step, self.student
        assert student is not None
        self.title.setText(f"{index + 1}  {tr(step.title)}")
        kind = tr(KIND_TEXTS[step.kind])
        if step.kind == "explain":
            kind += " · " + tr("at least {n} words", n=step.words)
        elif step.kind == "do" and step.stage is not None:
            kind += ": " + tr(PLACES[step.stage])
        self.kind.setText(kind)
        self.text.show_markdown(step.text)
        self.number.setText(student.answers.get(index, "") if step.kind != "explain" else "")
        self.words.blockSignals(True)
        self.words.setPlainText(student.answers.get(index, "") if step.kind == "explain" else "")
        self.words.blockSignals(False)
        self.result.clear()
        taken = student.hints.get(index, 0)
        self._show_hints(taken)
        self._refresh()

    @Slot()
    def keep(self) -> None:
        """Save what was typed, at once."""
        self._typed.stop()
        if (
            self.student is not None
            and self.step.kind in ("predict", "measure", "explain")
            and not self.checking
        ):
            self._try(lambda: self._keep())

    def check(self) -> None:
        """Judge the step in the background; the result is saved at once."""
        student, pipeline = self.student, self.session.pipeline
        if student is None or self.checking or not self.check_button.isEnabled():
            return
        self.keep()
        index, answer = self.index, self._answer()

        def work(run: Run) -> tuple[int, Outcome]:
            if student.lab.target or self.step.kind == "detect":
                load_engine()
            return index, student.answer(index, answer, pipeline, run)

        self.checking = True
        long = self.step.kind in LONG
        self.result.setText(tr(LONG[self.step.kind]) if long else tr("Checking …"))
        self._run(work, self._checked, self._progressed if long else None)
        self._refresh()

    def hint(self) -> None:
        """Show the next hint; it is remembered that it was taken."""
        student = self.student
        if student is not None:
            self._try(lambda: student.hint(self.index))
            self._show_hints(student.hints.get(self.index, 0))
            self._refresh()

    def hand_in(self) -> None:
        """Write the hand-in and open it."""
        student, pipeline = self.student, self.session.pipeline
        if student is None or not self.project_is_open() or (pipeline is None and not student.lab.target):
            self.result.setText(tr("Open the project of this lab first."))
            return
        self.keep()

        def work(run: Run) -> Path:
            path = student.folder / REPORT
            write_text(path, hand_in(student, pipeline))
            return path

        self.result.setText(tr("Writing …"))
        self._run(work, self._handed_in)

    def show_key(self) -> None:
        """Show the instructor's key of this student's own block."""
        student, pipeline = self.student, self.session.pipeline
        if student is None or not self.project_is_open() or (pipeline is None and not student.lab.target):
            self.result.setText(tr("Open the project of this lab first."))
            return
        self.result.setText(tr("Computing the key …"))
        self._run(lambda run: key_page(student, pipeline), self._show_key)

    # ----------------------------------------------------------------------------------------------- events

    def _run(
        self,
        work: Callable[[Run], Any],
        then: Callable[[Any], None],
        progress: Callable[[float, float, str], None] | None = None,
    ) -> None:
        job = Job(work, name="lab check", engine=False)
        if progress is not None:
            job.progressed.connect(progress)
        job.succeeded.connect(then)
        job.failed.connect(self._failed)
        self.session.jobs.start(job)

    def _progressed(self, done: float, total: float, what: str) -> None:
        self.result.setText(
            tr(
                "{what} {done} of {total}",
                what=tr(what),
                done=f"{done:.0f}",
                total=f"{total:.0f}",
            )
        )

    @Slot(object)
    def _checked(self, judged: tuple[int, Outcome]) -> None:
        self.checking = False
        index, outcome = judged
        if index == self.index:
            mark = "✓ " if outcome.passed else "✗ "
            self.result.setText(mark + (tr(outcome.text) if outcome.text else tr("Done.")))
        self.judged.emit()
        self._refresh()
        if outcome.passed and self.step.kind == "read" and index == self.index:
            self.next_asked.emit()

    @Slot(object)
    def _handed_in(self, path: Path) -> None:
        try:
            write_pdf(path.read_text("utf-8"), path.with_suffix(".pdf"))
        except OSError as problem:
            self.session.message.emit("warning", tr("The PDF was not written: {why}", why=problem))
        self.result.setText(tr("Written: {path} and the same as PDF beside it.", path=path))
        QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))

    @Slot(object)
    def _show_key(self, rows: list[tuple[str, str]]) -> None:
        self.result.clear()
        lines = [f"| {title} | {value} |".replace("\n", " ") for title, value in rows]
        heading = f"## {tr('Key')}\n\n| {tr('Step')} | {tr('From the results')} |\n|---|---|\n"
        self.text.show_markdown(heading + "\n".join(lines))

    @Slot(object)
    def _failed(self, problem: BaseException) -> None:
        self.checking = False
        if isinstance(problem, UserError):
            self.result.setText(" ".join(tr(p) for p in (problem.what, problem.why, problem.todo) if p))
        else:
            self.result.clear()
            self.session.tell(problem)
        self._refresh()

    @Slot(str)
    def _results(self, stage: str) -> None:
        """Check a “do” step by itself as soon as its stage has finished."""
        student = self.student
        if student is None or not self.project_is_open():
            return
        step, pipeline = self.step, self.session.pipeline
        waits = step.kind == "do" and step.stage == stage and self.index not in student.passed
        if waits and pipeline is not None and pipeline.state(step.stage).status == "done":  # type: ignore[arg-type]
            self._refresh()
            self.check()

    def _show_hints(self, taken: int) -> None:
        self.hint_text.setText(
            "\n".join(
                tr("Hint {n}: {hint}", n=i + 1, hint=tr(hint))
                for i, hint in enumerate(self.step.hints[:taken])
            )
        )

    def _fit_text(self) -> None:
        """Make the text no higher than it is, so that the answer stands right below it."""
        self.text.setFixedHeight(
            max(60, min(self.text.height_of_text(), round(0.6 * max(self.height(), 400))))
        )

    def _edited(self) -> None:
        self._typed.start()

    def _keep(self) -> None:
        student = self.student
        if student is not None and self._answer() != student.answers.get(self.index, ""):
            student.keep(self.index, self._answer())
            self.judged.emit()

    def _answer(self) -> str:
        return self.words.toPlainText() if self.step.kind == "explain" else self.number.text()

    def _next(self) -> None:
        self.keep()
        self.next_asked.emit()

    def _help(self, kind: str, name: str) -> None:
        (self.lesson_asked if kind == "lesson" else self.simulator_asked).emit(name)

    def _try(self, act: Callable[[], Any]) -> None:
        try:
            act()
        except GraphosError as problem:
            self._failed(problem)

    @Slot()
    def _refresh(self) -> None:
        student = self.student
        if student is None:
            return
        step, is_open = self.step, self.project_is_open()
        self.open_button.setVisible(not is_open)
        self.open_button.setEnabled(self.session.running is None)
        typed = step.kind in ("predict", "measure")
        self.number.setVisible(typed)
        self.number.setReadOnly(step.kind == "predict" and self.index in student.passed)
        self.words.setVisible(step.kind == "explain")
        self.check_button.setText(tr(CHECK_TEXTS.get(step.kind, "Check")))
        reason = "" if is_open else tr("Open the project of this lab first.")
        self.check_button.setEnabled(not reason and not self.checking)
        if reason or self.result.text() == tr("Open the project of this lab first."):
            self.result.setText(reason)
        if self.index in student.passed and not self.result.text():
            self.result.setText("✓ " + tr("Done."))
        self.go_button.setVisible(step.stage is not None)
        if step.stage is not None:
            self.go_button.setText(tr("Go to {stage}", stage=tr(PLACES[step.stage])))
        bench = student.bench()
        self.calibrations.setVisible(bench is not None)
        if bench is not None:
            self.calibrations.show_bench(bench, step.photos)
        self.detectors.show_lab(student)
        self.lesson_button.setVisible(bool(step.lesson))
        self.lesson_button.setText(tr("Read the lesson"))
        self.play_button.setVisible(bool(step.simulator))
        self.play_button.setText(tr("Open the simulator"))
        passed = self.index in student.passed
        over = student.current >= len(student.lab.steps)
        self.next_button.setVisible((passed or step.kind != "read") and not over)
        self.next_button.setText(tr("Next step") if passed else tr("Skip for now"))
        set_role(self.next_button, "primary" if passed else "")
        set_role(self.check_button, "" if passed else "primary")
        self.check_button.setVisible(not (passed and step.kind in ("read", "predict")))
        left = len(step.hints) - student.hints.get(self.index, 0)
        self.hint_button.setVisible(bool(step.hints))
        self.hint_button.setEnabled(left > 0)
        self.hint_button.setText(
            tr("Hint") if left == len(step.hints) else tr("A stronger hint") if left else tr("No more hints")
        )


def set_role(button: QPushButton, role: str) -> None:
    """Dress a button anew; the one thing to do next is the filled one."""
    if button.property("role") != role:
        button.setProperty("role", role)
        button.style().unpolish(button)
        button.style().polish(button)
