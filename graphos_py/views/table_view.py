"""A table of results: numbers with units and standard deviations, sorted by their true value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from PySide6.QtCore import (
    QAbstractTableModel,
    QItemSelection,
    QItemSelectionModel,
    QModelIndex,
    QPersistentModelIndex,
    Qt,
    Signal,
)
from PySide6.QtGui import QAction, QContextMenuEvent, QKeySequence, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractItemView, QApplication, QHeaderView, QTableView, QVBoxLayout, QWidget

from graphos_core.data.record import Array
from graphos_core.number_format import format_value
from graphos_py.views.export import Writer, csv_text, export_menu, write_csv, write_png
from graphos_py.views.painting import paint_empty_state

Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True)
class Column:
    """One column.

    Attributes
    ----------
    title : str
    values : sequence of n numbers, texts or None
    unit : str
        Shown in the header.
    sigmas : sequence of n floats or None
        Standard deviations, shown as ± and exported beside the values.
    digits : int
        Significant digits of numbers without standard deviation.
    help : str
        Shown at the header.
    """

    title: str
    values: Sequence[Any] | Array
    unit: str = ""
    sigmas: Sequence[float] | Array | None = None
    digits: int = 4
    help: str = ""

    def text(self, row: int) -> str:
        """Return a cell for people."""
        value = self.values[row]
        if isinstance(value, str):
            return value
        if isinstance(value, bool | np.bool_):
            return "✓" if value else "–"
        if isinstance(value, np.integer):
            value = int(value)
        sigma = None if self.sigmas is None else float(self.sigmas[row])
        return format_value(value, sigma, digits=self.digits)

    def sort_key(self, row: int) -> tuple[int, Any]:
        """Return what a cell is sorted by: numbers by value, texts as words, nothing last."""
        value = self.values[row]
        if isinstance(value, str):
            return 1, [int(part) if part.isdigit() else part.casefold() for part in _runs(value)]
        if value is None or (isinstance(value, float | np.floating) and math.isnan(value)):
            return 2, 0
        return 0, float(value)

    @property
    def is_text(self) -> bool:
        """Whether cells are texts, which are left-aligned."""
        return any(isinstance(value, str) for value in self.values)


class TableModel(QAbstractTableModel):
    """Columns as Qt wants them; rows in the order of sorting."""

    def __init__(self) -> None:
        super().__init__()
        self.columns: tuple[Column, ...] = ()
        self.order: list[int] = []

    def set_columns(self, columns: Sequence[Column]) -> None:
        """Show other columns."""
        self.beginResetModel()
        self.columns = tuple(columns)
        self.order = list(range(len(columns[0].values) if columns else 0))
        self.endResetModel()

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008
        """Return the number of rows."""
        return 0 if parent.isValid() else len(self.order)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008
        """Return the number of columns."""
        return 0 if parent.isValid() else len(self.columns)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return text or alignment of a cell."""
        column = self.columns[index.column()]
        if role == Qt.ItemDataRole.DisplayRole:
            return column.text(self.order[index.row()])
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return _alignment(column)
        return None

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """Return title and unit."""
        if orientation == Qt.Orientation.Vertical:
            return str(self.order[section] + 1) if role == Qt.ItemDataRole.DisplayRole else None
        column = self.columns[section]
        if role == Qt.ItemDataRole.DisplayRole:
            return f"{column.title} [{column.unit}]" if column.unit else column.title
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return _alignment(column)
        if role == Qt.ItemDataRole.ToolTipRole:
            return column.help or None
        return None

    def sort(self, column: int, order: Qt.SortOrder = Qt.SortOrder.AscendingOrder) -> None:
        """Sort by true value; rows without value stay last."""
        if not 0 <= column < len(self.columns):
            return
        self.layoutAboutToBeChanged.emit()
        before, old = self.persistentIndexList(), self.order
        keys = {row: self.columns[column].sort_key(row) for row in old}
        filled = sorted(
            (row for row in sorted(old) if keys[row][0] < 2), key=lambda row: _comparable(keys[row])
        )
        if order == Qt.SortOrder.DescendingOrder:
            filled.reverse()
        self.order = filled + [row for row in sorted(old) if keys[row][0] == 2]
        place = {row: i for i, row in enumerate(self.order)}
        after = [self.index(place[old[index.row()]], index.column()) for index in before]
        self.changePersistentIndexList(before, after)
        self.layoutChanged.emit()


