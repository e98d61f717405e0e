"""The one place that holds the control points while they are edited: undo, saving, and telling the session."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from graphos_core.errors import GraphosError
from graphos_core.exchange.control import read_control
from graphos_core.exchange.control_sheet import ControlSheet
from graphos_core.exchange.control_tables import LARGEST
from graphos_core.exchange.table_preview import guess, read_points
from graphos_core.project_file import inside
from graphos_core.run import Run
from graphos_core.text import Text
from graphos_py.jobs import Job
from graphos_py.session import Session
from graphos_py.translation import tr

SAVE_MS = 600
"""Edits that follow each other faster than this are written together."""


class SheetEdit(QUndoCommand):
    """From one sheet to the next; edits with the same `merge` key that follow each other become one."""

    def __init__(
        self, desk: ControlDesk, after: ControlSheet, text: str, merge: tuple[str, ...] = ()
    ) -> None:
        super().__init__(text)
        self._desk, self._before, self._after, self._merge = desk, desk.sheet, after, merge

    def id(self) -> int:
        """Return whether it can be joined with another edit."""
        return 1 if self._merge else -1

    def mergeWith(self, other: QUndoCommand) -> bool:
        """Join with a later edit of the same thing."""
        if not isinstance(other, SheetEdit) or other._merge != self._merge:
            return False
        self._after = other._after
        return True

    def redo(self) -> None:
        """Show the sheet after the edit."""
        self._desk.put(self._after)

    def undo(self) -> None:
        """Show the sheet before the edit."""
        self._desk.put(self._before)


class ControlDesk(QObject):
    """The control points of the open project.

    Signals
    -------
    changed()
        The sheet is another one.
    point_chosen(name)
        Another point was chosen; empty for none.
    """

    changed = Signal()
    point_chosen = Signal(str)

    def __init__(self, session: Session, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.session = session
        self.sheet = ControlSheet()
        self.problem: GraphosError | None = None
        self.point = ""
        self.undo = QUndoStack(self)
        self._folder: Path | None = None
        self._project: Any = None
        self._digests: list[Any] = []
        self._original: tuple[ControlSheet, dict[str, bytes]] = (ControlSheet(), {})
        self._saving = QTimer(self, singleShot=True, interval=SAVE_MS)
        self._saving.timeout.connect(self.save)
        self._kept = False
        session.project_changed.connect(self.load)
        session.run_changed.connect(self._run_changed)

    # -------------------------------------------------------------------------------------------------- sheets

    def load(self) -> None:
        """Read the control points of the project, unless the files are those written here."""
        project = self.session.project
        if project is None:
            return
        digests = _digests(project)
        if project.folder == self._folder and digests == self._digests:
            return
        if project.folder != self._folder:
            self.flush()
            self._kept = False
        self._saving.stop()  # a file that was taken meanwhile counts more than an edit that waits
        self._project = project
        self._folder, self._digests, self.problem = project.folder, digests, None
        try:
            self.sheet = ControlSheet.from_known(*project.control(), _own_distances(project))
        except GraphosError as problem:
            self.sheet, self.problem = _readable(project), problem
        self._original = (self.sheet, _files(project.folder))
        if not self.sheet.crs and _names_system(project):
            self.session.message.emit("info", Text(
                "The control points are geographic; here they are shown in a local frame (east, north, up), and an edit "
                "writes them so. The file as it was is kept in {folder}.", folder="earlier"))  # fmt: skip
        self.undo.clear()
        self.choose(self.point if self.sheet.index(self.point) >= 0 else "")
        self.changed.emit()

    def edit(self, after: ControlSheet, text: str, merge: tuple[str, ...] = ()) -> None:
        """Go to another sheet, in a way that can be undone; `text` says what was done."""
        if after != self.sheet and self.session.project is not None:
            self.undo.push(SheetEdit(self, after, tr(text), merge))

    def put(self, sheet: ControlSheet) -> None:
        """Show a sheet and save it soon; called by the undo stack."""
        self.sheet, self.problem = sheet, None
        self._saving.start()
        if self.point and sheet.index(self.point) < 0:
            self.choose("")
        self.changed.emit()

    def choose(self, name: str) -> None:
        """Choose the point that is measured."""
        if name != self.point:
            self.point = name
            self.point_chosen.emit(name)

    # -------------------------------------------------------------------------------------------------- saving

    @property
    def unsaved(self) -> bool:
        """Whether an edit waits to be written."""
        return self._saving.isActive()

    def save(self) -> None:
        """Write the files in the background; not while a step runs, which reads them."""
        project = self.session.project
        if project is None or project.folder != self._folder:
            return
        if self.session.running is not None:
            self._saving.start()
            return
        self._saving.stop()
        job = Job(self._work(project), name="control", engine=False)
        job.succeeded.connect(self._saved)
        job.failed.connect(self.session.tell)
        self.session.jobs.start(job)

    def flush(self) -> None:
        """Write an edit that waits at once, before the project or the window is closed."""
        if self.unsaved and self._project is not None:
            self._saving.stop()
            try:
                self._work(self._project)(Run())
            except GraphosError as problem:
                self.session.tell(problem)

    def _work(self, project: Any) -> Callable[[Run], Any]:
        """Return the work that writes the sheet, or what was read where the sheet is that again."""
        original, files = self._original
        keep, self._kept = not self._kept, True
        return (
            _restore(project, files)
            if self.sheet == original and files
            else _write(project, self.sheet, keep)
        )

    def _saved(self, project: Any) -> None:
        if self.session.project is not None and project.folder == self.session.project.folder:
            self._digests, self._project = _digests(project), project
            self.session.known_changed(project)

    def _run_changed(self) -> None:
        if self.session.running is None and self.unsaved:
            self.save()


def _names_system(project: Any) -> bool:
    """Say whether the control file names a coordinate system in its comment."""
    path = project.folder / project.settings.control
    if not project.settings.control or not path.is_file():
        return False
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        return any(line.lstrip("# \t").casefold().startswith("crs:") for line in file if line.startswith("#"))


def _readable(project: Any) -> ControlSheet:
    """Return the points of a table with bad lines without those lines, and the measurements beside it."""
    try:
        path = inside(project.folder, project.settings.control)
        text = path.read_bytes()[:LARGEST].decode("utf-8-sig", errors="replace")
    except (OSError, GraphosError):
        return ControlSheet()
    points, _ = read_points(text, guess(text))
    beside = path.with_name(f"{path.stem}_measurements{path.suffix}")
    try:
        measured = ControlSheet.from_known(*read_control(beside)) if beside.is_file() else ControlSheet()
    except GraphosError:
        measured = ControlSheet()
    return measured.with_points(points)


def _own_distances(project: Any) -> Any:
    """Return the distances of the table; that of the project's settings stays there."""
    own = 0 if project.settings.distance is None else 1
    return project.known_distances()[own:]


