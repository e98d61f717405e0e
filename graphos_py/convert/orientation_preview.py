"""A table of positions and angles as it is understood: every choice shows its effect at once, guesses say why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
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

from graphos_core.exchange.attitudes import ORDERS, UNITS
from graphos_core.exchange.control_tables import LENGTHS
from graphos_core.exchange.orientation_table import OrientationTableFormat, guess_orientations, preview
from graphos_core.exchange.table_preview import DELIMITERS
from graphos_py.theme import theme
from graphos_py.translation import tr

SHOWN = 40
COLUMNS = {
    "": "–",
    "name": "photo",
    "x": "X",
    "y": "Y",
    "z": "Z",
    "a": "1st angle",
    "b": "2nd angle",
    "c": "3rd angle",
}


class OrientationPreview(QWidget):
    """Choices on top, the table below, problems at the bottom.

    Signals
    -------
    changed()
        The table is understood differently.
    """

    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.form: OrientationTableFormat | None = None
        self._text = ""
        self.delimiter = choices(DELIMITERS, labels=True)
        self.decimal = choices({".": "point  1.5", ",": "comma  1,5"}, labels=True)
        self.order, self.angle, self.length = choices(ORDERS), choices(UNITS), choices(LENGTHS)
        self.skip, self.crs = QSpinBox(), QLineEdit()
        self.skip.setRange(0, 999)
        self.crs.setPlaceholderText(tr("local, or EPSG:25832"))
        self.columns: list[QComboBox] = []
        self.table = QTableWidget()
        self.table.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.table.horizontalHeader().hide()
        self.problems = QLabel()
        self.problems.setProperty("role", "error")
        self.problems.setWordWrap(True)
        self.reasons = QLabel()
        self.reasons.setProperty("role", "caption")
        self.reasons.setWordWrap(True)
        grid = QGridLayout()
        fields = ((tr("Separated by"), self.delimiter), (tr("Decimal sign"), self.decimal), (tr("Angles"), self.order),
                  (tr("in"), self.angle), (tr("Positions in"), self.length), (tr("Lines above"), self.skip),
                  (tr("Coordinate system"), self.crs))  # fmt: skip
        for place, (label, widget) in enumerate(fields):
            name = QLabel(label)
            name.setBuddy(widget)
            grid.addWidget(name, 0, place)
            grid.addWidget(widget, 1, place)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(grid)
        for widget in (self.reasons, self.table, self.problems):
            column.addWidget(widget, int(widget is self.table))
        for combo in (self.delimiter, self.decimal, self.order, self.angle, self.length):
            combo.activated.connect(self._chosen)
        self.skip.valueChanged.connect(self._chosen)
        self.crs.textChanged.connect(self._chosen)

    def show_text(self, text: str) -> None:
        """Show another text, its format guessed; empty for none."""
        self._text = text
        self.form = guess_orientations(text) if text.strip() else None
        self._fill()

    def _chosen(self) -> None:
        """Take all choices."""
        if self.form is None:
            return
        table = replace(
            self.form.table, delimiter=str(self.delimiter.currentData()), decimal=str(self.decimal.currentData()),
            skip=self.skip.value(), unit=str(self.length.currentData()),
        )  # fmt: skip
        self.form = OrientationTableFormat(
            table, str(self.order.currentData()), str(self.angle.currentData()), self.crs.text().strip(), {}
        )
        self._fill()
        self.changed.emit()

    def _column_chosen(self, place: int) -> None:
        if self.form is None:
            return
        key = str(self.columns[place].currentData())
        kept = {k: c for k, c in self.form.table.columns.items() if c != place and k != key}
        columns = {**kept, key: place} if key else kept
        self.form = replace(self.form, table=replace(self.form.table, columns=columns), reasons={})
        self._fill()
        self.changed.emit()

    def _fill(self) -> None:
        form = self.form
        if form is None:
            self.table.setRowCount(0)
            self.problems.setText("")
            self.reasons.setText("")
            return
        chosen = ((self.delimiter, form.table.delimiter), (self.decimal, form.table.decimal), (self.order, form.order),
                  (self.angle, form.angle_unit), (self.length, form.table.unit))  # fmt: skip
        for combo, value in chosen:
            combo.setCurrentIndex(combo.findData(value))
        with QSignalBlocker(self.skip):
            self.skip.setValue(form.table.skip)
        found = preview(self._text, form, SHOWN)
        self._fill_table(found.cells, form, {b.line: tr(b.why) for b in found.bad})
        bad = [tr("Line {line}: {why}.", line=b.line, why=tr(b.why)) for b in found.bad[:4]]
        self.problems.setText("\n".join(bad))
        self.reasons.setText(" ".join(dict.fromkeys(tr(reason) for reason in form.reasons.values())))

    def _fill_table(
        self, cells: tuple[tuple[str, ...], ...], form: OrientationTableFormat, wrong: Mapping[int, str]
    ) -> None:
        of_column = {place: key for key, place in form.table.columns.items()}
        width = max((len(row) for row in cells), default=0)
        self.table.clear()
        self.table.setRowCount(len(cells) + 1)
        self.table.setColumnCount(width)
        self.table.setVerticalHeaderLabels([tr("is"), *(str(i) for i in range(1, len(cells) + 1))])
        self.columns = []
        for place in range(width):
            combo = choices(COLUMNS, labels=True)
            combo.setCurrentIndex(combo.findData(of_column.get(place, "")))
            combo.activated.connect(lambda _, c=place: self._column_chosen(c))
            self.columns.append(combo)
            self.table.setCellWidget(0, place, combo)
        for line, row in enumerate(cells, 1):
            for place, text in enumerate(row):
                item = QTableWidgetItem(text)
                if line in wrong:
                    item.setForeground(theme().colour("bad"))
                    item.setToolTip(wrong[line])
                elif line <= form.table.skip or place not in of_column:
                    item.setForeground(theme().colour("muted"))
                self.table.setItem(line, place, item)


def choices(entries: Mapping[str, object], *, labels: bool = False) -> QComboBox:
    """Return a chooser of keys; their texts are the labels, or else the explanation of each key."""
    combo = QComboBox()
    for key, text in entries.items():
        combo.addItem(tr(str(text)) if labels else tr(key), key)
        if not labels and isinstance(text, str):
            combo.setItemData(combo.count() - 1, tr(text), Qt.ItemDataRole.ToolTipRole)
    return combo
