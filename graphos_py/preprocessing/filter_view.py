"""A photo before and after its filters: a divider that can be dragged, or both side by side; only pieces are filtered."""

from __future__ import annotations

from typing import Literal

import cv2
import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QContextMenuEvent, QImage, QMouseEvent, QPainter, QPalette, QPen
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from graphos_core.data.record import Array
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_core.preprocessing.preview import Piece, Region
from graphos_core.rendering.colour_maps import colour_table, colours_of_values
from graphos_py.fields import QuietCombo
from graphos_py.translation import tr
from graphos_py.views.colour_legend import paint_legend
from graphos_py.views.export import Writer, export_menu, image_from_array, write_png, write_svg
from graphos_py.views.painting import plate
from graphos_py.views.pixel_canvas import PixelCanvas

Look = Literal["photo", "contrast", "false"]
LOOKS: dict[Look, str] = {
    "photo": "Photo",
    "contrast": "Local standard deviation",
    "false": "False colours of the grey value",
}
CONTRAST_WINDOW = 21
"""Window of the local standard deviation, pixels as seen."""
MOST_CONTRAST = 80.0
GRIP = 7.0


def seen_as(image: Array, look: Look) -> Array:
    """Return uint8 (h, w) or (h, w, 3) as it is looked at: as it is, its local contrast, or in false colours."""
    if look == "photo":
        return image
    grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    if look == "false":
        return colour_table("viridis")[grey]
    from graphos_core.preprocessing.wallis import local_statistics

    _, std = local_statistics(np.ascontiguousarray(grey), CONTRAST_WINDOW)
    return colours_of_values(std, 0.0, MOST_CONTRAST)


