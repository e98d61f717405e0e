"""The correlation matrix of a camera as a picture: a diverging colour and the number in every cell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QContextMenuEvent, QFont, QMouseEvent, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QWidget

from graphos_core.data.record import Array
from graphos_core.number_format import MINUS
from graphos_core.rendering.colour_maps import colour_table, colours_of_values
from graphos_py.translation import tr
from graphos_py.views.export import Writer, export_menu, image_from_array, write_csv, write_png, write_svg
from graphos_py.views.painting import paint_empty_state

STRONG = 0.9
"""Correlations beyond this are framed: two unknowns that can hardly be told apart."""


class CorrelationView(QWidget):
    """A square matrix with values from −1 to 1.

    Signals
    -------
    cell_hovered(sentence)
        What the cell under the cursor says; empty for none.
    """

    cell_hovered = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("correlations")
        self.names: list[str] = []
        self.labels: list[str] = []
        self.matrix: Array = np.zeros((0, 0))
        self.setMinimumSize(200, 200)
        self.setMouseTracking(True)

    def set_matrix(self, labels: Sequence[str], names: Sequence[str], matrix: Array) -> None:
        """Show a matrix (k, k) with short labels at its sides and full names in the sentences."""
        self.labels, self.names, self.matrix = list(labels), list(names), np.asarray(matrix, dtype=np.float64)
        self.update()

    def _area(self) -> tuple[QRectF, float]:
        """Return the square of the cells and the side of one."""
        metrics = self.fontMetrics()
        wide = max((metrics.horizontalAdvance(label) for label in self.labels), default=0) + 12
        high = metrics.height() + 8
        legend = 2 * metrics.height() + 22
        side = max(min((self.width() - wide - 12) / len(self.labels),
                       (self.height() - high - legend - 8) / len(self.labels), 64.0), 4.0)  # fmt: skip
        return QRectF(wide, high, side * len(self.labels), side * len(self.labels)), side

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint cells, numbers and legend."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Base))
        if len(self.labels) < 2:
            paint_empty_state(painter, self.rect(), self.palette(), tr("Correlations of the camera's parameters"),
                              tr("Run the adjustment with a calibration of two free parameters or more."))  # fmt: skip
            return
        area, side = self._area()
        colours = colours_of_values(self.matrix, -1.0, 1.0, "diverging")
        numbers = QFont(painter.font())
        numbers.setPointSizeF(min(numbers.pointSizeF(), 0.28 * side))
        ink = self.palette().color(QPalette.ColorRole.Text)
        for i, label in enumerate(self.labels):
            painter.setPen(ink)
            painter.drawText(QRectF(0, area.top() + i * side, area.left() - 6, side),
                             Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, label)  # fmt: skip
            painter.drawText(QRectF(area.left() + i * side, 0, side, area.top() - 4),
                             Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignBottom, label)  # fmt: skip
        painter.setFont(numbers)
        for i in range(len(self.labels)):
            for j in range(len(self.labels)):
                self._cell(
                    painter, QRectF(area.left() + j * side, area.top() + i * side, side, side), i, j, colours
                )
        painter.setFont(self.font())
        self._legend(painter, area)

    def _cell(self, painter: QPainter, box: QRectF, i: int, j: int, colours: Array) -> None:
        value, colour = float(self.matrix[i, j]), QColor(*(int(c) for c in colours[i, j]))
        painter.fillRect(box.adjusted(0.5, 0.5, -0.5, -0.5), colour)
        if box.width() >= 20:
            painter.setPen(QColor("#000000") if colour.lightnessF() > 0.5 else QColor("#ffffff"))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, _short(value))
        if i != j and abs(value) > STRONG:
            painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Text), 2))
            painter.drawRect(box.adjusted(1.5, 1.5, -1.5, -1.5))

    def _legend(self, painter: QPainter, area: QRectF) -> None:
        metrics = painter.fontMetrics()
        bar = QRectF(area.left(), area.bottom() + 10, max(area.width(), 120.0), 8)
        painter.drawImage(bar, image_from_array(colour_table("diverging")[None, :, :]))
        painter.setPen(self.palette().color(QPalette.ColorRole.Text))
        ends = QRectF(bar.left() - 8, bar.bottom() + 2, bar.width() + 16, metrics.height())
        for side, text in ((Qt.AlignmentFlag.AlignLeft, f"{MINUS}1"), (Qt.AlignmentFlag.AlignHCenter, "0"),
                           (Qt.AlignmentFlag.AlignRight, "1")):  # fmt: skip
            painter.drawText(ends, side, text)

    def _cell_at(self, at: QPointF) -> tuple[int, int] | None:
        if len(self.labels) < 2:
            return None
        area, side = self._area()
        column, row = int((at.x() - area.left()) // side), int((at.y() - area.top()) // side)
        return (row, column) if 0 <= row < len(self.labels) and 0 <= column < len(self.labels) else None

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Say what the cell under the cursor means."""
        cell = self._cell_at(event.position())
        sentence = "" if cell is None or cell[0] == cell[1] else correlation_sentence(
            self.names[cell[0]], self.names[cell[1]], float(self.matrix[cell]))  # fmt: skip
        self.setToolTip(sentence)
        self.cell_hovered.emit(sentence)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        rows = [(name, *row) for name, row in zip(self.names, self.matrix.tolist())]
        return {
            "png": lambda path: write_png(self, path),
            "svg": lambda path: write_svg(self, path),
            "csv": lambda path: write_csv(path, ["", *self.names], rows),
        }


def correlation_sentence(a: str, b: str, value: float) -> str:
    """Say how strongly two parameters hang together."""
    if abs(value) > STRONG:
        return tr("{a} and {b}: {value}. The photos can hardly tell them apart; rolled and convergent photos would.",
                  a=a, b=b, value=_short(value))  # fmt: skip
    if abs(value) > 0.7:
        return tr("{a} and {b}: {value}. They are partly exchangeable.", a=a, b=b, value=_short(value))
    return tr("{a} and {b}: {value}. The photos tell them apart.", a=a, b=b, value=_short(value))


def _short(value: float) -> str:
    return f"{value:.2f}".replace("-", MINUS)
