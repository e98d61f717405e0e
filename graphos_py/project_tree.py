"""The project on the left: photos, cameras, runs, control."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtWidgets import QMenu, QTreeWidget, QTreeWidgetItem, QWidget

from graphos_core.errors import GraphosError
from graphos_core.number_format import format_value
from graphos_core.registry import STAGES, Stage
from graphos_core.run import Run
from graphos_py.icons import icon
from graphos_py.jobs import Job
from graphos_py.session import STAGE_LABELS, Session
from graphos_py.theme import theme
from graphos_py.translation import tr

if TYPE_CHECKING:
    from graphos_core.pipeline import Pipeline

ROLE = Qt.ItemDataRole.UserRole


@dataclass(frozen=True)
class PastRun:
    """One stored result: its stage, step, key, when it was made, its line, and whether it is the current one."""

    stage: Stage
    step: str
    key: str
    made: str
    line: str
    seconds: float
    size: int
    current: bool


def past_runs(pipeline: Pipeline) -> list[PastRun]:
    """Read the stored results of the last step of every stage, newest first; touches the disk."""
    from graphos_core.steps import steps_of

    runs = []
    for stage in STAGES:
        step = steps_of(stage)[-1].name
        try:
            wanted = pipeline.key(step)
        except GraphosError:  # the stage's state says why
            wanted = ""
        for key in pipeline.project.store.keys(step):
            about = pipeline.project.store.about(step, key)
            runs.append(
                PastRun(
                    stage, step, key, str(about.get("made", "")), about.get("line", ""),
                    float(about.get("seconds", 0.0)), pipeline.project.store.size(step, key),
                    key == wanted,
                )
            )  # fmt: skip
    return sorted(runs, key=lambda run: run.made, reverse=True)


class ProjectTree(QTreeWidget):
    """Photos, cameras, runs and control of the session's project."""

    run_chosen = Signal(object)
    run_deleted = Signal(object)
    asked = Signal(str)

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._session = session
        self._reading: Job | None = None
        self.setHeaderHidden(True)
        self.setIndentation(14)
        self.setAccessibleName(tr("Project"))
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.customContextMenuRequested.connect(self._menu)
        self.itemSelectionChanged.connect(self._selected)
        self.itemDoubleClicked.connect(self._opened)
        session.project_changed.connect(self.rebuild)
        session.photo_selected.connect(self._show_photo)
        session.results_changed.connect(self._read_runs)
        session.states_changed.connect(self._read_runs)
        theme().changed.connect(self.rebuild)
        self.rebuild()

    def rebuild(self) -> None:
        """Show the project anew."""
        self.clear()
        self._photos: list[QTreeWidgetItem] = []
        self._runs: QTreeWidgetItem | None = None
        project = self._session.project
        if project is None:
            item = QTreeWidgetItem([tr("No project yet")])
            item.setFlags(Qt.ItemFlag.NoItemFlags)
            self.addTopLevelItem(item)
            return
        photo_set = project.photo_set
        photos = self._branch("photo", tr("Photos ({n})", n=len(photo_set.photos)))
        for index, photo in enumerate(photo_set.photos):
            item = QTreeWidgetItem(photos, [photo.name])
            item.setData(0, ROLE, ("photo", index))
            item.setToolTip(0, f"{photo.width} × {photo.height} px")
            self._photos.append(item)
        for failure in photo_set.failures:
            item = QTreeWidgetItem(photos, [failure.item])
            item.setIcon(0, icon("warning", "warn"))
            item.setToolTip(0, tr(failure.reason))
        cameras = self._branch("camera", tr("Cameras ({n})", n=len(photo_set.cameras)))
        for camera in photo_set.cameras:
            focal = format_value(camera.focal_px, unit="px", digits=5)
            label = f"{tr(camera.label)}\nf = {focal}"
            if camera.focal_estimated:
                label += " · " + tr("estimated")
            item = QTreeWidgetItem(cameras, [label])
            item.setToolTip(0, tr(camera.focal_source))
            item.setData(0, ROLE, ("ask", "camera"))
            if camera.focal_estimated:
                item.setIcon(0, icon("warning", "warn"))
        self._runs = self._branch("runs", tr("Runs"))
        self._control(project)
        cameras.setExpanded(True)
        photos.setExpanded(len(self._photos) <= 20)
        self._runs.setExpanded(True)
        self._read_runs()

    def _branch(self, symbol: str, label: str) -> QTreeWidgetItem:
        item = QTreeWidgetItem(self, [label])
        item.setIcon(0, icon(symbol, "muted"))
        return item

    def _control(self, project: Any) -> None:
        branch = self._branch("control", tr("Known in object space"))
        settings = project.settings
        entries = {
            "control": tr("Control points: {file}", file=settings.control) if settings.control else "",
            "distance": tr("Distance {a} – {b}: {value}", a=settings.distance[0], b=settings.distance[1],
                           value=format_value(settings.distance[2], unit="m")) if settings.distance else "",
            "reference": tr("Reference: {file}", file=settings.reference) if settings.reference else "",
        }  # fmt: skip
        missing = {
            "control": tr("Add control points …"),
            "distance": tr("Add a known distance …"),
            "reference": tr("Add a reference surface …"),
        }
        for key, text in entries.items():
            item = QTreeWidgetItem(branch, [text or missing[key]])
            item.setData(0, ROLE, ("ask", key))
            if not text:
                item.setForeground(0, theme().colour("muted"))
        branch.setExpanded(True)

    # ------------------------------------------------------------------------------------------------- runs

    def _read_runs(self, _: str = "") -> None:
        pipeline = self._session.pipeline
        if pipeline is None or self._reading is not None or self._session.running is not None:
            return

        def work(run: Run) -> list[PastRun]:
            return past_runs(pipeline)

        self._reading = Job(work, name="runs", engine=False)
        self._reading.succeeded.connect(self._show_runs)
        self._reading.failed.connect(self._not_read)
        self._session.jobs.start(self._reading)

    def _not_read(self, problem: object) -> None:
        self._reading = None

    def _show_runs(self, runs: list[PastRun]) -> None:
        self._reading = None
        if self._runs is None:
            return
        self._runs.takeChildren()
        total = sum(run.size for run in runs) / 1e6
        self._runs.setText(0, tr("Runs ({n} · {size} MB)", n=len(runs), size=f"{total:.0f}"))
        for run in runs:
            mark = "●" if run.current else "○"
            item = QTreeWidgetItem(self._runs, [f"{mark} {tr(STAGE_LABELS[run.stage])} · {tr(run.line)}"])
            item.setData(0, ROLE, ("run", run))
            made = _local_time(run.made)
            item.setToolTip(
                0,
                tr("Made {when} in {seconds} s, {size} MB on disk.", when=made, seconds=f"{run.seconds:.1f}",
                   size=f"{run.size / 1e6:.1f}")
                + "\n" + (tr("The result of the present parameters.") if run.current
                          else tr("Double-click to go back to its parameters.")),
            )  # fmt: skip
            if not run.current:
                item.setForeground(0, theme().colour("muted"))

    # --------------------------------------------------------------------------------------------- reacting

    def _selected(self) -> None:
        for item in self.selectedItems():
            kind, value = item.data(0, ROLE) or ("", -1)
            if kind == "photo" and isinstance(value, int):
                self._session.select_photo(value)

    def _show_photo(self, index: int) -> None:
        if 0 <= index < len(self._photos) and not self._photos[index].isSelected():
            self.setCurrentItem(self._photos[index])

    def _opened(self, item: QTreeWidgetItem) -> None:
        kind, value = item.data(0, ROLE) or ("", None)
        if kind == "run":
            self.run_chosen.emit(value)
        elif kind == "ask":
            self.asked.emit(value)

    def _menu(self, where: QPoint) -> None:
        item = self.itemAt(where)
        kind, value = (item.data(0, ROLE) if item else None) or ("", None)
        menu = QMenu(self)
        if kind == "run":
            menu.addAction(tr("Use its parameters")).triggered.connect(lambda: self.run_chosen.emit(value))
            delete = menu.addAction(tr("Delete this result from disk …"))
            delete.triggered.connect(lambda: self.run_deleted.emit(value))
        elif kind == "ask":
            menu.addAction(tr("Change …")).triggered.connect(lambda: self.asked.emit(value))
        if menu.actions():
            menu.popup(self.viewport().mapToGlobal(where))


def _local_time(made: str) -> str:
    try:
        return datetime.fromisoformat(made).astimezone().strftime("%Y-%m-%d %H:%M")
    except ValueError:
        return made
