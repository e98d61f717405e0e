"""What every page has that shows a part of a result."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QToolButton, QVBoxLayout, QWidget

from graphos_core.params import Level
from graphos_py.icons import bind_icon
from graphos_py.settings import LEVELS
from graphos_py.translation import tr


class ResultPage(QWidget):
    """A page that shows a part of a result; filled when it is seen, so that hidden pages cost nothing.

    A subclass names its `label` and the lowest `level` that sees it, and fills itself in `fill`.

    Signals
    -------
    photo_wanted(index)
        A photo of the project.
    lesson(name)
        The person wants to read a lesson.
    """

    label = ""
    level: Level = "novice"
    photo_wanted = Signal(int)
    lesson = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.result: Any = None
        self._stale = True
        self.column = QVBoxLayout(self)
        self.column.setContentsMargins(0, 0, 0, 0)
        self.column.setSpacing(0)

    def show_result(self, result: Any) -> None:
        """Take a result, or None for none."""
        self.result, self._stale = result, True
        if self.isVisible():
            self._refresh()

    def fill(self) -> None:
        """Fill the page from `result`, which may be None."""
        raise NotImplementedError

    def show_photo(self, index: int) -> None:
        """Another photo was selected; nothing by default."""

    def set_level(self, level: Level) -> None:
        """Show what belongs to a level; nothing by default."""

    def seen_by(self, level: Level) -> bool:
        """Return whether a level sees this page."""
        return LEVELS.index(self.level) <= LEVELS.index(level)

    def lesson_button(self, name: str) -> QToolButton:
        """Return a button that opens a lesson."""
        button = QToolButton()
        button.setProperty("role", "flat")
        button.setToolTip(tr("Read the lesson"))
        button.setAccessibleName(tr("Read the lesson"))
        bind_icon(button, "learn", "muted")
        button.clicked.connect(lambda: self.lesson.emit(name))
        return button

    def _refresh(self) -> None:
        if self._stale:
            self._stale = False
            self.fill()

    def showEvent(self, event: Any) -> None:
        """Fill what is stale."""
        super().showEvent(event)
        self._refresh()
