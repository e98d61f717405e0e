"""A file or folder to read, with its recognised kind."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QComboBox, QFileDialog, QHBoxLayout, QLineEdit, QPushButton, QWidget

from graphos_py.dialogs import documents
from graphos_py.translation import tr

RECOGNISE = ""


class SourceLine(QWidget):
    """A path that can be typed or chosen; `folders` lets folders be chosen too.

    Signals
    -------
    changed()
    """

    changed = Signal()

    def __init__(self, *, folders: bool = False) -> None:
        super().__init__()
        self.line = QLineEdit()
        self.line.setPlaceholderText(tr("File to read"))
        self.line.textChanged.connect(self.changed)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.line, 1)
        self._button(row, tr("File …"), self._choose_file)
        if folders:
            self._button(row, tr("Folder …"), self._choose_folder)

    def _button(self, row: QHBoxLayout, text: str, then: Callable[[], None]) -> None:
        button = QPushButton(text)
        button.clicked.connect(then)
        row.addWidget(button)

    @property
    def path(self) -> Path | None:
        """The path, if it exists."""
        text = self.line.text().strip()
        path = Path(text) if text else None
        return path if path is not None and path.exists() else None

    def _choose_file(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, tr("File to read"), self._start())
        if name:
            self.line.setText(name)

    def _choose_folder(self) -> None:
        name = QFileDialog.getExistingDirectory(self, tr("Folder to read"), self._start())
        if name:
            self.line.setText(name)

    def _start(self) -> str:
        return str(self.path.parent if self.path is not None else documents())


def format_chooser(formats: Iterable[tuple[str, str]], recognise: bool) -> QComboBox:
    """Return a chooser of formats (name, label), the first one "recognise it" where wanted."""
    combo = QComboBox()
    if recognise:
        combo.addItem(tr("Recognise it"), RECOGNISE)
    for name, label in formats:
        combo.addItem(tr(label), name)
    return combo
