"""The rows of the control table: what each column shows, and what typing into it changes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, Qt, Signal

from graphos_core.data.record import Array
from graphos_core.exchange.control_sheet import ROLES, SheetPoint
from graphos_core.exchange.table_preview import number
from graphos_core.number_format import UNKNOWN, format_value, group_thousands
from graphos_core.params import Level
from graphos_py.control.desk import ControlDesk
from graphos_py.translation import tr

Index = QModelIndex | QPersistentModelIndex
ROLE_LABELS = {"control": "control", "check": "check", "off": "off"}
TIE = "tie point"


@dataclass(frozen=True)
class TableColumn:
    """One column: its key, title, unit, explanation, and the levels that see it."""

    key: str
    title: str
    unit: str
    help: str
    levels: tuple[Level, ...] = ("novice", "student", "expert")

    @property
    def editable(self) -> bool:
        """Whether a person types here."""
        return self.key in ("name", "role") or self.key[0] in "xs"


GROWN: tuple[Level, ...] = ("student", "expert")
COLUMNS = (
    TableColumn("name", "point", "", "Unique name of the point."),
    TableColumn("role", "role", "", "Control takes part in the adjustment, check only tests it, off does neither."),
    *(TableColumn(f"x{i}", axis, "m", "Given coordinate; empty where not known.") for i, axis in enumerate("XYZ")),
    TableColumn("photos", "photos", "", "Photos in which the point is measured."),
    TableColumn("image", "image", "px", "Root mean square of the image residuals per coordinate, if the point is "
                "intersected by its rays alone; at once after every measurement.", GROWN),
    *(
        TableColumn(f"r{i}", f"Δ{axis}", "mm", "Computed − given after the last adjustment.", GROWN)
        for i, axis in enumerate("XYZ")
    ),
    TableColumn("r", "Δ", "mm", "Distance of the computed from the given point after the last adjustment."),
    *(
        TableColumn(f"s{i}", f"σ{axis}", "mm", "A priori standard deviation of the given coordinate; empty takes "
                    "the default of the adjustment, 0 holds the coordinate fixed.", GROWN)
        for i, axis in enumerate("XYZ")
    ),
)  # fmt: skip


class ControlModel(QAbstractTableModel):
    """The sheet of the desk as a table.

    Signals
    -------
    refused(sentence)
        What was typed makes no sense.
    """

    refused = Signal(str)

    def __init__(self, desk: ControlDesk) -> None:
        super().__init__()
        self.desk = desk
        self.residuals: Mapping[str, Array] = {}
        self.image_rms: Mapping[str, float] = {}
        self._shown = desk.sheet.points
        desk.changed.connect(self._changed)

    def set_residuals(self, residuals: Mapping[str, Array], image_rms: Mapping[str, float]) -> None:
        """Show residuals by point: in object space (3,) in m, and the RMS in the images in px."""
        self.residuals, self.image_rms = residuals, image_rms
        if self.rowCount():
            self.dataChanged.emit(self.index(0, 0), self.index(self.rowCount() - 1, len(COLUMNS) - 1))

    def _changed(self) -> None:
        points = self.desk.sheet.points
        if len(points) != len(self._shown):
            self.beginResetModel()
            self._shown = points
            self.endResetModel()
            return
        self._shown = points
        if points:
            self.dataChanged.emit(self.index(0, 0), self.index(len(points) - 1, len(COLUMNS) - 1))

    # ------------------------------------------------------------------------------------------------------- Qt

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008
        """Return the number of points."""
        return 0 if parent.isValid() else len(self._shown)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008
        """Return the number of columns."""
        return 0 if parent.isValid() else len(COLUMNS)

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """Return title and unit, or the explanation."""
        if orientation == Qt.Orientation.Vertical:
            return str(section + 1) if role == Qt.ItemDataRole.DisplayRole else None
        column = COLUMNS[section]
        if role == Qt.ItemDataRole.DisplayRole:
            title = tr(column.title)
            return f"{title} [{column.unit}]" if column.unit else title
        if role == Qt.ItemDataRole.ToolTipRole:
            return tr(column.help)
        return None

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Allow typing where it changes something."""
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return flags | Qt.ItemFlag.ItemIsEditable if COLUMNS[index.column()].editable else flags

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return text, editable text, alignment or explanation of a cell."""
        point, column = self._shown[index.row()], COLUMNS[index.column()]
        if role == Qt.ItemDataRole.DisplayRole:
            return self.text(point, column.key)
        if role == Qt.ItemDataRole.EditRole:
            return self.plain(point, column.key)
        if role == Qt.ItemDataRole.TextAlignmentRole:
            left = column.key in ("name", "role")
            side = Qt.AlignmentFlag.AlignLeft if left else Qt.AlignmentFlag.AlignRight
            return int(side | Qt.AlignmentFlag.AlignVCenter)
        return None

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Take what was typed, as an edit that can be undone."""
        if role != Qt.ItemDataRole.EditRole:
            return False
        row, column = index.row(), COLUMNS[index.column()]
        point, text = self._shown[row], str(value).strip()
        if text == self.plain(point, column.key):
            return False
        changed = changed_point(point, column.key, text)
        if isinstance(changed, str):
            self.refused.emit(tr(changed))
            return False
        try:
            sheet = self.desk.sheet.with_point(row, changed)
        except ValueError:
            self.refused.emit(tr("Every point needs a name of its own."))
            return False
        if self.desk.point == point.name:
            self.desk.point = changed.name
        self.refused.emit("")
        self.desk.edit(sheet, tr("Change {point}", point=changed.name))
        return True

    # ---------------------------------------------------------------------------------------------------- cells

    def text(self, point: SheetPoint, key: str) -> str:
        """Return a cell for people."""
        if key == "photos":
            return str(len(self.desk.sheet.marks_of(point.name)))
        if key == "image":
            return format_value(self.image_rms.get(point.name), digits=2)
        if key[0] == "r" and key != "role":
            residual = self.residuals.get(point.name)
            if residual is None:
                return UNKNOWN
            value = float(residual[int(key[1])]) if key[1:] else float(math.hypot(*residual))
            return _fixed(1000 * value, 2)
        if key == "role":
            return tr(ROLE_LABELS[point.role] if point.known or point.role == "off" else TIE)
        if key[0] == "x":
            return _fixed(point.xyz[int(key[1])], 4)
        return self.plain(point, key) or (UNKNOWN if key[0] == "s" else "")

    def plain(self, point: SheetPoint, key: str) -> str:
        """Return a cell as it is typed."""
        if key == "name":
            return point.name
        if key == "role":
            return point.role
        value = point.xyz[int(key[1])] if key[0] == "x" else 1000 * point.sigma[int(key[1])]
        return f"{value:.12g}" if math.isfinite(value) else ""


def changed_point(point: SheetPoint, key: str, text: str) -> SheetPoint | str:
    """Return the point after typing `text` into a column, or why that makes no sense."""
    if key == "name":
        return replace(point, name=text)
    if key == "role":
        role = next((r for r in ROLES if r == text), None)
        return "The role is control, check or off." if role is None else replace(point, role=role)
    value = number(text.replace(",", "."), ".") if text not in ("", UNKNOWN) else math.nan
    if text not in ("", UNKNOWN) and not math.isfinite(value):
        return "A number is needed here, or nothing."
    place = int(key[1])
    if key[0] == "x":
        return replace(point, xyz=_replaced(point.xyz, place, value))
    if value < 0:
        return "A standard deviation is 0 or more."
    return replace(point, sigma=_replaced(point.sigma, place, value / 1000))


def _replaced(values: tuple[float, float, float], place: int, value: float) -> tuple[float, float, float]:
    x, y, z = (value if i == place else v for i, v in enumerate(values))
    return x, y, z


def _fixed(value: float, decimals: int) -> str:
    return group_thousands(f"{value:.{decimals}f}") if math.isfinite(value) else UNKNOWN
