"""Detectors, descriptors and matchers side by side on the project's photos: form, table, figures, export."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from graphos_core.data import PhotoSet
from graphos_core.features_comparison.page import columns, remarks
from graphos_core.features_comparison.records import DEFINITIONS, Curve, FeatureComparison, Row
from graphos_core.params import Level
from graphos_core.recipe import Recipe
from graphos_core.run import Run
from graphos_py.features.compare_choices import CompareChoices, Wanted
from graphos_py.icons import bind_icon
from graphos_py.jobs import Job
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.translation import tr
from graphos_py.views.figure_view import FigureView
from graphos_py.views.table_view import Column, TableView

if TYPE_CHECKING:
    from collections.abc import Sequence

LESSON = "features/comparing"
DECIMALS = {"time_s": 2, "mean_rays": 2, "inlier_share": 3, "coverage": 3, "repeatability": 3, "precision": 3,
            "matching_score": 3}  # fmt: skip


class ComparePage(ResultPage):
    """Choose algorithms and compare them."""

    label = "Compare algorithms"
    level: Level = "student"

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.comparison: FeatureComparison | None = None
        self._names: tuple[str, ...] = ()
        self._rows: list[Row] = []
        self._known_curves: list[Curve] = []
        self._job: Job | None = None
        self.choices = CompareChoices()
        self.choices.changed.connect(self._update)
        self.table = TableView()
        self.table.set_empty_text(
            tr("Algorithms compared on your photos"), tr("Tick detectors on the left and press Compare.")
        )
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setContentsMargins(8, 4, 8, 4)
        self.bars = FigureView(
            tr("Here the algorithms will be seen side by side"), tr("Key points, matches, shares, and seconds."),
            tr("Key points, matches, shares and seconds of each algorithm as bars"),
        )  # fmt: skip
        self.curves = FigureView(
            tr("Here you will see what each algorithm bears"), tr("Tick “also changed versions” and compare."),
            tr("Repeatability and matching score of each algorithm against growing disturbance"),
        )  # fmt: skip
        self._lay_out()
        self._update()

    def _lay_out(self) -> None:
        self.figures = QTabWidget()
        self.figures.setDocumentMode(True)
        self.figures.addTab(self.bars, tr("Side by side"))
        self.figures.addTab(self.curves, tr("Against disturbances"))
        right = QSplitter(Qt.Orientation.Vertical)
        top = QWidget()
        column = QVBoxLayout(top)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.table, 1)
        column.addWidget(self.said)
        right.addWidget(top)
        right.addWidget(self.figures)
        right.setSizes([240, 380])
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.setChildrenCollapsible(False)
        splitter.addWidget(self.choices)
        splitter.addWidget(right)
        splitter.setStretchFactor(1, 1)
        splitter.setSizes([250, 700])
        self.column.addLayout(self._bar())
        self.column.addWidget(splitter, 1)

    def _bar(self) -> QHBoxLayout:
        self.button = QPushButton(tr("Compare"))
        bind_icon(self.button, "compare", "text")
        self.button.clicked.connect(self.compare)
        self.stop_button = QPushButton(tr("Stop"))
        bind_icon(self.stop_button, "stop", "bad")
        self.stop_button.clicked.connect(self.stop)
        self.progress = QProgressBar()
        self.progress.setTextVisible(False)
        self.progress.setMaximumWidth(240)
        self.state = QLabel()
        self.state.setProperty("role", "caption")
        self.export = QPushButton(tr("Export…"))
        self.export.setToolTip(tr("Table (CSV, JSON), report (HTML) and figures (PNG, SVG) into a folder"))
        bind_icon(self.export, "save", "text")
        self.export.clicked.connect(self._ask_folder)
        read = QPushButton(tr("Lesson"))
        bind_icon(read, "learn", "text")
        read.clicked.connect(lambda: self.lesson.emit(LESSON))
        bar = QHBoxLayout()
        bar.setContentsMargins(12, 8, 12, 4)
        bar.setSpacing(8)
        for widget in (self.button, self.stop_button, self.progress):
            bar.addWidget(widget)
        bar.addWidget(self.state, 1)
        bar.addWidget(read)
        bar.addWidget(self.export)
        return bar

    # ------------------------------------------------------------------------------------------------ public

    def fill(self) -> None:
        """Nothing comes from the result of a run: a comparison is made here."""
        self._update()

    def set_level(self, level: Level) -> None:
        """Show what belongs to a level."""
        self.choices.set_level(level)

    def why_not(self) -> str:
        """Return why nothing can be compared now; empty when it can."""
        project = self.session.project
        if project is None or not project.photo_set.photos:
            return tr("Photos are needed.")
        wanted = self.choices.wanted()
        if not wanted.detectors:
            return tr("Tick at least one detector.")
        if len(project.photo_set.photos) < 2 and not wanted.disturbed:
            return tr("One photo cannot be matched: tick “also changed versions”.")
        return ""

    def compare(self) -> None:
        """Compare in the background."""
        project = self.session.project
        if self.why_not() or self._job is not None or project is None:
            return
        self._rows, self._known_curves, self.comparison = [], [], None
        wanted, recipe = self.choices.wanted(), self.session.recipe
        photos = _chosen(project.photo_set, wanted, self.session.photo)
        self._names = tuple(photo.name for photo in photos.photos)
        work = partial(_compare, photos=photos, wanted=wanted, recipe=recipe or Recipe.default())
        self._job = Job(work, name="algorithms", seed=recipe.seed if recipe else 0)
        self._job.progressed.connect(self._progressed)
        self._job.shown.connect(self._shown)
        self._job.succeeded.connect(self._compared)
        self._job.failed.connect(self.session.tell)
        self._job.finished.connect(self._ended)
        self.bars.show_figure(None)
        self.curves.show_figure(None)
        self.said.clear()
        self._show_rows()
        self._update()
        self.session.jobs.start(self._job)

    def stop(self) -> None:
        """Stop; the rows that are finished stay."""
        if self._job is not None:
            self._job.stop()
            self.stop_button.setEnabled(False)
            self.state.setText(tr("Stopping …"))

    # --------------------------------------------------------------------------------------------- reacting

    def _progressed(self, done: float, total: float, what: str) -> None:
        if what != "comparison":  # steps inside an algorithm
            return
        self.progress.setRange(0, 1000)
        self.progress.setValue(round(1000 * done / total) if total else 0)
        if self.stop_button.isEnabled():
            self.state.setText(tr("{n} of {total} steps", n=f"{done:.0f}", total=f"{total:.0f}"))

    def _shown(self, key: str, values: Sequence[Any]) -> None:
        if key == "row":
            self._rows += values
            self._show_rows()
        elif key == "curve":
            self._known_curves += values
        so_far = self._so_far()
        if key == "row" and any(not row.failure for row in self._rows):
            self.bars.show_figure(partial(_bars, so_far))
        if key == "curve":
            self.curves.show_figure(partial(_curves, so_far))

    def _compared(self, comparison: FeatureComparison) -> None:
        self.comparison, self._rows = comparison, list(comparison.rows)
        self._show_rows()
        self.said.setText(" ".join(tr(text) for text in remarks(comparison)))
        if any(not row.failure for row in comparison.rows):
            self.bars.show_figure(partial(_bars, comparison))
        if comparison.curves:
            self.curves.show_figure(partial(_curves, comparison))

    def _ended(self) -> None:
        self._job = None
        self._update()

    def _show_rows(self) -> None:
        shown = self.comparison or self._so_far()
        self.table.set_table([
            Column(
                tr(heading), [getattr(row, key) if not row.failure or key == "algorithm" else None for row in self._rows],
                digits=9, decimals=DECIMALS.get(key), help=tr(DEFINITIONS.get(key, "")),
            )
            for key, heading in columns(shown)
        ])  # fmt: skip

    def _so_far(self) -> FeatureComparison:
        """Return what is finished while the rest is computed."""
        known = any(row.correct_3px is not None for row in self._rows)
        return FeatureComparison(
            self._names, tuple(self._rows), _IDENTITY if known else None, "", tuple(self._known_curves)
        )

    def _update(self) -> None:
        running, reason = self._job is not None, self.why_not()
        self.button.setVisible(not running)
        self.button.setEnabled(not reason)
        self.stop_button.setVisible(running)
        self.stop_button.setEnabled(True)
        self.progress.setVisible(running)
        self.export.setEnabled(self.comparison is not None)
        if running:
            self.progress.setRange(0, 0)
        self.state.setText(tr("Starting …") if running else reason)

    def _ask_folder(self) -> None:
        folder = QFileDialog.getExistingDirectory(self, tr("Folder for the comparison"))
        if folder:
            self.write(Path(folder))

    def write(self, folder: Path) -> None:
        """Write table, report and figures into a folder, in the background."""
        comparison = self.comparison
        if comparison is None:
            return

        def work(run: Run) -> None:
            from graphos_core.features_comparison.page import write_comparison

            write_comparison(comparison, folder)

        job = Job(work, name="export", engine=False)
        job.succeeded.connect(lambda _: self.state.setText(tr("Written: {path}", path=folder)))
        job.failed.connect(self.session.tell)
        self.session.jobs.start(job)


_IDENTITY = np.eye(3)
"""Stands for a homography while rows with truth come in."""


def _chosen(photos: PhotoSet, wanted: Wanted, selected: int) -> PhotoSet:
    """Return all photos, or the selected one and the next (at the end the one before)."""
    if wanted.everything or len(photos.photos) < 2:
        return photos
    first = min(max(selected, 0), len(photos.photos) - 2)
    return replace(photos, photos=photos.photos[first : first + 2])


def _compare(run: Run, photos: PhotoSet, wanted: Wanted, recipe: Recipe) -> FeatureComparison:
    from graphos_core.features_comparison.compare import compare_features
    from graphos_core.features_comparison.disturbances import DISTURBANCES
    from graphos_core.features_comparison.truth import read_homography
    from graphos_core.features_comparison.variants import variants

    return compare_features(
        photos, variants(wanted.detectors, wanted.assignments, recipe.seed, recipe), run=run,
        homography=read_homography(wanted.homography) if wanted.homography is not None else None,
        against=tuple(DISTURBANCES) if wanted.disturbed else (),
    )  # fmt: skip


def _bars(comparison: FeatureComparison, dark: bool) -> Any:
    from graphos_core.features_comparison.figures import DARK, LIGHT, bars

    return bars(comparison, DARK if dark else LIGHT)


def _curves(comparison: FeatureComparison, dark: bool) -> Any:
    from graphos_core.features_comparison.figures import DARK, LIGHT, curves

    return curves(comparison, DARK if dark else LIGHT)
