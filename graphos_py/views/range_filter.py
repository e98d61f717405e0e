"""A histogram between whose two handles values pass: how many there are, how many are let through."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QLabel, QVBoxLayout, QWidget

from graphos_core.data.record import Array
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.painting import quiet_text

BINS = 60
STEPS = 1000
"""Steps of a handle from one end to the other."""
SPREAD = 20.0
"""Values over a wider range than this get a logarithmic axis."""


class HistogramStrip(QWidget):
    """The bars and the two handles; positions are shares of the axis from 0 to 1.

    Signals
    -------
    dragged(handle, share)
        Handle 0 or 1.
    """

    dragged = Signal(int, float)

    def __init__(self) -> None:
        super().__init__()
        self.counts: Array = np.zeros(0)
        self.shares = [0.0, 1.0]
        self._held = -1
        self.setMouseTracking(True)
        self.setMinimumWidth(120)

    def sizeHint(self) -> QSize:
        """Ask for a low strip."""
        return QSize(240, theme().px(40))

    def minimumSizeHint(self) -> QSize:
        """Do not become lower."""
        return QSize(120, theme().px(34))

    def _span(self) -> tuple[float, float]:
        return 7.0, max(self.width() - 14.0, 1.0)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint bars, those let through in the accent colour, and the handles."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        left, width = self._span()
        floor = self.height() - 3.0
        accent = self.palette().color(QPalette.ColorRole.Highlight)
        quiet = QColor(quiet_text(self.palette()))
        quiet.setAlpha(110)
        high = math.sqrt(float(self.counts.max())) if len(self.counts) and self.counts.max() > 0 else 1.0
        step = width / max(len(self.counts), 1)
        for i, count in enumerate(self.counts.tolist()):
            if count:
                tall = max((floor - 4.0) * math.sqrt(count) / high, 1.5)
                middle = (i + 0.5) / len(self.counts)
                inside = self.shares[0] <= middle <= self.shares[1]
                painter.fillRect(
                    QRectF(left + i * step, floor - tall, max(step - 1, 1), tall), accent if inside else quiet
                )
        painter.setPen(QPen(quiet_text(self.palette()), 1))
        painter.drawLine(QPointF(left, floor), QPointF(left + width, floor))
        for share in self.shares:
            x = left + share * width
            painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Text), 1.6))
            painter.drawLine(QPointF(x, 1), QPointF(x, floor))
            painter.setBrush(self.palette().color(QPalette.ColorRole.Base))
            painter.drawEllipse(QPointF(x, floor - 4), 5.0, 5.0)

    def _share_at(self, x: float) -> float:
        left, width = self._span()
        return min(max((x - left) / width, 0.0), 1.0)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the nearer handle."""
        share = self._share_at(event.position().x())
        distance = [abs(share - at) for at in self.shares]
        above = share > 0.5 * (self.shares[0] + self.shares[1])
        self._held = int(above) if distance[0] == distance[1] else int(distance[1] < distance[0])
        self.dragged.emit(self._held, share)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the handle that is held."""
        if self._held >= 0:
            self.dragged.emit(self._held, self._share_at(event.position().x()))
        self.setCursor(Qt.CursorShape.SizeHorCursor)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go."""
        self._held = -1


