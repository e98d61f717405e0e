"""What is drawn on the photo while measuring: marks with their residuals, the predicted place, epipolar lines."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from graphos_core.adjustment.measuring.prediction import Prediction
from graphos_core.data.record import Array
from graphos_core.exchange.control_sheet import Mark
from graphos_core.number_format import format_value
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.painting import plate, round_step
from graphos_py.views.pixel_canvas import PixelCanvas

LINE = QColor(255, 190, 40)
RESIDUAL = QColor(255, 110, 60)
UNDER = QColor(0, 0, 0, 160)


class MarksLayer:
    """Painter of the measurements of one photo."""

    def __init__(self, canvas: PixelCanvas) -> None:
        self.canvas = canvas
        self.marks: Mapping[str, Mark] = {}
        self.current = ""
        self.prediction: Prediction | None = None
        self.residual: Array | None = None
        self.exaggeration = 1.0

    def nearest(self, x: float, y: float, reach: float = 9.0) -> str:
        """Return the point whose mark lies within `reach` screen px of an image position; empty for none."""
        if not self.marks:
            return ""
        names = list(self.marks)
        places = np.array([self.marks[name].xy for name in names])
        distance = np.hypot(*(places - [x, y]).T) * self.canvas.zoom
        best = int(np.argmin(distance))
        return names[best] if distance[best] <= reach else ""

    def paint(self, painter: QPainter) -> None:
        """Paint everything over the photo."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_lines(painter)
        for name, mark in self.marks.items():
            self._paint_mark(painter, name, mark, name == self.current)
        if self.current not in self.marks:
            self._paint_prediction(painter)
        elif self.residual is not None:
            self._paint_residual(painter, self.marks[self.current])

    def _place(self, xy: Array) -> QPointF:
        x, y = self.canvas.to_screen(np.asarray(xy)[None])[0]
        return QPointF(float(x), float(y))

    def _paint_lines(self, painter: QPainter) -> None:
        if self.prediction is None or self.current in self.marks:
            return
        for line in self.prediction.lines:
            places = [QPointF(float(x), float(y)) for x, y in self.canvas.to_screen(line)]
            for ink, width in ((UNDER, 4.0), (LINE, 1.8)):
                painter.setPen(QPen(ink, width))
                for a, b in pairwise(places):
                    painter.drawLine(a, b)

    def _paint_mark(self, painter: QPainter, name: str, mark: Mark, current: bool) -> None:
        at, accent = self._place(mark.xy), theme().colour("accent")
        size = 9.0 if current else 6.0
        for ink, width in ((QColor(255, 255, 255, 230), 4.0), (accent, 2.0)):
            painter.setPen(QPen(ink, width))
            for dx, dy in ((1.0, 0.0), (0.0, 1.0)):
                arm = QPointF(size * dx, size * dy)
                painter.drawLine(at - arm, at - arm * 0.25)
                painter.drawLine(at + arm * 0.25, at + arm)
        if current:
            painter.setPen(QPen(accent, 1.5))
            painter.drawEllipse(at, 14, 14)
        self._text(painter, at + QPointF(12, -26), name, current)

    def _paint_prediction(self, painter: QPainter) -> None:
        found = self.prediction
        if found is None or found.xy is None or not found.inside:
            return
        at = self._place(found.xy)
        for ink, width in ((UNDER, 4.0), (LINE, 2.0)):
            pen = QPen(ink, width)
            pen.setStyle(Qt.PenStyle.DashLine if ink is LINE else Qt.PenStyle.SolidLine)
            painter.setPen(pen)
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(at, 15, 15)
        self._text(painter, at + QPointF(16, -28), tr("{point} expected", point=self.current), True)

    def _paint_residual(self, painter: QPainter, mark: Mark) -> None:
        assert self.residual is not None
        length = float(np.hypot(*self.residual))
        if length == 0:
            return
        at = self._place(mark.xy)
        self.exaggeration = max(1.0, round_step(60.0 / (length * self.canvas.zoom)))
        tip = at + QPointF(*(self.residual * self.exaggeration * self.canvas.zoom).tolist())
        for ink, width in ((UNDER, 4.0), (RESIDUAL, 2.0)):
            painter.setPen(QPen(ink, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            painter.drawLine(at, tip)
        longer = format_value(self.exaggeration, digits=2)
        text = tr("residual {length}, drawn {factor}× longer", length=format_value(length, unit="px", digits=2),
                  factor=longer)  # fmt: skip
        self._text(painter, at + QPointF(12, 14), text, True)

    def _text(self, painter: QPainter, at: QPointF, text: str, strong: bool) -> None:
        metrics = painter.fontMetrics()
        box = QRectF(at.x(), at.y(), metrics.horizontalAdvance(text) + 10, metrics.height() + 2)
        plate(painter, box, self.canvas.palette())
        if strong:
            painter.setPen(theme().colour("text"))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
