"""The window: time to the first paint, longest block of its thread, and time from Stop to stopped.

    python benchmarks/window.py start [--repeat N]
    python benchmarks/window.py block PHOTOS [--until STAGE] [--where]
    python benchmarks/window.py cancel PHOTOS [--until STAGE]

`start` starts the program anew each time and takes the median. `block` runs the steps on the photos while a timer
ticks every 10 ms in the window's thread: a tick that comes late is a block; ``--where`` prints what the thread did
meanwhile. `cancel` stops each step ever later and measures until it has stopped; the step then runs again.
"""

from __future__ import annotations

import argparse
import faulthandler
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

STAGES = ("preprocessing", "features", "adjustment", "dense", "quality")
TICK_S = 0.01
BLOCK_S = 0.1

FIRST_PAINT = """
import sys, time
from PySide6.QtCore import QEvent, QObject, QSettings
from graphos_py.app import Application, make_application
from graphos_py.settings import Settings
app = make_application()
application = Application(Settings(QSettings(sys.argv[1], QSettings.Format.IniFormat)))
class Watch(QObject):
    def eventFilter(self, watched, event):
        if event.type() == QEvent.Type.UpdateRequest:
            watched.removeEventFilter(self)
            watched.event(event)
            print(time.time(), flush=True)
            application.window.close()
            app.quit()
            return True
        return False
watch = Watch()
application.window.installEventFilter(watch)
application.show()
app.exec()
"""


def start(repeat: int) -> None:
    """Print the times from the start of the process to the first painted window."""
    times = []
    with tempfile.TemporaryDirectory() as scratch:
        for _ in range(repeat + 1):
            begun = time.time()
            done = subprocess.run(
                [sys.executable, "-c", FIRST_PAINT, f"{scratch}/settings.ini"],
                capture_output=True, text=True, timeout=120, check=False,
            )  # fmt: skip
            if not done.stdout.strip():
                raise SystemExit(done.stderr)
            times.append(float(done.stdout.split()[0]) - begun)
    warm = times[1:]
    listed = ", ".join(f"{t:.2f}" for t in warm)
    print(
        f"first paint, warm: median {statistics.median(warm):.2f} s of {listed}; first of all {times[0]:.2f} s"
    )


class Watchdog:
    """Collects late ticks of the window's thread, and from another thread what it was doing."""

    def __init__(self, window: Any, where: bool) -> None:
        from PySide6.QtCore import QTimer

        self.window = window
        self.blocks: list[tuple[float, str]] = []
        self._last = time.perf_counter()
        self._timer = QTimer(window)
        self._timer.timeout.connect(self._tick)
        self._timer.start(round(1000 * TICK_S))
        self._stacks = tempfile.TemporaryFile("w+") if where else None  # noqa: SIM115  lives with the watchdog
        self._tick()

    def _tick(self) -> None:
        now = time.perf_counter()
        late = now - self._last - TICK_S
        if late > 0.5 * BLOCK_S:
            self.blocks.append((late, self.window.session.running or "-"))
        self._last = now
        if self._stacks is not None:  # written by C: it holds no frame, so no painter outlives its event
            faulthandler.dump_traceback_later(0.7 * BLOCK_S, file=self._stacks)

    def stop(self) -> None:
        """End watching."""
        self._timer.stop()
        faulthandler.cancel_dump_traceback_later()

    def places(self) -> list[tuple[str, int]]:
        """Return what the window's thread did during blocks, most frequent first."""
        if self._stacks is None:
            return []
        self._stacks.seek(0)
        found: Counter[str] = Counter()
        for dump in self._stacks.read().split("Timeout (")[1:]:
            frames = dump.split("Current thread")[-1] if "Current thread" in dump else dump
            main = frames.split("Thread 0x")[-1] if "Current thread" not in dump else frames
            lines = [line.strip() for line in main.splitlines() if line.strip().startswith("File")]
            found[" < ".join(lines[:7]).replace("File ", "")] += 1
        return found.most_common(12)


