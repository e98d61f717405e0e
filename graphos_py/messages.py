"""The message list: errors, warnings and information, each with why and what to try."""

from __future__ import annotations

from datetime import datetime

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QAction, QGuiApplication, QKeySequence
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.errors import UserError
from graphos_py.icons import bind_icon, icon
from graphos_py.theme import theme
from graphos_py.translation import tr

KINDS = {"error": ("Errors", "bad"), "warning": ("Warnings", "warn"), "info": ("Information", "muted")}
LIMIT = 2000


def sentences(what: object) -> str:
    """Return the text of a message: the three sentences of a `UserError` on lines, else the translated text."""
    if isinstance(what, UserError):
        return "\n".join(tr(part) for part in (what.what, what.why, what.todo) if part)
    return tr(what) if isinstance(what, str) else str(what)


class Messages(QWidget):
    """A list that can be filtered by kind; the newest is at the bottom and in view."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        column = QVBoxLayout(self)
        column.setContentsMargins(4, 0, 4, 4)
        column.setSpacing(4)
        row = QHBoxLayout()
        row.setSpacing(2)
        self._counts: dict[str, int] = dict.fromkeys(KINDS, 0)
        self._filters: dict[str, QToolButton] = {}
        for kind, (_, colour) in KINDS.items():
            button = QToolButton()
            button.setProperty("role", "flat")
            button.setCheckable(True)
            button.setChecked(True)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
            bind_icon(button, kind, colour)
            button.toggled.connect(self._filter)
            self._filters[kind] = button
            row.addWidget(button)
        row.addStretch(1)
        clear = QToolButton()
        clear.setProperty("role", "flat")
        clear.setToolTip(tr("Clear the messages"))
        clear.setAccessibleName(clear.toolTip())
        bind_icon(clear, "trash", "muted")
        clear.clicked.connect(self.clear)
        row.addWidget(clear)
        column.addLayout(row)
        self._list = QListWidget()
        self._list.setWordWrap(True)
        self._list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.setIconSize(QSize(16, 16))
        self._list.setSelectionMode(QListWidget.SelectionMode.ExtendedSelection)
        self._list.setVerticalScrollMode(QListWidget.ScrollMode.ScrollPerPixel)
        copy = QAction(tr("Copy"), self._list)
        copy.setShortcut(QKeySequence.StandardKey.Copy)
        copy.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)
        copy.triggered.connect(self._copy)
        self._list.addAction(copy)
        self._list.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        column.addWidget(self._list, 1)
        self._empty = QLabel(tr("What the program has to say appears here, each with what to try."))
        self._empty.setProperty("role", "caption")
        self._empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._empty.setWordWrap(True)
        column.addWidget(self._empty, 1)
        theme().changed.connect(self._recolour)
        self._label()

    def add(self, kind: str, what: object) -> None:
        """Append a message; a `UserError` is shown as its three sentences."""
        item = QListWidgetItem(icon(kind, KINDS[kind][1]), sentences(what))
        item.setData(Qt.ItemDataRole.UserRole, kind)
        item.setToolTip(datetime.now().strftime("%H:%M:%S"))
        self._list.addItem(item)
        if self._list.count() > LIMIT:
            old = self._list.takeItem(0)
            self._counts[old.data(Qt.ItemDataRole.UserRole)] -= 1
        self._counts[kind] += 1
        item.setHidden(not self._filters[kind].isChecked())
        self._list.scrollToBottom()
        self._label()

    def texts(self, kind: str | None = None) -> list[str]:
        """Return the messages, of one kind if given."""
        items = [self._list.item(i) for i in range(self._list.count())]
        return [i.text() for i in items if kind in (None, i.data(Qt.ItemDataRole.UserRole))]

    def clear(self) -> None:
        """Remove all messages."""
        self._list.clear()
        self._counts = dict.fromkeys(KINDS, 0)
        self._label()

    def _label(self) -> None:
        for kind, button in self._filters.items():
            button.setText(f"{tr(KINDS[kind][0])} {self._counts[kind]}")
            button.setAccessibleName(button.text())
        some = self._list.count() > 0
        self._list.setVisible(some)
        self._empty.setVisible(not some)

    def _filter(self) -> None:
        for i in range(self._list.count()):
            item = self._list.item(i)
            item.setHidden(not self._filters[item.data(Qt.ItemDataRole.UserRole)].isChecked())

    def _recolour(self) -> None:
        for i in range(self._list.count()):
            item = self._list.item(i)
            kind = item.data(Qt.ItemDataRole.UserRole)
            item.setIcon(icon(kind, KINDS[kind][1]))

    def _copy(self) -> None:
        chosen = self._list.selectedItems()
        QGuiApplication.clipboard().setText("\n\n".join(item.text() for item in chosen))
