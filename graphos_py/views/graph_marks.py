"""Edges and nodes of the image graph, and how each is painted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPalette, QPen, QPolygonF

from graphos_core.data.record import Array
from graphos_py.theme import theme
from graphos_py.views.painting import plate

THINNEST, THICKEST = 1.4, 7.0
MOST_BENT, STRIP, BOW_POINTS = 0.2, 0.35, 17
"""Bend of the edges of photos in one line, relative width from which a strip is none, points of a bow."""


@dataclass(frozen=True)
class Edge:
    """A verified pair: row of the pair, its photos, its matches, and whether the graph falls apart without it."""

    pair: int
    a: int
    b: int
    matches: int
    weak: bool = False


def bend_of(places: Array) -> float:
    """Return how far edges bow out, as a share of their length: photos in a strip would hide each other's edges."""
    if len(places) < 3:
        return 0.0
    extent = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    return float(MOST_BENT * max(0.0, 1.0 - extent[1] / max(STRIP * extent[0], 1e-12)))


def bowed(start: Array, end: Array, bend: float) -> Array:
    """Return points (…, k, 2) of the bows from places (…, 2) to places (…, 2); straight for a bend of 0."""
    share = np.linspace(0.0, 1.0, BOW_POINTS)[:, None]
    along = (end - start)[..., None, :]
    aside = np.stack([along[..., 1], -along[..., 0]], axis=-1)
    return np.asarray(start[..., None, :] + share * along + 4.0 * bend * share * (1.0 - share) * aside)


def paint_edge(
    painter: QPainter, edge: Edge, bow: Array, look: tuple[QColor, float], marked: bool = False
) -> None:
    """Paint an edge along points (k, 2), in a colour and as thick as its share of the strongest pair.

    A weak one lies on broad dashes, the marked one on a broad line.
    """
    line = QPolygonF([QPointF(x, y) for x, y in bow.tolist()])
    colour, share = look
    width = THINNEST + (THICKEST - THINNEST) * share
    if edge.weak or marked:
        style = Qt.PenStyle.SolidLine if marked else Qt.PenStyle.DashLine
        painter.setPen(QPen(theme().colour("accent" if marked else "bad"), width + 5.0, style))
        painter.drawPolyline(line)
    painter.setPen(QPen(colour, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    painter.drawPolyline(line)


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