def opened(photos: Path, folder: Path) -> Any:
    """Return a window with a new project of the photos."""
    from PySide6.QtCore import QSettings

    from graphos_core.project import Project
    from graphos_py.app import Application, make_application
    from graphos_py.settings import Settings

    make_application()
    project = Project.create(folder / "project", photos, name="Window")
    settings = Settings(QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat))
    application = Application(settings)
    window = application.window
    window.resize(1600, 1000)
    application.show(project.folder)
    until(lambda: window.session.project is not None and not window.jobs.running)
    window.benchmark = application
    return window


def until(done: Any, limit_s: float = 1200.0) -> None:
    """Let events happen until `done()`."""
    from PySide6.QtCore import QEventLoop, QTimer

    loop, end = QEventLoop(), time.monotonic() + limit_s
    timer = QTimer()
    timer.timeout.connect(lambda: loop.quit() if done() or time.monotonic() > end else None)
    timer.start(15)
    loop.exec()


def block(photos: Path, goal: str, where: bool) -> None:
    """Print the late ticks while the steps run, each in its tab, and while every tab is then shown."""
    with tempfile.TemporaryDirectory() as scratch:
        window = opened(photos, Path(scratch))
        for what in ("running", "showing"):
            dog = Watchdog(window, where)
            for stage in STAGES[: STAGES.index(goal) + 1]:
                window.show_tab(stage)
                if what == "running":
                    window.session.run(stage)
                until(lambda: window.session.running is None and not window.jobs.running)
                views = window.stage_tab(stage).views
                for page in range(views.count()):
                    views.setCurrentIndex(page)
                    ready = time.monotonic() + 0.4
                    until(lambda ready=ready: time.monotonic() > ready)
            dog.stop()
            longest = sorted(dog.blocks, reverse=True)[:8]
            print(f"{what}: {sum(late > BLOCK_S for late, _ in dog.blocks)} blocks over {BLOCK_S:.1f} s; longest: "
                  + ", ".join(f"{1000 * late:.0f} ms ({stage})" for late, stage in longest))  # fmt: skip
            for place, count in dog.places():
                print(f"  {count:4d}  {place}")
        for kind in ("error", "warning"):
            print(kind, window.messages.texts(kind))
        window.close()


def cancel(photos: Path, goal: str) -> None:
    """Print the times from Stop to stopped."""
    with tempfile.TemporaryDirectory() as scratch:
        window = opened(photos, Path(scratch))
        session = window.session
        for stage in STAGES[: STAGES.index(goal) + 1]:
            window.show_tab(stage)
            times, wait_s = [], 0.3
            while session.pipeline.state(stage).status != "done" and stage not in session.failed:
                session.run(stage)
                end = time.monotonic() + wait_s
                until(lambda end=end: session.running is None or time.monotonic() > end)
                if session.running is not None:
                    asked = time.perf_counter()
                    session.stop()
                    until(lambda: session.running is None)
                    times.append((time.perf_counter() - asked, wait_s))
                wait_s *= 1.35
            listed = ", ".join(f"{t:.2f} (after {w:.1f})" for t, w in times)
            print(f"{stage}: longest {max([t for t, _ in times], default=0):.2f} s; {listed}", flush=True)
        print(window.messages.texts("error"))
        window.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("start", "block", "cancel"))
    parser.add_argument("photos", type=Path, nargs="?")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--until", choices=STAGES, default="adjustment")
    parser.add_argument("--where", action="store_true")
    asked = parser.parse_args()
    if asked.what == "start":
        start(asked.repeat)
    elif asked.photos is None:
        parser.error("which photos?")
    elif asked.what == "block":
        block(asked.photos, asked.until, asked.where)
    else:
        cancel(asked.photos, asked.until)


if __name__ == "__main__":
    main()
