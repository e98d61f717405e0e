"""The surface that every picture is shown on: zoom at the cursor, pan, crisp pixels, layers painted on top.

Image coordinates have the centre of the top-left pixel at (0, 0); screen coordinates are the widget's logical px.
"""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from graphos_core.data.record import Array
from graphos_py.views.export import image_from_array
from graphos_py.views.painting import paint_empty_state

Layer = Callable[[QPainter], None]
LARGEST_ZOOM = 64.0
DRAG_STARTS = 4.0


class PixelCanvas(QWidget):
    """A picture that can be zoomed to its pixels.

    Signals
    -------
    cursor_moved(x, y)
        Image coordinates under the cursor, px; NaN when the cursor leaves.
    clicked(x, y)
        Left click without drag, image coordinates.
    view_changed()
        Zoom or position changed.
    """

    cursor_moved = Signal(float, float)
    clicked = Signal(float, float)
    view_changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.zoom = 1.0
        self.left = 0.0
        self.top = 0.0
        self.array: Array | None = None
        self.layers: list[Layer] = []
        self.empty = ("", "")
        self._levels: list[QImage] = []
        self._second: list[QImage] = []
        self.split: float | None = None
        self._fitted = True
        self._pressed: QPointF | None = None
        self._last = QPointF()
        self._dragging = False
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(80, 80)

    # picture

    def set_array(self, image: Array | None, keep_view: bool = False) -> None:
        """Show uint8 (h, w) or (h, w, 3) RGB; None empties. `keep_view` keeps zoom and position."""
        same = image is not None and self.array is not None and image.shape[:2] == self.array.shape[:2]
        self.array = image
        self._levels = [] if image is None else _levels(image)
        self._second = []
        if not (keep_view and same):
            self.fit()
        self.update()

    def share(self, other: PixelCanvas) -> None:
        """Show the picture of another canvas, kept once for both."""
        self.array, self._levels, self._second = other.array, other._levels, []
        self.fit()

    def set_second(self, image: Array | None) -> None:
        """Show another picture of the same size right of the divider at `split` (share of the width)."""
        self._second = [] if image is None else _levels(image)
        self.update()

    @property
    def fitted(self) -> bool:
        """Whether the whole picture is shown as large as it goes, and stays so when the size changes."""
        return self._fitted

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height of the picture, px; (0, 0) when empty."""
        return (0, 0) if self.array is None else (self.array.shape[1], self.array.shape[0])

    # coordinates

    def to_screen(self, xy: Array) -> Array:
        """Return screen positions (n, 2) of image positions (n, 2)."""
        return (np.asarray(xy, dtype=np.float64).reshape(-1, 2) + 0.5) * self.zoom + [self.left, self.top]

    def to_image(self, x: float, y: float) -> tuple[float, float]:
        """Return the image position of a screen position."""
        return (x - self.left) / self.zoom - 0.5, (y - self.top) / self.zoom - 0.5

    def visible(self) -> QRectF:
        """Return the part of the picture that is seen: image px counted from the outer edge of the picture."""
        width, height = self.image_size
        seen = QRectF(
            -self.left / self.zoom, -self.top / self.zoom, self.width() / self.zoom, self.height() / self.zoom
        )
        return seen.intersected(QRectF(0, 0, width, height))

    # view

    def fit(self) -> None:
        """Show the whole picture."""
        width, height = self.image_size
        if width and height:
            self.zoom = min(self.width() / width, self.height() / height, LARGEST_ZOOM)
            self.left = 0.5 * (self.width() - width * self.zoom)
            self.top = 0.5 * (self.height() - height * self.zoom)
        self._changed(fitted=True)

    def zoom_at(self, x: float, y: float, factor: float) -> None:
        """Zoom by `factor`; what is under the screen position (x, y) stays there."""
        smallest = min(0.5 * self._fit_zoom(), 1.0)
        zoom = min(max(self.zoom * factor, smallest), LARGEST_ZOOM)
        self.left = x - (x - self.left) * zoom / self.zoom
        self.top = y - (y - self.top) * zoom / self.zoom
        self.zoom = zoom
        self._changed()

    def focus_on(self, x: float, y: float, zoom: float | None = None) -> None:
        """Bring the image position (x, y) to the middle, at `zoom` or as it is."""
        self.zoom = min(max(zoom or self.zoom, 1e-3), LARGEST_ZOOM)
        self.left = 0.5 * self.width() - (x + 0.5) * self.zoom
        self.top = 0.5 * self.height() - (y + 0.5) * self.zoom
        self._changed()

    def pan(self, x: float, y: float) -> None:
        """Move the picture by (x, y) screen px."""
        self.left += x
        self.top += y
        self._changed()

    def _fit_zoom(self) -> float:
        width, height = self.image_size
        return min(self.width() / width, self.height() / height) if width and height else 1.0

    def _changed(self, fitted: bool = False) -> None:
        self._fitted = fitted
        if not fitted and self.array is not None:  # never lose the picture out of sight
            width, height = self.image_size
            margin = 40.0
            self.left = min(max(self.left, margin - width * self.zoom), self.width() - margin)
            self.top = min(max(self.top, margin - height * self.zoom), self.height() - margin)
        self.update()
        self.view_changed.emit()

    # painting

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint picture and layers."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Base))
        if not self._levels:
            paint_empty_state(painter, self.rect(), self.palette(), *self.empty)
            return
        split = None if self.split is None or not self._second else self.split_position()
        self._draw(painter, self._levels, None if split is None else (0.0, split))
        if split is not None:
            self._draw(painter, self._second, (split, float(self.width())))
        for layer in self.layers:
            painter.save()
            layer(painter)
            painter.restore()

    def split_position(self) -> float:
        """Return the screen x of the divider."""
        return self.left + (self.split or 0.0) * self.image_size[0] * self.zoom

    def _draw(self, painter: QPainter, levels: list[QImage], between: tuple[float, float] | None) -> None:
        painter.save()
        if between is not None:
            painter.setClipRect(QRectF(between[0], 0, between[1] - between[0], self.height()))
        ratio = self.devicePixelRatioF()
        level = min(max(int(-np.log2(self.zoom * ratio) + 0.01), 0), len(levels) - 1)
        image = levels[level]
        width, height = self.image_size
        sx, sy = image.width() / width, image.height() / height
        seen = self.visible()
        whole = QRectF(  # whole pixels, else they would be cut at the border of the widget
            np.floor(seen.x() * sx), np.floor(seen.y() * sy),
            np.ceil(seen.width() * sx) + 1, np.ceil(seen.height() * sy) + 1,
        ).intersected(QRectF(0, 0, image.width(), image.height()))  # fmt: skip
        target = QRectF(
            self.left + whole.x() / sx * self.zoom, self.top + whole.y() / sy * self.zoom,
            whole.width() / sx * self.zoom, whole.height() / sy * self.zoom,
        )  # fmt: skip
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, self.zoom * ratio < 1.999)
        painter.drawImage(target, image, whole)
        if self.zoom >= 24:
            self._draw_grid(painter, seen)
        painter.restore()

    def _draw_grid(self, painter: QPainter, seen: QRectF) -> None:
        painter.setPen(QColor(128, 128, 128, 70))
        for column in range(int(seen.left()), int(seen.right()) + 2):
            x = self.left + column * self.zoom
            painter.drawLine(
                QPointF(x, self.top + seen.top() * self.zoom),
                QPointF(x, self.top + seen.bottom() * self.zoom),
            )
        for row in range(int(seen.top()), int(seen.bottom()) + 2):
            y = self.top + row * self.zoom
            painter.drawLine(
                QPointF(self.left + seen.left() * self.zoom, y),
                QPointF(self.left + seen.right() * self.zoom, y),
            )

    # people

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the whole picture in sight, or the same picture position in the middle."""
        if self._fitted:
            self.fit()
        else:
            old = event.oldSize()
            self.pan(0.5 * (self.width() - old.width()), 0.5 * (self.height() - old.height()))

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom at the cursor."""
        if self.array is None:
            return
        position = event.position()
        self.zoom_at(position.x(), position.y(), 1.0015 ** event.angleDelta().y())
        event.accept()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a click or a drag."""
        if event.button() in (Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton):
            self._pressed = self._last = event.position()
            self._dragging = False

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Pan while dragging; tell the position under the cursor."""
        position = event.position()
        if self._pressed is not None and self.array is not None:
            if not self._dragging and (position - self._pressed).manhattanLength() > DRAG_STARTS:
                self._dragging = True
                self.setCursor(Qt.CursorShape.ClosedHandCursor)
            if self._dragging:
                self.pan(position.x() - self._last.x(), position.y() - self._last.y())
                self._last = position
        if self.array is not None:
            self.cursor_moved.emit(*self.to_image(position.x(), position.y()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End a drag, or tell a click."""
        clicked = self._pressed is not None and not self._dragging and self.array is not None
        if clicked and event.button() == Qt.MouseButton.LeftButton:
            self.clicked.emit(*self.to_image(event.position().x(), event.position().y()))
        if self._dragging:
            self.unsetCursor()
        self._pressed = None
        self._dragging = False

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Bring the place under the cursor to the middle, larger."""
        if self.array is not None and event.button() == Qt.MouseButton.LeftButton:
            x, y = self.to_image(event.position().x(), event.position().y())
            self.focus_on(x, y, max(2.0 * self.zoom, 1.0))

    def leaveEvent(self, event: object) -> None:
        """Tell that there is no position under the cursor."""
        self.cursor_moved.emit(float("nan"), float("nan"))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """F fits, 1 shows one px per px, + and − zoom, arrows pan."""
        middle = (0.5 * self.width(), 0.5 * self.height())
        step = 0.1 * min(self.width(), self.height())
        key = event.key()
        pans = {
            Qt.Key.Key_Left: (step, 0.0), Qt.Key.Key_Right: (-step, 0.0),
            Qt.Key.Key_Up: (0.0, step), Qt.Key.Key_Down: (0.0, -step),
        }  # fmt: skip
        if key == Qt.Key.Key_F:
            self.fit()
        elif key == Qt.Key.Key_1:
            self.zoom_at(*middle, 1.0 / self.zoom)
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal):
            self.zoom_at(*middle, 1.25)
        elif key == Qt.Key.Key_Minus:
            self.zoom_at(*middle, 0.8)
        elif key in pans:
            self.pan(*pans[Qt.Key(key)])
        else:
            super().keyPressEvent(event)


def _levels(image: Array) -> list[QImage]:
    """Return the picture and its halves by area averages, so that a small view does not flicker."""
    levels = [image_from_array(image)]
    small = image
    while min(small.shape[:2]) > 256:
        small = cv2.resize(
            small, (max(small.shape[1] // 2, 1), max(small.shape[0] // 2, 1)), interpolation=cv2.INTER_AREA
        )
        levels.append(image_from_array(small))
    return levels
