"""The Learn tab: simulators, lessons and labs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
from PySide6.QtCore import QEvent, QObject, Qt, Slot
from PySide6.QtGui import QShortcut, QShowEvent
from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QMainWindow,
    QPushButton,
    QStackedWidget,
    QToolBar,
    QVBoxLayout,
    QWidget,
)

from graphos_core.errors import UserError
from graphos_core.params import Level
from graphos_core.registry import STAGES
from graphos_core.run import Run
from graphos_core.text import Text
from graphos_py.dialogs import documents
from graphos_py.icons import bind_icon
from graphos_py.jobs import Job
from graphos_py.pixels import read_upright
from graphos_py.session import STAGE_LABELS, Session, load_engine
from graphos_py.tabs.learn_list import Entry, LearnList
from graphos_py.tabs.learn_welcome import Welcome
from graphos_py.theme import theme
from graphos_py.translation import tr

PHOTO_SIDE = 1200
"""Longer side of the project's photo in a simulator, px."""


def catalogue(run: Run) -> list[Entry]:
    """Return what there is; imports the engine, so it is called in a job."""
    load_engine()
    from graphos_didactic.labs import labs
    from graphos_didactic.lessons import lessons
    from graphos_didactic.simulator import simulators

    entries = [
        Entry("welcome", "", "First things to try", "Where to begin.", "explain"),
        _group("Simulators"),
    ]
    for stage in STAGES:
        found = [Entry("simulator", s.key, s.title, s.summary, stage, s.first) for s in simulators(stage)]
        entries += [Entry("", "", STAGE_LABELS[stage]), *found] if found else []
    entries.append(_group("Labs"))
    entries += [Entry("lab", lab.name, lab.title, lab.goal, "lab") for lab in labs().values()]
    entries.append(_group("Lessons"))
    for stage in STAGES:
        found = [
            Entry("lesson", x.name, x.title, x.summary, stage) for x in lessons().values() if x.room == stage
        ]
        entries += [Entry("", "", STAGE_LABELS[stage]), *found] if found else []
    return entries


def _group(title: str) -> Entry:
    return Entry("", "", title, "group")


