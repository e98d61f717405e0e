"""The beginning of a lab: who, where, and making the student's own photos."""

from __future__ import annotations

import re
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QFileDialog,
    QFormLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.errors import UserError
from graphos_core.run import Run
from graphos_didactic.lab_session import FILE, LabSession
from graphos_didactic.labs import Lab, target_sheet
from graphos_py.dialogs import documents
from graphos_py.icons import bind_icon
from graphos_py.jobs import Job
from graphos_py.session import Session, load_engine
from graphos_py.tabs.lab_target import OwnPhotos
from graphos_py.theme import theme
from graphos_py.translation import tr


def labs_folder() -> Path:
    """Return where labs are kept unless the person chooses another place."""
    return documents() / "GRAPHOS" / "labs"


def folder_for(lab: str, student: str) -> Path:
    """Return the proposed folder of a student in a lab."""
    plain = re.sub(r"[^\w-]+", "-", student.strip().casefold()).strip("-") or "student"
    return labs_folder() / f"{lab}-{plain}"


class LabStart(QFrame):
    """Asks for name and folder, makes the photos and the project.

    Signals
    -------
    started : LabSession
        Photos and project are there.
    """

    started = Signal(object)

    def __init__(self, session: Session, lab: Lab, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.session = session
        self.lab = lab
        self._job: Job | None = None
        self._own_folder = False
        self.setProperty("role", "card")
        self.setMaximumWidth(theme().px(620))
        self.name = QLineEdit()
        self.name.setPlaceholderText(tr("Your name: your photos are made from it"))
        self.folder = QLineEdit()
        self.own = OwnPhotos(target_sheet(lab.target)) if lab.target else None
        self.start = QPushButton(tr("Start"))
        self.start.setProperty("role", "primary")
        self.stop = QPushButton(tr("Stop"))
        bind_icon(self.stop, "stop", "bad")
        self.bar = QProgressBar()
        self.bar.setTextVisible(False)
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setProperty("role", "caption")
        self._build()
        self._show_running(False)
        self._update()

    def _build(self) -> None:
        column = QVBoxLayout(self)
        column.setContentsMargins(20, 16, 20, 16)
        column.setSpacing(10)
        form = QFormLayout()
        form.addRow(tr("Name"), self.name)
        row = QHBoxLayout()
        row.addWidget(self.folder, 1)
        choose = QPushButton(tr("Choose …"))
        choose.clicked.connect(self._choose)
        row.addWidget(choose)
        form.addRow(tr("Folder"), row)
        column.addLayout(form)
        if self.own is not None:
            column.addWidget(self.own)
        buttons = QHBoxLayout()
        for widget in (self.start, self.stop, self.bar):
            buttons.addWidget(widget)
        buttons.addStretch(1)
        column.addLayout(buttons)
        column.addWidget(self.said)
        self.name.textEdited.connect(self._named)
        self.name.returnPressed.connect(self.begin)
        self.folder.textEdited.connect(self._placed)
        self.start.clicked.connect(self.begin)
        self.stop.clicked.connect(self.cancel)

    def resumable(self) -> list[LabSession]:
        """Return the sessions of this lab that were begun in the usual place."""
        found = []
        for file in sorted(labs_folder().glob(f"*/{FILE}")):
            try:
                found.append(LabSession.resume(self.lab, file.parent))
            except UserError:  # of another lab, or damaged
                continue
        return found

    def begin(self) -> None:
        """Start, or go on where a session is in the folder."""
        if not self.start.isEnabled() or self._job is not None:
            return
        folder = Path(self.folder.text().strip()).expanduser()
        try:
            if (folder / FILE).is_file():
                made = LabSession.resume(self.lab, folder)
            else:
                made = LabSession(self.lab, " ".join(self.name.text().split()), folder)
                made.own = self.own.own() if self.own is not None else {}
        except UserError as problem:
            self.said.setText(tr(problem.what) + " " + tr(problem.todo))
            return
        self.prepare(made)

    def prepare(self, made: LabSession) -> None:
        """Make what is missing of a session in the background."""
        if self.session.running is not None:
            self.said.setText(tr("A step is running in the open project; stop it or wait until it is done."))
            return

        def work(run: Run) -> LabSession:
            load_engine()
            made.prepare(run)
            return made

        self._show_running(True)
        self.said.setText(tr("Making your own photos; this takes about half a minute."))
        self._job = Job(work, name="lab")
        self._job.progressed.connect(self._progressed)
        self._job.succeeded.connect(self.started)
        self._job.stopped.connect(self._stopped)
        self._job.failed.connect(self._failed)
        self._job.finished.connect(self._over)
        self.session.jobs.start(self._job)

    def cancel(self) -> None:
        """Stop making photos."""
        if self._job is not None:
            self._job.stop()
            self.said.setText(tr("Stopping …"))

    # ----------------------------------------------------------------------------------------------- events

    def _progressed(self, done: float, total: float, what: str) -> None:
        self.bar.setRange(0, 1000)
        self.bar.setValue(round(1000 * done / total) if total else 0)
        self.said.setText(
            tr("Making your own photos: {what} {done} of {total}", what=tr(what), done=f"{done:.0f}",
               total=f"{total:.0f}")
        )  # fmt: skip

    def _stopped(self) -> None:
        self.said.setText(tr("Stopped. Start again when you like."))

    def _failed(self, problem: BaseException) -> None:
        if isinstance(problem, UserError):
            self.said.setText(" ".join(tr(p) for p in (problem.what, problem.why, problem.todo) if p))
        else:
            self.said.setText(tr("The photos could not be made."))
            self.session.tell(problem)

    def _over(self) -> None:
        self._job = None
        self._show_running(False)

    def _show_running(self, running: bool) -> None:
        self.start.setVisible(not running)
        for widget in (self.stop, self.bar):
            widget.setVisible(running)
        self.bar.setRange(0, 0)
        self.name.setEnabled(not running)
        self.folder.setEnabled(not running)

    def _named(self, name: str) -> None:
        if not self._own_folder:
            self.folder.setText(str(folder_for(self.lab.name, name)) if name.strip() else "")
        self._update()

    def _placed(self, folder: str) -> None:
        self._own_folder = bool(folder.strip())
        self._update()

    def _choose(self) -> None:
        chosen = QFileDialog.getExistingDirectory(self, tr("Folder of the lab"), str(documents()))
        if chosen:
            self.folder.setText(chosen)
            self._placed(chosen)

    def _update(self) -> None:
        folder = self.folder.text().strip()
        begun = bool(folder) and (Path(folder).expanduser() / FILE).is_file()
        reason = ""
        if not begun and not self.name.text().strip():
            reason = tr("Type your name to start.")
        elif not folder:
            reason = tr("Choose a folder.")
        self.start.setText(tr("Go on") if begun else tr("Start"))
        self.start.setEnabled(not reason)
        self.said.setText(reason or (tr("A session of this lab is in this folder.") if begun else ""))
