"""Long work in worker threads: progress comes by queued signals, cancelling takes effect within a second.

A `Job` is a thread with a `QtRun`; `Jobs` keeps every job until Qt itself says that its thread has finished, so no
thread object is ever collected while it runs. Engine work takes `ENGINE` first: parallel kernels must not be called
from two threads at once.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from PySide6.QtCore import QObject, QThread, Signal, Slot

from graphos_core.errors import Stopped
from graphos_core.run import Run

ENGINE = threading.Lock()
"""Held while the engine computes; two runs at once would share one pool of kernel threads."""

INTERVAL_S = 0.05
"""Shortest time between two progress signals, and between two partial results of one key."""


class TimeLeft:
    """Estimates the time left of one kind of item from how fast its share grew."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._what = ""
        self._start = 0.0
        self._first = 0.0

    def seconds(self, done: float, total: float, what: str) -> float | None:
        """Return the seconds left, or None while it is too early to say."""
        now = self._clock()
        if what != self._what or done < self._first:
            self._what, self._start, self._first = what, now, done
            return None
        elapsed, gained = now - self._start, done - self._first
        if elapsed < 0.8 or gained <= 0 or total <= 0:
            return None
        return max(0.0, (total - done) * elapsed / gained)


class QtRun(Run):
    """Tells a `Job` what happens; may be called from any thread."""

    def __init__(self, job: Job, *, seed: int = 0, threads: int | None = None) -> None:
        super().__init__(threads=threads, seed=seed)
        self._job = job
        self._lock = threading.Lock()
        self._told = 0.0
        self._what = ""
        self._shown: dict[str, float] = {}
        self._kept: dict[str, list[Any]] = {}

    def progress(self, done: float, total: float, what: str) -> None:
        """Tell progress at most twenty times a second, but every change of subject and every end."""
        now = time.monotonic()
        with self._lock:
            if what == self._what and done < total and now - self._told < INTERVAL_S:
                return
            self._told, self._what = now, what
        self._job.progressed.emit(float(done), float(total), what)

    def say(self, text: str) -> None:
        """Send a sentence for the messages."""
        self._job.said.emit(text)

    def warn(self, text: str) -> None:
        """Send a warning for the messages and keep it for the report."""
        super().warn(text)
        self._job.warned.emit(text)

    def show(self, key: str, value: Any) -> None:
        """Send partial results; those that come too fast are collected and sent together, none is lost."""
        now = time.monotonic()
        with self._lock:
            self._kept.setdefault(key, []).append(value)
            if now - self._shown.get(key, 0.0) < INTERVAL_S:
                return
            self._shown[key] = now
            values = self._kept.pop(key)
        self._job.shown.emit(key, values)

    def flush(self) -> None:
        """Send what was collected and not sent yet."""
        with self._lock:
            kept, self._kept = self._kept, {}
        for key, values in kept.items():
            self._job.shown.emit(key, values)


class Job(QThread):
    """One piece of work in a thread of its own.

    Signals are emitted from the worker and delivered in the thread of the receiver. Exactly one of `succeeded`,
    `stopped` and `failed` comes, then Qt's ``finished``.
    """

    progressed = Signal(float, float, object)
    said = Signal(object)
    warned = Signal(object)
    shown = Signal(str, object)
    succeeded = Signal(object)
    stopped = Signal()
    failed = Signal(object)

    def __init__(
        self, work: Callable[[Run], Any], *, name: str = "", seed: int = 0, engine: bool = True
    ) -> None:
        super().__init__()
        self.setObjectName(name or "job")
        self.name = name
        self.qt_run = QtRun(self, seed=seed)
        self._work = work
        self._engine = engine

    def run(self) -> None:
        """Do the work; called by Qt in the new thread."""
        held = False
        try:
            while self._engine and not held:
                self.qt_run.check()
                held = ENGINE.acquire(timeout=0.1)
            if held:
                yield_to_window()
            result = self._work(self.qt_run)
            self.qt_run.flush()
            self.succeeded.emit(result)
        except Stopped:
            self.qt_run.flush()
            self.stopped.emit()
        except BaseException as problem:
            self.failed.emit(problem)
        finally:
            if held:
                ENGINE.release()

    def stop(self) -> None:
        """Ask the work to stop."""
        self.qt_run.stop()


def yield_to_window() -> None:
    """Let this thread, and those it starts, go behind the window's thread when all processors are busy."""
    if sys.platform == "linux":  # elsewhere a thread has no nice value of its own
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 5)


class Jobs(QObject):
    """Keeps running jobs alive, and ends them with the window."""

    idle = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._alive: set[Job] = set()

    def start(self, job: Job) -> Job:
        """Start a job and keep it until its thread has finished."""
        self._alive.add(job)
        job.finished.connect(self._release)
        job.start()
        return job

    @property
    def running(self) -> tuple[Job, ...]:
        """Jobs whose threads have not finished."""
        return tuple(self._alive)

    @Slot()
    def _release(self) -> None:
        """Let go of the job whose own ``finished`` arrived: all its earlier signals have been delivered by then."""
        job = self.sender()
        if isinstance(job, Job) and job in self._alive:
            self._alive.discard(job)
            job.deleteLater()
        if not self._alive:
            self.idle.emit()

    def stop_all(self, wait_ms: int = 30000) -> bool:
        """Ask every job to stop and wait for the threads; True when all have ended."""
        for job in self._alive:
            job.stop()
        for job in list(self._alive):
            if job.wait(wait_ms):
                self._alive.discard(job)
                job.deleteLater()
        return not self._alive
