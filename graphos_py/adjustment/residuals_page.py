"""Image residuals: their vectors in the photo, and their distribution."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QSplitter, QTabWidget, QVBoxLayout, QWidget

from graphos_core.data import Adjustment, Array
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_py.adjustment.page import ResultPage
from graphos_py.session import Session
from graphos_py.tabs.images import read_photo
from graphos_py.translation import tr
from graphos_py.views.image_view import ImageView
from graphos_py.views.plot_view import PlotView

ARROWS = 400
"""Residual vectors drawn at most, chosen evenly."""


class ResidualsPage(ResultPage):
    """The selected photo with its residuals, and plots of all of them."""

    label = "Residuals"
    level: Level = "student"

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self._shown = ""
        self.image = ImageView()
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setContentsMargins(12, 8, 12, 4)
        self.histogram = PlotView()
        self.plots = QTabWidget()
        self.plots.setDocumentMode(True)
        self.plots.addTab(self.histogram, tr("Histogram"))
        side = QWidget()
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.said)
        column.addWidget(self.plots, 1)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.addWidget(self.image)
        splitter.addWidget(side)
        splitter.setSizes([500, 500])
        self.column.addWidget(splitter)

    def fill(self) -> None:
        """Show plots and the selected photo."""
        self._shown = ""
        if self.result is None:
            self.histogram.clear()
            self.image.set_image(None)
            self.said.setText("")
            return
        adjustment: Adjustment = self.result.adjustment
        rms = format_value(adjustment.rms_px, unit="px", digits=3)
        self.said.setText(tr("Image residuals of all photos, RMS per coordinate {rms}", rms=rms))
        residuals = np.asarray(adjustment.residuals).ravel()
        self.histogram.show_histogram(residuals, tr("residual per coordinate"), "px")
        self.show_photo(self.session.photo)

    def show_photo(self, index: int) -> None:
        """Read another photo and show its residuals."""
        project = self.session.project
        photos = project.photo_set.photos if project is not None else ()
        if self.result is None or not self.isVisible() or index >= len(photos):
            return
        if photos[index].digest != self._shown:
            self._shown = photos[index].digest
            read_photo(self.session, photos[index], self._read)

    def _read(self, read: tuple[str, Array]) -> None:
        digest, pixels = read
        if digest != self._shown or self.result is None:
            return
        adjustment: Adjustment = self.result.adjustment
        mine = np.flatnonzero(np.asarray(adjustment.block.obs_photo) == self.session.photo)
        self.image.set_image(pixels, keep_view=True)
        if len(mine):
            chosen = mine[
                np.unique(np.linspace(0, len(mine) - 1, ARROWS).astype(int))
            ]  # more hide each other
            points, vectors = (
                np.asarray(adjustment.block.obs_xy)[chosen],
                np.asarray(adjustment.residuals)[chosen],
            )
            self.image.set_overlay(points, vectors, None, tr("residual"))
