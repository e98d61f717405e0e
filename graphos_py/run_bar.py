"""Run and Stop of a tab, with progress, time left, and the reason when Run is disabled."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QPushButton, QSizePolicy, QWidget

from graphos_core.registry import Stage
from graphos_py.icons import bind_icon
from graphos_py.session import STAGE_LABELS, Progress
from graphos_py.translation import tr


def seconds_text(seconds: float) -> str:
    """Return a time in words that are only as exact as an estimate can be."""
    if seconds < 60:
        return tr("{n} s left", n=max(1, round(seconds)))
    if seconds < 3600:
        return tr("{n} min left", n=round(seconds / 60))
    return tr("{n} h left", n=f"{seconds / 3600:.1f}")


def progress_text(progress: Progress) -> str:
    """Return ``"63 % · pairs 34 of 55 · 12 s left"``."""
    share = 100 * progress.done / progress.total if progress.total else 0
    parts = [f"{share:.0f} %"]
    if progress.total > 1:
        parts.append(
            tr("{what} {done} of {total}", what=tr(progress.what), done=f"{progress.done:.0f}",
               total=f"{progress.total:.0f}")
        )  # fmt: skip
    else:
        parts.append(tr(progress.what))
    if progress.seconds_left is not None:
        parts.append(seconds_text(progress.seconds_left))
    return " · ".join(parts)


class RunBar(QWidget):
    """The row above form and view."""

    run = Signal()
    stop = Signal()

    def __init__(self, stage: Stage) -> None:
        super().__init__()
        self.stage = stage
        row = QHBoxLayout(self)
        row.setContentsMargins(8, 8, 8, 4)
        row.setSpacing(8)
        self.title = QLabel(tr(STAGE_LABELS[stage]))
        self.title.setProperty("role", "title")
        self.run_button = QPushButton(tr("Run"))
        self.run_button.setProperty("role", "primary")
        self.run_button.setToolTip(tr("Run this step, and the earlier ones that are missing (F5)"))
        bind_icon(self.run_button, "run", "on_accent")
        self.run_button.clicked.connect(self.run)
        self.stop_button = QPushButton(tr("Stop"))
        self.stop_button.setToolTip(tr("Stop; what is finished stays (Esc)"))
        bind_icon(self.stop_button, "stop", "bad")
        self.stop_button.clicked.connect(self.stop)
        self.bar = QProgressBar()
        self.bar.setTextVisible(False)
        self.bar.setMinimumWidth(140)
        self.bar.setMaximumWidth(320)
        self.bar.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.text = QLabel()
        self.text.setProperty("role", "caption")
        self.text.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        for widget in (self.title, self.run_button, self.stop_button, self.bar):
            row.addWidget(widget)
        row.addWidget(self.text, 1)
        self.show_idle("", "")

    def show_idle(self, reason: str, line: str) -> None:
        """Show that nothing of the stage runs; `reason` says why it cannot, `line` where it stands."""
        self.run_button.setVisible(True)
        self.run_button.setEnabled(not reason)
        self.stop_button.hide()
        self.bar.hide()
        bind_icon(self.run_button, "run", "disabled" if reason else "on_accent")
        self.text.setText(tr(reason) if reason else tr(line))
        self.text.setToolTip(self.text.text())

    def show_running(self, stopping: bool) -> None:
        """Show that the stage runs."""
        self.run_button.hide()
        self.stop_button.setVisible(True)
        self.stop_button.setEnabled(not stopping)
        if not self.bar.isVisible():
            self.bar.setRange(0, 0)
        self.bar.show()
        self.text.setText(tr("Stopping …") if stopping else tr("Starting …"))

    def show_progress(self, progress: Progress) -> None:
        """Show how far it is."""
        self.bar.setRange(0, 1000)
        self.bar.setValue(round(1000 * progress.done / progress.total) if progress.total else 0)
        if self.stop_button.isEnabled():
            self.text.setText(progress_text(progress))