class LearnTab(QWidget):
    """List on the left; first page, simulator, lesson or lab on the right.

    Parameters
    ----------
    session : Session
    """

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.list = LearnList()
        self.list.setFixedWidth(theme().px(290))
        self.stack = QStackedWidget()
        self.welcome = Welcome()
        self.stack.addWidget(self.welcome)
        self._labs: dict[str, Any] = {}
        self._wanted: tuple[str, str] | None = None
        self._place: QPushButton | None = None
        self._place_of = ""
        self._watched: QWidget | None = None
        self.ready = False
        row = QHBoxLayout(self)
        row.setContentsMargins(8, 8, 8, 8)
        row.setSpacing(8)
        left = QVBoxLayout()
        left.setSpacing(8)
        left.addWidget(self.list, 1)
        self.own_lab = QPushButton(tr("Open a lab of your own …"))
        self.own_lab.setToolTip(tr("A lab is a folder with lab.toml, written by your instructor."))
        bind_icon(self.own_lab, "open")
        self.own_lab.clicked.connect(self._choose_lab)
        left.addWidget(self.own_lab)
        row.addLayout(left)
        row.addWidget(self.stack, 1)
        self.list.asked.connect(self.open)
        self.welcome.asked.connect(self.open)
        self._escape = QShortcut(Qt.Key.Key_Escape, self)
        self._escape.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        self._escape.setEnabled(False)
        self._escape.activated.connect(lambda: self.window().showNormal())
        job = Job(catalogue, name="catalogue", engine=False)
        job.succeeded.connect(self._filled)
        job.failed.connect(self._not_filled)
        session.jobs.start(job)

    # ----------------------------------------------------------------------------------------------- public

    @property
    def level(self) -> Level:
        """Who sits in front of the window."""
        level: Level = getattr(getattr(self.window(), "settings", None), "level", "student")
        return level

    def open_simulator(self, key: str) -> None:
        """Open a simulator by room and name."""
        self.open("simulator", key)

    def try_simulator(self, key: str, values: dict[str, Any]) -> None:
        """Open a simulator with these values of its parameters."""
        from graphos_py.tabs.simulator_page import SimulatorPage

        self.open_simulator(key)
        page = self.stack.currentWidget()
        if isinstance(page, SimulatorPage):
            page.show_params(page.simulator.params.from_dict(values))

    def open_lesson(self, name: str) -> None:
        """Open a lesson by room and name."""
        self.open("lesson", name)

    def open_lab(self, name: str) -> None:
        """Open a lab by name, or an instructor's by the path of its folder."""
        self.open("lab", name)

    def open(self, kind: str, name: str) -> None:
        """Open something of the list; waits until the list is there."""
        if not self.ready:
            self._wanted = (kind, name)
            return
        try:
            page = self._make(kind, name)
        except UserError as problem:
            self.session.tell(problem)
            self.welcome.say(" ".join(tr(p) for p in (problem.what, problem.why, problem.todo) if p))
            page = self.welcome
        self._show(page)
        self.list.mark(kind, name)

    # ------------------------------------------------------------------------------------------------ pages

    def _make(self, kind: str, name: str) -> QWidget:
        if kind == "simulator":
            return self._simulator(name)
        if kind == "lesson":
            return self._lesson(name)
        if kind == "lab":
            return self._lab(name)
        return self.welcome

    def _simulator(self, key: str) -> QWidget:
        from graphos_didactic.simulator import find_simulator
        from graphos_py.tabs.simulator_page import SimulatorPage

        simulator = find_simulator(key)
        page = SimulatorPage(simulator, level=self.level)
        page.left.connect(self.leave)
        page.lesson_asked.connect(self.open_lesson)
        self._read_photo(page)
        return page

    def _lesson(self, name: str) -> QWidget:
        from graphos_didactic.lessons import find_lesson
        from graphos_py.tabs.lesson_page import LessonPage

        page = LessonPage(self.session, find_lesson(name))
        page.left.connect(self.leave)
        page.lesson_asked.connect(self.open_lesson)
        page.simulator_asked.connect(self.open_simulator)
        page.simulator_tried.connect(self.try_simulator)
        page.stage_asked.connect(self._go_to)
        return page

    def _lab(self, name: str) -> QWidget:
        from graphos_didactic.labs import labs, read_lab_folder
        from graphos_py.tabs.lab_page import LabPage

        if name not in self._labs:
            if name in labs():
                lab = labs()[name]
            elif Path(name).is_absolute():
                lab = read_lab_folder(Path(name))
            else:
                raise UserError(Text("There is no lab “{name}”.", name=name))
            page = LabPage(self.session, lab)
            page.left.connect(self.leave)
            page.lesson_asked.connect(self.open_lesson)
            page.simulator_asked.connect(self.open_simulator)
            page.stage_asked.connect(self._go_to)
            page.placed.connect(lambda text: self._show_place(name, text))
            self._labs[name] = page
        self._labs[name].set_level(self.level)
        page = self._labs[name]
        assert isinstance(page, LabPage)
        return page

    def _choose_lab(self) -> None:
        chosen = QFileDialog.getExistingDirectory(self, tr("Folder of the lab"), str(documents()))
        if chosen:
            self.open_lab(chosen)

    def leave(self) -> None:
        """Go back to the first page."""
        if self.window().isFullScreen():
            self.window().showNormal()
        self.open("welcome", "")

    def _show(self, page: QWidget) -> None:
        before: QWidget = self.stack.currentWidget() or self.welcome
        if self.stack.indexOf(page) < 0:
            self.stack.addWidget(page)
        self.stack.setCurrentWidget(page)
        if before is not page and before is not self.welcome and before not in self._labs.values():
            self.stack.removeWidget(before)
            before.deleteLater()
        self._fit_screen()

    @Slot(object)
    def _filled(self, entries: list[Entry]) -> None:
        self.ready = True
        self.list.fill(entries)
        self.welcome.fill(entries)
        kind, name = self._wanted or ("welcome", "")
        self.open(kind, name)

    @Slot(object)
    def _not_filled(self, problem: BaseException) -> None:
        """Say on the page itself why it is empty; the messages are hidden here."""
        self.session.tell(problem)
        parts = (
            (problem.what, problem.why, problem.todo) if isinstance(problem, UserError) else (repr(problem),)
        )
        self.welcome.say(" ".join(tr(part) for part in parts if part))

    # ------------------------------------------------------------------------------- photo of the project

    def _read_photo(self, page: Any) -> None:
        project = self.session.project
        if project is None or self.session.photo >= len(project.photo_set.photos):
            return
        photo = project.photo_set.photos[self.session.photo]
        path = Path(photo.path)

        def work(run: Run) -> tuple[Any, str]:
            pixels = read_upright(path)
            if pixels is not None and max(pixels.shape[:2]) > PHOTO_SIDE:
                scale = PHOTO_SIDE / max(pixels.shape[:2])
                pixels = cv2.resize(pixels, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
            return pixels, photo.name

        job = Job(work, name="photo", engine=False)
        job.succeeded.connect(self._photo_read)
        job.failed.connect(self.session.tell)
        self.session.jobs.start(job)

    @Slot(object)
    def _photo_read(self, read: tuple[Any, str]) -> None:
        page: Any = self.stack.currentWidget()
        if read[0] is not None and hasattr(page, "set_photo"):
            page.set_photo(*read)

    # ------------------------------------------------------------------------------------------- the window

    def _go_to(self, stage: str) -> None:
        show = getattr(self.window(), "show_tab", None)
        if show is not None:
            show(stage)

    def _show_place(self, lab: str, text: str) -> None:
        """Say below every tab where one is in the lab; a click leads back to it."""
        window = self.window()
        if not isinstance(window, QMainWindow):
            return
        if self._place is None:
            self._place = QPushButton()
            self._place.setProperty("role", "link")
            window.statusBar().addWidget(self._place, 1)
            self._place.clicked.connect(self._back_to_lab)
        self._place_of = lab
        self._place.setText(f"←  {text}" if text else "")
        self._place.setToolTip(tr("Back to the lab"))
        window.statusBar().setVisible(bool(text))

    def _back_to_lab(self) -> None:
        self._go_to("learn")
        self.open_lab(self._place_of)

    def showEvent(self, event: QShowEvent) -> None:
        """Watch the window for full screen."""
        super().showEvent(event)
        if self._watched is not self.window():
            self._watched = self.window()
            self._watched.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Give the whole screen to the simulator, or take it back."""
        if event.type() == QEvent.Type.WindowStateChange and watched is self._watched:
            self._fit_screen()
        return False

    def _fit_screen(self) -> None:
        window = self.window()
        full = window.isFullScreen() and hasattr(self.stack.currentWidget(), "toggle_full_screen")
        self.list.setVisible(not full)
        self.own_lab.setVisible(not full)
        self._escape.setEnabled(full)
        if isinstance(window, QMainWindow):
            window.menuBar().setVisible(not full)
            for bar in window.findChildren(QToolBar):
                bar.setVisible(not full)
