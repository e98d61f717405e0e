"""The first page of the Learn tab: what to try first."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QScrollArea, QVBoxLayout, QWidget

from graphos_py.start_page import Card
from graphos_py.tabs.learn_list import Entry
from graphos_py.translation import tr

FIRST_LESSONS = ("adjustment/overlap", "features/sift", "adjustment/bundle")


class Welcome(QScrollArea):
    """Cards that open something.

    Signals
    -------
    asked : str, str
        Kind and name, as in `graphos_py.tabs.learn_list.LearnList`.
    """

    asked = Signal(str, str)

    def __init__(self) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.cards: list[Card] = []
        self._note = QLabel(tr("Loading simulators, lessons and labs …"))
        self._note.setWordWrap(True)
        page = QWidget()
        page.setProperty("role", "paper")
        self._column = QVBoxLayout(page)
        self._column.setContentsMargins(32, 24, 32, 24)
        self._column.setSpacing(8)
        title = QLabel(tr("Learn"))
        title.setProperty("role", "title")
        line = QLabel(
            tr("Drag, guess, look, and ask why: everything here is computed by the engine you work with.")
        )
        line.setProperty("role", "caption")
        line.setWordWrap(True)
        for widget in (title, line, self._note):
            self._column.addWidget(widget)
        self._column.addStretch(1)
        self.setWidget(page)

    @property
    def note(self) -> str:
        """What was said below the title."""
        return self._note.text()

    def say(self, text: str) -> None:
        """Say something below the title, such as why a page could not be opened."""
        self._note.setText(text)
        self._note.show()

    def fill(self, entries: list[Entry]) -> None:
        """Make the cards."""
        self._note.hide()
        groups = {
            "Play: drag something": [e for e in entries if e.kind == "simulator"],
            "Do: a guided lab with your own photos": [e for e in entries if e.kind == "lab"],
            "Read: three lessons to begin with": [
                e for e in entries if e.kind == "lesson" and e.name in FIRST_LESSONS
            ],
        }
        place = self._column.count() - 1
        for heading, found in groups.items():
            if not found:
                continue
            label = QLabel(tr(heading))
            label.setProperty("role", "heading")
            label.setContentsMargins(0, 14, 0, 2)
            grid = QGridLayout()
            grid.setSpacing(10)
            for column in range(3):
                grid.setColumnStretch(column, 1)
            for number, entry in enumerate(found):
                card = Card(entry.symbol, entry.title, entry.first or entry.text)
                card.clicked.connect(partial(self.asked.emit, entry.kind, entry.name))
                grid.addWidget(card, number // 3, number % 3)
                self.cards.append(card)
            self._column.insertWidget(place, label)
            self._column.insertLayout(place + 1, grid)
            place += 2
