"""A row of small patches with what is said about each; one can be chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QImage, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from graphos_core.data.record import Array
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.export import image_from_array
from graphos_py.views.painting import quiet_text


@dataclass(frozen=True)
class Patch:
    """One picture of the row, grey 0 to 255 (s, s) or None, and two lines of text below it."""

    pixels: Array | None
    lines: tuple[str, str]
    marked: bool = False


class PatchStrip(QWidget):
    """Patches side by side.

    Signals
    -------
    chosen(index)
    """

    chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.patches: tuple[Patch, ...] = ()
        self.selected = -1
        self.empty = ""
        self._images: list[QImage | None] = []
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        theme().changed.connect(self.updateGeometry)

    def set_patches(self, patches: Sequence[Patch], selected: int = 0, empty: str = "") -> None:
        """Show patches; `empty` is said where there are none. Emits nothing."""
        self.patches, self.empty = tuple(patches), empty
        self.selected = selected if patches else -1
        self._images = [
            None
            if p.pixels is None
            else image_from_array(np.clip(np.rint(p.pixels), 0, 255).astype(np.uint8))
            for p in patches
        ]
        self.setAccessibleName(
            tr("Nearest neighbours") + ": " + "; ".join(", ".join(p.lines) for p in patches)
        )
        self.update()

    def sizeHint(self) -> QSize:
        """Ask for a row of patches of 64 px with two lines."""
        return QSize(500, 64 + 2 * self.fontMetrics().height() + 12)

    def minimumSizeHint(self) -> QSize:
        """Keep the row."""
        return QSize(300, self.sizeHint().height())

    @property
    def in_sight(self) -> int:
        """How many patches there is room for with their texts."""
        return min(len(self.patches), max(1, int(self.width() // (self._widest + 12))))

    @property
    def _widest(self) -> int:
        texts = [text for patch in self.patches for text in patch.lines]
        return max((self.fontMetrics().horizontalAdvance(text) for text in texts), default=0)

    def _box(self, index: int) -> QRectF:
        step = min(self.width() / max(self.in_sight, 1), max(150.0, self._widest + 12.0))
        return QRectF(index * step + 4, 2, step - 8, self.height() - 4)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the row."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if not self.patches:
            painter.setPen(quiet_text(self.palette()))
            wrap = int(Qt.TextFlag.TextWordWrap) | int(Qt.AlignmentFlag.AlignCenter)
            painter.drawText(self.rect().adjusted(8, 0, -8, 0), wrap, self.empty)
            return
        for index, patch in enumerate(self.patches[: self.in_sight]):
            self._paint(painter, self._box(index), index, patch)

    def _paint(self, painter: QPainter, box: QRectF, index: int, patch: Patch) -> None:
        chosen = index == self.selected
        if chosen:
            painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Highlight), 2))
            painter.setBrush(theme().colour("selected"))
            painter.drawRoundedRect(box, 4, 4)
            painter.setBrush(Qt.BrushStyle.NoBrush)
        high = self.fontMetrics().height()
        side = min(box.width() - 8, box.height() - 2 * high - 8)
        place = QRectF(box.center().x() - side / 2, box.top() + 4, side, side)
        image = self._images[index]
        if image is not None:
            painter.drawImage(place, image)
        painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Mid), 1))
        painter.drawRect(place)
        for row, text in enumerate(patch.lines):
            painter.setPen(
                self.palette().color(QPalette.ColorRole.Text) if row == 0 else quiet_text(self.palette())
            )
            line = QRectF(box.left(), place.bottom() + 2 + row * high, box.width(), high)
            shown = painter.fontMetrics().elidedText(text, Qt.TextElideMode.ElideRight, int(line.width()))
            painter.drawText(line, Qt.AlignmentFlag.AlignHCenter, shown)
        if patch.marked:
            painter.setPen(QPen(theme().colour("good"), 2.5))
            painter.drawRect(place.adjusted(1, 1, -1, -1))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose the patch under the cursor."""
        for index in range(self.in_sight):
            if self._box(index).contains(event.position()):
                self._choose(index)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Left and right go through the patches."""
        step = {Qt.Key.Key_Right: 1, Qt.Key.Key_Left: -1}.get(Qt.Key(event.key()), 0)
        if step and self.patches:
            self._choose(min(max(self.selected + step, 0), self.in_sight - 1))
        else:
            super().keyPressEvent(event)

    def _choose(self, index: int) -> None:
        self.selected = index
        self.update()
        self.chosen.emit(index)
