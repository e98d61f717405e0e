"""Edges and nodes of the image graph, and how each is painted."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPalette, QPen

from graphos_core.data.record import Array
from graphos_py.theme import theme
from graphos_py.views.painting import plate

THINNEST, THICKEST = 1.4, 7.0


@dataclass(frozen=True)
class Edge:
    """A verified pair: row of the pair, its photos, its matches, and whether the graph falls apart without it."""

    pair: int
    a: int
    b: int
    matches: int
    weak: bool = False


def paint_edge(
    painter: QPainter, edge: Edge, at: Array, look: tuple[QColor, float], marked: bool = False
) -> None:
    """Paint an edge between nodes at (n, 2), in a colour and as thick as its share of the strongest pair.

    A weak one lies on broad dashes, the marked one on a broad line.
    """
    a, b = QPointF(*at[edge.a].tolist()), QPointF(*at[edge.b].tolist())
    colour, share = look
    width = THINNEST + (THICKEST - THINNEST) * share
    if edge.weak or marked:
        style = Qt.PenStyle.SolidLine if marked else Qt.PenStyle.DashLine
        painter.setPen(QPen(theme().colour("accent" if marked else "bad"), width + 5.0, style))
        painter.drawLine(a, b)
    painter.setPen(QPen(colour, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    painter.drawLine(a, b)


def paint_node(
    painter: QPainter,
    box: QRectF,
    index: int,
    picture: QImage | None,
    palette: QPalette,
    *,
    chosen: bool,
    cut: bool,
) -> None:
    """Paint a photo with its number; the chosen one framed, one that holds the block together framed by dashes."""
    if picture is not None:
        painter.drawImage(box, picture)
    else:
        painter.fillRect(box, palette.color(QPalette.ColorRole.Button))
    colour = theme().colour("accent" if chosen else "bad" if cut else "border")
    style = Qt.PenStyle.DashLine if cut and not chosen else Qt.PenStyle.SolidLine
    painter.setPen(QPen(colour, 3.0 if chosen or cut else 1.0, style))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRect(box)
    number, metrics = str(index + 1), painter.fontMetrics()
    label = QRectF(box.left(), box.top(), metrics.horizontalAdvance(number) + 8, metrics.height())
    plate(painter, label, palette)
    painter.drawText(label, Qt.AlignmentFlag.AlignCenter, number)
