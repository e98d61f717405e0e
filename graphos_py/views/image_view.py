"""A photo with its keypoints, residuals, and a comparison before and after."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QContextMenuEvent, QMouseEvent, QPainter, QPalette, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget

from graphos_core.data.features import Features
from graphos_core.data.record import Array
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_py.views.export import Writer, export_menu, write_csv, write_png, write_svg
from graphos_py.views.keypoint_layer import KeypointLayer
from graphos_py.views.painting import plate
from graphos_py.views.pixel_canvas import PixelCanvas
from graphos_py.views.vector_layer import VectorLayer

GRIP = 7.0


class ImageView(QWidget):
    """One photo: zoom to the pixel, read values, see keypoints and residual vectors, compare two versions.

    A view that is small is `brief` in the line below the photo.

    Signals
    -------
    cursor_moved(x, y)
        Image position under the cursor, px; NaN outside.
    clicked(x, y)
        Image position of a click, px.
    keypoint_selected(index)
        Index of the keypoint that was clicked; −1 for none.
    """

    cursor_moved = Signal(float, float)
    clicked = Signal(float, float)
    keypoint_selected = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("image")
        self.canvas = PixelCanvas(self)
        self.canvas.empty = (
            self.tr("Here you will see a photo, down to its pixels"),
            self.tr("Choose a photo below, or drop photos into the window."),
        )
        self.keypoints = KeypointLayer(self.canvas)
        self.vectors = VectorLayer(self.canvas)
        self.canvas.layers = [self.keypoints.paint, self.vectors.paint, self._paint_divider]
        self.brief = False
        self._captions = ("", "")
        self._after: Array | None = None
        self._moving_divider = False
        self._cursor = (math.nan, math.nan)
        self._position = QLabel()
        self._state = QLabel()
        self._state.setAlignment(Qt.AlignmentFlag.AlignRight)
        footer = QHBoxLayout()
        footer.setContentsMargins(8, 2, 8, 2)
        footer.addWidget(self._position, 1)
        footer.addWidget(self._state)
        box = QVBoxLayout(self)
        box.setContentsMargins(0, 0, 0, 0)
        box.setSpacing(0)
        box.addWidget(self.canvas, 1)
        box.addLayout(footer)
        self.setFocusProxy(self.canvas)
        self.canvas.installEventFilter(self)
        self.canvas.cursor_moved.connect(self._on_cursor)
        self.canvas.clicked.connect(self._on_click)
        self.canvas.view_changed.connect(self._write_state)
        self._write_state()

    # what is shown

    def set_image(self, image: Array | None, keep_view: bool = False) -> None:
        """Show uint8 (h, w) or (h, w, 3) RGB and remove everything drawn on the last photo.

        Parameters
        ----------
        image : uint8 (h, w) or (h, w, 3), or None
            None empties the view.
        keep_view : bool
            Keep zoom and position if the size is the same.
        """
        self._after = None
        self.canvas.split = None
        self.keypoints.set_features(None)
        self.vectors.clear()
        self.canvas.set_array(image, keep_view)
        self._on_cursor(*self._cursor)
        self._write_state()

    def set_empty_text(self, title: str, hint: str) -> None:
        """Say in two lines what will be shown here and what to do next."""
        self.canvas.empty = (title, hint)
        self.canvas.update()

    def set_keypoints(
        self, features: Features | None, shown: Array | None = None, marked: Array | None = None
    ) -> None:
        """Draw keypoints: a circle of their scale and a line of their orientation; None removes them.

        `shown` and `marked`, bool (n,), say which are seen and which of these are told from the others.
        """
        self.keypoints.set_features(features, shown, marked)
        self._write_state()

    def filter_keypoints(self, shown: Array | None, marked: Array | None = None) -> None:
        """Show some of the keypoints, see `set_keypoints`; the selected one stays selected."""
        self.keypoints.filter(shown, marked)
        self._write_state()

    def select_keypoint(self, index: int) -> None:
        """Highlight keypoint `index`; −1 for none. Emits nothing."""
        self.keypoints.selected = index
        self.canvas.update()
        self._write_state()

    def show_keypoint(self, index: int) -> None:
        """Highlight keypoint `index` and bring it into sight. Emits nothing."""
        self.select_keypoint(index)
        place = self.keypoints.place(index)
        if place is not None and not self.canvas.visible().contains(QPointF(*place)):
            self.canvas.focus_on(*place)

    def set_overlay(
        self,
        points: Array | None = None,
        vectors: Array | None = None,
        exaggeration: float | None = None,
        label: str = "",
        names: list[str] | None = None,
    ) -> None:
        """Draw points and, from them, vectors such as residuals.

        Parameters
        ----------
        points : float (n, 2) or None
            Image positions, px; None removes the overlay.
        vectors : float (n, 2) or None
            px of the image, drawn `exaggeration` times as long; a legend says so.
        exaggeration : float or None
            None chooses a round number that shows the typical vector at some 30 px.
        label : str
            What the vectors are: ``"residual"``.
        names : list of str or None
            Written beside the points.
        """
        self.vectors.set(points, vectors, exaggeration, label or self.tr("vector"), names)

    def compare(self, before: Array, after: Array, captions: tuple[str, str] | None = None) -> None:
        """Show two versions of one photo with a divider that can be dragged."""
        keep = before.shape[:2] == (self.canvas.array.shape[:2] if self.canvas.array is not None else None)
        split = self.canvas.split
        if after.shape[:2] != before.shape[:2]:
            raise ValueError(f"compare: sizes {before.shape[:2]} and {after.shape[:2]} differ")
        self.set_image(before, keep_view=keep)
        self._captions = captions or (self.tr("before"), self.tr("after"))
        self._after = after
        self.canvas.split = 0.5 if split is None else split
        self.canvas.set_second(after)

    # numbers

    def _on_cursor(self, x: float, y: float) -> None:
        self._cursor = (x, y)
        self._position.setText(self.readout(x, y))
        self.cursor_moved.emit(x, y)

    def readout(self, x: float, y: float) -> str:
        """Return position and value at an image position, for people."""
        width, height = self.canvas.image_size
        if not (-0.5 <= x < width - 0.5 and -0.5 <= y < height - 0.5):
            return ""
        column, row = math.floor(x + 0.5), math.floor(y + 0.5)
        text = f"x {x:.1f}   y {y:.1f}{THIN_SPACE}px      {_value(self.canvas.array, row, column)}"
        if self._after is not None:
            text += f"  →  {_value(self._after, row, column)}"
        return text

    def _write_state(self) -> None:
        parts = []
        if self.keypoints.selected >= 0 and not self.brief:
            parts.append(self.keypoints.describe(self.keypoints.selected))
        if self.keypoints.count:
            parts.append(self.tr("{n} keypoints").format(n=format_value(self.keypoints.count)))
        width, height = self.canvas.image_size
        if width and not self.brief:
            parts.append(f"{width} × {height}{THIN_SPACE}px")
            parts.append(f"{format_value(self.canvas.zoom * 100, digits=3)}{THIN_SPACE}%")
        self._state.setText("      ".join(parts))

    # people

    def _on_click(self, x: float, y: float) -> None:
        if self.keypoints.count:
            self.select_keypoint(self.keypoints.nearest(x, y))
            self.keypoint_selected.emit(self.keypoints.selected)
        self.clicked.emit(x, y)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let the divider be dragged."""
        if self._after is None or not isinstance(event, QMouseEvent):
            return super().eventFilter(watched, event)
        near = abs(event.position().x() - self.canvas.split_position()) <= GRIP
        if event.type() == QEvent.Type.MouseButtonPress and near:
            self._moving_divider = True
            return True
        if event.type() == QEvent.Type.MouseButtonRelease and self._moving_divider:
            self._moving_divider = False
            return True
        if event.type() == QEvent.Type.MouseMove:
            if self._moving_divider:
                x, _ = self.canvas.to_image(event.position().x(), 0.0)
                self.canvas.split = min(max((x + 0.5) / self.canvas.image_size[0], 0.0), 1.0)
                self.canvas.update()
                return True
            if not event.buttons():
                self.canvas.setCursor(Qt.CursorShape.SplitHCursor if near else Qt.CursorShape.ArrowCursor)
        return super().eventFilter(watched, event)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        writers: dict[str, Writer] = {
            "png": lambda path: write_png(self.canvas, path),
            "svg": lambda path: write_svg(self.canvas, path),
        }
        if self.keypoints.count:
            header, rows = self.keypoints.table()
            writers["csv"] = lambda path: write_csv(path, header, rows)
        return writers

    # painting

    def _paint_divider(self, painter: QPainter) -> None:
        if self._after is None:
            return
        x = self.canvas.split_position()
        accent = self.palette().color(QPalette.ColorRole.Highlight)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(255, 255, 255), 4))
        painter.drawLine(QPointF(x, 0), QPointF(x, self.canvas.height()))
        painter.setPen(QPen(accent, 2))
        painter.drawLine(QPointF(x, 0), QPointF(x, self.canvas.height()))
        painter.setBrush(accent)
        painter.setPen(QPen(QColor(255, 255, 255), 2))
        middle = QPointF(x, self.canvas.height() / 2)
        painter.drawEllipse(middle, 11, 11)
        for sign in (-1, 1):
            tip = middle + QPointF(6 * sign, 0)
            painter.drawLine(tip, tip + QPointF(-3 * sign, -3))
            painter.drawLine(tip, tip + QPointF(-3 * sign, 3))
        for text, right in zip(self._captions, (True, False)):
            wide = painter.fontMetrics().horizontalAdvance(text) + 16
            box = QRectF(x - wide - 12 if right else x + 12, 12, wide, painter.fontMetrics().height() + 6)
            plate(painter, box, self.palette())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def _value(image: Array | None, row: int, column: int) -> str:
    if image is None:
        return ""
    value = np.atleast_1d(image[row, column])
    return ("RGB " if len(value) == 3 else "grey ") + " ".join(str(int(v)) for v in value)
