"""What an empty place says: two lines on what it will show, and the one thing to do next."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from graphos_py.icons import icon
from graphos_py.theme import theme
from graphos_py.translation import tr


class EmptyState(QWidget):
    """An icon, a heading, a sentence and at most one button."""

    acted = Signal()

    def __init__(self, symbol: str, heading: str, text: str, action: str = "") -> None:
        super().__init__()
        self._symbol = symbol
        column = QVBoxLayout(self)
        column.setContentsMargins(24, 24, 24, 24)
        column.setSpacing(8)
        column.addStretch(2)
        self._picture = QLabel()
        self.heading = QLabel(tr(heading))
        self.heading.setProperty("role", "heading")
        self.text = QLabel(tr(text))
        self.text.setWordWrap(True)
        self.button = QPushButton(tr(action))
        self.button.setVisible(bool(action))
        self.button.clicked.connect(self.acted)
        for label in (self._picture, self.heading, self.text):
            label.setAlignment(Qt.AlignmentFlag.AlignCenter)
        for widget in (self._picture, self.heading, self.text, self.button):
            column.addWidget(widget, 0, Qt.AlignmentFlag.AlignHCenter)
        column.addStretch(3)
        theme().changed.connect(self._draw)
        self._draw()

    def tell(self, heading: str, text: str, action: str = "") -> None:
        """Say something else."""
        self.heading.setText(tr(heading))
        self.text.setText(tr(text))
        self.button.setText(tr(action))
        self.button.setVisible(bool(action))
        self._draw()

    def _draw(self) -> None:
        width = theme().px(480)
        self.text.setFixedWidth(width)
        self.text.setMinimumHeight(self.text.heightForWidth(width))
        size = theme().px(48)
        self._picture.setPixmap(icon(self._symbol, "muted").pixmap(QSize(size, size)))
