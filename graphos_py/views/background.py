"""A quiet thread for what views compute: a result comes back in the window's thread as a call."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache
from typing import Any

from PySide6.QtCore import QObject, Signal


class Background(QObject):
    """Runs functions in a thread that all views share, one after the other.

    It belongs to a widget and goes with it: results for a closed view are dropped.
    """

    _finished = Signal(object, object)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._finished.connect(lambda then, result: then(result))

    def run(self, work: Callable[[], Any], then: Callable[[Any], None], lane: str = "views") -> None:
        """Run `work` and give its result, or the exception it raised, to `then` in the window's thread.

        Work of one lane runs in the order in which it came; lanes do not wait for each other.
        """

        def task() -> None:
            result: Any
            try:
                result = work()
            except Exception as problem:  # the view says it
                result = problem
            with suppress(RuntimeError):  # the view was closed meanwhile
                self._finished.emit(then, result)

        _thread(lane).submit(task)


@cache
def _thread(lane: str) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, thread_name_prefix=lane)
