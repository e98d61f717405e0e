"""A magnifier in the corner of a photo: what lies under the cursor or the mark, enlarged, with a cross hair."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from graphos_py.theme import theme
from graphos_py.views.export import image_from_array
from graphos_py.views.painting import plate
from graphos_py.views.pixel_canvas import PixelCanvas

SIZE_PX = 190.0
FACTORS = (4, 8, 16, 32)


class Loupe:
    """Painter of the magnifier; `at` is the image position in its middle, NaN for none."""

    def __init__(self, canvas: PixelCanvas) -> None:
        self.canvas = canvas
        self.at = (math.nan, math.nan)
        self.factor = 8
        self.marks: list[tuple[float, float]] = []

    def box(self) -> QRectF:
        """Return where the magnifier is: the upper right corner, or the upper left when the place lies there."""
        size = min(theme().px(SIZE_PX), 0.36 * self.canvas.width(), 0.5 * self.canvas.height())
        right = self.canvas.width() - size - 12
        place = self.canvas.to_screen(np.array([self.at]))[0]
        near = place[0] > right - 180 and place[1] < size + 72
        return QRectF(12.0 if near else right, 12.0, size, size)

    def paint(self, painter: QPainter) -> None:
        """Paint the magnifier over the photo."""
        image, (x, y) = self.canvas.array, self.at
        if image is None or not (math.isfinite(x) and math.isfinite(y)):
            return
        box = self.box()
        reach = math.ceil(0.5 * box.width() / self.factor) + 1
        left, top = math.floor(x) - reach, math.floor(y) - reach
        rows = np.clip(np.arange(top, top + 2 * reach + 2), 0, image.shape[0] - 1)
        columns = np.clip(np.arange(left, left + 2 * reach + 2), 0, image.shape[1] - 1)
        part = image[np.ix_(rows, columns)]
        corner = QPointF(
            box.center().x() + (left - 0.5 - x) * self.factor,
            box.center().y() + (top - 0.5 - y) * self.factor,
        )
        side = len(rows) * self.factor
        painter.save()
        painter.setClipRect(box)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, False)
        painter.drawImage(QRectF(corner.x(), corner.y(), side, side), image_from_array(part))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for mark in self.marks:
            centre = box.center() + QPointF((mark[0] - x) * self.factor, (mark[1] - y) * self.factor)
            self._cross(painter, centre, theme().colour("accent"), 9.0)
        self._hair(painter, box)
        painter.restore()
        painter.setPen(QPen(theme().colour("border"), 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(box)
        self._caption(painter, box)

    def _hair(self, painter: QPainter, box: QRectF) -> None:
        middle, gap = box.center(), 6.0
        arms = ((0.0, -1.0), (0.0, 1.0), (-1.0, 0.0), (1.0, 0.0))
        for colour, width in ((QColor(0, 0, 0, 150), 3.0), (QColor(255, 255, 255, 230), 1.0)):
            painter.setPen(QPen(colour, width))
            for dx, dy in arms:
                painter.drawLine(
                    middle + QPointF(gap * dx, gap * dy),
                    middle + QPointF(0.5 * box.width() * dx, 0.5 * box.height() * dy),
                )

    def _cross(self, painter: QPainter, at: QPointF, colour: QColor, size: float) -> None:
        for ink, width in ((QColor(255, 255, 255, 220), 4.0), (colour, 2.0)):
            painter.setPen(QPen(ink, width))
            painter.drawLine(at - QPointF(size, size), at + QPointF(size, size))
            painter.drawLine(at - QPointF(size, -size), at + QPointF(size, -size))

    def _caption(self, painter: QPainter, box: QRectF) -> None:
        text = f"{self.at[0]:.2f}  {self.at[1]:.2f} px   {self.factor}×"
        metrics = painter.fontMetrics()
        ground = QRectF(box.left(), box.bottom() + 2, box.width(), metrics.height() + 4)
        plate(painter, ground, self.canvas.palette())
        painter.drawText(ground, Qt.AlignmentFlag.AlignCenter, text)
