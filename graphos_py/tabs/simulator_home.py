"""The button “Take home”: picture, data and state of a simulator to a file, and a state back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog, QMenu, QMessageBox, QToolButton

from graphos_py.icons import bind_icon
from graphos_py.translation import tr

if TYPE_CHECKING:
    from graphos_py.tabs.simulator_page import SimulatorPage


class TakeHome(QToolButton):
    """Asks for a file and lets the page write or read it."""

    def __init__(self, page: SimulatorPage) -> None:
        super().__init__(page)
        self._page = page
        self.setText(tr("Take home"))
        bind_icon(self, "save")
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        menu = QMenu(self)
        for text, ending in (
            (tr("Picture (PNG)…"), "png"),
            (tr("Picture (SVG)…"), "svg"),
            (tr("Data (CSV)…"), "csv"),
            (tr("State (TOML)…"), "toml"),
        ):
            menu.addAction(text).triggered.connect(lambda _=False, e=ending: self._save(e))
        menu.addSeparator()
        menu.addAction(tr("Open a state…")).triggered.connect(self._open)
        self.setMenu(menu)

    def _save(self, ending: str) -> None:
        start = str(Path.home() / f"{self._page.simulator.name}.{ending}")
        name, _ = QFileDialog.getSaveFileName(self, tr("Take home"), start, f"{ending.upper()} (*.{ending})")
        if not name:
            return
        try:
            self._page.save(Path(name).with_suffix(f".{ending}"))
        except OSError as problem:
            QMessageBox.warning(self, tr("Take home"), tr("Nothing was written: {why}", why=problem))

    def _open(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, tr("Open a state"), str(Path.home()), "TOML (*.toml)")
        if name:
            self._page.open_state(Path(name))
