"""Two descriptors side by side: patch, gradients, fans and numbers of each, and their difference."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QContextMenuEvent, QMouseEvent, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from graphos_core.data.record import Array
from graphos_core.number_format import format_value
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views import descriptor_panels as panels
from graphos_py.views.descriptor_shown import Shown
from graphos_py.views.export import Writer, export_menu, write_csv, write_png, write_svg
from graphos_py.views.painting import paint_empty_state, quiet_text

GAP = 10.0
LEAST, MOST = 84.0, 240.0
"""Side of a panel, px; the least one follows the font scale."""


class DescriptorView(QWidget):
    """A keypoint, another one, and what differs. What is under the cursor is marked in every part."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("descriptor")
        self.first: Shown | None = None
        self.second: Shown | None = None
        self.marked: tuple[int, int | None] | None = None
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName(tr("Descriptor"))

    def show_pair(self, first: Shown | None, second: Shown | None) -> None:
        """Show a keypoint and the one it is compared with; None for none."""
        self.first, self.second, self.marked = first, second, None
        titles = [shown.title.replace("\n", ", ") for shown in (first, second) if shown is not None]
        self.setAccessibleName(" ↔ ".join([tr("Descriptor"), *titles]))
        self.update()

    def difference(self) -> Array | None:
        """Return the second minus the first, in rows; of bits where they differ."""
        if self.first is None or self.second is None or self.first.grid.shape != self.second.grid.shape:
            return None
        a, b = self.first.grid, self.second.grid
        return np.bitwise_xor(a, b) if self.first.binary else b - a

    # places

    def sizeHint(self) -> QSize:
        """Ask for panels of a readable size."""
        return QSize(700, self._height(130.0))

    def minimumSizeHint(self) -> QSize:
        """Keep two rows of panels."""
        return QSize(int(5 * theme().px(LEAST) + 6 * GAP), self._height(theme().px(LEAST)))

    def _line(self) -> float:
        return float(self.fontMetrics().height() + 2)

    def _height(self, side: float) -> int:
        return int(2 * side + 4 * self._line() + 3 * GAP)

    def _side(self) -> float:
        wide = (self.width() - 6 * GAP) / 5
        tall = (self.height() - 4 * self._line() - 3 * GAP) / 2
        return float(min(max(min(wide, tall), theme().px(LEAST)), theme().px(MOST)))

    def box(self, column: int, row: int) -> QRectF:
        """Return the place of a panel; columns 0 and 1 are this keypoint, 2 and 3 the other, 4 the difference."""
        side = self._side()
        left = GAP + column * (side + GAP)
        top = GAP + 2 * self._line() + row * (side + self._line() + GAP)
        return QRectF(left, top, side, side)

    # painting

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint both keypoints and their difference."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Base))
        if self.first is None:
            paint_empty_state(painter, self.rect(), self.palette(), tr("What a keypoint is recognised by"),
                              tr("Click a keypoint in the photo on the left."))  # fmt: skip
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        high = self._highest()
        longest = max(float(shown.norms.max()) for shown in (self.first, self.second) if shown is not None)
        for column, shown in ((0, self.first), (2, self.second)):
            if shown is not None:
                self._paint_keypoint(painter, column, shown, high, longest)
        self._paint_difference(painter)
        self._paint_marks(painter)

    def _highest(self) -> float:
        """Return the largest number of both descriptors, which gets the last colour."""
        return max(float(shown.grid.max()) for shown in (self.first, self.second) if shown is not None)

    def _paint_keypoint(
        self, painter: QPainter, column: int, shown: Shown, high: float, longest: float
    ) -> None:
        self._title(painter, column, 2, shown.title)
        found = shown.described
        if found is not None:
            panels.paint_patch(painter, self.box(column, 0), found.patch)
            panels.paint_gradients(
                painter, self.box(column + 1, 0), found.magnitude, found.direction, found.weight
            )
            self._caption(painter, column, 0, tr("patch"))
            self._caption(painter, column + 1, 0, tr("gradients"))
        fans, numbers = self.box(column, 1), self.box(column + 1, 1)
        if shown.binary:
            self._paint_bits(painter, column, shown)
            return
        if shown.descriptor.size == 128:
            panels.paint_fans(painter, fans, shown.grid.reshape(4, 4, 8), high, self.palette())
            self._caption(painter, column, 1, tr("histograms"))
        grey, coloured, bars = panels.grid_boxes(numbers)
        panels.paint_grid(painter, grey, shown.grid, 0.0, high, "grey")
        panels.paint_grid(painter, coloured, shown.grid, 0.0, high, "viridis")
        panels.paint_norms(painter, bars, shown.norms, longest, self.palette())
        whole = format_value(float(np.linalg.norm(shown.grid)), digits=3)
        self._caption(painter, column + 1, 1, tr("length {l}", l=whole))

    def _paint_bits(self, painter: QPainter, column: int, shown: Shown) -> None:
        panels.paint_grid(painter, self.box(column, 1), shown.grid, 0.0, 1.0, "grey")
        total = tr("{k} of {n} bits set", n=8 * len(shown.descriptor), k=int(shown.grid.sum()))
        self._caption(painter, column, 1, total)

    def _paint_difference(self, painter: QPainter) -> None:
        difference = self.difference()
        if difference is None or self.first is None:
            return
        self._title(painter, 4, 1, tr("difference"))
        box = self.box(4, 0)
        if self.first.binary:
            panels.paint_grid(painter, box, difference, 0.0, 1.0, "viridis")
            said = tr("{n} of {all} bits differ", n=int(difference.sum()), all=8 * len(self.first.descriptor))
            self._caption(painter, 4, 0, said)
            self._explain(painter, tr("White: a bit is set. Yellow: it differs. The number of different bits is the "
                                      "distance (Hamming)."))  # fmt: skip
            return
        high = max(float(np.abs(difference).max()), 1e-9)
        signed = QRectF(box.left(), box.top(), 0.62 * box.width(), box.height())
        bars = QRectF(signed.right() + 4, box.top(), box.right() - signed.right() - 4, box.height())
        panels.paint_grid(painter, signed, difference, -high, high, "diverging")
        norms = np.linalg.norm(difference, axis=1)
        panels.paint_norms(painter, bars, norms, max(float(norms.max()), 1e-9), self.palette())
        distance = format_value(float(np.linalg.norm(difference)), digits=3)
        self._caption(painter, 4, 0, tr("length {d}", d=distance))
        self._paint_explanation(painter, high)

    def _paint_explanation(self, painter: QPainter, high: float) -> None:
        """Say what the colours mean, where the second row of the difference is free."""
        first = format_value(high, digits=3)
        text = tr("Difference: blue less, red more, up to {h}. Grids: 0 to {m}; a row is a cell from the upper left, a "
                  "column a direction counter-clockwise from the right, a bar the row's length.", h=first,
                  m=format_value(self._highest(), digits=3))  # fmt: skip
        self._explain(painter, text)

    def _explain(self, painter: QPainter, text: str) -> None:
        """Write a text, or what is under the cursor, below the difference."""
        painter.setPen(quiet_text(self.palette()))
        font = painter.font()
        painter.save()
        font.setPointSizeF(theme().points("caption"))
        painter.setFont(font)
        wrap = int(Qt.TextFlag.TextWordWrap) | int(Qt.AlignmentFlag.AlignTop)
        said = text if self.marked is None else self.describe_mark()
        painter.drawText(self.box(4, 1).adjusted(0, 0, GAP, self._line()), wrap, said)
        painter.restore()

    def _title(self, painter: QPainter, column: int, wide: int, text: str) -> None:
        side = self._side()
        room = wide * side + (wide - 1) * GAP
        box = QRectF(GAP + column * (side + GAP), GAP, room, self._line())
        painter.save()
        font = painter.font()
        for row, line in enumerate(text.splitlines()[:2]):
            ink = self.palette().color(QPalette.ColorRole.Text) if row == 0 else quiet_text(self.palette())
            font.setPointSizeF(theme().points("caption" if row else "body"))
            painter.setFont(font)
            painter.setPen(ink)
            shown = painter.fontMetrics().elidedText(line, Qt.TextElideMode.ElideRight, int(room))
            painter.drawText(box.translated(0, row * self._line()), Qt.AlignmentFlag.AlignVCenter, shown)
        painter.restore()

    def _caption(self, painter: QPainter, column: int, row: int, text: str) -> None:
        box = self.box(column, row)
        painter.save()
        font = painter.font()
        font.setPointSizeF(theme().points("caption"))
        painter.setFont(font)
        painter.setPen(quiet_text(self.palette()))
        under = QRectF(box.left(), box.bottom() + 1, box.width() + GAP - 2, self._line())
        shown = painter.fontMetrics().elidedText(text, Qt.TextElideMode.ElideRight, int(under.width()))
        painter.drawText(under, Qt.AlignmentFlag.AlignLeft, shown)
        painter.restore()

    # the mark under the cursor

    def _parts(self, column: int, shown: Shown) -> list[tuple[QRectF, int, int]]:
        """Return the grids of a keypoint: place, rows, columns."""
        rows, columns = shown.grid.shape
        if shown.binary:
            return [(self.box(column, 1), rows, columns)]
        grey, coloured, bars = panels.grid_boxes(self.box(column + 1, 1))
        return [(grey, rows, columns), (coloured, rows, columns), (bars, rows, 1)]

    def _difference_part(self) -> tuple[QRectF, int, int] | None:
        difference = self.difference()
        if difference is None or self.first is None:
            return None
        box = self.box(4, 0)
        if not self.first.binary:
            box = QRectF(box.left(), box.top(), 0.62 * box.width(), box.height())
        return box, *difference.shape

    def _all_parts(self) -> list[tuple[QRectF, int, int]]:
        both = [(0, self.first), (2, self.second)]
        parts = [part for column, shown in both if shown is not None for part in self._parts(column, shown)]
        more = self._difference_part()
        return parts if more is None else [*parts, more]

    def _cell_boxes(self) -> list[QRectF]:
        """Return the panels that are cut into 4 × 4 cells."""
        both = [(0, self.first), (2, self.second)]
        boxes = []
        for column, shown in both:
            if shown is not None and not shown.binary and shown.descriptor.size == 128:
                boxes.append(self.box(column, 1))
                if shown.described is not None:
                    boxes += [self.box(column, 0), self.box(column + 1, 0)]
        return boxes

    def mark_at(self, at: QPointF) -> tuple[int, int | None] | None:
        """Return row and column of the number, or the row of the cell, at a place; None for none."""
        for box, rows, columns in self._all_parts():
            if box.contains(at):
                row = min(int((at.y() - box.top()) / box.height() * rows), rows - 1)
                column = min(int((at.x() - box.left()) / box.width() * columns), columns - 1)
                return row, column if columns > 1 else None
        for box in self._cell_boxes():
            if box.contains(at):
                row, column = (min(int(4 * share), 3) for share in
                               ((at.y() - box.top()) / box.height(), (at.x() - box.left()) / box.width()))  # fmt: skip
                return 4 * row + column, None
        return None

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Mark what is under the cursor in every part."""
        mark = self.mark_at(event.position())
        if mark != self.marked:
            self.marked = mark
            self.setToolTip("" if mark is None else self.describe_mark())
            self.update()

    def leaveEvent(self, event: object) -> None:
        """Mark nothing."""
        self.marked = None
        self.update()

    def describe_mark(self) -> str:
        """Return the marked number, or cell, of both keypoints in words."""
        if self.marked is None or self.first is None:
            return ""
        row, column = self.marked
        grids = [shown.grid for shown in (self.first, self.second) if shown is not None]
        if self.first.binary:
            bit = row * panels.BIT_COLUMNS + (column or 0)
            return tr(
                "Bit {n}: {values}", n=bit, values=" ↔ ".join(str(int(g[row, column or 0])) for g in grids)
            )
        place = tr("Cell in row {r}, column {c}", r=row // 4 + 1, c=row % 4 + 1)
        if column is None:
            norms = " ↔ ".join(format_value(float(np.linalg.norm(g[row])), digits=3) for g in grids)
            return tr("{place}: length {n}", place=place, n=norms)
        values = " ↔ ".join(format_value(float(g[row, column]), digits=3) for g in grids)
        return tr("{place}, direction {d}°: {v}", place=place, d=45 * column, v=values)

    def _paint_marks(self, painter: QPainter) -> None:
        if self.marked is None:
            return
        row, column = self.marked
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(panels.LINE, 2))
        for box, rows, columns in self._all_parts():
            if row < rows:
                painter.drawRect(panels.corners(box, rows, columns, row, column if columns > 1 else None))
        for box in self._cell_boxes():
            painter.drawRect(panels.corners(box, 4, 4, row // 4, row % 4))
            if column is not None and box in (self.box(0, 1), self.box(2, 1)):
                painter.drawPolygon(panels.fan(box, row // 4, row % 4, column, 1.0))

    # export

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        if self.first is not None:
            export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending; the table has a row per number."""
        both = [shown for shown in (self.first, self.second) if shown is not None]
        rows = np.column_stack([shown.grid.ravel() for shown in both]).tolist() if both else []
        return {
            "png": lambda path: write_png(self, path),
            "svg": lambda path: write_svg(self, path),
            "csv": lambda path: write_csv(path, [shown.title for shown in both], rows),
        }
