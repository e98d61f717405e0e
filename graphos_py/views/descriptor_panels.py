"""The parts a descriptor is drawn in: patch, gradients, fans of histograms, grid of numbers, bits, difference."""

from __future__ import annotations

import math
from collections.abc import Iterator

import cv2
import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPalette, QPen, QPolygonF

from graphos_core.data.record import Array
from graphos_core.rendering.colour_maps import colours_of_values
from graphos_py.views.export import image_from_array
from graphos_py.views.painting import quiet_text

CELLS, DIRECTIONS = 4, 8
ARROWS = 16
"""Gradient arrows along a side of the patch."""
BIT_COLUMNS = 16
GRID_SHARE = 0.42
"""Width of one 16 × 8 grid as a share of the side of a panel."""
LINE = QColor(255, 221, 51)


def paint_patch(painter: QPainter, box: QRectF, patch: Array) -> None:
    """Paint an upright patch, grey 0 to 255, with the borders of its 4 × 4 cells."""
    image = image_from_array(np.clip(np.rint(patch), 0, 255).astype(np.uint8))
    painter.drawImage(box, image)
    _paint_cells(painter, box, QColor(255, 221, 51, 150))


def paint_gradients(
    painter: QPainter, box: QRectF, magnitude: Array, direction: Array, weight: Array
) -> None:
    """Paint the weighted gradients of a patch as arrows, the longest as long as their spacing."""
    painter.fillRect(box, QColor(24, 26, 30))
    size = (ARROWS, ARROWS)
    right, down = (
        cv2.resize(
            (magnitude * weight * part(direction)).astype(np.float32), size, interpolation=cv2.INTER_AREA
        )
        for part in (np.cos, np.sin)
    )
    strength = np.hypot(right, down)
    longest = float(strength.max())
    _paint_cells(painter, box, QColor(255, 255, 255, 60))
    if longest <= 0:
        return
    step = box.width() / ARROWS
    colours = colours_of_values(np.sqrt(strength), 0.0, math.sqrt(longest), "bright viridis")
    for row, column in np.ndindex(ARROWS, ARROWS):
        share = math.sqrt(float(strength[row, column]) / longest)
        if share < 0.05:
            continue
        middle = QPointF(box.left() + (column + 0.5) * step, box.top() + (row + 0.5) * step)
        unit = QPointF(float(right[row, column]), float(down[row, column])) / float(strength[row, column])
        tip = middle + unit * (0.5 * step * share)
        painter.setPen(QPen(QColor(*colours[row, column].tolist()), 1.4))
        painter.drawLine(QLineF(middle - unit * (0.5 * step * share), tip))
        painter.drawEllipse(tip, 0.9, 0.9)


def fan(box: QRectF, row: int, column: int, direction: int, share: float) -> QPolygonF:
    """Return the wedge of a direction of a cell; direction k points 45° k counter-clockwise from the right."""
    side = box.width() / CELLS
    middle = QPointF(box.left() + (column + 0.5) * side, box.top() + (row + 0.5) * side)
    radius = 0.48 * side * share
    turn = direction * math.pi / 4
    ends = [turn - 0.32, turn, turn + 0.32]
    return QPolygonF([middle, *(middle + QPointF(math.cos(a), -math.sin(a)) * radius for a in ends)])


def paint_fans(painter: QPainter, box: QRectF, values: Array, high: float, palette: QPalette) -> None:
    """Paint the histogram of every cell as wedges whose lengths are the numbers (4, 4, 8), `high` the longest."""
    painter.fillRect(box, palette.color(QPalette.ColorRole.AlternateBase))
    _paint_cells(painter, box, QColor(128, 128, 128, 130))
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(palette.color(QPalette.ColorRole.Highlight))
    for row, column, direction in np.ndindex(CELLS, CELLS, DIRECTIONS):
        share = float(values[row, column, direction]) / high if high > 0 else 0.0
        if share > 0.01:
            painter.drawPolygon(fan(box, row, column, direction, share))
    painter.setBrush(Qt.BrushStyle.NoBrush)


def paint_grid(painter: QPainter, box: QRectF, values: Array, low: float, high: float, table: str) -> None:
    """Paint numbers (rows, columns) as cells, in grey for the table ``"grey"``, else in a colour map."""
    if table == "grey":
        span = high - low if high > low else 1.0
        rgb = np.clip(255 * (values - low) / span, 0, 255).astype(np.uint8)
    else:
        rgb = colours_of_values(values, low, high, table)
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, False)
    painter.drawImage(box, _enlarged(rgb))
    painter.setPen(QPen(QColor(128, 128, 128, 120), 1))
    painter.drawRect(box)


def paint_norms(painter: QPainter, box: QRectF, norms: Array, high: float, palette: QPalette) -> None:
    """Paint the length of every row's numbers as a bar beside a grid."""
    step = box.height() / max(len(norms), 1)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(palette.color(QPalette.ColorRole.Highlight))
    for row, norm in enumerate(norms.tolist()):
        wide = box.width() * norm / high if high > 0 else 0.0
        painter.drawRect(QRectF(box.left(), box.top() + row * step + 1, wide, max(step - 2, 1)))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(quiet_text(palette), 1))
    painter.drawLine(box.topLeft(), box.bottomLeft())


def grid_boxes(box: QRectF) -> tuple[QRectF, QRectF, QRectF]:
    """Return where the grey grid, the coloured grid and the bars of the norms lie in a square panel."""
    wide = GRID_SHARE * box.width()
    gap = 0.03 * box.width()
    grey = QRectF(box.left(), box.top(), wide, box.height())
    coloured = grey.translated(wide + gap, 0)
    return (
        grey,
        coloured,
        QRectF(coloured.right() + gap, box.top(), box.right() - coloured.right() - gap, box.height()),
    )


def bit_grid(descriptor: Array) -> Array:
    """Return the bits of bytes as 0 and 1, uint8 (rows, 16), the lowest bit of each byte first."""
    bits = np.unpackbits(np.asarray(descriptor, np.uint8), bitorder="little")
    rows = math.ceil(len(bits) / BIT_COLUMNS)
    return np.pad(bits, (0, rows * BIT_COLUMNS - len(bits))).reshape(rows, BIT_COLUMNS)


def number_grid(descriptor: Array) -> Array:
    """Return the numbers of a descriptor, float64 (16, d / 16), a row per cell; one row where that does not divide."""
    values = np.asarray(descriptor, np.float64)
    return values.reshape(16, -1) if len(values) % 16 == 0 and len(values) else values[None]


def corners(box: QRectF, rows: int, columns: int, row: int, column: int | None) -> QRectF:
    """Return the rectangle of a cell of a grid, or of its whole row."""
    wide, tall = box.width() / columns, box.height() / rows
    if column is None:
        return QRectF(box.left(), box.top() + row * tall, box.width(), tall)
    return QRectF(box.left() + column * wide, box.top() + row * tall, wide, tall)


def _paint_cells(painter: QPainter, box: QRectF, colour: QColor) -> None:
    painter.setPen(QPen(colour, 1))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRect(box)
    painter.drawLines(list(_cell_lines(box)))


def _cell_lines(box: QRectF) -> Iterator[QLineF]:
    for i in range(1, CELLS):
        x, y = box.left() + i * box.width() / CELLS, box.top() + i * box.height() / CELLS
        yield QLineF(x, box.top(), x, box.bottom())
        yield QLineF(box.left(), y, box.right(), y)


def _enlarged(values: Array) -> QImage:
    """Return a picture with several px per cell, so that no scaling blurs the borders."""
    return image_from_array(np.repeat(np.repeat(values, 8, axis=0), 8, axis=1))
