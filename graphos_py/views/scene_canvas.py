"""A canvas on Qt's painter: implements `graphos_didactic.scene_drawing.Canvas`."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import (
    QBrush,
    QColor,
    QFont,
    QFontMetricsF,
    QImage,
    QPainter,
    QPainterPath,
    QPen,
    QPolygonF,
)

from graphos_core.data.record import Array
from graphos_didactic.formula_outline import Outline
from graphos_didactic.scene_drawing import Horizontal, Vertical
from graphos_didactic.scene_layout import Box
from graphos_didactic.scene_svg import finite_parts

if TYPE_CHECKING:
    from graphos_didactic.scene_drawing import Canvas

_FAR = 1e5
"""Positions further away than this, px, are drawn here."""
_LONG = 60
"""Curves of more points are drawn piece by piece: as one stroke a noisy curve takes a hundred times longer."""


class QtCanvas:
    """A canvas that draws with a `QPainter`.

    Parameters
    ----------
    painter : QPainter
        Active.
    font : QFont
        Family of all texts.
    """

    _paths: OrderedDict[int, tuple[Outline, QPainterPath]] = OrderedDict()

    def __init__(self, painter: QPainter, font: QFont) -> None:
        self._painter = painter
        self._font = font
        self._metrics: dict[tuple[float, bool], tuple[QFont, QFontMetricsF]] = {}
        painter.setRenderHints(
            QPainter.RenderHint.Antialiasing
            | QPainter.RenderHint.TextAntialiasing
            | QPainter.RenderHint.SmoothPixmapTransform
        )

    def polyline(self, xy: Array, colour: str, width: float, dash: tuple[float, ...]) -> None:
        """Draw an open line; where a coordinate is NaN it is interrupted."""
        long = len(xy) > _LONG
        pen = _pen(colour, width, () if long else dash)
        if long and dash:
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        self._painter.setPen(pen)
        self._painter.setBrush(Qt.BrushStyle.NoBrush)
        for part in finite_parts(np.asarray(xy)):
            if long:
                self._painter.drawLines(_lines(dashes(np.clip(part, -_FAR, _FAR), dash)))
            else:
                self._painter.drawPolyline(_polygon(part))

    def polygon(
        self,
        xy: Array,
        fill: str,
        opacity: float,
        colour: str = "",
        width: float = 0.0,
        dash: tuple[float, ...] = (),
    ) -> None:
        """Draw a closed polygon."""
        if not np.isfinite(xy).all():
            return
        paint = QColor(fill)
        paint.setAlphaF(opacity)
        self._painter.setBrush(QBrush(paint))
        self._painter.setPen(_pen(colour, width, dash) if colour and width else QPen(Qt.PenStyle.NoPen))
        self._painter.drawPolygon(_polygon(xy))

    def discs(self, xy: Array, radius: float, fill: str, colour: str, width: float) -> None:
        """Draw a circle at every position."""
        self._painter.setPen(_pen(colour, width, ()) if width else QPen(Qt.PenStyle.NoPen))
        self._painter.setBrush(QBrush(QColor(fill)) if fill else QBrush(Qt.BrushStyle.NoBrush))
        for x, y in np.clip(xy[np.isfinite(xy).all(axis=1)], -_FAR, _FAR):
            self._painter.drawEllipse(QPointF(x, y), radius, radius)

    def text(
        self,
        at: tuple[float, float],
        text: str,
        size: float,
        colour: str,
        horizontal: Horizontal = "left",
        vertical: Vertical = "baseline",
        bold: bool = False,
        upright: bool = True,
    ) -> None:
        """Write a text; not `upright` reads from bottom to top and is centred on its position."""
        font, metrics = self._measure(size, bold)
        self._painter.setFont(font)
        self._painter.setPen(QPen(QColor(colour)))
        width = metrics.horizontalAdvance(text)
        x = {"left": 0.0, "centre": -width / 2, "right": -width}[horizontal]
        y = {"baseline": 0.0, "middle": 0.35 * size, "top": 0.8 * size}[vertical]
        if upright:
            self._painter.drawText(QPointF(at[0] + x, at[1] + y), text)
            return
        self._painter.save()
        self._painter.translate(*at)
        self._painter.rotate(-90)
        self._painter.drawText(QPointF(x, y), text)
        self._painter.restore()

    def text_width(self, text: str, size: float, bold: bool = False) -> float:
        """Return the width of a text, px."""
        return self._measure(size, bold)[1].horizontalAdvance(text)

    def outline(self, outline: Outline, at: tuple[float, float], scale: float, colour: str) -> None:
        """Draw a formula."""
        self._painter.save()
        self._painter.translate(*at)
        self._painter.scale(scale, -scale)
        self._painter.setPen(QPen(Qt.PenStyle.NoPen))
        self._painter.setBrush(QBrush(QColor(colour)))
        self._painter.drawPath(self._path(outline))
        self._painter.restore()

    def picture(self, pixels: Array, box: Box) -> None:
        """Draw an image; magnified pixels stay visible as squares."""
        stored = np.ascontiguousarray(pixels)
        height, width = stored.shape[:2]
        form = QImage.Format.Format_Grayscale8 if stored.ndim == 2 else QImage.Format.Format_RGB888
        image = QImage(stored.data, width, height, stored.strides[0], form)
        smooth = bool(box[2] < 6 * width)
        self._painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, smooth)
        self._painter.drawImage(QRectF(*box), image)

    def clip(self, box: Box) -> None:
        """Show only what lies in `box` until `unclip`."""
        self._painter.save()
        self._painter.setClipRect(QRectF(*box), Qt.ClipOperation.IntersectClip)

    def unclip(self) -> None:
        """End the last `clip`."""
        self._painter.restore()

    def _measure(self, size: float, bold: bool) -> tuple[QFont, QFontMetricsF]:
        key = (round(size, 2), bold)
        if key not in self._metrics:
            font = QFont(self._font)
            font.setPixelSize(max(6, round(size)))
            font.setWeight(QFont.Weight.DemiBold if bold else QFont.Weight.Normal)
            self._metrics[key] = font, QFontMetricsF(font)
        return self._metrics[key]

    def _path(self, outline: Outline) -> QPainterPath:
        known = self._paths.get(id(outline))
        if known is None or known[0] is not outline:
            known = outline, _painter_path(outline)
            self._paths[id(outline)] = known
            while len(self._paths) > 300:
                self._paths.popitem(last=False)
        return known[1]


def _pen(colour: str, width: float, dash: tuple[float, ...]) -> QPen:
    pen = QPen(QColor(colour), width)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    if dash:
        pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        pen.setDashPattern([max(part / max(width, 0.1), 0.1) for part in dash])
    return pen


def _polygon(xy: Array) -> QPolygonF:
    return QPolygonF([QPointF(x, y) for x, y in np.clip(xy, -_FAR, _FAR).tolist()])


def dashes(xy: Array, dash: tuple[float, ...]) -> Array:
    """Return the straight pieces of a dashed curve, float (k, 4) as x1, y1, x2, y2; of a solid one all its pieces.

    Parameters
    ----------
    xy : float (n, 2)
    dash : tuple of float
        Lengths of dash, gap, dash, gap …; empty for a solid curve.
    """
    xy = np.asarray(xy, dtype=float)
    if not dash or len(xy) < 2:
        return np.hstack([xy[:-1], xy[1:]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(xy, axis=0).T))])
    ends = np.cumsum(dash)
    rounds = np.arange(np.ceil(along[-1] / ends[-1])) * ends[-1]
    cuts = (rounds[:, None] + ends).ravel()
    places = np.unique(np.concatenate([along, cuts[cuts < along[-1]]]))
    x, y = np.interp(places, along, xy[:, 0]), np.interp(places, along, xy[:, 1])
    middle = (places[:-1] + places[1:]) / 2 % ends[-1]
    drawn = np.searchsorted(ends, middle, side="right") % 2 == 0
    return np.stack([x[:-1], y[:-1], x[1:], y[1:]], axis=1)[drawn]


def _lines(pieces: Array) -> list[QLineF]:
    return [QLineF(*piece) for piece in pieces.tolist()]


def _painter_path(outline: Outline) -> QPainterPath:
    path = QPainterPath()
    path.setFillRule(Qt.FillRule.WindingFill)
    places = [QPointF(x, y) for x, y in outline.vertices.tolist()]
    i = 0
    while i < len(outline.codes):
        match int(outline.codes[i]):
            case 1:
                path.moveTo(places[i])
            case 2:
                path.lineTo(places[i])
            case 3:
                path.quadTo(places[i], places[i + 1])
                i += 1
            case 4:
                path.cubicTo(places[i], places[i + 1], places[i + 2])
                i += 2
            case _:
                path.closeSubpath()
        i += 1
    return path


def _is_canvas(canvas: QtCanvas) -> Canvas:
    """Let the type checker prove that `QtCanvas` implements the protocol."""
    return canvas
