"""Image residuals: their vectors in the photo, their distribution, and what is common to them over the sensor."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QSplitter, QTabWidget, QVBoxLayout, QWidget

from graphos_core.data import Adjustment, Array
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_core.report.photo_pictures import cell_means
from graphos_core.report.residual_figures import standardised
from graphos_py.adjustment.special_plots import QuantilePlot
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.tabs.images import read_photo
from graphos_py.theme import theme
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
        self.plots.tabBar().setDrawBase(False)
        self.quantiles = QuantilePlot()
        self.sensor = ImageView()
        self.sensor_text = QLabel()
        self.plots.addTab(self.histogram, tr("Histogram"))
        self.plots.addTab(self.quantiles, tr("Quantiles"))
        self.plots.addTab(_under(self.sensor, self.sensor_text), tr("Over the sensor"))
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
            self.quantiles.clear()
            self.sensor.set_image(None)
            self.sensor_text.setText("")
            self.image.set_image(None)
            self.said.setText("")
            return
        adjustment: Adjustment = self.result.adjustment
        rms = format_value(adjustment.rms_px, unit="px", digits=3)
        self.said.setText(tr("Image residuals of all photos, RMS per coordinate {rms}", rms=rms))
        residuals = np.asarray(adjustment.residuals).ravel()
        self.histogram.show_histogram(residuals, tr("residual per coordinate"), "px")
        tested = adjustment.reliability is not None
        self.quantiles.show_quantiles(
            standardised(adjustment), tr("τ of the residuals") if tested else tr("residual / its spread")
        )
        self._show_sensor(adjustment)
        self.show_photo(self.session.photo)

    def _show_sensor(self, adjustment: Adjustment) -> None:
        """Show the mean residual in every cell of the format of the camera of the selected photo."""
        block = adjustment.block
        index = min(self.session.photo, len(block.names) - 1)
        number = int(block.camera_of_photo[index])
        camera = block.cameras[number]
        mine = np.asarray(block.camera_of_photo)[np.asarray(block.obs_photo)] == number
        centres, means, chance = cell_means(
            camera, np.asarray(block.obs_xy)[mine], np.asarray(adjustment.residuals)[mine]
        )
        colour = 40 if theme().name == "dark" else 224
        self.sensor.set_image(np.full((camera.height, camera.width), colour, np.uint8))
        if not len(means):
            return
        self.sensor.set_overlay(centres, means, None, tr("mean residual"))
        length = float(np.sqrt((means**2).sum(axis=1).mean()))
        self.sensor_text.setText(
            tr("Mean residuals in {n} cells of the format: {length} long, where chance alone makes {chance}. A ring, a "
               "swirl or a common direction shows what the camera model lacks.", n=len(means),
               length=format_value(length, unit="px", digits=2),
               chance=format_value(float(np.sqrt((chance**2).mean())), unit="px", digits=2))
        )  # fmt: skip

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


def _under(view: QWidget, text: QLabel) -> QWidget:
    text.setWordWrap(True)
    text.setProperty("role", "caption")
    text.setContentsMargins(12, 4, 12, 6)
    holder = QWidget()
    column = QVBoxLayout(holder)
    column.setContentsMargins(0, 0, 0, 0)
    column.addWidget(view, 1)
    column.addWidget(text)
    return holder
