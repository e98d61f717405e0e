"""What masks look like on a photo: hidden parts dark and hatched, outlines with corners, the polygon being drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QImage, QPainter, QPainterPath, QPen, QPolygonF

from graphos_core.data.record import Array
from graphos_core.masks import Polygon
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.painting import plate
from graphos_py.views.pixel_canvas import PixelCanvas

DIM, HATCH, HALO = QColor(0, 0, 0, 130), QColor(255, 255, 255, 90), QColor(255, 255, 255, 230)
CORNER = 4.5


class MaskLayer:
    """Painter of the mask of one photo."""

    def __init__(self, canvas: PixelCanvas) -> None:
        self.canvas = canvas
        self.polygons: tuple[Polygon, ...] = ()
        self.selected = -1
        self.corner = -1
        self.drawing: list[tuple[float, float]] = []
        self.cursor: tuple[float, float] | None = None
        self._picture: QImage | None = None

    def set_picture(self, free: Array | None) -> None:
        """Take the picture of an imported mask, bool (h, w), reduced as much as wanted; None for none."""
        if free is None:
            self._picture = None
            return
        rgba = np.zeros((*free.shape, 4), np.uint8)
        rgba[~free, 3] = DIM.alpha()
        height, width = free.shape
        self._picture = QImage(rgba.data, width, height, 4 * width, QImage.Format.Format_RGBA8888).copy()

    def paint(self, painter: QPainter) -> None:
        """Paint everything over the photo."""
        if self.canvas.array is None:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        frame = self._frame()
        if self._picture is not None:
            painter.drawImage(frame, self._picture)
        hidden = self._hidden(frame)
        painter.fillPath(hidden, DIM)
        painter.fillPath(hidden, QBrush(HATCH, Qt.BrushStyle.BDiagPattern))
        for index, polygon in enumerate(self.polygons):
            self._outline(painter, polygon, index == self.selected)
        self._draft(painter)

    def _frame(self) -> QRectF:
        width, height = self.canvas.image_size
        (left, top), (right, bottom) = self.canvas.to_screen(
            np.array([[-0.5, -0.5], [width - 0.5, height - 0.5]])
        )
        return QRectF(QPointF(left, top), QPointF(right, bottom))

    def _hidden(self, frame: QRectF) -> QPainterPath:
        whole = QPainterPath()
        whole.addRect(frame)
        hidden = QPainterPath()
        keeps = [p for p in self.polygons if p.kind == "kept"]
        if keeps:
            hidden.addRect(frame)
            for polygon in keeps:
                hidden = hidden.subtracted(self._path(polygon.points))
        for polygon in self.polygons:
            if polygon.kind == "excluded":
                hidden = hidden.united(self._path(polygon.points))
        return hidden.intersected(whole)

    def _places(self, points: Sequence[tuple[float, float]]) -> list[QPointF]:
        return [QPointF(float(x), float(y)) for x, y in self.canvas.to_screen(np.array(points))]

    def _path(self, points: Sequence[tuple[float, float]]) -> QPainterPath:
        path = QPainterPath()
        path.addPolygon(QPolygonF(self._places(points)))
        path.closeSubpath()
        return path

    def _outline(self, painter: QPainter, polygon: Polygon, selected: bool) -> None:
        path, accent = self._path(polygon.points), theme().colour("accent")
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for ink, width in ((HALO, 5.0 if selected else 4.0), (accent, 2.5 if selected else 1.5)):
            pen = QPen(ink, width)
            if ink is accent and polygon.kind == "kept":
                pen.setStyle(Qt.PenStyle.DashLine)
            painter.setPen(pen)
            painter.drawPath(path)
        for index, place in enumerate(self._places(polygon.points)):
            chosen = selected and index == self.corner
            painter.setPen(QPen(accent, 1.5))
            painter.setBrush(accent if chosen else HALO)
            size = CORNER + (2.0 if chosen else 0.0 if selected else -1.5)
            painter.drawRect(QRectF(place.x() - size, place.y() - size, 2 * size, 2 * size))
        if selected:
            self._label(
                painter, path.boundingRect(), tr("kept") if polygon.kind == "kept" else tr("excluded")
            )

    def _label(self, painter: QPainter, around: QRectF, text: str) -> None:
        metrics = painter.fontMetrics()
        inside = around.intersected(QRectF(self.canvas.rect()))
        wide, high = metrics.horizontalAdvance(text) + 12, metrics.height() + 4
        box = QRectF(inside.center().x() - wide / 2, inside.center().y() - high / 2, wide, high)
        plate(painter, box, self.canvas.palette())
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _draft(self, painter: QPainter) -> None:
        if not self.drawing:
            return
        places, accent = self._places(self.drawing), theme().colour("accent")
        line = [*places, *self._places([self.cursor])] if self.cursor else places
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for ink, width in ((HALO, 4.0), (accent, 2.0)):
            painter.setPen(QPen(ink, width))
            painter.drawPolyline(QPolygonF(line))
        for index, place in enumerate(places):
            painter.setPen(QPen(accent, 1.5))
            painter.setBrush(accent if index == 0 else HALO)
            painter.drawEllipse(place, CORNER + 1, CORNER + 1)
