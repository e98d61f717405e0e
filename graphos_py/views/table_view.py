"""A table of results: numbers with units and standard deviations, sorted by their true value."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QItemSelection, QItemSelectionModel, Qt, Signal
from PySide6.QtGui import QAction, QContextMenuEvent, QKeySequence, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractItemView, QApplication, QHeaderView, QTableView, QVBoxLayout, QWidget

from graphos_py.views.export import Writer, csv_text, export_menu, write_csv, write_png
from graphos_py.views.painting import paint_empty_state
from graphos_py.views.table_model import Column, TableModel

__all__ = ["Column", "TableView"]


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

    def set_table(self, columns: Sequence[Column], keep_widths: bool = False) -> None:
        """Show columns of equal length; the chosen sorting stays, and with `keep_widths` the width of each column.

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
        if not keep_widths:
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
        self.horizontalHeader().setResizeContentsPrecision(60)  # rows that a width is chosen by

    def changeEvent(self, event: QEvent) -> None:
        """Follow the font scale."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 8)
            self.resizeColumnsToContents()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the table or the empty state."""
        super().paintEvent(event)
        if self.model() is None or self.model().rowCount() == 0:
            painter = QPainter(self.viewport())
            paint_empty_state(painter, self.viewport().rect(), self.palette(), *self.empty)
