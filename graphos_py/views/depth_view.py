"""Depths, or any figure per pixel, in colour with a legend."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QEvent, QRectF, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QPainter
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget

from graphos_core.data.record import Array
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_core.rendering.colour_maps import colours_of_values
from graphos_py.views.colour_legend import paint_legend
from graphos_py.views.export import Writer, export_menu, write_csv, write_png, write_svg
from graphos_py.views.painting import is_dark
from graphos_py.views.pixel_canvas import PixelCanvas


class DepthView(QWidget):
    """A map of figures: perceptual colours, diverging ones for signed figures, grey where unknown.

    Signals
    -------
    cursor_moved(x, y), clicked(x, y)
        Position in the map, px.
    """

    cursor_moved = Signal(float, float)
    clicked = Signal(float, float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("depth")
        self.values: Array | None = None
        self.range = (0.0, 1.0)
        self.unit = ""
        self.title = self.tr("Depth")
        self.table = "viridis"
        self.canvas = PixelCanvas(self)
        self.canvas.empty = (
            self.tr("Here you will see how far away every pixel is"),
            self.tr("Run dense matching, then choose a photo."),
        )
        self.canvas.layers = [self._paint_legend]
        self._position, self._state = QLabel(), QLabel()
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
        self.canvas.cursor_moved.connect(self._on_cursor)
        self.canvas.clicked.connect(self.clicked)

    def set_depth(
        self,
        values: Array | None,
        unit: str = "model units",
        title: str = "",
        signed: bool = False,
        limits: tuple[float, float] | None = None,
    ) -> None:
        """Show a map.

        Parameters
        ----------
        values : float (h, w) or None
            NaN where unknown; None empties the view.
        unit : str
        title : str
            What the figures are; "Depth" if empty.
        signed : bool
            Diverging colours with zero in the middle.
        limits : (low, high) or None
            Figures that get the ends of the map; None takes the 1 % and 99 % quantiles.
        """
        keep = self.values is not None and values is not None and self.values.shape == values.shape
        self.values = None if values is None else np.asarray(values)
        self.unit, self.title = unit, title or self.tr("Depth")
        self.table = "diverging" if signed else "viridis"
        self.range = limits or self._quantiles(signed)
        self.canvas.set_array(self.picture(), keep_view=keep)
        self._position.setText("")
        self._write_state()

    def picture(self) -> Array | None:
        """Return the map in colour, uint8 (h, w, 3)."""
        if self.values is None:
            return None
        missing = (70, 70, 70) if is_dark(self.palette()) else (190, 190, 190)
        return colours_of_values(self.values, *self.range, self.table, missing)

    def _quantiles(self, signed: bool) -> tuple[float, float]:
        known = np.zeros(0) if self.values is None else self.values[np.isfinite(self.values)]
        if not known.size:
            return 0.0, 1.0
        known = known[:: max(known.size // 500_000, 1)]
        if signed:
            high = float(np.quantile(np.abs(known), 0.99)) or 1.0
            return -high, high
        low, high = (float(v) for v in np.quantile(known, [0.01, 0.99]))
        return (low, high) if high > low else (low - 0.5, high + 0.5)

    def readout(self, x: float, y: float) -> str:
        """Return position and figure for people."""
        width, height = self.canvas.image_size
        if self.values is None or not (-0.5 <= x < width - 0.5 and -0.5 <= y < height - 0.5):
            return ""
        value = float(self.values[math.floor(y + 0.5), math.floor(x + 0.5)])
        shown = format_value(value, unit=self.unit) if math.isfinite(value) else self.tr("unknown")
        return f"x {x:.1f}   y {y:.1f}{THIN_SPACE}px      {self.title} {shown}"

    def _on_cursor(self, x: float, y: float) -> None:
        self._position.setText(self.readout(x, y))
        self.cursor_moved.emit(x, y)

    def _write_state(self) -> None:
        if self.values is None:
            self._state.setText("")
            return
        share = format_value(100.0 * float(np.isfinite(self.values).mean()), digits=3, unit="%")
        width, height = self.canvas.image_size
        self._state.setText(
            self.tr("{share} known").format(share=share) + f"      {width} × {height}{THIN_SPACE}px"
        )

    def changeEvent(self, event: QEvent) -> None:
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self.values is not None:
            self.canvas.set_array(self.picture(), keep_view=True)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        writers: dict[str, Writer] = {
            "png": lambda path: write_png(self.canvas, path),
            "svg": lambda path: write_svg(self.canvas, path),
        }
        if self.values is not None:
            values = self.values
            columns = [f"{self.title} [{self.unit}] x={x}" for x in range(values.shape[1])]
            writers["csv"] = lambda path: write_csv(path, columns, values.tolist())
        return writers

    def _paint_legend(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        area = QRectF(self.canvas.rect())
        paint_legend(painter, area, self.palette(), *self.range, self.title, self.unit, self.table)
        painter.setPen(Qt.PenStyle.NoPen)
