"""The legend of a colour map on a picture: a bar with its ends, what it means, and the unit."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QImage, QPainter, QPalette

from graphos_core.number_format import THIN_SPACE, format_value
from graphos_core.rendering.colour_maps import colour_table
from graphos_py.views.export import image_from_array
from graphos_py.views.painting import plate

BAR_WIDTH = 160.0
BAR_HEIGHT = 10.0


def paint_legend(
    painter: QPainter,
    area: QRectF,
    palette: QPalette,
    low: float,
    high: float,
    title: str,
    unit: str,
    table: str = "viridis",
) -> None:
    """Paint a legend into the lower right corner of `area`."""
    metrics = painter.fontMetrics()
    line = metrics.height()
    heading = f"{title} [{unit}]" if unit else title
    width = min(max(BAR_WIDTH, float(metrics.horizontalAdvance(heading))) + 20, area.width() - 16)
    heading = metrics.elidedText(heading, Qt.TextElideMode.ElideMiddle, max(int(width) - 16, 0))
    box = QRectF(
        area.right() - width - 12,
        area.bottom() - 2 * line - BAR_HEIGHT - 30,
        width,
        2 * line + BAR_HEIGHT + 18,
    )
    painter.save()
    plate(painter, box, palette)
    inner = box.adjusted(10, 6, -10, -6)
    painter.drawText(
        QRectF(inner.left(), inner.top(), inner.width(), line), Qt.AlignmentFlag.AlignLeft, heading
    )
    bar = QRectF(inner.left(), inner.top() + line + 3, inner.width(), BAR_HEIGHT)
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
    painter.drawImage(bar, _bar(table))
    ends = QRectF(inner.left(), bar.bottom() + 2, inner.width(), line)
    painter.drawText(ends, Qt.AlignmentFlag.AlignLeft, _end(low, high))
    painter.drawText(ends, Qt.AlignmentFlag.AlignRight, _end(high, low))
    if low < 0 < high:
        painter.drawText(ends, Qt.AlignmentFlag.AlignHCenter, "0")
    painter.restore()


def _bar(table: str) -> QImage:
    return image_from_array(colour_table(table)[None, :, :])


def _end(value: float, other: float) -> str:
    """Return an end of the bar: exact between whole numbers, else with two digits of a fifth of the span."""
    if value == 0:
        return "0"
    if float(value).is_integer() and float(other).is_integer():
        return format_value(int(value))
    return format_value(value, sigma=abs(value - other) / 5 or None).split(" ±")[0].strip(THIN_SPACE)
