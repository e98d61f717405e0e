"""Light and dark: palette and stylesheet made from one small table of colours, and the projector's font scale."""

from __future__ import annotations

import tempfile
import tomllib
from functools import cache
from importlib import resources
from pathlib import Path
from string import Template
from typing import Literal

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QColor, QFont, QPalette
from PySide6.QtWidgets import QApplication

Name = Literal["light", "dark"]
SIZES = {"title": 1.55, "heading": 1.18, "body": 1.0, "caption": 0.9}
"""The four text sizes, relative to the system's font."""


@cache
def colour_table() -> dict[str, dict[str, str]]:
    """Return the colours by theme and name, as ``#rrggbb``."""
    text = (resources.files("graphos_resources") / "style" / "colours.toml").read_text("utf-8")
    return tomllib.loads(text)


def contrast(a: str, b: str) -> float:
    """Return the contrast ratio of two colours (WCAG 2.2, relative luminance), 1 to 21."""

    def luminance(colour: str) -> float:
        parts = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
        red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue

    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


class Theme(QObject):
    """The look in use; `changed` is emitted after it was applied to the application."""

    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.name: Name = "light"
        self.scale = 1.0
        self._base_points = 0.0
        self._pictures = tempfile.TemporaryDirectory(prefix="graphos-style-")

    def colour(self, name: str) -> QColor:
        """Return a colour of the table."""
        return QColor(colour_table()[self.name][name])

    def points(self, size: str = "body") -> float:
        """Return a text size in points at the present scale."""
        return round(self._base_points * self.scale * SIZES[size], 2)

    def px(self, pixels: float) -> int:
        """Return a length that follows the font scale."""
        return round(pixels * (0.5 + 0.5 * self.scale))

    def apply(self, name: Name, scale: float = 1.0) -> None:
        """Dress the whole application."""
        app = QApplication.instance()
        if not isinstance(app, QApplication):
            raise RuntimeError("a theme needs a QApplication")
        if not self._base_points:
            points = app.font().pointSizeF()
            self._base_points = points if points > 0 else 10.0
        self.name, self.scale = name, min(2.0, max(1.0, scale))
        font = QFont(app.font())
        font.setPointSizeF(self.points())
        app.setFont(font)
        app.setPalette(self._palette())
        app.setStyleSheet(self._stylesheet())
        self.changed.emit()

    def _palette(self) -> QPalette:
        palette = QPalette()
        roles = {
            QPalette.ColorRole.Window: "window",
            QPalette.ColorRole.WindowText: "text",
            QPalette.ColorRole.Base: "base",
            QPalette.ColorRole.AlternateBase: "window",
            QPalette.ColorRole.Text: "text",
            QPalette.ColorRole.Button: "raised",
            QPalette.ColorRole.ButtonText: "text",
            QPalette.ColorRole.ToolTipBase: "raised",
            QPalette.ColorRole.ToolTipText: "text",
            QPalette.ColorRole.PlaceholderText: "muted",
            QPalette.ColorRole.Highlight: "accent",
            QPalette.ColorRole.HighlightedText: "on_accent",
            QPalette.ColorRole.Link: "accent",
            QPalette.ColorRole.Mid: "border",
        }
        for role, colour in roles.items():
            palette.setColor(role, self.colour(colour))
        for role in (QPalette.ColorRole.WindowText, QPalette.ColorRole.Text, QPalette.ColorRole.ButtonText):
            palette.setColor(QPalette.ColorGroup.Disabled, role, self.colour("disabled"))
        return palette

    def _stylesheet(self) -> str:
        sheet = (resources.files("graphos_resources") / "style" / "window.qss").read_text("utf-8")
        values = dict(colour_table()[self.name])
        values |= {size: f"{self.points(size)}pt" for size in SIZES}
        accent = self.colour("accent")
        values["accent_hover"] = (accent.darker(115) if self.name == "light" else accent.lighter(112)).name()
        values |= self._glyphs()
        return Template(sheet).substitute(values)

    def _glyphs(self) -> dict[str, str]:
        """Draw the few small pictures a stylesheet can only take from files."""
        shapes = {
            "arrow_down": "M4 6 L8 10 L12 6",
            "arrow_up": "M4 10 L8 6 L12 10",
            "arrow_right": "M6 4 L10 8 L6 12",
            "check": "M3.5 8.5 L6.5 11.5 L12.5 5",
            "close": "M4 4 L12 12 M12 4 L4 12",
            "float": "M4 4 H12 V12 H4 Z",
        }
        files = {}
        for shape, path in shapes.items():
            colour = self.colour("on_accent" if shape == "check" else "muted").name()
            file = Path(self._pictures.name) / f"{shape}-{self.name}.svg"
            file.write_text(
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 16 16"><path d="{path}" fill="none" '
                f'stroke="{colour}" stroke-width="1.8" stroke-linecap="round" stroke-linejoin="round"/></svg>',
                "utf-8",
            )
            files[shape] = file.as_posix()
        return files


@cache
def theme() -> Theme:
    """Return the application's theme."""
    return Theme()


def system_theme() -> Name:
    """Return what the desktop prefers."""
    app = QApplication.instance()
    hints = app.styleHints() if isinstance(app, QApplication) else None
    return "dark" if hints is not None and hints.colorScheme() == Qt.ColorScheme.Dark else "light"
