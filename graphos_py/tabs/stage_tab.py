"""What the tabs of the five steps share: Run and progress on top, forms left, views right, an empty state first."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QSplitter, QStackedWidget, QTabWidget, QVBoxLayout, QWidget

from graphos_core.params import Level
from graphos_core.registry import Stage
from graphos_py.empty_state import EmptyState
from graphos_py.run_bar import RunBar
from graphos_py.session import Progress, Session
from graphos_py.stage_panel import StagePanel
from graphos_py.theme import theme
from graphos_py.translation import tr


class StageTab(QWidget):
    """Base of the five tabs.

    A subclass names its `stage` and `empty` texts, makes its views in `make_views` (called when there is first
    something to show, so that the window appears without them) and fills them in `show_result`.
    """

    stage: Stage
    symbol = ""
    empty = ("", "")
    empty_action = "Run"
    explained = Signal(object, str)
    lesson = Signal(str)

    def __init__(self, session: Session, level: Level = "student") -> None:
        super().__init__()
        self.session = session
        self._made = False
        self._stale = True
        self.bar = RunBar(self.stage)
        self.bar.run.connect(self.run)
        self.bar.stop.connect(session.stop)
        self.panel = StagePanel(self.stage, level)
        self.panel.chosen.connect(self._chosen)
        self.panel.edited.connect(self._edited)
        self.panel.focused.connect(self.explained)
        self.panel.judged.connect(session.states_changed)
        self.empty_state = EmptyState(
            self.symbol or self.stage, self.empty[0], self.empty[1], self.empty_action
        )
        self.empty_state.acted.connect(self.run)
        self.views = QTabWidget()
        self.views.setDocumentMode(True)
        self.views.tabBar().setDrawBase(False)
        self.views.currentChanged.connect(self._view_changed)
        self.stack = QStackedWidget()
        self.stack.addWidget(self.empty_state)
        self.stack.addWidget(self.views)
        self.stack.setMinimumWidth(
            320
        )  # not what the widest page would like: the Explain panel stays in sight
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.setChildrenCollapsible(False)
        splitter.addWidget(self.panel)
        splitter.addWidget(self.stack)
        splitter.setStretchFactor(0, 0)
        splitter.setStretchFactor(1, 1)
        splitter.setSizes([theme().px(350), 900])
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.bar)
        column.addWidget(splitter, 1)
        session.recipe_changed.connect(self._recipe_changed)
        session.project_changed.connect(self._project_changed)
        session.results_changed.connect(self._results_changed)
        session.photo_selected.connect(self._photo_selected)
        session.states_changed.connect(self.update_state)
        session.run_changed.connect(self.update_state)
        session.progressed.connect(self._progressed)
        session.partial.connect(self._partial)
        self.update_state()

    # ---------------------------------------------------------------------------------------- for subclasses

    def make_views(self) -> None:
        """Make the views and add them with `add_view`; imports of view modules belong in here."""
        raise NotImplementedError

    def show_result(self, result: Any) -> None:
        """Fill the views with a result of this stage."""
        raise NotImplementedError

    def show_partial(self, key: str, values: list[Any]) -> None:
        """Show partial results while the stage runs; nothing by default."""

    def show_photo(self, index: int) -> None:
        """Another photo was selected; nothing by default."""

    def closing(self) -> None:
        """Write what waits to be written: the window is about to close; nothing by default."""

    def add_view(self, view: QWidget, label: str) -> None:
        """Add a page to the views."""
        self.views.addTab(view, tr(label))

    # ------------------------------------------------------------------------------------------------ public

    @property
    def result(self) -> Any:
        """The last complete result of this stage, or None."""
        return self.session.results.get(self.stage)

    def run(self) -> None:
        """Run this stage unless a field is wrong or the session says why not."""
        if not self.why_not():
            self.session.run(self.stage)

    def why_not(self) -> str:
        """Return why Run is disabled; empty when it is not."""
        problems = self.panel.problems()
        return next(iter(problems.values())) if problems else self.session.why_not_run(self.stage)

    def set_level(self, level: Level) -> None:
        """Show what belongs to a level."""
        self.panel.set_level(level)

    def refresh(self) -> None:
        """Bring forms and views up to date; done when the tab is seen."""
        if not self.isVisible():
            self._stale = True
            return
        self._stale = False
        if self.session.recipe is not None:
            self.panel.show_recipe(self.session.recipe)
        if self.result is None and not self.keeps_views:
            if self.session.loading:
                self.empty_state.tell(
                    "Reading the results …", "The last results of this step appear in a moment."
                )
            else:
                self.empty_state.tell(*self.empty, self.empty_action)
            self.stack.setCurrentWidget(self.empty_state)
            return
        self.need_views()
        if self.result is not None:
            self.show_result(self.result)

    @property
    def keeps_views(self) -> bool:
        """Whether the views show something without a result, such as a preview."""
        return False

    def need_views(self) -> None:
        """Make the views if that has not happened, and show them."""
        if not self._made:
            self._made = True
            self.make_views()
        self.stack.setCurrentWidget(self.views)

    def update_state(self) -> None:
        """Show Run with its reason, or the running stage."""
        session = self.session
        reason = self.why_not()
        self.empty_state.button.setEnabled(not reason)
        self.empty_state.button.setToolTip(tr(reason))
        if session.running == self.stage:
            self.bar.show_running(session.stopping)
        else:
            line = session.pipeline.state(self.stage).line if session.pipeline is not None else ""
            failed = session.failed.get(self.stage)
            self.bar.show_idle(reason, failed.what if failed else line)

    # --------------------------------------------------------------------------------------------- reacting

    def showEvent(self, event: QShowEvent) -> None:
        """Refresh what changed while the tab was hidden."""
        super().showEvent(event)
        if self._stale:
            self.refresh()

    def sizeHint(self) -> QSize:
        """Ask for a useful size."""
        return QSize(900, 600)

    def _chosen(self, role: str, names: tuple[str, ...]) -> None:
        self.session.choose(self.stage, role, names)

    def _edited(self, name: str, sheet: Any) -> None:
        self.session.set_params(self.stage, name, sheet)

    def _recipe_changed(self, stage: str) -> None:
        if stage == self.stage and self.session.recipe is not None:
            if self.isVisible():
                self.panel.show_recipe(self.session.recipe)
            else:
                self._stale = True

    def _project_changed(self) -> None:
        self._stale = True
        self.refresh()

    def _results_changed(self, stage: str) -> None:
        if stage == self.stage:
            self.refresh()

    def _photo_selected(self, index: int) -> None:
        if self._made and self.isVisible():
            self.show_photo(index)
        else:
            self._stale = True

    def _progressed(self, progress: Progress) -> None:
        if progress.stage == self.stage:
            self.bar.show_progress(progress)

    def _partial(self, stage: str, key: str, values: list[Any]) -> None:
        if stage == self.stage and self.isVisible():
            self.show_partial(key, values)

    def _view_changed(self, index: int) -> None:
        if self._made and self.isVisible():
            self.view_shown(index)

    def view_shown(self, index: int) -> None:
        """Another page of the views is shown; nothing by default."""
