"""A funnel: what is left after each step, as bars with their counts."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QContextMenuEvent, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QSizePolicy, QWidget

from graphos_core.number_format import THIN_SPACE, format_value
from graphos_py.translation import tr
from graphos_py.views.export import Writer, export_menu, write_csv, write_png, write_svg
from graphos_py.views.painting import paint_empty_state, quiet_text


class FunnelView(QWidget):
    """One line per step: its name, its count, the share of the step before, and a bar as long as the count."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("funnel")
        self.steps: tuple[tuple[str, int], ...] = ()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def set_steps(self, steps: Sequence[tuple[str, int]]) -> None:
        """Show steps in order, names for people with counts."""
        self.steps = tuple(steps)
        self.setAccessibleName(tr("Funnel") + ": " + ", ".join(f"{name} {count}" for name, count in steps))
        self.updateGeometry()
        self.update()

    def _line(self) -> int:
        return self.fontMetrics().height() + 13

    def sizeHint(self) -> QSize:
        """Ask for a line per step."""
        return QSize(200, self._line() * max(len(self.steps), 2) + 8)

    def minimumSizeHint(self) -> QSize:
        """Keep every line readable."""
        return QSize(120, self.sizeHint().height())

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the lines."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Base))
        if not self.steps:
            title = tr("What each step of matching leaves")
            paint_empty_state(painter, self.rect(), self.palette(), title, tr("Choose a pair."))
            return
        most = max(1, *(count for _, count in self.steps))
        ink, accent = (
            self.palette().color(role) for role in (QPalette.ColorRole.Text, QPalette.ColorRole.Highlight)
        )
        width = self.width() - 16.0
        before = 0
        for i, (name, count) in enumerate(self.steps):
            top = 4.0 + i * self._line()
            text = QRectF(8, top, width, self.fontMetrics().height())
            share = f"{THIN_SPACE}·{THIN_SPACE}{100 * count / before:.0f}{THIN_SPACE}%" if before else ""
            figure = format_value(count)
            if i and self.fontMetrics().horizontalAdvance(f"{name}  {figure}{share}") < width:
                figure += share
            painter.setPen(quiet_text(self.palette()))
            room = text.width() - self.fontMetrics().horizontalAdvance(figure) - 8
            shown = self.fontMetrics().elidedText(name, Qt.TextElideMode.ElideRight, int(room))
            painter.drawText(text, Qt.AlignmentFlag.AlignLeft, shown)
            painter.setPen(ink)
            painter.drawText(text, Qt.AlignmentFlag.AlignRight, figure)
            bar = QRectF(8, text.bottom() + 2, max(width * count / most, 1.0), 6)
            painter.fillRect(QRectF(8, bar.top(), width, 6), self.palette().color(QPalette.ColorRole.Window))
            painter.fillRect(bar, accent)
            before = count

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        return {
            "png": lambda path: write_png(self, path),
            "svg": lambda path: write_svg(self, path),
            "csv": lambda path: write_csv(path, ("step", "count"), self.steps),
        }
