"""The first page: new, open, demo, labs, and the projects opened last."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from graphos_py.icons import bind_icon
from graphos_py.theme import theme
from graphos_py.translation import tr

CARDS = {
    "new": ("New project", "Choose a folder of photos; they stay where they are and are never changed."),
    "open": ("Open project", "Go on with a project and its results."),
    "demo": ("Demo project", "Twelve photos of a façade with known truth, made on this computer."),
    "lab": ("Labs", "Guided exercises with your own results: predict, do, compare, explain."),
}
STEPS = ("Photos", "Preprocessing", "Features", "Bundle adjustment", "Dense matching", "Quality control")


class Card(QPushButton):
    """A large button with icon, name and a sentence."""

    def __init__(self, symbol: str, name: str, text: str) -> None:
        super().__init__()
        self.setProperty("role", "card")
        self.setAccessibleName(tr(name))
        self.setAccessibleDescription(tr(text))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        row = self._row = QHBoxLayout(self)
        row.setContentsMargins(16, 14, 16, 14)
        row.setSpacing(14)
        self._picture = QLabel()
        row.addWidget(self._picture, 0, Qt.AlignmentFlag.AlignTop)
        column = QVBoxLayout()
        column.setSpacing(4)
        heading = QLabel(tr(name))
        heading.setProperty("role", "heading")
        sentence = QLabel(tr(text))
        sentence.setProperty("role", "caption")
        sentence.setWordWrap(True)
        column.addWidget(heading)
        column.addWidget(sentence)
        column.addStretch(1)
        row.addLayout(column, 1)
        for part in (self._picture, heading, sentence):
            part.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        bind_icon(self, symbol, "accent")

    def setIcon(self, icon: QIcon | object) -> None:
        """Show the icon beside the text instead of inside the button."""
        if isinstance(icon, QIcon):
            size = theme().px(34)
            self._picture.setPixmap(icon.pixmap(QSize(size, size)))

    def sizeHint(self) -> QSize:
        """Return the size of the texts."""
        return self._row.sizeHint()

    def minimumSizeHint(self) -> QSize:
        """Return the size of the texts."""
        return self._row.minimumSize()

    def heightForWidth(self, width: int) -> int:
        """Return the height the texts need."""
        return self._row.heightForWidth(width)

    def hasHeightForWidth(self) -> bool:
        """Follow the wrapped sentence."""
        return True


class StartPage(QScrollArea):
    """What one sees without a project."""

    new = Signal()
    open = Signal()
    demo = Signal()
    lab = Signal()
    recent = Signal(object)
    stop = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWidgetResizable(True)
        page = QWidget()
        page.setProperty("role", "paper")
        outer = QHBoxLayout(page)
        outer.setContentsMargins(32, 32, 32, 32)
        outer.addStretch(1)
        column = QVBoxLayout()
        column.setSpacing(8)
        outer.addLayout(column, 10)
        outer.addStretch(1)
        column.addStretch(2)
        title = QLabel("GRAPHOS-Py")
        title.setProperty("role", "title")
        title.setStyleSheet("font-size: 26pt; font-weight: 300;")
        self._title = title
        subtitle = QLabel(tr("From photos to a measured 3D model, every step explained."))
        subtitle.setProperty("role", "heading")
        subtitle.setStyleSheet("font-weight: 400")
        way = QLabel("  ▸  ".join(tr(step) for step in STEPS))
        way.setProperty("role", "caption")
        way.setWordWrap(True)
        for widget in (title, subtitle, way):
            column.addWidget(widget)
        column.addSpacing(24)
        grid = QGridLayout()
        grid.setSpacing(12)
        self.cards: dict[str, Card] = {}
        for number, (symbol, (name, text)) in enumerate(CARDS.items()):
            card = Card(symbol, name, text)
            card.clicked.connect(getattr(self, symbol))
            self.cards[symbol] = card
            grid.addWidget(card, number // 2, number % 2)
        grid.setColumnStretch(0, 1)
        grid.setColumnStretch(1, 1)
        column.addLayout(grid)
        hint = QLabel(tr("Or drop photos, a folder of photos or a project folder anywhere into this window."))
        hint.setProperty("role", "caption")
        column.addWidget(hint)
        column.addWidget(self._work_row())
        column.addSpacing(24)
        heading = QLabel(tr("Recent projects"))
        heading.setProperty("role", "heading")
        column.addWidget(heading)
        line = QFrame()
        line.setProperty("role", "line")
        column.addWidget(line)
        self._recent = QVBoxLayout()
        self._recent.setSpacing(0)
        column.addLayout(self._recent)
        column.addStretch(5)
        self.setWidget(page)
        theme().changed.connect(self._rescale)
        self._rescale()

    def _work_row(self) -> QWidget:
        self._work = QFrame()
        self._work.setProperty("role", "card")
        row = QHBoxLayout(self._work)
        row.setContentsMargins(16, 8, 16, 8)
        row.setSpacing(12)
        self.stop_button = QPushButton(tr("Stop"))
        bind_icon(self.stop_button, "stop", "bad")
        self.stop_button.clicked.connect(self.stop)
        self._bar = QProgressBar()
        self._bar.setTextVisible(False)
        self._bar.setFixedWidth(220)
        self._doing = QLabel()
        row.addWidget(self.stop_button)
        row.addWidget(self._bar)
        row.addWidget(self._doing, 1)
        self._work.hide()
        return self._work

    def show_work(self, text: str, share: float | None) -> None:
        """Show that something is being made; `share` 0 to 1, or None while that is unknown."""
        self._work.show()
        self._bar.setRange(0, 0 if share is None else 1000)
        self._bar.setValue(round(1000 * (share or 0.0)))
        self._doing.setText(text)
        self.cards["demo"].setEnabled(False)

    def hide_work(self) -> None:
        """Show that nothing is being made any more."""
        self._work.hide()
        self.cards["demo"].setEnabled(True)

    def show_recent(self, projects: list[Path]) -> None:
        """List the projects opened last."""
        while self._recent.count():
            item = self._recent.takeAt(0)
            widget = item.widget() if item is not None else None
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        if not projects:
            none = QLabel(tr("None yet. The demo project is a good first one."))
            none.setProperty("role", "caption")
            self._recent.addWidget(none)
        for path in projects:
            button = QPushButton(f"{path.name}    {_home_path(path.parent)}")
            button.setProperty("role", "link")
            button.setCursor(Qt.CursorShape.PointingHandCursor)
            button.clicked.connect(lambda _=False, path=path: self.recent.emit(path))
            self._recent.addWidget(button)

    def _rescale(self) -> None:
        self._title.setStyleSheet(f"font-size: {theme().points('title') * 1.6:.1f}pt; font-weight: 300;")


def _home_path(path: Path) -> str:
    """Return a path with ``~`` for the person's own folder."""
    try:
        return str(Path("~") / path.relative_to(Path.home()))
    except (ValueError, RuntimeError):
        return str(path)
