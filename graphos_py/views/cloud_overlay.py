"""What is painted over the 3D picture: scale bar, axes, measurement, names, legend."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPalette, QPen

from graphos_core.data.record import Array
from graphos_core.number_format import format_value
from graphos_py.views.cloud_scene import AXIS_COLOURS
from graphos_py.views.colour_legend import paint_legend
from graphos_py.views.painting import plate, round_step

if TYPE_CHECKING:
    from graphos_py.views.cloud_view import CloudView

AXIS_PX = 34.0


class CloudOverlay:
    """Painter of everything that has the size of the screen and not of the object."""

    def __init__(self, view: CloudView) -> None:
        self.view = view
        self.hovered_camera = -1

    def paint(self, painter: QPainter) -> None:
        """Paint over the latest picture."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_measurement(painter)
        self._paint_camera_name(painter)
        self._paint_axes(painter)
        self._paint_scale_bar(painter)
        view = self.view
        legend = view.scene.legend(view.mode)
        if legend is not None:
            area = QRectF(view.canvas.rect())
            title = legend.title if legend is view.scene.value_legend else view.bar.modes.currentText()
            paint_legend(
                painter, area, view.palette(), legend.low, legend.high, title, legend.unit, legend.table
            )

    def _place(self, points: Array) -> Array:
        return self.view.canvas.shown_camera.project(points, *self.view.canvas.size_px())

    def _text(self, painter: QPainter, at: QPointF, text: str) -> None:
        metrics = painter.fontMetrics()
        box = QRectF(at.x(), at.y(), metrics.horizontalAdvance(text) + 12, metrics.height() + 4)
        plate(painter, box, self.view.palette())
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_measurement(self, painter: QPainter) -> None:
        view = self.view
        indices = view.measurement.points or ([view.picked] if view.picked >= 0 else [])
        if not indices or max(indices) >= len(view.scene.points):
            return
        accent = view.palette().color(QPalette.ColorRole.Highlight)
        placed = [
            QPointF(*p[:2].tolist()) for p in self._place(view.scene.points[indices]) if np.isfinite(p).all()
        ]
        for colour, width in ((QColor(255, 255, 255), 5.0), (accent, 2.5)):
            painter.setPen(QPen(colour, width))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            for a, b in pairwise(placed):
                painter.drawLine(a, b)
            for p in placed:
                painter.drawEllipse(p, 6, 6)
        if not view.measurement.points:
            return
        for number, p in enumerate(placed, 1):
            self._text(painter, p + QPointF(9, -24), str(number))
        if len(placed) == 2:
            self._text(painter, (placed[0] + placed[1]) / 2 + QPointF(8, 8), view.measurement.text())
        elif len(placed) == 3:
            self._text(painter, placed[1] + QPointF(12, 8), view.measurement.text())

    def _paint_camera_name(self, painter: QPainter) -> None:
        scene = self.view.scene
        for index in {self.hovered_camera, self.view.selected_camera}:
            if 0 <= index < len(scene.names) and self.view.bar.cameras.isChecked():
                x, y, depth = self._place(scene.centres[index : index + 1])[0]
                if depth > 0 and np.isfinite(x):
                    self._text(painter, QPointF(float(x) + 10, float(y) - 30), scene.names[index])

    def _paint_axes(self, painter: QPainter) -> None:
        """Paint the directions X, Y, Z in the lower left corner, the nearest last."""
        rotation = self.view.canvas.shown_camera.rotation
        origin = QPointF(AXIS_PX + 20, self.view.canvas.height() - AXIS_PX - 20)
        for axis in np.argsort(-rotation[2]).tolist():
            direction = rotation[:, axis]
            tip = origin + QPointF(AXIS_PX * float(direction[0]), AXIS_PX * float(direction[1]))
            colour = QColor(*AXIS_COLOURS[axis].tolist())
            painter.setPen(QPen(colour, 2.5, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            painter.drawLine(origin, tip)
            reach = AXIS_PX + 9
            label = origin + QPointF(reach * float(direction[0]), reach * float(direction[1]))
            painter.setPen(self.view.palette().color(QPalette.ColorRole.Text))
            painter.drawText(
                QRectF(label.x() - 8, label.y() - 9, 16, 18), Qt.AlignmentFlag.AlignCenter, "XYZ"[axis]
            )

    def _paint_scale_bar(self, painter: QPainter) -> None:
        """Paint a round length as it looks at the distance of the target."""
        canvas, scene = self.view.canvas, self.view.scene
        per_px = canvas.shown_camera.distance / canvas.shown_camera.focal_px(*canvas.size_px())
        length = round_step(140.0 * per_px)
        wide = length / per_px
        text = format_value(length, digits=1, unit=scene.unit)
        x, y = 2 * AXIS_PX + 60.0, canvas.height() - 20.0
        metrics = painter.fontMetrics()
        ground = max(wide, float(metrics.horizontalAdvance(text))) + 20
        line = metrics.height()
        plate(
            painter, QRectF(x + 0.5 * (wide - ground), y - line - 12, ground, line + 20), self.view.palette()
        )
        painter.setPen(QPen(self.view.palette().color(QPalette.ColorRole.Text), 1.5))
        painter.drawLine(QPointF(x, y), QPointF(x + wide, y))
        for end in (x, x + wide):
            painter.drawLine(QPointF(end, y - 4), QPointF(end, y + 4))
        box = QRectF(
            x - 20, y - 8 - painter.fontMetrics().height(), wide + 40, painter.fontMetrics().height()
        )
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
