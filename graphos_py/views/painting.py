"""What all views paint alike: the empty state, plates under texts on pictures, and quiet colours."""

from __future__ import annotations

import math

from PySide6.QtCore import QRect, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPalette


def paint_empty_state(painter: QPainter, area: QRect, palette: QPalette, title: str, hint: str) -> None:
    """Write two lines in the middle of `area`."""
    heading = QFont(painter.font())
    heading.setPointSizeF(heading.pointSizeF() * 1.25)
    margin = min(32, area.width() // 8)
    inner = area.adjusted(margin, 0, -margin, 0)
    wrap = int(Qt.TextFlag.TextWordWrap) | int(Qt.AlignmentFlag.AlignHCenter)
    painter.save()
    body = painter.font()
    painter.setFont(heading)
    high = painter.boundingRect(inner, wrap | int(Qt.AlignmentFlag.AlignTop), title).height()
    painter.setPen(palette.color(QPalette.ColorRole.Text))
    middle = area.center().y()
    bottom = int(Qt.AlignmentFlag.AlignBottom)
    painter.drawText(QRect(inner.left(), middle - high - 8, inner.width(), high + 4), wrap | bottom, title)
    painter.setFont(body)
    painter.setPen(quiet_text(palette))
    painter.drawText(QRect(inner.left(), middle + 6, inner.width(), area.bottom() - middle - 6), wrap, hint)
    painter.restore()


def quiet_text(palette: QPalette) -> QColor:
    """Return a quieter text colour that still has a contrast of 4.5:1 against the background."""
    text = palette.color(QPalette.ColorRole.Text)
    ground = palette.color(QPalette.ColorRole.Base)
    share = 0.28
    return QColor(
        round(text.red() + share * (ground.red() - text.red())),
        round(text.green() + share * (ground.green() - text.green())),
        round(text.blue() + share * (ground.blue() - text.blue())),
    )


def is_dark(palette: QPalette) -> bool:
    """Return whether the palette is light text on dark ground."""
    return palette.color(QPalette.ColorRole.Base).lightness() < 128


def plate(painter: QPainter, box: QRectF, palette: QPalette) -> None:
    """Draw the ground of a text that lies on a picture, and leave the pen set for the text."""
    ground = palette.color(QPalette.ColorRole.Base)
    ground.setAlpha(220)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(ground)
    painter.drawRoundedRect(box, 4, 4)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(palette.color(QPalette.ColorRole.Text))


def round_step(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a positive `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= value * (1 + 1e-9))
