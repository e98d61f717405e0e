"""A table of points before it is taken: delimiter, decimal sign, columns, unit and coordinate system, seen at once."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QSpinBox,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from graphos_core.exchange.control_sheet import SheetPoint
from graphos_core.exchange.control_tables import LARGEST, LENGTHS
from graphos_core.exchange.table_preview import (
    DELIMITERS,
    FIELDS,
    BadLine,
    TableFormat,
    cells,
    guess,
    read_points,
    strange_units,
)
from graphos_py.theme import theme
from graphos_py.translation import tr

SHOWN_ROWS = 60
NOTHING = "–"
CRS = re.compile(r"(?:EPSG:)?\s*(\d{4,6})", re.IGNORECASE)


class ImportDialog(QDialog):
    """Shows what a file holds and how it is understood; every choice shows its effect at once."""

    def __init__(self, path: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr("Open table: {name}", name=path.name))
        self.resize(theme().px(820), theme().px(560))
        self.text = _text(path)
        self.format = guess(self.text)
        self._points: list[SheetPoint] = []
        self._filling = False
        self.preview = QTableWidget()
        self.preview.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
        self.preview.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.columns: list[QComboBox] = []
        self.verdict = QLabel()
        self.verdict.setWordWrap(True)
        self.verdict.setTextFormat(Qt.TextFormat.PlainText)
        buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        self.take = buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.take.setProperty("role", "primary")
        buttons.button(QDialogButtonBox.StandardButton.Cancel).setText(tr("Cancel"))
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(self._choices())
        column.addWidget(self.preview, 1)
        column.addWidget(self.verdict)
        column.addWidget(buttons)
        self._show()

    def points(self) -> list[SheetPoint]:
        """Return the points as understood."""
        return self._points

    def crs(self) -> str:
        """Return the coordinate system as ``"EPSG:25832"``; empty where none is given."""
        match = CRS.fullmatch(self.epsg.text().strip())
        return f"EPSG:{match[1]}" if match else ""

    # ------------------------------------------------------------------------------------------------ choices

    def _choices(self) -> QGridLayout:
        self.delimiter = _combo(
            [(tr(word), sign) for sign, word in DELIMITERS.items()], self.format.delimiter
        )
        self.decimal = _combo([(tr("point  1.5"), "."), (tr("comma  1,5"), ",")], self.format.decimal)
        self.unit = _combo([(unit, unit) for unit in LENGTHS], self.format.unit)
        self.skip = QSpinBox()
        self.skip.setRange(0, 999)
        self.skip.setValue(self.format.skip)
        self.epsg = QLineEdit()
        self.epsg.setPlaceholderText(tr("local, or EPSG:25832"))
        self.delimiter.activated.connect(self._delimiter_chosen)
        for combo in (self.decimal, self.unit):
            combo.activated.connect(self._chosen)
        self.skip.valueChanged.connect(self._chosen)
        self.epsg.textChanged.connect(self._chosen)
        grid = QGridLayout()
        grid.setHorizontalSpacing(12)
        fields = ((tr("Separated by"), self.delimiter), (tr("Decimal sign"), self.decimal),
                  (tr("Unit"), self.unit), (tr("Lines above the points"), self.skip),
                  (tr("Coordinate system"), self.epsg))  # fmt: skip
        for place, (label, widget) in enumerate(fields):
            name = QLabel(label)
            name.setBuddy(widget)
            grid.addWidget(name, 0, place)
            grid.addWidget(widget, 1, place)
        return grid

    def _delimiter_chosen(self) -> None:
        """Guess the columns anew: they are others now."""
        wanted = str(self.delimiter.currentData())
        rows = cells(self.text, replace(self.format, delimiter=wanted))
        width = max((len(row) for row in rows[self.format.skip :]), default=0)
        order = ("name", "x", "y", "z", "sx", "sy", "sz")
        kept = {f: c for f, c in self.format.columns.items() if c < width}
        columns = kept if len(kept) >= 4 else {f: i for i, f in enumerate(order) if i < width}
        self.format = replace(self.format, delimiter=wanted, columns=columns)
        self._show()

    def _chosen(self) -> None:
        if not self._filling:
            self.format = TableFormat(
                self.format.delimiter, str(self.decimal.currentData()), self.skip.value(),
                self.format.columns, str(self.unit.currentData()),
            )  # fmt: skip
            self._show()

    def _column_chosen(self, column: int) -> None:
        if self._filling:
            return
        field = str(self.columns[column].currentData())
        others = {f: c for f, c in self.format.columns.items() if c != column and f != field}
        self.format = replace(self.format, columns={**others, field: column} if field else others)
        self._show()

    # ------------------------------------------------------------------------------------------------- preview

    def _show(self) -> None:
        """Fill the preview and judge."""
        self._filling = True
        rows = cells(self.text, self.format)
        self._points, bad = read_points(self.text, self.format)
        shown = rows[:SHOWN_ROWS]
        width = max((len(row) for row in shown), default=0)
        wrong = {problem.line: tr(problem.why) for problem in bad}
        self.preview.clear()
        self.preview.setRowCount(len(shown) + 1)
        self.preview.setColumnCount(width)
        self.preview.horizontalHeader().hide()
        self.preview.setVerticalHeaderLabels([tr("is"), *(str(i) for i in range(1, len(shown) + 1))])
        of_column = {column: field for field, column in self.format.columns.items()}
        choices = [(NOTHING, ""), *((tr(field), field) for field in FIELDS)]
        self.columns = [_combo(choices, of_column.get(c, "")) for c in range(width)]
        for place, combo in enumerate(self.columns):
            combo.activated.connect(lambda _, c=place: self._column_chosen(c))
            self.preview.setCellWidget(0, place, combo)
        for line, row in enumerate(shown, 1):
            for place, cell in enumerate(row):
                self.preview.setItem(
                    line, place, self._cell(cell, line, place in of_column, wrong.get(line, ""))
                )
        self._judge(bad)
        self._filling = False

    def _cell(self, text: str, line: int, used: bool, problem: str) -> QTableWidgetItem:
        item = QTableWidgetItem(text)
        if problem:
            item.setForeground(theme().colour("bad"))
            item.setToolTip(problem)
        elif line <= self.format.skip or not used:
            item.setForeground(theme().colour("muted"))
        return item

    def _judge(self, bad: list[BadLine]) -> None:
        lines = [tr("Line {line}: {why}.", line=b.line, why=tr(b.why)) for b in bad[:4]]
        if len(bad) > 4:
            lines.append(tr("{n} more lines are no points.", n=len(bad) - 4))
        if self.epsg.text().strip() and not self.crs():
            lines.insert(0, tr("A coordinate system is written like EPSG:25832."))
        if units := strange_units(self.text, self.format):
            lines.insert(
                0,
                tr(
                    "The header says {units}, but all are taken in {unit}.",
                    units=units,
                    unit=self.format.unit,
                ),
            )
        if not self._points and not bad:
            lines = [tr("There are no points in this file.")]
        self.verdict.setText("\n".join(lines))
        self.verdict.setProperty("role", "error")
        self.take.setText(tr("Take {n} points", n=len(self._points)))
        self.take.setEnabled(bool(self._points) and (not self.epsg.text().strip() or bool(self.crs())))


def _text(path: Path) -> str:
    """Return the text of a file; nothing where it cannot be read or is too large."""
    try:
        return (
            "" if path.stat().st_size > LARGEST else path.read_bytes().decode("utf-8-sig", errors="replace")
        )
    except OSError:
        return ""


def _combo(choices: list[tuple[str, str]], now: str) -> QComboBox:
    combo = QComboBox()
    for label, value in choices:
        combo.addItem(label, value)
    combo.setCurrentIndex(max(combo.findData(now), 0))
    return combo
