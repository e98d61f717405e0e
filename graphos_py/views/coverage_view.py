"""The format with the matched points that hold it: heat map of cells, convex hull, radial zones, points."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QContextMenuEvent, QImage, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from graphos_core.data.record import Array
from graphos_core.features.coverage import Coverage
from graphos_core.number_format import format_value
from graphos_core.preprocessing.grey import luma
from graphos_core.rendering.colour_maps import colours_of_values
from graphos_py.translation import tr
from graphos_py.views.colour_legend import paint_legend
from graphos_py.views.export import Writer, export_menu, image_from_array, write_csv, write_png, write_svg
from graphos_py.views.painting import is_dark
from graphos_py.views.pixel_canvas import PixelCanvas

POINTS_AT_MOST = 5000
"""More would hide the heat map."""
OPACITY = 0.62
"""Of the heat map over a photo."""


class CoverageView(QWidget):
    """A photo, or the bare format, under its coverage.

    Signals
    -------
    cell_hovered(sentence)
        What the cell under the cursor says; empty outside.
    """

    cell_hovered = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("coverage")
        self.found: Coverage | None = None
        self.xy: Array = np.zeros((0, 2))
        self._heat: QImage | None = None
        self._opacity = OPACITY
        self.canvas = PixelCanvas(self)
        self.canvas.layers = [self._paint]
        self.canvas.empty = (
            tr("How much of the format matched points hold"),
            tr("Run this step; cells without a match stay bare."),
        )
        self.canvas.cursor_moved.connect(self._hovered)
        self.said = QLabel()
        self.said.setContentsMargins(8, 2, 8, 2)
        self.said.setProperty("role", "caption")
        box = QVBoxLayout(self)
        box.setContentsMargins(0, 0, 0, 0)
        box.setSpacing(0)
        box.addWidget(self.canvas, 1)
        box.addWidget(self.said)
        self.setFocusProxy(self.canvas)

    def show_coverage(self, found: Coverage | None, xy: Array, photo: Array | None = None) -> None:
        """Show a coverage and its points (n, 2), over a photo uint8, made grey, or over the bare format."""
        self.found, self.xy = found, np.asarray(xy, np.float64).reshape(-1, 2)
        if found is None:
            self.canvas.set_array(None)
            return
        blank = np.full((found.height, found.width), 45 if is_dark(self.palette()) else 235, np.uint8)
        self._opacity = 1.0 if photo is None else OPACITY
        self.canvas.set_array(blank if photo is None else luma(photo), keep_view=True)
        rgb = colours_of_values(found.counts, 0.0, max(float(found.counts.max()), 1.0), "viridis")
        self._heat = image_from_array(rgb)
        self.canvas.setAccessibleName(f"{tr(found.verdict)} {tr(found.advice)}")
        self._hovered(math.nan, math.nan)

    def _paint(self, painter: QPainter) -> None:
        found = self.found
        if found is None or self._heat is None:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        left, top = self.canvas.to_screen(np.array([[-0.5, -0.5]]))[0]
        area = QRectF(left, top, found.width * self.canvas.zoom, found.height * self.canvas.zoom)
        self._paint_cells(painter, area, found)
        self._paint_points(painter)
        self._paint_zones(painter, area, found)
        hull = [QPointF(x, y) for x, y in self.canvas.to_screen(found.hull).tolist()]
        for colour, width in ((QColor(0, 0, 0, 180), 5.0), (QColor(255, 255, 255), 2.2)):
            painter.setPen(QPen(colour, width))
            painter.drawPolygon(QPolygonF(hull))
        high = float(found.counts.max())
        screen = QRectF(0, 0, self.canvas.width(), self.canvas.height())
        paint_legend(painter, screen, self.palette(), 0.0, max(high, 1.0), tr("matched points per cell"), "")

    def _paint_cells(self, painter: QPainter, area: QRectF, found: Coverage) -> None:
        """Paint occupied cells in colour, bare ones hatched."""
        rows, columns = found.counts.shape
        assert self._heat is not None
        wide, high = area.width() / columns, area.height() / rows
        hatch = QColor(255, 255, 255, 90) if is_dark(self.palette()) else QColor(90, 60, 60, 120)
        for row, column in np.ndindex(rows, columns):
            cell = QRectF(area.left() + column * wide, area.top() + row * high, wide, high)
            if found.counts[row, column]:
                colour = self._heat.pixelColor(column, row)
                colour.setAlphaF(self._opacity)
                painter.fillRect(cell, colour)
            else:
                painter.setPen(Qt.PenStyle.NoPen)
                painter.setBrush(hatch)
                brush = painter.brush()
                brush.setStyle(Qt.BrushStyle.BDiagPattern)
                painter.fillRect(cell, brush)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(128, 128, 128, 120), 1))
        painter.drawRect(area)

    def _paint_points(self, painter: QPainter) -> None:
        chosen = self.xy[:: max(1, -(-len(self.xy) // POINTS_AT_MOST))]
        dots = [QPointF(x, y) for x, y in self.canvas.to_screen(chosen).tolist()]
        painter.setPen(QPen(QColor(255, 255, 255, 140), 1.6))
        painter.drawPoints(dots)

    def _paint_zones(self, painter: QPainter, area: QRectF, found: Coverage) -> None:
        painter.save()
        painter.setClipRect(area)
        painter.setPen(QPen(QColor(255, 255, 255, 130), 1.2, Qt.PenStyle.DashLine))
        for radius in found.radii[1:-1].tolist():
            painter.drawEllipse(area.center(), radius * self.canvas.zoom, radius * self.canvas.zoom)
        painter.restore()

    def _hovered(self, x: float, y: float) -> None:
        found, sentence = self.found, ""
        if found is not None and -0.5 <= x < found.width - 0.5 and -0.5 <= y < found.height - 0.5:
            rows, columns = found.counts.shape
            row, column = int((y + 0.5) / found.height * rows), int((x + 0.5) / found.width * columns)
            count = format_value(int(found.counts[row, column]))
            sentence = tr("column {c}, row {r}: {n} matched points", c=column + 1, r=row + 1, n=count)
        if not sentence and found is not None:
            total = format_value(found.points)
            sentence = tr("{n} matched points; white: their convex hull; hatched: bare cells", n=total)
        self.said.setText(sentence)
        self.cell_hovered.emit(sentence)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        if self.found is not None:
            export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending; the table has one row per row of cells."""
        counts = self.found.counts if self.found is not None else np.zeros((0, 0), np.int64)
        header = [f"column {i + 1}" for i in range(counts.shape[1])]
        return {
            "png": lambda path: write_png(self.canvas, path),
            "svg": lambda path: write_svg(self.canvas, path),
            "csv": lambda path: write_csv(path, header, counts.tolist()),
        }
