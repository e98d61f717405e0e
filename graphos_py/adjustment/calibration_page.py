"""The calibration of every camera: kind, parameters, correlations, distortion."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QInputDialog, QLabel, QSplitter, QTabWidget, QVBoxLayout, QWidget

from graphos_core.cameras.model import camera_model
from graphos_core.cameras.profile import balanced_profile, radial_profile
from graphos_core.data import Adjustment, Camera
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_py.adjustment.camera_tiles import CameraTiles
from graphos_py.adjustment.correlation_view import CorrelationView
from graphos_py.adjustment.parameter_table import ParameterTable
from graphos_py.adjustment.special_plots import ProfilePlot
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.translation import tr
from graphos_py.views.background import Background


class CalibrationPage(ResultPage):
    """Tiles on top; the parameters of the chosen camera; correlations beside them."""

    label = "Calibration"

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._level: Level = "student"
        self._background = Background(self)
        self.tiles = CameraTiles(session)
        self.cameras = QComboBox()
        self.cameras.activated.connect(self._show_camera)
        self.table = ParameterTable(session)
        self.table.sigma_wanted.connect(self._ask_sigma)
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setContentsMargins(12, 4, 12, 4)
        self.correlations = CorrelationView()
        self.correlations.cell_hovered.connect(self._hovered)
        self.hint = QLabel()
        self.hint.setProperty("role", "caption")
        self.hint.setWordWrap(True)
        self.hint.setContentsMargins(12, 0, 12, 6)
        left, right = QWidget(), QWidget()
        for holder, widgets in (
            (left, (self.cameras, self.said, self.table)),
            (right, (self.correlations, self.hint)),
        ):
            column = QVBoxLayout(holder)
            column.setContentsMargins(8, 0, 8, 0)
            for widget in widgets:
                column.addWidget(widget, int(widget in (self.table, self.correlations)))
        self.pictures = QTabWidget()
        self.pictures.setDocumentMode(True)
        self.pictures.tabBar().setDrawBase(False)
        self.profile = ProfilePlot()
        self.profile.set_empty_text(
            tr("Distortion over the radius, with its confidence band"),
            tr("Run the adjustment with a calibration."),
        )
        self.pictures.addTab(right, tr("Correlations"))
        self.pictures.addTab(self.profile, tr("Distortion"))
        self.splitter = QSplitter(Qt.Orientation.Horizontal)
        self.splitter.addWidget(left)
        self.splitter.addWidget(self.pictures)
        self.splitter.setSizes([520, 420])
        self.column.addWidget(self.tiles)
        self.column.addWidget(self.splitter, 1)
        session.recipe_changed.connect(lambda _: self.table.show_choices())

    def set_level(self, level: Level) -> None:
        """Show the tests to students, the choices to experts."""
        self._level = level
        self.table.set_level(level)
        self.pictures.setVisible(level != "novice")

    def fill(self) -> None:
        """Offer the cameras of the result."""
        now = max(self.cameras.currentIndex(), 0)
        self.cameras.clear()
        if self.result is None:
            self.table.setRowCount(0)
            self.said.setText(tr("Run the adjustment to see every parameter with its standard deviation."))
            self.correlations.set_matrix([], [], np.zeros((0, 0)))
            self.profile.clear()
            self.cameras.hide()
            return
        cameras = self.result.adjustment.block.cameras
        for index, camera in enumerate(cameras):
            self.cameras.addItem(tr(camera.label) or tr("Camera {n}", n=index + 1))
        self.cameras.setVisible(len(cameras) > 1)
        self.cameras.setCurrentIndex(min(now, len(cameras) - 1))
        self._show_camera()

    def _show_camera(self) -> None:
        adjustment: Adjustment = self.result.adjustment
        index = max(self.cameras.currentIndex(), 0)
        camera = adjustment.block.cameras[index]
        tests = {s.parameter: s for s in adjustment.significance if s.camera == index}
        self.table.show_camera(camera, index, len(adjustment.block.cameras), tests)
        self.table.set_level(self._level)
        self.said.setText(camera_sentence(camera))
        self._show_correlations(adjustment, camera, index)
        covariance = (
            None if adjustment.covariance is None else np.asarray(adjustment.covariance.cameras[index])
        )
        result = self.result
        self._background.run(
            lambda: (radial_profile(camera, covariance), balanced_profile(camera, covariance)),
            lambda found: self._show_profiles(found, result),
        )

    def _show_profiles(self, found: object, result: object) -> None:
        """Show the two profiles, which come from the views' thread because the first ones may compile."""
        if not isinstance(found, tuple) or result is not self.result:
            return
        radial, balanced = found
        focal = format_value(balanced.focal_px, unit="px", digits=6)
        self.profile.show_profiles(
            {tr("Gaussian, 95 % band"): radial, tr("balanced, f = {focal}", focal=focal): balanced}
        )

    def _show_correlations(self, adjustment: Adjustment, camera: Camera, index: int) -> None:
        parameters = camera_model(camera.model).parameters
        matrix = None if adjustment.covariance is None else np.asarray(adjustment.covariance.cameras[index])
        if matrix is None:
            self.correlations.set_matrix([], [], np.zeros((0, 0)))
            return
        sigma = np.sqrt(np.maximum(np.diag(matrix), 0.0))
        free = np.flatnonzero(sigma > 0)
        scaled = matrix[np.ix_(free, free)] / np.outer(sigma[free], sigma[free])
        labels = [parameters[i].symbol.replace("_", "") for i in free]
        self.correlations.set_matrix(labels, [tr(parameters[i].label) for i in free], scaled)
        self._hovered("")

    def _hovered(self, sentence: str) -> None:
        usual = tr("Framed cells: |correlation| over 0.9. Point at a cell to read what it means.")
        self.hint.setText(sentence or usual)

    def _ask_sigma(self, name: str) -> None:
        label = tr("Standard deviation of the start value of {name}, in its unit:", name=name)
        value, chosen = QInputDialog.getDouble(self, tr("Free with σ"), label, 0.001, 1e-12, 1e6, 9)
        self.table.choose(name, f"{value:.9g}") if chosen else self.table.show_choices()


def camera_sentence(camera: Camera) -> str:
    """Say which model a camera has, in which direction it works, and its principal distance in mm."""
    model = camera_model(camera.model)
    text = tr("Model: {model} ({direction}).", model=tr(model.label), direction=tr(model.direction))
    if camera.pixel_pitch_mm:
        sigma = None if camera.sigmas is None else float(camera.sigmas[0]) * camera.pixel_pitch_mm
        focal = format_value(camera.focal_px * camera.pixel_pitch_mm, sigma, "mm", 5)
        text += " " + tr("Principal distance {focal}.", focal=focal)
    return text
