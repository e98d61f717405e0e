"""What lies over both photos of a pair: lines, points, the highlighted match, the epipolar line, texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPalette, QPen, QResizeEvent
from PySide6.QtWidgets import QWidget

from graphos_core.data.record import Array
from graphos_py.views.colour_legend import paint_legend
from graphos_py.views.match_colours import TABLE
from graphos_py.views.painting import plate

if TYPE_CHECKING:
    from graphos_py.views.match_view import MatchView

LINES_AT_MOST = 120
POINTS_AT_MOST = 600
SHIFT = 4
ONE = 1 << SHIFT


class MatchOverlay(QWidget):
    """Transparent, and lets the mouse through to the photos."""

    def __init__(self, view: MatchView, photos: QWidget) -> None:
        super().__init__(photos)
        self.view = view
        self.lines_drawn = 0
        self._cache: QImage | None = None
        self._cache_key: object = None
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        photos.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Stay as large as the photos."""
        if isinstance(event, QResizeEvent):
            self.resize(event.size())
            self.raise_()
        return False

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint matches, the highlighted one, the epipolar curve, names and legend."""
        if self.view.canvases[0].array is None or self.view.canvases[1].array is None:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_matches(painter)
        self._paint_curve(painter)
        for index in {self.view.hovered, self.view.selected}:
            if 0 <= index < len(self.view.xy[0]):
                self._paint_highlight(painter, index)
        self._paint_texts(painter)

    def _paint_texts(self, painter: QPainter) -> None:
        for canvas, name in zip(self.view.canvases, self.view.names):
            if name:
                metrics = painter.fontMetrics()
                box = QRectF(
                    canvas.x() + 10,
                    canvas.y() + 10,
                    metrics.horizontalAdvance(name) + 16,
                    metrics.height() + 6,
                )
                plate(painter, box, self.palette())
                painter.drawText(box, Qt.AlignmentFlag.AlignCenter, name)
        said = self.view.colouring
        if said.values is not None and len(said.values):
            area = QRectF(0, 0, self.width(), self.height())
            paint_legend(painter, area, self.palette(), said.low, said.high, said.title, said.unit, TABLE)

    def _paint_matches(self, painter: QPainter) -> None:
        """Paint all points and, evenly chosen, as many lines as can be told apart; kept until the view changes."""
        ratio = self.devicePixelRatioF()
        views = [(c.zoom, c.left, c.top, c.x(), c.y(), c.width(), c.height()) for c in self.view.canvases]
        key = (tuple(views), ratio, len(self.view.xy[0]), id(self.view.colours), self.view.lines)
        if key != self._cache_key or self._cache is None:
            self._cache = self._picture(ratio)
            self._cache_key = key
        painter.setOpacity(0.65 if self.view.selected >= 0 or self.view.hovered >= 0 else 1.0)
        painter.drawImage(QPointF(0, 0), self._cache)
        painter.setOpacity(1.0)

    def _picture(self, ratio: float) -> QImage:
        """Return lines and points over nothing, premultiplied; by OpenCV, which is faster than a painter."""
        both = [self.view.screen_positions(side) for side in (0, 1)]
        inside = [self._in_sight(side, positions) for side, positions in enumerate(both)]
        kept = np.ones(len(both[0]), bool) if self.view.kept is None else self.view.kept
        linked = _evenly(
            np.flatnonzero(inside[0] & inside[1] & kept), LINES_AT_MOST if self.view.lines else 0
        )
        self.lines_drawn = len(linked)
        width, height = (max(round(side * ratio), 1) for side in (self.width(), self.height()))
        ink = np.zeros((height, width, 4), np.uint8)
        colours = [(c.blue(), c.green(), c.red(), 255) for c in self.view.colours]
        fixed = [np.round((np.clip(p, -1e4, 1e4) * ratio - 0.5) * ONE).astype(int) for p in both]
        thin, thick = max(round(1.3 * ratio), 1), max(round(3.0 * ratio), 3)
        for index in linked.tolist():
            ends = (fixed[0][index].tolist(), fixed[1][index].tolist())
            cv2.line(ink, *ends, (0, 0, 0, 150), thick, cv2.LINE_AA, SHIFT)
            cv2.line(ink, *ends, colours[index], thin, cv2.LINE_AA, SHIFT)
        for positions, seen in zip(fixed, inside):
            order = [*_evenly(np.flatnonzero(seen & ~kept), POINTS_AT_MOST).tolist(),
                     *_evenly(np.flatnonzero(seen & kept), POINTS_AT_MOST).tolist()]  # fmt: skip
            for index in order:
                rings = (
                    ((2.7, (0, 0, 0, 190)), (1.8, colours[index]))
                    if kept[index]
                    else ((1.3, colours[index]),)
                )
                for radius, colour in rings:
                    size = round(radius * ratio * ONE)
                    cv2.circle(ink, positions[index].tolist(), size, colour, -1, cv2.LINE_AA, SHIFT)
        picture = QImage(ink.data, width, height, 4 * width, QImage.Format.Format_ARGB32_Premultiplied).copy()
        picture.setDevicePixelRatio(ratio)
        return picture

    def _in_sight(self, side: int, positions: Array) -> Array:
        area = self.view.canvases[side].geometry()
        low, high = [area.left(), area.top()], [area.right() + 1, area.bottom() + 1]
        return np.asarray(((positions >= low) & (positions <= high)).all(axis=1))

    def _paint_highlight(self, painter: QPainter, index: int) -> None:
        a, b = (QPointF(*self.view.screen_positions(side)[index].tolist()) for side in (0, 1))
        accent = self.palette().color(QPalette.ColorRole.Highlight)
        for colour, width in ((QColor(255, 255, 255), 4.5), (accent, 2.5)):
            painter.setPen(QPen(colour, width))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawLine(a, b)
            painter.drawEllipse(a, 7, 7)
            painter.drawEllipse(b, 7, 7)

    def _paint_curve(self, painter: QPainter) -> None:
        """Paint the curve of the point under the cursor in the other photo, and the one it lies on in its own."""
        curve = self.view.curve
        if self.view.pointed is None or curve is None:
            return
        side, x, y = self.view.pointed
        points = _finite(curve(side, x, y))
        if not len(points):
            return
        geometry = self.view.pair_geometry
        if geometry is not None and geometry.mapped:
            self._paint_cross(painter, 1 - side, points[0])
            return
        self._paint_line(painter, 1 - side, points)
        width, height = self.view.canvases[1 - side].image_size
        middle = points[np.argmin(((points - [0.5 * width, 0.5 * height]) ** 2).sum(axis=1))]
        self._paint_line(painter, side, _finite(curve(1 - side, float(middle[0]), float(middle[1]))), 0.55)

    def _paint_line(self, painter: QPainter, side: int, points: Array, opacity: float = 1.0) -> None:
        canvas = self.view.canvases[side]
        painter.save()
        painter.setClipRect(canvas.geometry())
        painter.setOpacity(opacity)
        moved = canvas.to_screen(points) + np.array([canvas.x(), canvas.y()])
        line = [QPointF(*p) for p in np.clip(moved, -1e5, 1e5).tolist()]
        for colour, width in ((QColor(0, 0, 0, 160), 4.0), (QColor(255, 221, 51), 2.0)):
            painter.setPen(QPen(colour, width))
            painter.drawPolyline(line)
        painter.restore()

    def _paint_cross(self, painter: QPainter, side: int, point: Array) -> None:
        """Paint where a homography maps the point under the cursor."""
        canvas = self.view.canvases[side]
        x, y = (canvas.to_screen(point)[0] + np.array([canvas.x(), canvas.y()])).tolist()
        painter.save()
        painter.setClipRect(canvas.geometry())
        for colour, width in ((QColor(0, 0, 0, 160), 4.0), (QColor(255, 221, 51), 2.0)):
            painter.setPen(QPen(colour, width))
            painter.drawLine(QPointF(x - 12, y), QPointF(x + 12, y))
            painter.drawLine(QPointF(x, y - 12), QPointF(x, y + 12))
        painter.restore()

    def refresh(self) -> None:
        """Draw the matches anew."""
        self._cache_key = None
        self.update()


def _finite(points: Array) -> Array:
    points = np.asarray(points, np.float64).reshape(-1, 2)
    return points[np.isfinite(points).all(axis=1)]


def _evenly(rows: Array, count: int) -> Array:
    """Return at most `count` of the rows, evenly chosen: more would hide each other."""
    if not count:
        return rows[:0]
    return rows if len(rows) <= count else rows[np.linspace(0, len(rows) - 1, count).astype(int)]
