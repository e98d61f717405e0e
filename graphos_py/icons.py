"""Icons: one family (Material Design Icons, Apache-2.0, through qtawesome), coloured by the theme."""

from __future__ import annotations

import weakref
from typing import Any

from PySide6.QtGui import QIcon

from graphos_py.theme import theme

NAMES = {
    "images": "image-multiple-outline",
    "preprocessing": "tune-variant",
    "features": "vector-polyline",
    "adjustment": "axis-arrow",
    "dense": "blur",
    "quality": "chart-bell-curve",
    "learn": "school-outline",
    "not yet": "circle-outline",
    "next": "arrow-right-circle",
    "done": "check-circle",
    "stale": "clock-alert-outline",
    "failed": "alert-octagon",
    "running": "progress-clock",
    "run": "play",
    "run all": "fast-forward",
    "stop": "stop",
    "new": "plus-box-outline",
    "open": "folder-open-outline",
    "recent": "history",
    "demo": "pillar",
    "lab": "flask-outline",
    "light": "white-balance-sunny",
    "dark": "weather-night",
    "error": "alert-octagon",
    "warning": "alert",
    "info": "information-outline",
    "camera": "camera-outline",
    "photo": "image-outline",
    "control": "map-marker-outline",
    "runs": "history",
    "project": "folder-outline",
    "add": "plus",
    "remove": "close",
    "up": "chevron-up",
    "down": "chevron-down",
    "right": "chevron-right",
    "reset": "circle-medium",
    "explain": "lightbulb-on-outline",
    "help": "help-circle-outline",
    "save": "content-save-outline",
    "copy": "content-copy",
    "disk": "harddisk",
    "ruler": "ruler",
    "trash": "trash-can-outline",
    "mask": "selection-off",
    "mask kept": "selection",
    "undo": "undo",
    "redo": "redo",
    "paste": "content-paste",
    "import": "table-arrow-left",
    "previous": "chevron-left",
    "target": "target",
    "check points": "map-marker-check-outline",
    "step back": "skip-previous",
    "step": "skip-next",
    "to start": "skip-backward",
    "pause": "pause",
    "phone": "cellphone",
    "compact": "camera-outline",
    "reflex": "camera-iris",
    "drone": "quadcopter",
    "fish-eye": "blur-radial",
    "compare": "compare-horizontal",
}

_bound: list[tuple[weakref.ref[Any], str, str]] = []


def icon(name: str, colour: str = "text") -> QIcon:
    """Return the icon of a thing of the program, in a colour of the theme."""
    import qtawesome

    return qtawesome.icon(
        f"mdi6.{NAMES[name]}",
        color=theme().colour(colour).name(),
        color_disabled=theme().colour("disabled").name(),
    )


def bind_icon(target: Any, name: str, colour: str = "text") -> None:
    """Give a button or action its icon, now and after every change of theme."""
    unbind_icon(target)
    target.setIcon(icon(name, colour))
    _bound.append((weakref.ref(target), name, colour))


def unbind_icon(target: Any) -> None:
    """Forget a button's icon."""
    _bound[:] = [entry for entry in _bound if entry[0]() is not None and entry[0]() is not target]


def _refresh() -> None:
    for reference, name, colour in list(_bound):
        target = reference()
        if target is None:
            continue
        try:
            target.setIcon(icon(name, colour))
        except RuntimeError:  # Qt has deleted the widget while Python still held its wrapper
            unbind_icon(target)


theme().changed.connect(_refresh)
