"""Which photos hang together: a matrix of verified matches, to be clicked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPoint, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QHelpEvent, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from graphos_core.data import PairMatches
from graphos_core.number_format import format_value
from graphos_core.rendering.colour_maps import colour_table
from graphos_py.theme import theme
from graphos_py.translation import tr


class PairMatrix(QWidget):
    """One cell per pair; brighter means more verified matches, a dash means that the pair is not used."""

    pair_chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self._pairs: dict[tuple[int, int], int] = {}
        self._list: Sequence[PairMatches] = ()
        self._names: Sequence[str] = ()
        self._most = 1
        self.selected = -1
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(160, 160)
        self.setAccessibleName(tr("Matrix of verified matches"))

    def show_pairs(self, pairs: Sequence[PairMatches], names: Sequence[str]) -> None:
        """Show pairs of photos."""
        self._list, self._names = pairs, names
        self._pairs = {(pair.a, pair.b): i for i, pair in enumerate(pairs)}
        self._most = max((len(pair.matches) for pair in pairs), default=1) or 1
        self.update()

    def select(self, index: int) -> None:
        """Mark a pair."""
        self.selected = index
        self.update()

    def sizeHint(self) -> QSize:
        """Ask for a square."""
        return QSize(300, 320)

    def _cell(self) -> tuple[float, float, float]:
        """Return left, top and size of the cells."""
        n = max(1, len(self._names))
        margin, legend = theme().px(22), theme().px(44)
        size = min((self.width() - margin - 8) / n, (self.height() - margin - legend) / n, 44.0)
        return margin, margin, size

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw cells, numbers of the photos, and the legend."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), theme().colour("base"))
        left, top, size = self._cell()
        n = len(self._names)
        font = painter.font()
        font.setPointSizeF(max(5.0, min(theme().points("caption"), size * 0.42)))
        painter.setFont(font)
        painter.setPen(theme().colour("muted"))
        every = max(1, int(np.ceil(14 / max(size, 1))))
        for i in range(0, n, every):
            painter.drawText(QRectF(0, top + i * size, left - 4, size), Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, str(i + 1))  # fmt: skip
            painter.drawText(QRectF(left + i * size, 0, size, top - 3), Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignBottom, str(i + 1))  # fmt: skip
        table = colour_table("viridis")
        for (a, b), index in self._pairs.items():
            pair = self._list[index]
            for row, column in ((a, b), (b, a)):
                box = QRectF(left + column * size, top + row * size, size - 1, size - 1)
                self._draw_cell(painter, box, pair, table, size)
                if index == self.selected:
                    painter.setPen(QPen(theme().colour("accent"), 2.5))
                    painter.setBrush(Qt.BrushStyle.NoBrush)
                    painter.drawRect(box.adjusted(1, 1, -1, -1))
        for i in range(n):
            painter.fillRect(
                QRectF(left + i * size, top + i * size, size - 1, size - 1), theme().colour("hover")
            )
        self._draw_legend(painter, table, left, top + n * size + 8, n * size)

    def _draw_cell(
        self, painter: QPainter, box: QRectF, pair: PairMatches, table: object, size: float
    ) -> None:
        used = not pair.reason and len(pair.matches) > 0
        if not used:
            painter.fillRect(box, theme().colour("window"))
            painter.setPen(theme().colour("muted"))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, "–")
            return
        share = np.sqrt(len(pair.matches) / self._most)
        red, green, blue = (int(c) for c in np.asarray(table)[round(40 + 215 * share)])
        painter.fillRect(box, QColor(red, green, blue))
        if size >= 26:
            bright = 0.3 * red + 0.59 * green + 0.11 * blue
            painter.setPen(QColor("#000000" if bright > 120 else "#ffffff"))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, f"{len(pair.matches)}")

    def _draw_legend(self, painter: QPainter, table: object, left: float, top: float, width: float) -> None:
        if not self._pairs:
            return
        bar = min(width, 120.0)
        for i in range(int(bar)):
            share = np.sqrt(i / bar)
            red, green, blue = (int(c) for c in np.asarray(table)[round(40 + 215 * share)])
            painter.fillRect(QRectF(left + i, top, 1.5, 8), QColor(red, green, blue))
        font = painter.font()
        font.setPointSizeF(theme().points("caption"))
        painter.setFont(font)
        painter.setPen(theme().colour("muted"))
        painter.drawText(
            QRectF(left, top + 10, self.width() - left, theme().px(44)),
            int(Qt.AlignmentFlag.AlignTop) | int(Qt.TextFlag.TextWordWrap),
            tr("0 to {n} verified matches", n=format_value(self._most)),
        )

    def _at(self, where: QPoint) -> int:
        left, top, size = self._cell()
        column, row = int((where.x() - left) // size), int((where.y() - top) // size)
        return self._pairs.get((min(row, column), max(row, column)), -1)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose a pair."""
        index = self._at(event.position().toPoint())
        if index >= 0:
            self.select(index)
            self.pair_chosen.emit(index)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Go to the next or the previous pair with the arrows."""
        step = {Qt.Key.Key_Right: 1, Qt.Key.Key_Down: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_Up: -1}.get(
            Qt.Key(event.key()), 0
        )
        if step and self._list:
            self.select(min(max(self.selected + step, 0), len(self._list) - 1))
            self.pair_chosen.emit(self.selected)
        else:
            super().keyPressEvent(event)

    def event(self, event: object) -> bool:
        """Tell what is under the cursor."""
        if isinstance(event, QHelpEvent):
            index = self._at(event.pos())
            if index >= 0:
                QToolTip.showText(event.globalPos(), self._tip(self._list[index]), self)
            else:
                QToolTip.hideText()
            return True
        return super().event(event)  # type: ignore[arg-type]

    def _tip(self, pair: PairMatches) -> str:
        names = f"{self._names[pair.a]} – {self._names[pair.b]}"
        counts = tr("{verified} verified of {candidates} candidates", verified=len(pair.matches), candidates=pair.candidates)  # fmt: skip
        return f"{names}\n{counts}" + (f"\n{tr(pair.reason)}" if pair.reason else "")
