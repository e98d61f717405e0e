"""Known distances: between measured points or photos, what the block says about them, and the difference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QKeySequence, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QTableWidget,
    QTableWidgetItem,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.data import Block
from graphos_core.exchange.control_sheet import SheetDistance
from graphos_core.exchange.table_preview import number
from graphos_core.number_format import UNKNOWN, format_value
from graphos_py.control.desk import ControlDesk
from graphos_py.icons import bind_icon
from graphos_py.translation import tr
from graphos_py.views.painting import paint_empty_state

TITLES = ("from", "to", "known [m]", "σ [mm]", "role", "measured", "difference")
FROM, TO, KNOWN, SIGMA, ROLE, MEASURED, DIFFERENCE = range(7)
TYPED = (KNOWN, SIGMA)


class DistancesPanel(QWidget):
    """The table of known distances, and a line to add one."""

    def __init__(self, desk: ControlDesk) -> None:
        super().__init__()
        self.desk = desk
        self.block: Block | None = None
        self.measured: list[float] = []
        self.table = _Table(0, len(TITLES))
        self.table.setHorizontalHeaderLabels([tr(title) for title in TITLES])
        self.table.itemChanged.connect(self._typed)
        self.table.cellDoubleClicked.connect(self._role_clicked)
        self.problem = QLabel()
        self.problem.setProperty("role", "error")
        self.problem.setWordWrap(True)
        self.problem.hide()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addLayout(self._bar())
        column.addWidget(self.table, 1)
        column.addWidget(self.problem)
        desk.changed.connect(self.refresh)
        self.refresh()

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 6, 8, 0)
        self.ends = (QComboBox(), QComboBox())
        self.metres = QLineEdit()
        self.metres.setPlaceholderText(tr("distance in m"))
        self.metres.returnPressed.connect(self.add)
        for label, widget in ((tr("From"), self.ends[0]), (tr("to"), self.ends[1]), ("", self.metres)):
            if label:
                name = QLabel(label)
                name.setBuddy(widget)
                bar.addWidget(name)
            bar.addWidget(widget, 1)
        for symbol, tip, then in (("add", tr("Add this distance"), self.add),
                                  ("trash", tr("Remove the selected distances"), self.remove)):  # fmt: skip
            button = QToolButton()
            button.setProperty("role", "flat")
            button.setToolTip(tip)
            button.setAccessibleName(tip)
            bind_icon(button, symbol, "text")
            button.clicked.connect(then)
            bar.addWidget(button)
            if symbol == "trash":
                button.setShortcut(QKeySequence())
        return bar

    # ------------------------------------------------------------------------------------------------ public

    def show_block(self, block: Block | None, measured: Sequence[float]) -> None:
        """Take the adjusted block and what it says of the distances, in its unit; None for none."""
        self.block, self.measured = block, list(measured)
        self.refresh()

    def offer(self, a: str, b: str) -> None:
        """Put two ends into the line to add a distance, and ask for its length."""
        for combo, name in zip(self.ends, (a, b), strict=True):
            combo.setCurrentIndex(combo.findText(name))
        self.metres.setFocus()

    def add(self) -> None:
        """Add the distance of the line on top."""
        a, b = (combo.currentText() for combo in self.ends)
        metres = number(self.metres.text().strip().replace(",", "."), ".")
        if not a or not b or a == b or not metres > 0:
            self.say(tr("Two different ends and a distance of more than 0 m are needed."))
            return
        kept = tuple(d for d in self.desk.sheet.distances if {d.a, d.b} != {a, b})
        self.say("")
        self.metres.clear()
        self._put((*kept, SheetDistance(a, b, metres)), tr("Distance {a} – {b}", a=a, b=b))

    def remove(self) -> None:
        """Remove the selected distances."""
        rows = {index.row() for index in self.table.selectedIndexes()}
        kept = tuple(d for row, d in enumerate(self.desk.sheet.distances) if row not in rows)
        self._put(kept, tr("Remove a distance"))

    def say(self, sentence: str) -> None:
        """Say what is wrong below the table; nothing for an empty sentence."""
        self.problem.setText(sentence)
        self.problem.setVisible(bool(sentence))

    def refresh(self) -> None:
        """Fill the table from the sheet."""
        self._offer_ends()
        distances = self.desk.sheet.distances
        with QSignalBlocker(self.table):
            self.table.setRowCount(len(distances))
            for row, distance in enumerate(distances):
                value = self.measured[row] if row < len(self.measured) else math.nan
                for column, text in enumerate(self._texts(distance, value)):
                    self.table.setItem(row, column, _item(text, column))
        self.table.resizeColumnsToContents()

    # --------------------------------------------------------------------------------------------- reacting

    def _put(self, distances: Sequence[SheetDistance], text: str) -> None:
        self.desk.edit(replace(self.desk.sheet, distances=tuple(distances)), text)

    def _offer_ends(self) -> None:
        project = self.desk.session.project
        photos = [photo.name for photo in project.photo_set.photos] if project is not None else []
        names = [point.name for point in self.desk.sheet.points] + photos
        for place, combo in enumerate(self.ends):
            if [combo.itemText(i) for i in range(combo.count())] != names:
                now = combo.currentText()
                combo.clear()
                combo.addItems(names)
                combo.setCurrentIndex(max(combo.findText(now), min(place, combo.count() - 1)))

    def _texts(self, d: SheetDistance, value: float) -> list[str]:
        sigma = format_value(1000 * d.sigma, digits=3) if math.isfinite(d.sigma) else ""
        measured, difference = UNKNOWN, UNKNOWN
        if self.block is not None:
            measured = format_value(value, unit=tr(self.block.unit), digits=6)
            if self.block.unit == "m" and math.isfinite(value):
                difference = format_value(1000 * (value - d.metres), unit="mm", digits=3)
        return [
            d.a,
            d.b,
            f"{d.metres:.12g}",
            sigma,
            tr("check") if d.check else tr("scale"),
            measured,
            difference,
        ]

    def _typed(self, item: QTableWidgetItem) -> None:
        row, column = item.row(), item.column()
        old = self.desk.sheet.distances[row]
        text = item.text().strip()
        value = number(text.replace(",", "."), ".")
        changed = old
        if column == KNOWN and value > 0:
            changed = replace(old, metres=value)
        elif column == SIGMA and (not text or value >= 0):
            changed = replace(old, sigma=value / 1000)
        else:
            self.say(tr("A distance is more than 0 m, its standard deviation 0 or more."))
            self.refresh()
            return
        self.say("")
        self._change(row, changed)

    def _role_clicked(self, row: int, column: int) -> None:
        """Change between scale and check."""
        if column == ROLE:
            old = self.desk.sheet.distances[row]
            self._change(row, replace(old, check=not old.check))

    def _change(self, row: int, changed: SheetDistance) -> None:
        rows = list(self.desk.sheet.distances)
        rows[row] = changed
        self._put(rows, tr("Distance {a} – {b}", a=changed.a, b=changed.b))


class _Table(QTableWidget):
    def __init__(self, rows: int, columns: int) -> None:
        super().__init__(rows, columns)
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setSelectionBehavior(QTableWidget.SelectionBehavior.SelectRows)
        self.verticalHeader().setVisible(False)
        self.horizontalHeader().setHighlightSections(False)
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Interactive)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the table, or what will be here."""
        super().paintEvent(event)
        if not self.rowCount():
            title = tr("A known distance gives the block its scale")
            hint = tr("Choose two measured points, or two photos, and type their distance; or measure two points in "
                      "the 3D view and take them.")  # fmt: skip
            paint_empty_state(QPainter(self.viewport()), self.viewport().rect(), self.palette(), title, hint)


def _item(text: str, column: int) -> QTableWidgetItem:
    item = QTableWidgetItem(text)
    flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
    item.setFlags(flags | Qt.ItemFlag.ItemIsEditable if column in TYPED else flags)
    left = column in (FROM, TO, ROLE)
    item.setTextAlignment(
        Qt.AlignmentFlag.AlignVCenter | (Qt.AlignmentFlag.AlignLeft if left else Qt.AlignmentFlag.AlignRight)
    )
    tips: dict[int, Any] = {
        ROLE: tr("Double-click: scale takes part, check only tests it."), DIFFERENCE: tr("measured − known")
    }  # fmt: skip
    item.setToolTip(tips.get(column, ""))
    return item