def _digests(project: Any) -> list[Any]:
    from graphos_core.steps import file_digest

    return [
        project.settings.control,
        *([p.name, file_digest(p)] for p in sorted(project.folder.glob("control*"))),
    ]


def _files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.glob("control*") if path.is_file()}


def _write(project: Any, sheet: ControlSheet, keep: bool) -> Callable[[Run], Any]:
    """Return work that writes a sheet; `keep` keeps the files as they were before the first edit."""

    def work(run: Run) -> Any:
        from graphos_core.exchange.control_writing import POINTS, keep_version, write_sheet

        kept = keep_version(project.folder) if keep else None
        write_sheet(project.folder, sheet)
        if kept is not None:
            run.say(
                Text("The control points as they were are kept in {folder}.", folder=f"earlier/{kept.name}")
            )
        return project if project.settings.control == POINTS else project.with_control(POINTS)

    return work


def _restore(project: Any, files: dict[str, bytes]) -> Callable[[Run], Any]:
    """Return work that writes the files as they were read, so that results of then are those of now."""

    def work(run: Run) -> Any:
        from graphos_core.store import write_bytes

        for name, content in files.items():
            write_bytes(project.folder / name, content)
        for path in project.folder.glob("control*"):  # written here since, and kept in the earlier versions
            if path.name not in files:
                path.unlink()
        return project

    return work
