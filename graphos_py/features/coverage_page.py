"""The coverage assistant: how much of the format matched points hold, in one photo and in all, and what to change."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QLabel,
    QSplitter,
    QTabWidget,
    QToolButton,
    QVBoxLayout,
)

from graphos_core.data import Array
from graphos_core.features.coverage import (
    Coverage,
    CoverageParams,
    camera_coverage,
    matched_features,
    photo_coverage,
)
from graphos_py.features.photo_pixels import PhotoPixels
from graphos_py.features.radial_plot import RadialPlot
from graphos_py.form import Form
from graphos_py.icons import icon
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.background import Background
from graphos_py.views.coverage_view import CoverageView
from graphos_py.views.table_view import Column, TableView

PHOTO, CAMERA = "photo", "camera"


class CoveragePage(ResultPage):
    """Heat map and hull above; the verdict, the radial zones and all photos below."""

    label = "Coverage"

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.params = CoverageParams()
        self._pixels = PhotoPixels(session, self)
        self._background = Background(self)
        self._asked = 0
        self._shown: tuple[int, Coverage, Array] | None = None
        self.view = CoverageView()
        self.radial = RadialPlot()
        self.table = TableView()
        self.table.row_selected.connect(self.photo_wanted)
        self.form = Form(self.params)
        self.form.changed.connect(self._params_changed)
        self.form.hide()
        self._lay()

    def _lay(self) -> None:
        self.mark, self.said, self.advice = QLabel(), QLabel(), QLabel()
        for label in (self.said, self.advice):
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.advice.setProperty("role", "caption")
        self.mark.setAlignment(Qt.AlignmentFlag.AlignTop)
        words = QVBoxLayout()
        words.setSpacing(2)
        words.addWidget(self.said)
        words.addWidget(self.advice)
        verdict = QHBoxLayout()
        verdict.setContentsMargins(8, 6, 8, 6)
        verdict.setSpacing(8)
        verdict.addWidget(self.mark)
        verdict.addLayout(words, 1)
        lower = QTabWidget()
        lower.setDocumentMode(True)
        lower.tabBar().setDrawBase(False)
        lower.addTab(self.radial, tr("Radial zones"))
        lower.addTab(self.table, tr("All photos"))
        self.tables = lower
        splitter = QSplitter(Qt.Orientation.Vertical)
        splitter.addWidget(self.view)
        splitter.addWidget(lower)
        splitter.setStretchFactor(0, 3)
        splitter.setStretchFactor(1, 2)
        splitter.setSizes([360, 220])
        self.column.addLayout(self._bar())
        self.column.addWidget(self.form)
        self.column.addLayout(verdict)
        self.column.addWidget(splitter, 1)
        self.form.setContentsMargins(8, 8, 8, 4)
        theme().changed.connect(self._write)

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 4, 8, 0)
        bar.setSpacing(8)
        self.which = QComboBox()
        self.which.setAccessibleName(tr("Whose matched points"))
        self.which.addItem(tr("This photo"), PHOTO)
        self.which.addItem(tr("All photos of its camera"), CAMERA)
        self.which.activated.connect(self._measure)
        bar.addWidget(self.which)
        bar.addStretch(1)
        self.settings = QToolButton()
        self.settings.setText(tr("Settings"))
        self.settings.setCheckable(True)
        self.settings.toggled.connect(self.form.setVisible)
        bar.addWidget(self.settings)
        bar.addWidget(self.lesson_button("features/coverage"))
        return bar

    # ------------------------------------------------------------------------------------------------ public

    def fill(self) -> None:
        """Measure the coverage of the selected photo and of all."""
        self._fill_table()
        self._measure()

    def show_photo(self, index: int) -> None:
        """Show another photo."""
        if self.isVisible():
            self._measure()
            self.table.select_rows([index])
        else:
            self._stale = True

    # --------------------------------------------------------------------------------------------- measuring

    def _params_changed(self, params: CoverageParams) -> None:
        self.params = params
        self.fill()

    def _measure(self) -> None:
        result, index = self.result, self.session.photo
        if result is None or index >= len(result.features):
            self._shown = None
            self.view.show_coverage(None, np.zeros((0, 2)))
            self.radial.clear()
            self._write()
            return
        whole, params, photos = self.which.currentData() == CAMERA, self.params, self._of_camera(index)
        self._asked += 1
        asked = self._asked

        def work() -> tuple[Coverage, Array]:
            features, pairs = result.features, result.pairs
            if whole:
                found = camera_coverage(features, pairs, photos, params)
                return found, np.concatenate([_matched(result, i) for i in photos])
            return photo_coverage(features, pairs, index, params), _matched(result, index)

        def take(done: object) -> None:
            if asked == self._asked and result is self.result and isinstance(done, tuple):
                self._take(index, *done, whole=whole)

        self._background.run(work, take)

    def _take(self, index: int, found: Coverage, xy: Array, *, whole: bool) -> None:
        self._shown = (index, found, xy)
        self.radial.show_zones(found)
        self._write()
        self.view.show_coverage(found, xy)
        if not whole:
            self._pixels.read(index, self._pixels_read)

    def _pixels_read(self, index: int, pixels: Array) -> None:
        if self._shown is not None and self._shown[0] == index and self.which.currentData() == PHOTO:
            self.view.show_coverage(self._shown[1], self._shown[2], pixels)

    def _of_camera(self, index: int) -> list[int]:
        """Return the photos of the same camera and format as a photo, itself first."""
        features = self.result.features
        photos = self.session.project.photo_set.photos if self.session.project is not None else ()
        size = (features[index].width, features[index].height)
        alike = [
            i for i, f in enumerate(features)
            if (f.width, f.height) == size and (not photos or photos[i].camera == photos[index].camera)
        ]  # fmt: skip
        return [index, *(i for i in alike if i != index)]

    def _fill_table(self) -> None:
        result, params, project = self.result, self.params, self.session.project
        if result is None or project is None:
            self.table.set_table([])
            return
        names = [photo.name for photo in project.photo_set.photos]

        def take(found: object) -> None:
            if result is self.result and params is self.params and isinstance(found, list):
                self.table.set_table(_columns(names, found))
                self.table.select_rows([self.session.photo])

        self._background.run(
            lambda: [photo_coverage(result.features, result.pairs, i, params) for i in range(len(names))],
            take,
        )

    def _write(self) -> None:
        """Say the verdict with its sign, and the advice."""
        found = self._shown[1] if self._shown is not None else None
        if found is None:
            for label in (self.mark, self.said, self.advice):
                label.clear()
            return
        sign, colour = ("warning", "warn") if found.alert else ("done", "good")
        size = theme().px(22)
        self.mark.setPixmap(icon(sign, colour).pixmap(size, size))
        verdict = tr("Too little is covered.") if found.alert else tr("Enough is covered.")
        self.said.setText(f"<b>{verdict}</b> {tr(found.verdict)}")
        self.advice.setText(tr(found.advice))
        self.advice.setVisible(bool(found.advice))


def _matched(result: Any, photo: int) -> Array:
    return np.asarray(result.features[photo].xy)[matched_features(result.features, result.pairs, photo)]


def _columns(names: list[str], found: list[Coverage]) -> list[Column]:
    return [
        Column(tr("photo"), names),
        Column(tr("verdict"), ["⚠ " + tr("too little") if c.alert else "✓ " + tr("enough") for c in found]),
        Column(tr("cells"), [100 * c.occupied_share for c in found], "%", decimals=0,
               help=tr("Cells with at least one matched point.")),
        Column(tr("hull"), [100 * c.hull_share for c in found], "%", decimals=0,
               help=tr("Area of the convex hull of the matched points.")),
        Column(tr("reach"), [100 * c.reach for c in found], "%", decimals=0,
               help=tr("Largest distance of a matched point from the centre, as a share of the half diagonal.")),
        Column(tr("points"), [c.points for c in found]),
        Column(tr("bare parts"), [", ".join(tr(part) for part in c.empty) or "–" for c in found]),
    ]  # fmt: skip
