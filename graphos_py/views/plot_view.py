"""Plots of results: histogram, lines, scatter and bars, with units, in the theme."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QContextMenuEvent, QKeyEvent, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QVBoxLayout, QWidget

from graphos_core.data.record import Array
from graphos_core.number_format import format_value
from graphos_py.views.background import Background
from graphos_py.views.export import Writer, export_menu, write_csv, write_png, write_svg
from graphos_py.views.painting import is_dark, paint_empty_state

LIGHT_SERIES = ("#1f6fc4", "#b35900", "#2b8a57", "#8a3fa0", "#b0303c", "#5d6670")
DARK_SERIES = ("#5aa7f0", "#f0a050", "#5cc48c", "#c58ad8", "#f07a84", "#a7b0b9")

Axes = tuple[str, str, str, str]
"""Label and unit of x, label and unit of y."""


class PlotView(QWidget):
    """One plot at a time; each `show_…` call replaces the last.

    The plotting library is imported in the background by the first call, not with the window.

    Signals
    -------
    point_clicked(index)
        Index of the point of a scatter or line plot that was clicked.
    drawn()
        The plot is on the screen.
    """

    point_clicked = Signal(int)
    drawn = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("plot")
        self.plot: Any = None
        self._header: list[str] = []
        self._columns: list[Array] = []
        self._drawing: Callable[[], None] | None = None
        self._title = ""
        self._background = Background(self)
        self._redraw = QTimer(self)
        self._redraw.setSingleShot(True)
        self._redraw.timeout.connect(self._on_redraw)
        self._empty = (self.tr("Here you will see a plot"), self.tr("Run this step to draw it."))
        self._box = QVBoxLayout(self)
        self._box.setContentsMargins(0, 0, 0, 0)
        self.setMinimumSize(160, 120)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def set_empty_text(self, title: str, hint: str) -> None:
        """Say in two lines what will be shown here and what to do next."""
        self._empty = (title, hint)
        self.update()

    def clear(self) -> None:
        """Show the empty state."""
        self._drawing = None
        self._header, self._columns = [], []
        if self.plot is not None:
            self.plot.hide()
        self.update()

    # plots

    def show_histogram(
        self,
        values: Array,
        label: str,
        unit: str = "",
        bins: int | None = None,
        title: str = "",
        normal: bool = True,
    ) -> None:
        """Show a histogram with mean ± σ, median ± NMAD and the normal curve of the same mean and σ.

        Parameters
        ----------
        values : float (n,)
            Figures that are not finite are left out.
        label, unit : str
            Of the figures.
        bins : int or None
            None follows Freedman and Diaconis (1981).
        """
        values = np.asarray(values, np.float64).ravel()
        values = values[np.isfinite(values)]
        if not len(values):
            self.clear()
            return
        self._show(lambda: self._draw_histogram(values, label, unit, bins, normal), title)

    def _draw_histogram(self, values: Array, label: str, unit: str, bins: int | None, normal: bool) -> None:
        counts, edges = np.histogram(values, bins=bins or _bin_edges(values))
        middle, width = 0.5 * (edges[1:] + edges[:-1]), edges[1] - edges[0]
        pg = _pyqtgraph()
        fill = self._colour(0)
        fill.setAlpha(150)
        self.plot.addItem(
            pg.BarGraphItem(x=middle, height=counts, width=width, brush=fill, pen=self._pen(0, 0.5))
        )
        mean, std = float(values.mean()), float(values.std())
        median = float(np.median(values))
        nmad = 1.4826 * float(np.median(np.abs(values - median)))
        if normal and std > 0:
            x = np.linspace(edges[0], edges[-1], 300)
            density = np.exp(-0.5 * ((x - mean) / std) ** 2) / (std * math.sqrt(2 * math.pi))
            name = self.tr("normal, mean {m}, σ {s}").format(m=_short(mean, unit), s=_short(std, unit))
            self.plot.plot(x, density * len(values) * width, pen=self._pen(1, 2), name=name)
        if nmad > 0:
            name = self.tr("median {m}, ± NMAD {s}").format(m=_short(median, unit), s=_short(nmad, unit))
            self._mark(median, 2, 2.0)
            self._mark(median - nmad, 2, 1.5, dash=True)
            self._mark(median + nmad, 2, 1.5, dash=True)
            self.plot.plot([], [], pen=self._pen(2, 2), name=name)
        self._axes(label, unit, self.tr("count"), "")
        legend = 4.5 * self.fontMetrics().height()  # two lines and their margins stay free
        room = float(np.clip(self.height() / max(self.height() - 1.5 * legend, 1.0), 1.35, 2.2))
        self.plot.setYRange(0.0, room * float(counts.max()), padding=0.0)
        self._keep(
            [f"{label} from [{unit}]", f"{label} to [{unit}]", "count"], [edges[:-1], edges[1:], counts]
        )

    def show_lines(
        self,
        x: Array,
        series: dict[str, Array],
        x_label: str,
        y_label: str,
        x_unit: str = "",
        y_unit: str = "",
        log_y: bool = False,
        title: str = "",
    ) -> None:
        """Show series over x; `log_y` for traces of an iteration, where figures ≤ 0 are left out."""
        x = np.asarray(x, np.float64)
        axes = (x_label, x_unit, y_label, y_unit)
        self._show(lambda: self._draw_lines(x, series, axes, log_y), title)

    def _draw_lines(self, x: Array, series: dict[str, Array], axes: Axes, log_y: bool) -> None:
        self.plot.setLogMode(False, log_y)
        for i, (name, values) in enumerate(series.items()):
            y = np.asarray(values, np.float64)
            y = np.where(y > 0, y, np.nan) if log_y else y
            symbol = "o" if len(x) <= 200 else None
            item = self.plot.plot(
                x, y, pen=self._pen(i, 2), name=name if len(series) > 1 else None, symbol=symbol, symbolSize=6,
                symbolBrush=self._colour(i), symbolPen=None, connect="finite",
            )  # fmt: skip
            item.scatter.sigClicked.connect(self._on_points)
        self._axes(*axes)
        units = [f"{name} [{axes[3]}]" for name in series]
        self._keep([f"{axes[0]} [{axes[1]}]", *units], [x, *(np.asarray(v) for v in series.values())])

    def show_scatter(
        self,
        x: Array,
        y: Array,
        x_label: str,
        y_label: str,
        x_unit: str = "",
        y_unit: str = "",
        equal: bool = False,
        title: str = "",
    ) -> None:
        """Show points; `equal` gives both axes the same scale."""
        x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
        axes = (x_label, x_unit, y_label, y_unit)
        self._show(lambda: self._draw_scatter(x, y, axes, equal), title)

    def _draw_scatter(self, x: Array, y: Array, axes: Axes, equal: bool) -> None:
        colour = self._colour(0)
        colour.setAlpha(230 if len(x) < 500 else 110)
        item = _pyqtgraph().ScatterPlotItem(
            x, y, size=7 if len(x) < 500 else 4, brush=colour, pen=None, hoverable=len(x) < 5000
        )
        item.sigClicked.connect(self._on_points)
        self.plot.addItem(item)
        self.plot.setAspectLocked(equal)
        self._axes(*axes)
        self._keep([f"{axes[0]} [{axes[1]}]", f"{axes[2]} [{axes[3]}]"], [x, y])

    def show_bars(
        self,
        names: Sequence[str],
        values: Array,
        label: str,
        unit: str = "",
        sigmas: Array | None = None,
        title: str = "",
    ) -> None:
        """Show a bar per name, with whiskers of one standard deviation where there are any."""
        heights = np.asarray(values, np.float64)
        self._show(lambda: self._draw_bars(names, heights, label, unit, sigmas), title)

    def _draw_bars(
        self, names: Sequence[str], heights: Array, label: str, unit: str, sigmas: Array | None
    ) -> None:
        pg, x = _pyqtgraph(), np.arange(len(heights), dtype=np.float64)
        self.plot.addItem(pg.BarGraphItem(x=x, height=heights, width=0.7, brush=self._colour(0), pen=None))
        if sigmas is not None:
            whiskers = pg.ErrorBarItem(
                x=x, y=heights, height=2 * np.asarray(sigmas), beam=0.2, pen=self._pen(1, 2)
            )
            self.plot.addItem(whiskers)
        every = max(1, math.ceil(len(names) / 24))
        ticks = [(float(i), name) for i, name in enumerate(names) if i % every == 0]
        self._axes("", "", label, unit)
        self.plot.getAxis("bottom").setTicks([ticks])
        header, columns = ["name", f"{label} [{unit}]"], [np.array(names, dtype=object), heights]
        self._keep(header, columns)

    # theme and export

    def _show(self, draw: Callable[[], None], title: str) -> None:
        """Draw now, or as soon as the plotting library is there."""
        self._drawing, self._title = draw, title
        if plots_ready():
            self.draw_now()
            return
        self.update()
        self._background.run(preload_plots, lambda _: self.draw_now() if plots_ready() else None)

    def draw_now(self) -> None:
        """Draw at once, importing the plotting library if need be, for screenshots."""
        if self._drawing is not None:
            self._start(self._title)
            self._drawing()
            self.drawn.emit()

    def _start(self, title: str) -> None:
        """Begin an empty plot in the present theme."""
        pg = _pyqtgraph()
        if self.plot is None:
            self.plot = pg.PlotWidget(self)
            self.plot.setMenuEnabled(False)
            self.plot.hideButtons()
            self.plot.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            self._box.addWidget(self.plot)
        self.plot.show()
        self.plot.clear()
        self.plot.setLogMode(False, False)
        self.plot.setAspectLocked(False)
        self.plot.getAxis("bottom").setTicks(None)
        palette = self.palette()
        ink = palette.color(QPalette.ColorRole.Text)
        self.plot.setBackground(palette.color(QPalette.ColorRole.Base))
        self.plot.setTitle(title or None, color=ink.name(), size=f"{self.font().pointSizeF() * 1.1:.1f}pt")
        for side in ("left", "bottom"):
            axis = self.plot.getAxis(side)
            # the ranges first: switching it off computes the factor once more where the label is seen, and keeps it
            axis.setSIPrefixEnableRanges(((0.0, 0.0),))
            axis.enableAutoSIPrefix(False)
            axis.setPen(ink)
            axis.setTextPen(ink)
            axis.setTickFont(self.font())
        self.plot.showGrid(x=True, y=True, alpha=0.15)
        item = self.plot.getPlotItem()
        if item.legend is not None:
            item.legend.scene().removeItem(item.legend)
            item.legend = None
        ground = palette.color(QPalette.ColorRole.Base)
        ground.setAlpha(220)
        item.addLegend(
            offset=(-12, 12),
            brush=ground,
            labelTextColor=ink,
            labelTextSize=f"{self.font().pointSizeF():.1f}pt",
        )
        self.plot.enableAutoRange()

    def _axes(self, x_label: str, x_unit: str, y_label: str, y_unit: str) -> None:
        ink = self.palette().color(QPalette.ColorRole.Text).name()
        style = {"color": ink, "font-size": f"{self.font().pointSizeF():.1f}pt"}
        for side, label, unit in (("bottom", x_label, x_unit), ("left", y_label, y_unit)):
            self.plot.setLabel(side, f"{label} [{unit}]" if unit else label, **style)

    def _colour(self, number: int) -> QColor:
        series = DARK_SERIES if is_dark(self.palette()) else LIGHT_SERIES
        return QColor(series[number % len(series)])

    def _pen(self, number: int, width: float, dash: bool = False) -> Any:
        style = Qt.PenStyle.DashLine if dash else Qt.PenStyle.SolidLine
        return _pyqtgraph().mkPen(self._colour(number), width=width, style=style)

    def _mark(self, x: float, number: int, width: float, dash: bool = False) -> None:
        self.plot.addItem(_pyqtgraph().InfiniteLine(x, angle=90, pen=self._pen(number, width, dash)))

    def _keep(self, header: list[str], columns: list[Array]) -> None:
        self._header = [name.replace(" []", "") for name in header]
        self._columns = columns

    def _on_points(self, _item: Any, points: Any, *_: Any) -> None:
        if len(points):
            self.point_clicked.emit(int(points[0].index()))

    def fit(self) -> None:
        """Show everything."""
        if self.plot is not None:
            self.plot.autoRange()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """F fits."""
        if event.key() == Qt.Key.Key_F:
            self.fit()
        else:
            super().keyPressEvent(event)

    def mouseDoubleClickEvent(self, event: object) -> None:
        """Fit."""
        self.fit()

    def changeEvent(self, event: QEvent) -> None:
        """Follow the theme, after Qt has dressed every widget: rebuilding a plot meanwhile brings it down."""
        super().changeEvent(event)
        if (
            event.type() in (QEvent.Type.PaletteChange, QEvent.Type.FontChange)
            and not self._redraw.isActive()
        ):
            self._redraw.start(0)

    def _on_redraw(self) -> None:
        if self._drawing is not None and plots_ready():
            self.draw_now()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        if self._drawing is not None:
            export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        return {
            "png": lambda path: write_png(self, path),
            "svg": lambda path: write_svg(self, path),
            "csv": lambda path: write_csv(path, self._header, self.rows()),
        }

    def rows(self) -> list[tuple[Any, ...]]:
        """Return the figures behind the plot, row by row."""
        return list(zip(*(column.tolist() for column in self._columns)))

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the empty state."""
        if self._drawing is None or not plots_ready():
            waiting = (self.tr("Preparing the plot…"), "")
            painter = QPainter(self)
            painter.fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Base))
            text = self._empty if self._drawing is None else waiting
            paint_empty_state(painter, self.rect(), self.palette(), *text)


def plots_ready() -> bool:
    """Return whether the plotting library is imported."""
    return "pyqtgraph" in sys.modules and hasattr(sys.modules["pyqtgraph"], "PlotWidget")


def preload_plots() -> None:
    """Import the plotting library; the window calls this in a thread after its first paint."""
    _pyqtgraph()


def _pyqtgraph() -> Any:
    import pyqtgraph

    pyqtgraph.setConfigOptions(antialias=True)
    return pyqtgraph


def _short(value: float, unit: str) -> str:
    return format_value(value, digits=2, unit=unit)


def _bin_edges(values: Array) -> Array:
    """Return edges after Freedman and Diaconis (1981) over the central 99.8 %, at most 200 bins."""
    low, q1, q3, high = np.quantile(values, [0.001, 0.25, 0.75, 0.999])
    if high <= low:
        return np.array([low - 0.5, low + 0.5])
    width = 2.0 * (q3 - q1) / len(values) ** (1 / 3) or (high - low) / 50
    count = int(np.clip(math.ceil((high - low) / width), 5, 200))
    return np.linspace(low, high, count + 1)
