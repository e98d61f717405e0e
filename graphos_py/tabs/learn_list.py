"""The list of the Learn tab: simulators and lessons by room, and labs, each with a line on what it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QSize, Qt, Signal
from PySide6.QtGui import QFont, QPainter
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QStyle, QStyledItemDelegate, QStyleOptionViewItem

from graphos_py.icons import icon
from graphos_py.theme import theme
from graphos_py.translation import tr

ENTRY = int(Qt.ItemDataRole.UserRole)


@dataclass(frozen=True)
class Entry:
    """One line of the list; without `kind` a heading. `first` is the first thing to try."""

    kind: str
    name: str
    title: str
    text: str = ""
    symbol: str = ""
    first: str = ""


class LearnList(QListWidget):
    """What there is to learn with.

    Signals
    -------
    asked : str, str
        Kind (``"simulator"``, ``"lesson"``, ``"lab"``, ``"welcome"``) and name.
    """

    asked = Signal(str, str)

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName(tr("Simulators, lessons and labs"))
        self.setItemDelegate(EntryDelegate(self))
        self.setVerticalScrollMode(QListWidget.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setUniformItemSizes(False)
        self.itemClicked.connect(self._ask)
        self.itemActivated.connect(self._ask)
        theme().changed.connect(self.scheduleDelayedItemsLayout)

    def fill(self, entries: list[Entry]) -> None:
        """Show entries and headings."""
        self.clear()
        for entry in entries:
            item = QListWidgetItem(tr(entry.title))
            item.setData(ENTRY, entry)
            if entry.kind:
                item.setToolTip(tr(entry.text))
            else:
                item.setFlags(Qt.ItemFlag.NoItemFlags)
            self.addItem(item)

    def entries(self, kind: str) -> list[Entry]:
        """Return the entries of a kind."""
        found = (self.item(i).data(ENTRY) for i in range(self.count()))
        return [entry for entry in found if entry.kind == kind]

    def mark(self, kind: str, name: str) -> None:
        """Select what is open."""
        for i in range(self.count()):
            entry = self.item(i).data(ENTRY)
            if (entry.kind, entry.name) == (kind, name):
                self.setCurrentRow(i)
                return
        self.setCurrentRow(-1)

    def _ask(self, item: QListWidgetItem) -> None:
        entry = item.data(ENTRY)
        if entry.kind:
            self.asked.emit(entry.kind, entry.name)


class EntryDelegate(QStyledItemDelegate):
    """Paints title and line of an entry."""

    def sizeHint(self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex) -> QSize:
        """Return the height of two lines, or of a heading."""
        entry: Entry = index.data(ENTRY)
        line = option.fontMetrics.height()
        if entry.kind:
            return QSize(100, round(2.1 * line) + 10)
        return QSize(100, line + (22 if entry.text == "group" else 12))

    def paint(
        self, painter: QPainter, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> None:
        """Paint one entry."""
        entry: Entry = index.data(ENTRY)
        style: Any = option
        area: QRect = style.rect
        painter.save()
        if entry.kind:
            self._paint_entry(painter, style, area, entry)
        else:
            font = QFont(style.font)
            font.setBold(True)
            font.setPointSizeF(theme().points("heading" if entry.text == "group" else "caption"))
            painter.setFont(font)
            painter.setPen(theme().colour("text" if entry.text == "group" else "muted"))
            place = area.adjusted(10, 0, -6, -4)
            painter.drawText(
                place, Qt.AlignmentFlag.AlignBottom | Qt.AlignmentFlag.AlignLeft, tr(entry.title)
            )
        painter.restore()

    def _paint_entry(self, painter: QPainter, style: Any, area: QRect, entry: Entry) -> None:
        look = theme()
        if style.state & QStyle.StateFlag.State_Selected:
            painter.fillRect(area, look.colour("selected"))
            painter.fillRect(QRect(area.left(), area.top(), 3, area.height()), look.colour("accent"))
        elif style.state & QStyle.StateFlag.State_MouseOver:
            painter.fillRect(area, look.colour("hover"))
        size = look.px(20)
        icon(entry.symbol, "accent").paint(
            painter, area.left() + 12, area.center().y() - size // 2, size, size
        )
        text = area.adjusted(22 + size, 4, -8, -4)
        top, below = QRect(text), QRect(text)
        top.setHeight(text.height() // 2)
        below.setTop(top.bottom())
        painter.setPen(look.colour("text"))
        painter.setFont(style.font)
        _elided(painter, top, tr(entry.title))
        font = QFont(style.font)
        font.setPointSizeF(look.points("caption"))
        painter.setFont(font)
        painter.setPen(look.colour("muted"))
        _elided(painter, below, tr(entry.text))


def _elided(painter: QPainter, area: QRect, text: str) -> None:
    shown = painter.fontMetrics().elidedText(text, Qt.TextElideMode.ElideRight, area.width())
    painter.drawText(area, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, shown)
