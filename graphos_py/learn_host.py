"""The Learn tab, or what is said while it is not installed."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

from PySide6.QtWidgets import QWidget

from graphos_py.empty_state import EmptyState
from graphos_py.session import Session


def make_learn_tab(session: Session) -> QWidget:
    """Return the Learn tab for a session."""
    if find_spec("graphos_py.tabs.learn") is not None:
        tab: QWidget = import_module("graphos_py.tabs.learn").LearnTab(session)
        return tab
    return EmptyState(
        "learn",
        "Simulators, lessons and labs",
        "Here you will drag cameras and windows, see what the engine answers, and follow guided labs.",
    )
