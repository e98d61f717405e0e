"""The block in space: photos as pyramids, points coloured by a figure, error ellipsoids, residuals, rays of a point."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QSlider, QToolButton, QVBoxLayout, QWidget

from graphos_core.adjustment.measuring.object_residuals import object_residuals
from graphos_core.adjustment.statistics.point_figures import point_figure
from graphos_core.data import Adjustment, Array, Block
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_core.rendering import Lines
from graphos_core.rendering.ellipsoids import ellipsoid_lines
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.background import Background
from graphos_py.views.block_cameras import show_cameras
from graphos_py.views.cloud_scene import HEIGHT, RGB
from graphos_py.views.cloud_view import CloudView

ELLIPSOIDS = 120
"""Object points that get an ellipsoid at most, chosen evenly."""

STEPS = (0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)
"""Exaggerations of the sliders; 0 shows nothing."""

FIGURES = {RGB: "Colour of the photos", HEIGHT: "Height", "precision": "Precision", "rays": "Rays", "angle": "Intersection angle",
           "residual": "Image residual"}  # fmt: skip
TITLES = {"precision": "largest σ of a coordinate", "rays": "photos that see the point",
          "angle": "largest intersection angle", "residual": "RMS of the image residuals"}  # fmt: skip
RAY, RESIDUAL, PHOTO_ELLIPSOID, POINT_ELLIPSOID = (
    (255, 190, 40),
    (235, 90, 40),
    (204, 85, 170),
    (40, 150, 200),
)


class SpacePage(QWidget):
    """The 3D view with what the statistics say about the block.

    Signals
    -------
    photo_clicked(index)
        A photo of the block.
    distance_wanted(a, b)
        Two object points between which a distance is known.
    """

    photo_clicked = Signal(int)
    distance_wanted = Signal(int, int)

    def __init__(self, level: Level = "student") -> None:
        super().__init__()
        self.cloud = CloudView()
        self.cloud.camera_clicked.connect(self._camera_clicked)
        self.cloud.point_picked.connect(self._picked)
        self.cloud.measured.connect(self._measured)
        self.cloud.more_lines = self.lines
        self.cloud.bar.modes.hide()
        self.result: Any = None
        self.given: dict[str, Array] = {}
        self._oriented: list[int] = []
        self._background = Background(self)
        self._cached: tuple[object, list[Lines]] | None = None
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addLayout(self._bar())
        column.addWidget(self.cloud, 1)
        self.set_level(level)

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 4, 8, 0)
        bar.setSpacing(8)
        self.figures = QComboBox()
        for key, label in FIGURES.items():
            self.figures.addItem(tr(label), key)
        self.figures.setToolTip(tr("What the colour of an object point says"))
        self.figures.activated.connect(self._colour)
        bar.addWidget(self.figures)
        self.ellipsoids, self.residuals = (
            _Exaggeration(tr("Ellipsoids")),
            _Exaggeration(tr("Residuals")),
        )
        self.ellipsoids.setToolTip(
            tr("Ellipsoids of one standard deviation of photos and points, drawn larger")
        )
        self.residuals.setToolTip(tr("Computed − given of control and check points, drawn longer"))
        for widget in (self.ellipsoids, self.residuals):
            widget.changed.connect(self.cloud.canvas.refresh)
            bar.addWidget(widget)
        self.rays = QToolButton()
        self.rays.setText(tr("Rays"))
        self.rays.setToolTip(tr("Show the rays of the point that is clicked"))
        self.rays.setCheckable(True)
        self.rays.setChecked(True)
        self.rays.setAutoRaise(True)
        self.rays.toggled.connect(self.cloud.canvas.refresh)
        bar.addWidget(self.rays)
        bar.addStretch(1)
        self.take = QToolButton()
        self.take.setText(tr("Known distance …"))
        self.take.setToolTip(
            tr("Measure two points first (M); their distance can then give the block its scale")
        )
        self.take.setEnabled(False)
        self.take.clicked.connect(self._take)
        bar.addWidget(self.take)
        return bar

    # ------------------------------------------------------------------------------------------------ public

    def set_level(self, level: Level) -> None:
        """Show what belongs to a level."""
        for widget in (self.ellipsoids, self.residuals, self.figures):
            widget.setVisible(level != "novice")

    def show_block(self, block: Block) -> None:
        """Show an oriented block, also while it grows."""
        self.result = None
        self._show_block(block)

    def show_result(self, result: Any, given: dict[str, Array]) -> None:
        """Show an adjusted block; `given` are control and check points by name in its frame, (3,)."""
        self.result, self.given, self._cached = result, given, None
        self._show_block(result.adjustment.block)
        self.cloud.set_sigmas(result.adjustment.sigma_points)
        self.residuals.setEnabled(bool(given))
        self._suggest()
        self._colour()

    def clear(self) -> None:
        """Show nothing."""
        self.result, self._cached, self._oriented = None, None, []
        self.cloud.clear()

    def select_photo(self, index: int) -> None:
        """Highlight a photo of the block."""
        self.cloud.select_camera(self._oriented.index(index) if index in self._oriented else -1)

    # ------------------------------------------------------------------------------------------------- lines

    def lines(self) -> list[Lines]:
        """Return rays, ellipsoids and residuals as lines of the picture."""
        if self.result is None:
            return []
        key = (self.ellipsoids.factor, self.residuals.factor, self.rays.isChecked(), self.cloud.picked)
        if self._cached is None or self._cached[0] != key:
            adjustment: Adjustment = self.result.adjustment
            made = [
                *self._ellipsoid_lines(adjustment),
                *self._residual_lines(),
                *self._ray_lines(adjustment.block),
            ]
            self._cached = (key, made)
        return self._cached[1]

    def _ellipsoid_lines(self, adjustment: Adjustment) -> list[Lines]:
        covariance, factor, block = adjustment.covariance, self.ellipsoids.factor, adjustment.block
        if covariance is None or not factor:
            return []
        chosen = np.unique(np.linspace(0, len(block.points) - 1, ELLIPSOIDS).astype(int))
        oriented = np.flatnonzero(np.asarray(block.oriented))
        groups = (
            (np.asarray(block.points)[chosen], np.asarray(covariance.points)[chosen], POINT_ELLIPSOID),
            (
                np.asarray(block.centres)[oriented],
                np.asarray(covariance.photos)[oriented, 3:, 3:],
                PHOTO_ELLIPSOID,
            ),
        )
        return [
            _lines(*ellipsoid_lines(places, matrices, factor), colour, 1.2)
            for places, matrices, colour in groups
        ]

    def _residual_lines(self) -> list[Lines]:
        factor = self.residuals.factor
        if not factor or not self.given:
            return []
        found = object_residuals(self.result.adjustment, self.result.georeference)
        names = [name for name in found if name in self.given and np.isfinite(found[name]).all()]
        if not names:
            return []
        starts = np.array([self.given[name] for name in names])
        ends = starts + factor * np.array([found[name] for name in names])
        return [_lines(starts, ends, RESIDUAL, 3.0)]

    def _ray_lines(self, block: Block) -> list[Lines]:
        point = self.cloud.picked
        if not self.rays.isChecked() or not 0 <= point < len(block.points):
            return []
        photos = np.asarray(block.obs_photo)[np.asarray(block.obs_point) == point]
        centres = np.asarray(block.centres)[photos]
        return [
            _lines(centres, np.repeat(np.asarray(block.points)[point][None], len(centres), axis=0), RAY, 1.6)
        ]

    # --------------------------------------------------------------------------------------------- reacting

    def _show_block(self, block: Block) -> None:
        self.cloud.set_cloud(block.points, block.colours, unit=block.unit)
        self._oriented = show_cameras(self.cloud, block)

    def _suggest(self) -> None:
        """Choose exaggerations that can be seen: an ellipsoid of a hundredth of the object."""
        adjustment: Adjustment = self.result.adjustment
        extent = self.cloud.scene.extent()
        self.ellipsoids.suggest(extent / 100, float(np.nanmedian(adjustment.sigma_points)))
        self.ellipsoids.setEnabled(adjustment.covariance is not None)
        found = object_residuals(adjustment, self.result.georeference)
        lengths = [float(np.linalg.norm(v)) for name, v in found.items() if name in self.given]
        self.residuals.suggest(extent / 15, float(np.nanmedian(lengths)) if lengths else math.nan)

    def _colour(self) -> None:
        kind = str(self.figures.currentData())
        if self.result is None or kind in (RGB, HEIGHT):
            self.cloud.set_mode(kind)
            return
        result, adjustment = self.result, self.result.adjustment

        def show(values: object) -> None:
            if (
                isinstance(values, np.ndarray)
                and result is self.result
                and kind == self.figures.currentData()
            ):
                self._show_figure(kind, values, adjustment.block.unit)

        self._background.run(lambda: point_figure(adjustment, kind), show)

    def _show_figure(self, kind: str, values: Array, block_unit: str) -> None:
        unit = {"precision": tr(block_unit), "rays": "", "angle": "°", "residual": "px"}[kind]
        if kind == "precision" and block_unit == "m":
            values, unit = 1000 * values, "mm"
        finite = values[np.isfinite(values)]
        if len(finite):
            low, high = (float(v) for v in np.percentile(finite, [2, 98]))
            self.cloud.set_values(values, low, max(high, low + 1e-9), tr(TITLES[kind]), unit)

    def _picked(self, _: int) -> None:
        if self.rays.isChecked():
            self.cloud.canvas.refresh()

    def _measured(self, _: str) -> None:
        self.take.setEnabled(self.result is not None and len(self.cloud.measurement.points) == 2)

    def _take(self) -> None:
        a, b = self.cloud.measurement.points[:2]
        self.distance_wanted.emit(a, b)

    def _camera_clicked(self, row: int) -> None:
        if 0 <= row < len(self._oriented):
            self.photo_clicked.emit(self._oriented[row])


class _Exaggeration(QWidget):
    """A slider over factors, with its value in words."""

    changed = Signal()

    def __init__(self, label: str) -> None:
        super().__init__()
        self._label = label
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setRange(0, len(STEPS) - 1)
        self.slider.setFixedWidth(theme().px(80))
        self.slider.setAccessibleName(label)
        self.text = QLabel()
        self.text.setMinimumWidth(self.fontMetrics().horizontalAdvance(f"{label} 10 000×"))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.text)
        row.addWidget(self.slider)
        self.slider.valueChanged.connect(self._moved)
        self._moved()

    @property
    def factor(self) -> float:
        """The exaggeration; 0 for nothing."""
        return float(STEPS[self.slider.value()])

    def suggest(self, wanted: float, typical: float) -> None:
        """Let the slider go in one page to the factor that shows a `typical` length as long as `wanted`."""
        if typical > 0 and math.isfinite(typical):
            best = min(int(np.searchsorted(STEPS, wanted / typical)), len(STEPS) - 1)
            self.slider.setPageStep(best)
            if self.slider.value():
                self.slider.setValue(best)

    def _moved(self) -> None:
        shown = f"{format_value(int(self.factor))}×" if self.factor else tr("off")
        self.text.setText(f"{self._label} {shown}")
        self.changed.emit()


def _lines(starts: Array, ends: Array, colour: tuple[int, int, int], width: float) -> Lines:
    return Lines(starts, ends, np.tile(np.array(colour, np.uint8), (len(starts), 1)), width)
