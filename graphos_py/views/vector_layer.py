"""Residual vectors on a photo, exaggerated, with a legend that says how much."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from graphos_core.data.record import Array
from graphos_core.number_format import format_value
from graphos_py.translation import tr
from graphos_py.views.painting import plate, round_step
from graphos_py.views.pixel_canvas import PixelCanvas

TYPICAL_LENGTH = 30.0
INK = QColor(255, 110, 60)
EDGE = QColor(0, 0, 0, 170)


class VectorLayer:
    """Points and the vectors that start there."""

    def __init__(self, canvas: PixelCanvas) -> None:
        self.canvas = canvas
        self.label = ""
        self._points: Array | None = None
        self._vectors: Array | None = None
        self._exaggeration: float | None = None
        self._names: list[str] | None = None

    def set(
        self,
        points: Array | None,
        vectors: Array | None,
        exaggeration: float | None,
        label: str,
        names: list[str] | None,
    ) -> None:
        """Show points (n, 2) in image px and vectors (n, 2) in image px."""
        self._points = None if points is None else np.asarray(points, np.float64).reshape(-1, 2)
        self._vectors = None if vectors is None else np.asarray(vectors, np.float64).reshape(-1, 2)
        self._exaggeration = exaggeration
        self.label = label
        self._names = names
        self.canvas.update()

    def clear(self) -> None:
        """Show nothing."""
        self.set(None, None, None, "", None)

    @property
    def exaggeration(self) -> float:
        """How many times longer than the photo's own px the vectors are drawn, in the present zoom."""
        if self._exaggeration is not None:
            return self._exaggeration
        if self._vectors is None or not len(self._vectors):
            return 1.0
        typical = float(np.median(np.hypot(*self._vectors.T))) * self.canvas.zoom
        return max(round_step(TYPICAL_LENGTH / typical), 1e-3) if typical > 0 else 1.0

    def paint(self, painter: QPainter) -> None:
        """Paint the vectors in sight and their legend."""
        if self._points is None or not len(self._points):
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        starts = self.canvas.to_screen(self._points)
        size = np.array([self.canvas.width(), self.canvas.height()])
        seen = np.flatnonzero(((starts > -50) & (starts < size + 50)).all(axis=1))
        dots = [QPointF(x, y) for x, y in starts[seen].tolist()]
        for colour, width in ((EDGE, 5.0), (INK, 3.0)):
            painter.setPen(QPen(colour, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            painter.drawPoints(dots)
        if self._vectors is not None:
            reach = self._vectors[seen] * self.exaggeration * self.canvas.zoom
            ends = starts[seen] + reach
            rows = np.column_stack([starts[seen], ends]).tolist()
            strokes = [QLineF(*row) for row in rows if all(np.isfinite(row))]
            for colour, width in ((EDGE, 3.2), (INK, 1.6)):
                painter.setPen(QPen(colour, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
                painter.drawLines(strokes)
            self._paint_legend(painter)
        if self._names is not None:
            for i in seen.tolist():
                self._paint_name(painter, self._names[i], starts[i])

    def _paint_name(self, painter: QPainter, name: str, at: Array) -> None:
        metrics = painter.fontMetrics()
        box = QRectF(
            at[0] + 8, at[1] - metrics.height() - 4, metrics.horizontalAdvance(name) + 10, metrics.height()
        )
        plate(painter, box, self.canvas.palette())
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, name)

    def _paint_legend(self, painter: QPainter) -> None:
        per_px = self.exaggeration * self.canvas.zoom
        shown = round_step(80.0 / per_px)
        length = shown * per_px
        longer = tr("drawn {factor}× longer", factor=format_value(self.exaggeration, digits=2))
        text = f"{format_value(shown, digits=1, unit='px')} {self.label}   {longer}"
        metrics = painter.fontMetrics()
        width = length + metrics.horizontalAdvance(text) + 32
        box = QRectF(12, self.canvas.height() - metrics.height() - 24, width, metrics.height() + 12)
        plate(painter, box, self.canvas.palette())
        middle = box.center().y()
        painter.drawText(
            box.adjusted(length + 22, 0, 0, 0),
            Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft,
            text,
        )
        painter.setPen(QPen(INK, 2))
        painter.drawLine(QPointF(box.left() + 10, middle), QPointF(box.left() + 10 + length, middle))
