"""A figure that the engine drew, fitted into the view; drawn again when the theme changes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QRectF, QSize
from PySide6.QtGui import QContextMenuEvent, QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from graphos_py.theme import theme
from graphos_py.views.background import Background
from graphos_py.views.export import Writer, export_menu
from graphos_py.views.painting import paint_empty_state

DPI = 160
"""Fine enough for a projector at twice the size."""

Drawing = Callable[[bool], Any]
"""Makes the figure, a matplotlib figure, for a dark paper or a light one."""


class FigureView(QWidget):
    """Shows a figure as large as it fits."""

    def __init__(self, title: str, hint: str, alt: str) -> None:
        super().__init__()
        self.setObjectName("figure")
        self.setAccessibleName(alt)
        self._empty = (title, hint)
        self._draw: Drawing | None = None
        self._image = QImage()
        self._background = Background(self)
        theme().changed.connect(self._redraw)

    def show_figure(self, draw: Drawing | None) -> None:
        """Show what `draw` makes, or the empty state."""
        self._draw = draw
        if draw is None:
            self._image = QImage()
            self.update()
        else:
            self._redraw()

    @property
    def image(self) -> QImage:
        """What is shown; null while there is nothing."""
        return self._image

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        if self._draw is None:
            return {}
        figure = self._draw(False)  # on white paper, whatever the theme is
        return {"png": partial(_write_png, figure), "svg": partial(_write_svg, figure)}

    def sizeHint(self) -> QSize:
        """Ask for a wide strip."""
        return QSize(720, 320)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer copy and exports."""
        export_menu(self, self.exports()).exec(event.globalPos())

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the figure in the middle, or the empty state."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), theme().colour("base"))
        if self._image.isNull():
            paint_empty_state(painter, self.rect(), self.palette(), *self._empty)
            return
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        factor = min(self.width() / self._image.width(), self.height() / self._image.height())
        width, height = self._image.width() * factor, self._image.height() * factor
        painter.drawImage(
            QRectF((self.width() - width) / 2, (self.height() - height) / 2, width, height), self._image
        )

    def _redraw(self) -> None:
        draw, dark = self._draw, theme().name == "dark"
        if draw is not None:
            self._background.run(
                lambda: _png(draw(dark)), lambda found: self._take(draw, found), lane="figures"
            )

    def _take(self, draw: Drawing, found: Any) -> None:
        if draw is self._draw and isinstance(found, bytes):
            self._image = QImage.fromData(found)
            self.update()


def _png(figure: Any) -> bytes:
    from graphos_core.calibration_pictures import png_bytes

    return png_bytes(figure, dpi=DPI)


def _write_png(figure: Any, path: Path) -> None:
    path.write_bytes(_png(figure))


def _write_svg(figure: Any, path: Path) -> None:
    figure.savefig(path, format="svg", metadata={"Date": None})
