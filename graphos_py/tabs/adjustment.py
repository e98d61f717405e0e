"""Bundle adjustment: the block in space, cameras and photos with standard deviations, residuals, iterations, control."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QSplitter, QVBoxLayout, QWidget

from graphos_core.data import Adjustment, Array, Block, Georeference, IterationRecord
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_py.tabs.images import read_photo
from graphos_py.tabs.stage_tab import StageTab
from graphos_py.thumbnail_pixels import thumbnail_arrays
from graphos_py.translation import tr

if TYPE_CHECKING:
    from graphos_py.views.cloud_view import CloudView

ARROWS = 400
"""Residual vectors drawn at most, chosen evenly."""


class AdjustmentTab(StageTab):
    """What the orientation found and how well it is determined."""

    stage = "adjustment"
    empty = (
        "Where the photos were taken, and how well that is known",
        "Here you will see cameras and object points in space, calibration and orientation with standard "
        "deviations, and residuals. Run computes them.",
    )

    def make_views(self) -> None:
        """Cloud, tables, plots."""
        from graphos_py.control.page import ControlPage
        from graphos_py.views.cloud_view import CloudView
        from graphos_py.views.image_view import ImageView
        from graphos_py.views.plot_view import PlotView
        from graphos_py.views.table_view import TableView

        self._trace: list[IterationRecord] = []
        self._photo_shown = ""
        self._oriented: list[int] = []
        self.cloud = CloudView()
        self.cloud.camera_clicked.connect(self._camera_clicked)
        self.summary = QLabel()
        self.summary.setTextFormat(Qt.TextFormat.RichText)
        self.summary.setMargin(12)
        self.summary.setWordWrap(True)
        self.cameras, self.photos = TableView(), TableView()
        self.control = ControlPage(self.session, self.panel.level)
        self.photos.row_selected.connect(self.session.select_photo)
        self.residual_image = ImageView()
        self.histogram, self.iterations = PlotView(), PlotView()
        self.add_view(self.cloud, "3D")
        self.add_view(self.control, "Control")
        self.add_view(_column(self.summary, self.cameras), "Calibration")
        self.add_view(self.photos, "Photos")
        self.residual_text = QLabel()
        self.residual_text.setWordWrap(True)
        self.residual_text.setMargin(12)
        residuals = QSplitter(Qt.Orientation.Horizontal)
        residuals.addWidget(self.residual_image)
        residuals.addWidget(_column(self.residual_text, self.histogram))
        residuals.setSizes([500, 500])
        self.add_view(residuals, "Residuals")
        self.add_view(self.iterations, "Iterations")

    # ---------------------------------------------------------------------------------------------- results

    def show_result(self, result: Any) -> None:
        """Fill all pages."""
        adjustment: Adjustment = result.adjustment
        georeference: Georeference = result.georeference
        from graphos_py.adjustment_tables import (
            camera_columns,
            endings,
            photo_columns,
            summary,
        )

        self._show_block(adjustment.block)
        self.cloud.set_sigmas(adjustment.sigma_points)
        self.summary.setText(_cells_html(summary(adjustment, georeference), endings(adjustment)))
        self.cameras.set_table(camera_columns(adjustment.block))
        self.photos.set_table(photo_columns(adjustment))
        self.control.show_result(result)
        self._show_histogram(adjustment)
        self._trace = list(adjustment.iterations)
        self._show_trace()
        self._photo_shown = ""
        self.show_photo(self.session.photo)

    @property
    def keeps_views(self) -> bool:
        """Control points can be measured before there is a result."""
        return self.session.project is not None

    def set_level(self, level: Level) -> None:
        """Show what belongs to a level."""
        super().set_level(level)
        if self._made:
            self.control.set_level(level)

    def show_partial(self, key: str, values: list[Any]) -> None:
        """Let the block grow and the cost fall while it runs."""
        if key == "block" and isinstance(values[-1], Block):
            self.need_views()
            self._show_block(values[-1])
        elif key == "iteration":
            self.need_views()
            for record in values:
                if isinstance(record, IterationRecord):
                    if record.iteration == 0:
                        self._trace = []
                    self._trace.append(record)
            if self.views.currentWidget() is self.iterations:
                self._show_trace()

    def _show_block(self, block: Block) -> None:
        self.cloud.set_cloud(block.points, block.colours, unit=block.unit)
        self._oriented = show_cameras(self.cloud, block)
        self._select_camera(self.session.photo)

    def show_photo(self, index: int) -> None:
        """Select the camera of a photo and show its residuals."""
        self.control.show_photo(index)
        self._select_camera(index)
        if self.result is not None and index < len(self.result.adjustment.block.names):
            self.photos.select_rows([index])
        project = self.session.project
        photos = project.photo_set.photos if project is not None else ()
        if self.result is None or index >= len(photos) or photos[index].digest == self._photo_shown:
            return
        self._photo_shown = photos[index].digest
        read_photo(self.session, photos[index], self._photo_read)

    def _photo_read(self, read: tuple[str, Array]) -> None:
        digest, pixels = read
        if digest != self._photo_shown or self.result is None:
            return
        adjustment: Adjustment = self.result.adjustment
        mine = np.asarray(adjustment.block.obs_photo) == self.session.photo
        self.residual_image.set_image(pixels, keep_view=True)
        if mine.any():
            points = np.asarray(adjustment.block.obs_xy)[mine]
            vectors = np.asarray(adjustment.residuals)[mine]
            if len(points) > ARROWS:  # more than that hide each other
                chosen = np.linspace(0, len(points) - 1, ARROWS).astype(int)
                points, vectors = points[chosen], vectors[chosen]
            self.residual_image.set_overlay(points, vectors, None, tr("residual"))

    def _select_camera(self, index: int) -> None:
        self.cloud.select_camera(self._oriented.index(index) if index in self._oriented else -1)

    def _camera_clicked(self, row: int) -> None:
        if 0 <= row < len(self._oriented):
            self.session.select_photo(self._oriented[row])

    # ------------------------------------------------------------------------------------------------ plots

    def _show_histogram(self, adjustment: Adjustment) -> None:
        rms = format_value(adjustment.rms_px, unit="px", digits=3)
        self.histogram.show_histogram(
            np.asarray(adjustment.residuals).ravel(),
            tr("residual per coordinate"),
            "px",
        )
        self.residual_text.setText(tr("Image residuals of all photos, RMS per coordinate {rms}", rms=rms))

    def _show_trace(self) -> None:
        if self._trace:
            self.iterations.show_lines(
                np.arange(len(self._trace), dtype=float),
                {tr("cost"): np.array([record.cost for record in self._trace])},
                tr("iteration"),
                tr("cost"),
                "",
                "px²",
                log_y=True,
                title=tr("Cost ½ Σ ρ(r²) per iteration"),
            )


def show_cameras(view: CloudView, block: Block) -> list[int]:
    """Show the oriented photos of a block as pyramids; returns their indices in the order of the pyramids."""
    oriented = [int(i) for i in np.flatnonzero(np.asarray(block.oriented))]
    names = [block.names[i] for i in oriented]
    view.set_cameras(
        np.asarray(block.rotations)[oriented],
        np.asarray(block.centres)[oriented],
        [block.cameras[int(block.camera_of_photo[i])] for i in oriented],
        names,
        thumbnail_arrays(names),
    )
    return oriented


def _column(*widgets: QWidget) -> QWidget:
    holder = QWidget()
    column = QVBoxLayout(holder)
    column.setContentsMargins(0, 0, 0, 0)
    for widget in widgets:
        column.addWidget(widget, int(widget is widgets[-1]))
    return holder


def _cells_html(facts: list[tuple[str, str]], sentences: list[tuple[str, str]]) -> str:
    from html import escape

    cells = [f"<td style='padding:2px 28px 2px 0'><b>{escape(v)}</b><br>{escape(k)}</td>" for k, v in facts]
    rows = [cells[i : i + 5] for i in range(0, len(cells), 5)]
    said = "".join(f"<br>{escape(k)}: {escape(v)}" for k, v in sentences)
    return "<table>" + "".join(f"<tr>{''.join(row)}</tr>" for row in rows) + "</table>" + said