class RangeFilter(QWidget):
    """A named figure with its histogram and the range that passes, by dragging or by typing.

    Signals
    -------
    changed()
        The range was changed by the person.
    """

    changed = Signal()

    def __init__(self, label: str, unit: str = "") -> None:
        super().__init__()
        self.label, self.unit = label, unit
        self._values: Array = np.zeros(0)
        self._ends = (0.0, 1.0)
        self._log = False
        self.low, self.high = 0.0, 1.0
        self.text = QLabel()
        self.text.setProperty("role", "caption")
        self.strip = HistogramStrip()
        self.strip.dragged.connect(self._dragged)
        self.strip.setToolTip(tr("Drag the two handles, or type the values below."))
        self.boxes = (QDoubleSpinBox(), QDoubleSpinBox())
        row = QHBoxLayout()
        row.setContentsMargins(0, 0, 0, 0)
        for handle, (box, what) in enumerate(zip(self.boxes, (tr("least"), tr("largest")))):
            box.setAccessibleName(f"{label}: {what}")
            box.setKeyboardTracking(False)
            box.setSuffix(f"{THIN_SPACE}{unit}" if unit else "")
            box.valueChanged.connect(lambda value, h=handle: self._typed(h, value))
        row.addWidget(self.boxes[0])
        row.addStretch(1)
        row.addWidget(self.boxes[1])
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 2, 8, 2)
        column.setSpacing(2)
        column.addWidget(self.text)
        column.addWidget(self.strip)
        column.addLayout(row)
        self.set_values(np.zeros(0))

    def set_values(self, values: Array) -> None:
        """Show other values; the range opens to all of them. Emits nothing."""
        values = np.asarray(values, np.float64)
        self._values = values
        finite = values[np.isfinite(values)]
        low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
        self._log = low > 0 and high > SPREAD * low
        self._ends = (low, high if high > low else low + 1.0)
        decimals = int(np.clip(2 - math.floor(math.log10(max(abs(low), (high - low) / 100, 1e-9))), 0, 6))
        edges = self._value_at(np.linspace(0.0, 1.0, BINS + 1))
        edges[0], edges[-1] = self._ends
        self.strip.counts = np.histogram(finite, bins=edges)[0] if len(finite) else np.zeros(0)
        scale = 10.0**decimals  # the boxes hold round numbers that leave no value out
        self.low, self.high = self._ends
        for box, value in zip(self.boxes, (math.floor(low * scale) / scale, math.ceil(high * scale) / scale)):
            box.blockSignals(True)
            box.setDecimals(decimals)
            box.setRange(math.floor(low * scale) / scale, math.ceil(self._ends[1] * scale) / scale)
            box.setSingleStep((self._ends[1] - self._ends[0]) / 100)
            box.setValue(value)
            box.blockSignals(False)
            box.setEnabled(len(finite) > 0)
        self._refresh()

    def reset(self) -> None:
        """Let everything through again."""
        self.set_values(self._values)
        self.changed.emit()

    @property
    def passing(self) -> Array:
        """Which values lie in the range, bool (n,)."""
        return np.asarray((self._values >= self.low) & (self._values <= self.high))

    @property
    def is_open(self) -> bool:
        """Whether everything passes."""
        return (self.low, self.high) == self._ends

    def _value_at(self, share: Array) -> Array:
        low, high = self._ends
        if self._log:
            return np.asarray(low * (high / low) ** share)
        return np.asarray(low + (high - low) * share)

    def _share_of(self, value: float) -> float:
        low, high = self._ends
        share = math.log(value / low) / math.log(high / low) if self._log else (value - low) / (high - low)
        return min(max(share, 0.0), 1.0)

    def _dragged(self, handle: int, share: float) -> None:
        value = self._ends[handle] if share in (0.0, 1.0) and round(share) == handle else float(
            self._value_at(np.array(round(share * STEPS) / STEPS)))  # fmt: skip
        self._set(handle, value)
        box = self.boxes[handle]
        box.blockSignals(True)
        box.setValue(self.high if handle else self.low)
        box.blockSignals(False)

    def _typed(self, handle: int, value: float) -> None:
        box = self.boxes[handle]
        at_end = value <= box.minimum() if handle == 0 else value >= box.maximum()
        self._set(handle, self._ends[handle] if at_end else value)

    def _set(self, handle: int, value: float) -> None:
        value = min(max(value, self._ends[0]), self._ends[1])
        if handle == 0:
            self.low = min(value, self.high)
        else:
            self.high = max(value, self.low)
        self._refresh()
        self.changed.emit()

    def _refresh(self) -> None:
        self.strip.shares = [self._share_of(self.low), self._share_of(self.high)]
        count, total = int(self.passing.sum()), len(self._values)
        said = tr("{label}  {n} / {all}", label=self.label, n=format_value(count), all=format_value(total))
        self.text.setText(said)
        self.strip.setAccessibleName(said)
        self.strip.update()