class FilterView(QWidget):
    """Two canvases on one photo; the second is only seen side by side.

    Signals
    -------
    piece_wanted()
        Another part or size of the photo is seen.
    """

    piece_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.look: Look = "photo"
        self.side_by_side = False
        self._pieces: list[Piece] = []
        self._images: list[tuple[QImage | None, QImage]] = []
        self.filtered = False
        self._moving_divider = False
        self._following = False
        self.canvas, self.other = PixelCanvas(self), PixelCanvas(self)
        self.canvas.empty = (
            tr("Here you will see a photo before and after its filters"), tr("Choose a photo below.")
        )  # fmt: skip
        self.canvas.split = 0.5
        self.canvas.layers = [self._paint_first]
        self.other.layers = [self._paint_second]
        self.other.hide()
        self._position, self._state = QLabel(), QLabel()
        self._state.setAlignment(Qt.AlignmentFlag.AlignRight)
        pictures = QHBoxLayout()
        pictures.setSpacing(2)
        pictures.addWidget(self.canvas, 1)
        pictures.addWidget(self.other, 1)
        footer = QHBoxLayout()
        footer.setContentsMargins(8, 2, 8, 2)
        footer.addWidget(self._position)
        footer.addWidget(self._state, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addLayout(self._controls())
        column.addLayout(pictures, 1)
        column.addLayout(footer)
        self.setFocusProxy(self.canvas)
        self.canvas.installEventFilter(self)
        for canvas, twin in ((self.canvas, self.other), (self.other, self.canvas)):
            canvas.cursor_moved.connect(self._tell_position)
            canvas.view_changed.connect(lambda canvas=canvas, twin=twin: self._moved(canvas, twin))

    def _controls(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(8, 4, 8, 4)
        row.setSpacing(4)
        self.ways = QButtonGroup(self)
        for number, label in enumerate(("Wipe", "Side by side")):
            button = QToolButton()
            button.setText(tr(label))
            button.setCheckable(True)
            button.setChecked(number == 0)
            self.ways.addButton(button, number)
            row.addWidget(button)
        self.ways.idClicked.connect(lambda number: self.set_side_by_side(number == 1))
        row.addSpacing(16)
        row.addWidget(QLabel(tr("Look at")))
        self.looks = QuietCombo()
        for look, label in LOOKS.items():
            self.looks.addItem(tr(label), look)
        self.looks.setSizeAdjustPolicy(QuietCombo.SizeAdjustPolicy.AdjustToContents)
        self.looks.setMinimumContentsLength(max(len(tr(label)) for label in LOOKS.values()))
        self.looks.activated.connect(lambda index: self.set_look(self.looks.itemData(index)))
        row.addWidget(self.looks)
        row.addStretch(1)
        self.honest = QLabel()
        self.honest.setProperty("role", "caption")
        row.addWidget(self.honest)
        return row

    # what is shown

    def set_photo(self, before: Array | None) -> None:
        """Show another photo, uint8; what was filtered is forgotten."""
        self._pieces, self._images = [], []
        self.honest.setText("")
        self.canvas.set_array(before)
        self.other.share(self.canvas)
        self._write_state()

    def show_pieces(self, pieces: list[Piece], filtered: bool) -> None:
        """Show pieces on top of the photo, coarse ones first; `filtered` is False for a chain without filters."""
        self.filtered = filtered
        self._pieces = pieces
        self._paint_pieces()
        last = pieces[-1].why if pieces and filtered else ""
        self.honest.setText(tr(last) if filtered else tr("no filter: the photo as it is"))
        self.honest.setToolTip(tr("What is exact in the filtered picture."))

    def set_look(self, look: Look) -> None:
        """Look at the photo, its local standard deviation, or false colours."""
        self.look = look
        self.looks.setCurrentIndex(self.looks.findData(look))
        self._paint_pieces()

    def set_side_by_side(self, on: bool) -> None:
        """Show both beside each other instead of a divider."""
        self.side_by_side = on
        button = self.ways.button(1 if on else 0)
        button.setChecked(True)
        self.other.setVisible(on)
        self.canvas.fit()
        self._moved(self.canvas, self.other)

    def seen(self) -> tuple[Region, int] | None:
        """Return the part of the photo that is seen, and by how much it is reduced; None without a photo."""
        width, height = self.canvas.image_size
        part = self.canvas.visible()
        if not width or part.isEmpty():
            return None
        region = Region(
            max(0, int(part.left())), max(0, int(part.top())),
            min(width, int(part.right()) + 1), min(height, int(part.bottom()) + 1),
        )  # fmt: skip
        factor, scale = 1, self.canvas.zoom * self.devicePixelRatioF()
        while scale * factor * 2 <= 1.001:
            factor *= 2
        return region, factor

    def piece_seen(self) -> Piece | None:
        """Return the piece shown last, whose pixels are those of the histogram."""
        return self._pieces[-1] if self._pieces else None

    # painting

    def _paint_pieces(self) -> None:
        always = self.look != "photo"
        self._images = [
            (
                image_from_array(seen_as(piece.before, self.look)) if always else None,
                image_from_array(seen_as(piece.after, self.look)),
            )
            for piece in self._pieces
        ]
        self.canvas.update()
        self.other.update()

    def _draw(self, painter: QPainter, canvas: PixelCanvas, after: bool) -> None:
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, canvas.zoom < 1.999)
        for piece, images in zip(self._pieces, self._images):
            image = images[1] if after else images[0]
            if image is not None:
                r = piece.region
                target = QRectF(
                    canvas.left + r.left * canvas.zoom, canvas.top + r.top * canvas.zoom,
                    (r.right - r.left) * canvas.zoom, (r.bottom - r.top) * canvas.zoom,
                )  # fmt: skip
                painter.drawImage(target, image)

    def _paint_first(self, painter: QPainter) -> None:
        area = QRectF(self.canvas.rect())
        self._draw(painter, self.canvas, after=False)
        if not self.side_by_side and self.filtered:
            x = self.canvas.split_position()
            painter.save()
            painter.setClipRect(QRectF(x, 0, max(area.width() - x, 0.0), area.height()))
            self._draw(painter, self.canvas, after=True)
            painter.restore()
            self._paint_divider(painter, x)
            self._caption(painter, tr("before"), x - 12, right=True)
            self._caption(painter, tr("after"), x + 12)
        elif self.filtered:
            self._caption(painter, tr("before"), 12)
        if not self.side_by_side:
            self._legend(painter, area)

    def _paint_second(self, painter: QPainter) -> None:
        if self.filtered:
            self._draw(painter, self.other, after=True)
        else:
            self._draw(painter, self.other, after=False)
        self._caption(painter, tr("after"), 12)
        self._legend(painter, QRectF(self.other.rect()))

    def _legend(self, painter: QPainter, area: QRectF) -> None:
        if self.look == "contrast":
            paint_legend(
                painter,
                area,
                self.palette(),
                0.0,
                MOST_CONTRAST,
                tr("local standard deviation"),
                tr("grey level"),
            )
        elif self.look == "false":
            paint_legend(painter, area, self.palette(), 0.0, 255.0, tr("grey value"), "")

    def _caption(self, painter: QPainter, text: str, x: float, right: bool = False) -> None:
        wide = painter.fontMetrics().horizontalAdvance(text) + 16
        box = QRectF(x - wide if right else x, 12, wide, painter.fontMetrics().height() + 6)
        plate(painter, box, self.palette())
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_divider(self, painter: QPainter, x: float) -> None:
        accent = self.palette().color(QPalette.ColorRole.Highlight)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for colour, width in ((QColor(255, 255, 255), 4), (accent, 2)):
            painter.setPen(QPen(colour, width))
            painter.drawLine(QPointF(x, 0), QPointF(x, self.canvas.height()))
        painter.setBrush(accent)
        painter.setPen(QPen(QColor(255, 255, 255), 2))
        middle = QPointF(x, self.canvas.height() / 2)
        painter.drawEllipse(middle, 11, 11)
        for sign in (-1, 1):
            tip = middle + QPointF(6 * sign, 0)
            painter.drawLine(tip, tip + QPointF(-3 * sign, -3))
            painter.drawLine(tip, tip + QPointF(-3 * sign, 3))

    # reacting

    def _moved(self, canvas: PixelCanvas, twin: PixelCanvas) -> None:
        if self._following:
            return
        if self.side_by_side:
            self._following = True
            x, y = canvas.to_image(0.5 * canvas.width(), 0.5 * canvas.height())
            twin.focus_on(x, y, canvas.zoom)
            self._following = False
        self._write_state()
        self.piece_wanted.emit()

    def _tell_position(self, x: float, y: float) -> None:
        width, height = self.canvas.image_size
        if not (-0.5 <= x < width - 0.5 and -0.5 <= y < height - 0.5) or self.canvas.array is None:
            self._position.setText("")
            return
        column, row = int(x + 0.5), int(y + 0.5)
        text = f"x {x:.1f}   y {y:.1f}{THIN_SPACE}px      {_value(self.canvas.array[row, column])}"
        piece = self.piece_seen()
        if piece is not None and self.filtered:
            r = piece.region
            if r.left <= column < r.right and r.top <= row < r.bottom:
                i = min((row - r.top) // piece.factor, piece.after.shape[0] - 1)
                j = min((column - r.left) // piece.factor, piece.after.shape[1] - 1)
                text += f"  →  {_value(piece.after[i, j])}"
        self._position.setText(text)

    def _write_state(self) -> None:
        width, height = self.canvas.image_size
        zoom = format_value(self.canvas.zoom * 100, digits=3)
        self._state.setText(f"{width} × {height}{THIN_SPACE}px      {zoom}{THIN_SPACE}%" if width else "")

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let the divider be dragged."""
        if self.side_by_side or not self.filtered or not isinstance(event, QMouseEvent):
            return super().eventFilter(watched, event)
        near = abs(event.position().x() - self.canvas.split_position()) <= GRIP
        kind = event.type()
        if kind == QEvent.Type.MouseButtonPress and near:
            self._moving_divider = True
            return True
        if kind == QEvent.Type.MouseButtonRelease and self._moving_divider:
            self._moving_divider = False
            return True
        if kind == QEvent.Type.MouseMove:
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
        return {
            "png": lambda path: write_png(self.canvas, path),
            "svg": lambda path: write_svg(self.canvas, path),
        }


def _value(value: Array) -> str:
    values = np.atleast_1d(value)
    return (tr("RGB") if len(values) == 3 else tr("grey")) + " " + " ".join(str(int(v)) for v in values)
