"""The window: ribbon on top, project left, tabs in the middle, Explain right, photos and messages below."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QByteArray, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QMainWindow,
    QPushButton,
    QStackedWidget,
    QToolBar,
    QVBoxLayout,
    QWidget,
)

from graphos_core.params import Level
from graphos_core.registry import STAGES, Stage
from graphos_py.dialogs import BugDialog, ask_to_close, ask_where_photos_are
from graphos_py.explain_panel import ExplainPanel
from graphos_py.icons import bind_icon
from graphos_py.jobs import Jobs
from graphos_py.menus import Menus
from graphos_py.messages import Messages
from graphos_py.project_actions import ProjectActions
from graphos_py.project_tree import ProjectTree
from graphos_py.ribbon import Ribbon, StepState
from graphos_py.run_bar import progress_text
from graphos_py.session import STAGE_LABELS, Progress, Session
from graphos_py.settings import Settings
from graphos_py.start_page import StartPage
from graphos_py.tabs.adjustment import AdjustmentTab
from graphos_py.tabs.dense import DenseTab
from graphos_py.tabs.features import FeaturesTab
from graphos_py.tabs.images import ImagesTab
from graphos_py.tabs.preprocessing import PreprocessingTab
from graphos_py.tabs.quality import QualityTab
from graphos_py.tabs.stage_tab import StageTab
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.workflow import images_state, stage_state, why_not_all

STEPS = [("images", "Images"), *STAGE_LABELS.items(), ("learn", "Learn")]
STAGE_TABS: tuple[type[StageTab], ...] = (
    PreprocessingTab,
    FeaturesTab,
    AdjustmentTab,
    DenseTab,
    QualityTab,
)
LAYOUT_VERSION = 1


class MainWindow(QMainWindow):
    """Everything one sees; all state is in the session.

    Parameters
    ----------
    settings : Settings
        What is remembered between sessions.
    """

    closed = Signal()

    def __init__(self, settings: Settings | None = None) -> None:
        super().__init__()
        self.settings = settings or Settings()
        self.jobs = Jobs(self)
        self.session = Session(self.jobs, self)
        self.setWindowTitle("GRAPHOS-Py")
        self.setAcceptDrops(True)
        self.setDockNestingEnabled(True)
        self.resize(1500, 940)
        self._current = "start"
        self._before_run: set[str] = set()
        self.actions_of_project = ProjectActions(self, self.session, self.settings)
        self._make_centre()
        self._make_docks()
        self.menus = Menus(self)
        self._connect()
        self._restore()
        self.show_tab("start")
        self._update_states()

    # --------------------------------------------------------------------------------------------- building

    def _make_centre(self) -> None:
        level = self.settings.level
        self.ribbon = Ribbon(STEPS)
        self.run_all = QPushButton()
        bind_icon(self.run_all, "run all", "text")
        self.run_all.setText(tr("Run all"))
        self.ribbon.add_at_end(self.run_all)
        self.start_page = StartPage()
        self.images = ImagesTab(self.session)
        self.tabs: dict[str, QWidget] = {"start": self.start_page, "images": self.images}
        for kind in STAGE_TABS:
            self.tabs[kind.stage] = kind(self.session, level)
        self.learn_page = QWidget()
        QVBoxLayout(self.learn_page).setContentsMargins(0, 0, 0, 0)
        self.tabs["learn"] = self.learn_page
        self.stack = QStackedWidget()
        for tab in self.tabs.values():
            self.stack.addWidget(tab)
        centre = QWidget()
        column = QVBoxLayout(centre)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.stack, 1)
        self.setCentralWidget(centre)
        top = QToolBar(tr("Workflow"))
        top.setObjectName("workflow")
        top.setMovable(False)
        top.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        top.toggleViewAction().setEnabled(False)
        top.addWidget(self.ribbon)
        self.addToolBar(top)

    def _make_docks(self) -> None:
        from graphos_py.thumbnails import Thumbnails

        self.tree = ProjectTree(self.session)
        self.explain = ExplainPanel(self.jobs)
        self.thumbnails = Thumbnails(self.session)
        self.messages = Messages()
        self.setCorner(Qt.Corner.TopLeftCorner, Qt.DockWidgetArea.LeftDockWidgetArea)
        left, right = Qt.DockWidgetArea.LeftDockWidgetArea, Qt.DockWidgetArea.RightDockWidgetArea
        below = Qt.DockWidgetArea.BottomDockWidgetArea
        self.docks = {
            "project": self._dock("project", tr("Project"), self.tree, left),
            "explain": self._dock("explain", tr("Explain"), self.explain, right),
            "photos": self._dock("photos", tr("Photos"), self.thumbnails, below),
            "messages": self._dock("messages", tr("Messages"), self.messages, below),
        }
        look = theme()
        self.resizeDocks(
            [self.docks["project"], self.docks["explain"]],
            [look.px(230), look.px(290)],
            Qt.Orientation.Horizontal,
        )
        self.resizeDocks(
            [self.docks["photos"], self.docks["messages"]], [750, 600], Qt.Orientation.Horizontal
        )
        self.resizeDocks([self.docks["photos"]], [look.px(172)], Qt.Orientation.Vertical)

    def _dock(self, key: str, title: str, widget: QWidget, area: Qt.DockWidgetArea) -> QDockWidget:
        dock = QDockWidget(title, self)
        dock.setObjectName(key)
        dock.setWidget(widget)
        dock.setFeatures(QDockWidget.DockWidgetFeature.DockWidgetMovable)
        self.addDockWidget(area, dock)
        return dock

    def _connect(self) -> None:
        session, project = self.session, self.actions_of_project
        self.ribbon.chosen.connect(self.show_tab)
        self.run_all.clicked.connect(self.run_everything)
        self.start_page.new.connect(project.new)
        self.start_page.open.connect(project.open)
        self.start_page.demo.connect(project.demo)
        self.start_page.lab.connect(lambda: self.show_tab("learn"))
        self.start_page.recent.connect(project.open_folder)
        self.start_page.stop.connect(project.stop_demo)
        project.making.connect(self.start_page.show_work)
        project.made.connect(self.start_page.hide_work)
        self.images.asked.connect(project.ask)
        self.images.lesson.connect(lambda name: self._learn("open_lesson", name))
        self.tree.asked.connect(project.ask)
        self.tree.run_chosen.connect(project.use_run)
        self.tree.run_deleted.connect(project.delete_run)
        self.explain.lesson.connect(lambda name: self._learn("open_lesson", name))
        self.explain.simulator.connect(lambda name: self._learn("open_simulator", name))
        self.explain.tried.connect(self._try)
        for stage in STAGES:
            self.stage_tab(stage).explained.connect(self.explain.explain)
            self.stage_tab(stage).lesson.connect(lambda name: self._learn("open_lesson", name))
        session.message.connect(self._message)
        session.bug.connect(self.show_bug)
        session.photos_moved.connect(self._photos_moved)
        session.project_changed.connect(self._project_changed)
        session.states_changed.connect(self._update_states)
        session.run_changed.connect(self._update_states)
        session.progressed.connect(self._progressed)

    # --------------------------------------------------------------------------------------------- tabs

    def stage_tab(self, stage: Stage) -> StageTab:
        """Return the tab of a stage."""
        tab = self.tabs[stage]
        assert isinstance(tab, StageTab)
        return tab

    def show_tab(self, key: str) -> None:
        """Show a tab by the key of its step, or ``"start"``."""
        self._current = key
        self.stack.setCurrentWidget(self.tabs[key])
        self.ribbon.select(key)
        for name in ("project", "photos", "explain"):
            wanted = key not in ("start", "learn") and not self.menus.hidden_by_person(name)
            self.docks[name].setVisible(wanted)
        wanted = bool(self.messages.texts()) if key == "start" else key != "learn"
        self.docks["messages"].setVisible(wanted and not self.menus.hidden_by_person("messages"))
        if key == "start":
            self.start_page.show_recent(self.settings.recent())
        if key == "learn":
            self._need_learn()
        self._explain_stage(key)

    def _explain_stage(self, key: str) -> None:
        tab = self.tabs[key]
        if isinstance(tab, StageTab) and tab.panel.boxes:
            self.explain.explain(next(iter(tab.panel.boxes.values())).algorithm)
        else:
            self.explain.clear()

    def _need_learn(self) -> None:
        layout = self.learn_page.layout()
        if layout is not None and not layout.count():
            from graphos_py.learn_host import make_learn_tab

            layout.addWidget(make_learn_tab(self.session))

    def _learn(self, what: str, name: str) -> None:
        """Open a lesson or a simulator in the Learn tab."""
        self.show_tab("learn")
        layout = self.learn_page.layout()
        item = layout.itemAt(0) if layout is not None else None
        tab = item.widget() if item is not None else None
        if tab is not None and hasattr(tab, what):
            getattr(tab, what)(name)

    def _try(self, name: str, values: dict[str, object]) -> None:
        """Set parameters of an algorithm, and choose it where it is not in use."""
        from graphos_core.registry import algorithms

        recipe = self.session.recipe
        found = next((a for a in algorithms() if a.name == name), None)
        if recipe is None or found is None:
            return
        stage = found.stage
        if name not in recipe.chosen(stage, found.role):
            self.session.choose(stage, found.role, (name,))
        self.session.set_params(stage, name, recipe.params(stage, name).replace(**values))
        label = tr(STAGE_LABELS[stage])
        self.messages.add("info", tr("Set. Run {stage} and compare with the result before.", stage=label))

    # --------------------------------------------------------------------------------------------- running

    def run_current(self) -> None:
        """Run the step whose tab is shown (F5)."""
        tab = self.tabs[self._current]
        if isinstance(tab, StageTab):
            tab.run()
        else:
            self.run_everything()

    def run_everything(self) -> None:
        """Run all five steps."""
        if not self._why_not_all():
            self.session.run_all()

    def _why_not_all(self) -> str:
        for stage in STAGES:
            for problem in self.stage_tab(stage).panel.problems().values():
                return problem
        return why_not_all(self.session)

    def _update_states(self) -> None:
        session = self.session
        self.ribbon.step("images").show_state(images_state(session))
        for stage in STAGES:
            self.ribbon.step(stage).show_state(stage_state(session, stage))
        self.ribbon.step("learn").show_state(StepState("plain", "simulators · labs"))
        reason = self._why_not_all()
        self.run_all.setEnabled(not reason)
        self.run_all.setToolTip(tr(reason) if reason else tr("Run every step that is not done yet (Ctrl+F5)"))
        self.menus.update_running(session.running is not None, reason)

    def _progressed(self, progress: Progress) -> None:
        if self.session.running == progress.stage and not self.session.stopping:
            share = progress.done / progress.total if progress.total else 0.0
            step = self.ribbon.step(progress.stage)
            step.show_state(StepState("running", progress_text(progress), share=share))

    # --------------------------------------------------------------------------------------------- events

    def _project_changed(self) -> None:
        project = self.session.project
        if project is None:
            return
        self.setWindowTitle(f"{project.name} – GRAPHOS-Py")
        self.settings.remember(project.folder)
        self._update_states()
        if self._current == "start":
            self.show_tab("images")
        self._explain_stage(self._current)

    def _message(self, kind: str, what: object) -> None:
        self.messages.add(kind, what)
        if kind == "error" or self._current not in ("start", "learn"):
            self.docks["messages"].setVisible(not self.menus.hidden_by_person("messages"))

    def _photos_moved(self, problem: object) -> None:
        from graphos_core.project import PhotosMoved

        assert isinstance(problem, PhotosMoved)
        QTimer.singleShot(0, self, lambda: self._ask_photos(problem))

    def _ask_photos(self, problem: object) -> None:
        from graphos_core.project import PhotosMoved

        assert isinstance(problem, PhotosMoved)
        folder = self.actions_of_project.asked_folder
        where = ask_where_photos_are(problem, problem.expected, self)
        if where is None:
            self.messages.add("error", problem)
        elif folder is not None:
            self.session.open(folder, where)

    def show_bug(self, problem: BaseException) -> None:
        """Show the bug dialog; the session goes on."""
        self.messages.add("error", tr("An error in the program: {problem}", problem=repr(problem)))
        BugDialog(problem, self).show()

    def set_level(self, level: Level) -> None:
        """Switch between novice, student and expert."""
        self.settings.level = level
        for stage in STAGES:
            self.stage_tab(stage).set_level(level)

    def engine_loaded(self, problems: list[str]) -> None:
        """Show the forms: the algorithms are known now."""
        for problem in problems:
            self.messages.add("warning", problem)
        self.session.engine_ready()
        self._explain_stage(self._current)

    def _restore(self) -> None:
        geometry, state = self.settings.layout("geometry"), self.settings.layout("docks")
        if not geometry.isEmpty():
            self.restoreGeometry(geometry)
        if not state.isEmpty():
            self.restoreState(state, LAYOUT_VERSION)

    def sizeHint(self) -> QSize:
        """Ask for a laptop's screen."""
        return QSize(1500, 940)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask while a step runs; then stop all work, save the recipe and remember the layout."""
        running = self.session.running
        if running is not None and not ask_to_close(STAGE_LABELS[running], self):
            event.ignore()
            return
        self.session.stop()
        self.session.save_recipe()
        for stage in STAGES:
            self.stage_tab(stage).closing()
        self.settings.keep_layout("geometry", self.saveGeometry())
        if self._current not in ("start", "learn"):
            self.settings.keep_layout("docks", QByteArray(self.saveState(LAYOUT_VERSION)))
        self.jobs.stop_all()
        event.accept()
        self.closed.emit()

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept files and folders."""
        if event.mimeData().hasUrls():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open a project folder, or make a project of photos."""
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            event.acceptProposedAction()
            QTimer.singleShot(0, self, lambda: self.actions_of_project.dropped(paths))
