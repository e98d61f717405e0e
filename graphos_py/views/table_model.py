"""The columns of a table and their order: texts for people, true values for sorting."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, Qt

from graphos_core.data.record import Array
from graphos_core.number_format import format_value, group_thousands

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
    decimals : int or None
        Decimal places of all numbers without standard deviation, so that they can be compared; None for `digits`.
    """

    title: str
    values: Sequence[Any] | Array
    unit: str = ""
    sigmas: Sequence[float] | Array | None = None
    digits: int = 4
    help: str = ""
    decimals: int | None = None

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
        if self.decimals is not None and sigma is None and isinstance(value, float) and math.isfinite(value):
            return group_thousands(f"{value:.{self.decimals}f}")
        return format_value(value, sigma, digits=self.digits)

    def sort_key(self, row: int) -> tuple[int, Any]:
        """Return what a cell is sorted by: numbers by value, texts as words, nothing last."""
        value = self.values[row]
        if isinstance(value, str):
            return 1, [int(part) if part.isdigit() else part.casefold() for part in _runs(value)]
        if value is None or (isinstance(value, float | np.floating) and math.isnan(value)):
            return 2, 0
        return 0, float(value)

    @cached_property
    def is_text(self) -> bool:
        """Whether cells are texts, which are left-aligned."""
        if isinstance(self.values, np.ndarray) and self.values.dtype != object:
            return bool(self.values.dtype.kind in "US")
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
