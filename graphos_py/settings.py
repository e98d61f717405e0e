"""What the window remembers between sessions: theme, level, scale, recent projects, layout."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QByteArray, QSettings

from graphos_core.params import Level
from graphos_py.theme import Name, system_theme

LEVELS: tuple[Level, ...] = ("novice", "student", "expert")


class Settings:
    """Typed access to the person's settings.

    Parameters
    ----------
    store : QSettings, optional
        Where they are kept; tests give a file of their own.
    """

    def __init__(self, store: QSettings | None = None) -> None:
        self._store = store or QSettings("GRAPHOS", "GRAPHOS-Py")

    @property
    def theme(self) -> Name:
        """Light or dark; what the desktop prefers until the person chooses."""
        value = self._text("theme")
        return "dark" if value == "dark" else "light" if value == "light" else system_theme()

    @theme.setter
    def theme(self, value: Name) -> None:
        self._store.setValue("theme", value)

    @property
    def level(self) -> Level:
        """Who sits in front of the window."""
        value = self._text("level")
        return next((level for level in LEVELS if level == value), "student")

    @level.setter
    def level(self, value: Level) -> None:
        self._store.setValue("level", value)

    @property
    def scale(self) -> float:
        """Font scale, 1 to 2."""
        try:
            return min(2.0, max(1.0, float(self._text("scale") or 1.0)))
        except ValueError:
            return 1.0

    @scale.setter
    def scale(self, value: float) -> None:
        self._store.setValue("scale", str(value))

    @property
    def language(self) -> str:
        """Code of the language."""
        return self._text("language") or "en"

    @language.setter
    def language(self, value: str) -> None:
        self._store.setValue("language", value)

    def recent(self) -> list[Path]:
        """Return the projects opened last that still exist, newest first."""
        stored: Any = self._store.value("recent", [])
        names = [stored] if isinstance(stored, str) else list(stored or [])
        return [Path(str(name)) for name in names if Path(str(name)).is_dir()]

    def remember(self, project: Path) -> None:
        """Put a project first in the list of recent ones."""
        others = [path for path in self.recent() if path != project]
        self._store.setValue("recent", [str(path) for path in [project, *others][:8]])

    def layout(self, key: str) -> QByteArray:
        """Return the remembered geometry or dock state; empty if none."""
        value: Any = self._store.value(key)
        return value if isinstance(value, QByteArray) else QByteArray()

    def keep_layout(self, key: str, value: QByteArray) -> None:
        """Remember the geometry or dock state."""
        self._store.setValue(key, value)

    def _text(self, key: str) -> str:
        value: Any = self._store.value(key, "")
        return str(value or "")