class TableView(QWidget):
    """A table that sorts, copies and exports.

    Signals
    -------
    row_selected(row)
        Row as given to `set_table`, whatever the sorting; −1 for none.
    rows_selected(rows)
        All selected rows.
    row_activated(row)
        Double click or Return.
    """

    row_selected = Signal(int)
    rows_selected = Signal(list)
    row_activated = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("table")
        self.model = TableModel()
        self.table = _Table(self)
        self.table.setModel(self.model)
        self.table.setSortingEnabled(True)
        self.table.horizontalHeader().setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        box = QVBoxLayout(self)
        box.setContentsMargins(0, 0, 0, 0)
        box.addWidget(self.table)
        self.setFocusProxy(self.table)
        copy = QAction(self.tr("Copy rows"), self)
        copy.setShortcut(QKeySequence(QKeySequence.StandardKey.Copy))
        copy.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        copy.triggered.connect(self.copy)
        self.addAction(copy)
        self._copy_action = copy
        self.table.selectionModel().selectionChanged.connect(self._on_selection)
        self.table.activated.connect(lambda index: self.row_activated.emit(self.model.order[index.row()]))
        self.set_empty_text(
            self.tr("Here you will see the figures"), self.tr("Run this step to fill the table.")
        )

    def set_empty_text(self, title: str, hint: str) -> None:
        """Say in two lines what will be shown here and what to do next."""
        self.table.empty = (title, hint)
        self.table.viewport().update()

    def set_table(self, columns: Sequence[Column]) -> None:
        """Show columns of equal length; the chosen sorting stays.

        Raises
        ------
        ValueError
            When the columns differ in length.
        """
        if len({len(column.values) for column in columns}) > 1:
            raise ValueError("the columns of a table differ in length")
        header = self.table.horizontalHeader()
        section, order = header.sortIndicatorSection(), header.sortIndicatorOrder()
        self.model.set_columns(columns)
        if 0 <= section < len(columns):
            self.model.sort(section, order)
        self.table.resizeColumnsToContents()

    def selected_rows(self) -> list[int]:
        """Return the selected rows as given to `set_table`."""
        return sorted(self.model.order[index.row()] for index in self.table.selectionModel().selectedRows())

    def select_rows(self, rows: Sequence[int]) -> None:
        """Select rows as given to `set_table` and bring the first into sight. Emits nothing."""
        selection = QItemSelection()
        place = {row: i for i, row in enumerate(self.model.order)}
        shown = [place[row] for row in rows if row in place]
        last = self.model.columnCount() - 1
        for i in shown:
            selection.select(self.model.index(i, 0), self.model.index(i, last))
        model = self.table.selectionModel()
        model.blockSignals(True)
        model.select(selection, QItemSelectionModel.SelectionFlag.ClearAndSelect)
        model.blockSignals(False)
        if shown:
            self.table.scrollTo(self.model.index(shown[0], 0))
        self.table.viewport().update()

    def csv(self, rows: Sequence[int] | None = None) -> str:
        """Return rows (all in the present order if None) as CSV with full precision."""
        return csv_text(*self._csv_parts(self.model.order if rows is None else rows))

    def copy(self) -> None:
        """Copy the selected rows, or all, as CSV."""
        QApplication.clipboard().setText(self.csv(self.selected_rows() or None))

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer copy and exports."""
        export_menu(self, self.exports(), [self._copy_action]).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        return {
            "csv": lambda path: write_csv(path, *self._csv_parts(self.model.order)),
            "png": lambda path: write_png(self.table, path),
        }

    def _csv_parts(self, rows: Sequence[int]) -> tuple[list[str], list[list[object]]]:
        header: list[str] = []
        for column in self.model.columns:
            unit = f" [{column.unit}]" if column.unit else ""
            header.append(f"{column.title}{unit}")
            if column.sigmas is not None:
                header.append(f"σ {column.title}{unit}")
        body: list[list[object]] = []
        for row in rows:
            cells: list[object] = []
            for column in self.model.columns:
                cells.append(column.values[row])
                if column.sigmas is not None:
                    cells.append(column.sigmas[row])
            body.append(cells)
        return header, body

    def _on_selection(self) -> None:
        rows = self.selected_rows()
        self.rows_selected.emit(rows)
        current = self.table.currentIndex()
        row = self.model.order[current.row()] if current.isValid() else -1
        self.row_selected.emit(row if row in rows else (rows[0] if rows else -1))


class _Table(QTableView):
    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.empty = ("", "")
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.setCornerButtonEnabled(False)
        self.verticalHeader().setVisible(False)
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 8)
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        self.horizontalHeader().setHighlightSections(False)
        self.horizontalHeader().setStretchLastSection(True)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the table or the empty state."""
        super().paintEvent(event)
        if self.model() is None or self.model().rowCount() == 0:
            painter = QPainter(self.viewport())
            paint_empty_state(painter, self.viewport().rect(), self.palette(), *self.empty)


def _alignment(column: Column) -> int:
    side = Qt.AlignmentFlag.AlignLeft if column.is_text else Qt.AlignmentFlag.AlignRight
    return int(side | Qt.AlignmentFlag.AlignVCenter)


def _runs(text: str) -> list[str]:
    """Cut a text into runs of digits and others, so that DSC_9 comes before DSC_10."""
    runs: list[str] = []
    for character in text:
        if runs and runs[-1][-1].isdigit() == character.isdigit():
            runs[-1] += character
        else:
            runs.append(character)
    return runs


def _comparable(key: tuple[int, Any]) -> tuple[int, Any]:
    kind, value = key
    if kind != 1:
        return kind, value
    return kind, [(0, part, "") if isinstance(part, int) else (1, 0, part) for part in value]
