"""The iterations of an adjustment as a player: what each step did to cost, step, damping and gradient."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSlider, QToolButton

from graphos_core.data import IterationRecord
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_py.icons import bind_icon
from graphos_py.result_page import ResultPage
from graphos_py.translation import tr
from graphos_py.views.plot_view import PlotView
from graphos_py.views.table_view import Column, TableView

MOST_CAMERAS = 3
"""Cameras whose principal distance has a column."""
PLAY_MS, WHOLE_MS = 700, 15_000
"""Longest time of one iteration, and of all together, while playing."""


class IterationsPage(ResultPage):
    """Play, step and step back over the iterations; the plot marks where one is, the table has all numbers."""

    label = "Iterations"
    level: Level = "student"

    def __init__(self) -> None:
        super().__init__()
        self.records: list[IterationRecord] = []
        self.now = 0
        self._timer = QTimer(self, interval=PLAY_MS)
        self._timer.timeout.connect(self._tick)
        self.plot, self.table = PlotView(), TableView()
        self.plot.set_empty_text(
            tr("How the adjustment converges"), tr("Run this step; every iteration appears here.")
        )
        self.table.set_empty_text("", "")
        self.table.row_selected.connect(lambda row: self.go(row) if row >= 0 else None)
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setContentsMargins(12, 4, 12, 6)
        self.column.addWidget(self.plot, 3)
        self.column.addLayout(self._bar())
        self.column.addWidget(self.said)
        self.column.addWidget(self.table, 2)

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(12, 4, 12, 0)
        self.buttons: dict[str, QToolButton] = {}
        for symbol, tip, then in (
            ("to start", tr("To the start (Home)"), lambda: self.go(0)),
            ("step back", tr("One iteration back (←)"), lambda: self.go(self.now - 1)),
            ("run", tr("Play (Space)"), self.play),
            ("step", tr("One iteration on (→)"), lambda: self.go(self.now + 1)),
        ):
            button = QToolButton()
            button.setProperty("role", "flat")
            button.setToolTip(tip)
            button.setAccessibleName(tip)
            bind_icon(button, symbol, "text")
            button.clicked.connect(then)
            self.buttons[symbol] = button
            bar.addWidget(button)
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setAccessibleName(tr("Iteration"))
        self.slider.valueChanged.connect(self.go)
        bar.addWidget(self.slider, 1)
        self.place = QLabel()
        bar.addWidget(self.place)
        return bar

    # ------------------------------------------------------------------------------------------------ records

    def fill(self) -> None:
        """Take the iterations of the result."""
        self.set_records([] if self.result is None else list(self.result.adjustment.iterations))

    def add_records(self, records: Sequence[IterationRecord]) -> None:
        """Take iterations while the adjustment runs; number 0 begins anew."""
        for record in records:
            if record.iteration == 0:
                self.records = []
            self.records.append(record)
        if self.isVisible():
            self.set_records(self.records)

    def set_records(self, records: list[IterationRecord]) -> None:
        """Show iterations, the last one first."""
        self.records = records
        self._timer.stop()
        self._timer.setInterval(min(PLAY_MS, WHOLE_MS // max(len(records), 1)))
        self.slider.blockSignals(True)
        self.slider.setRange(0, max(len(records) - 1, 0))
        self.slider.blockSignals(False)
        self.table.set_table(iteration_columns(records))
        for widget in (*self.buttons.values(), self.slider):
            widget.setEnabled(len(records) > 1)
        if not records:
            self.plot.clear()
            self.said.setText("")
            self.place.setText("")
            return
        self.go(len(records) - 1)

    # ------------------------------------------------------------------------------------------------- player

    def go(self, number: int) -> None:
        """Show one iteration."""
        if not self.records:
            return
        self.now = min(max(number, 0), len(self.records) - 1)
        self.slider.blockSignals(True)
        self.slider.setValue(self.now)
        self.slider.blockSignals(False)
        self.place.setText(tr("{n} of {total}", n=self.now, total=len(self.records) - 1))
        self.said.setText(step_sentence(self.records, self.now))
        self.table.select_rows([self.now])
        numbers = np.arange(len(self.records), dtype=float)
        series = {tr(label): self._column(key, self.now) for key, label in _SERIES.items()}
        shown = {label: values for label, values in series.items() if np.isfinite(values).any()}
        self.plot.show_lines(
            numbers,
            shown,
            tr("iteration"),
            tr("relative to the start"),
            log_y=True,
            title=_title(self.result),
        )

    def _column(self, key: str, last: int) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Return a series over its first positive value, up to the iteration that is shown."""
        values = np.array([getattr(record, key) for record in self.records], dtype=np.float64)
        values = values - values[-1] if key == "cost" else values
        values = np.where(np.isfinite(values) & (values > 0), values, np.nan)
        first = next((v for v in values if math.isfinite(v)), 1.0)
        values = values / first
        values[last + 1 :] = np.nan
        return values

    def play(self) -> None:
        """Play from the start, or from where one is; again to pause."""
        if self._timer.isActive():
            self._timer.stop()
        else:
            if self.now >= len(self.records) - 1:
                self.go(0)
            self._timer.start()
        bind_icon(self.buttons["run"], "pause" if self._timer.isActive() else "run", "text")

    def _tick(self) -> None:
        self.go(self.now + 1)
        if self.now >= len(self.records) - 1:
            self._timer.stop()
            bind_icon(self.buttons["run"], "run", "text")

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Space plays, arrows step, Home and End jump."""
        actions: dict[Qt.Key, Callable[[], None]] = {
            Qt.Key.Key_Space: self.play, Qt.Key.Key_Right: lambda: self.go(self.now + 1),
            Qt.Key.Key_Left: lambda: self.go(self.now - 1), Qt.Key.Key_Home: lambda: self.go(0),
            Qt.Key.Key_End: lambda: self.go(len(self.records) - 1),
        }  # fmt: skip
        action = actions.get(Qt.Key(event.key()))
        if action is None:
            super().keyPressEvent(event)
        else:
            action()


_SERIES = {"cost": "cost above its end", "step": "step", "gradient": "gradient", "damping": "damping"}


def _title(result: Any) -> str:
    return "" if result is None else tr(result.adjustment.stop_reason)


def iteration_columns(records: Sequence[IterationRecord]) -> list[Column]:
    """Return one row per iteration."""
    if not records:
        return []
    return [
        Column(tr("iteration"), [record.iteration for record in records]),
        Column(tr("cost"), [record.cost for record in records], digits=8, help=tr("½ Σ ρ(v²/σ²)")),
        Column(tr("step"), [record.step for record in records], digits=3,
               help=tr("Norm of the parameter step over the norm of the parameters.")),
        Column(tr("damping"), [record.damping for record in records], digits=3,
               help=tr("What the method steers with: λ, the share of a step, or the radius of the trust region.")),
        Column(tr("gradient"), [record.gradient for record in records], digits=3,
               help=tr("Largest element of the gradient.")),
        Column(tr("accepted"), [bool(record.accepted) for record in records]),
        *_interior_columns(records),
    ]  # fmt: skip


def _interior_columns(records: Sequence[IterationRecord]) -> list[Column]:
    """Return the principal distance of the first cameras after every iteration."""
    known = [record.interior for record in records]
    if any(values is None for values in known):
        return []
    cameras = min(len(values) for values in known if values is not None)
    return [
        Column(tr("f") if cameras == 1 else tr("f, camera {n}", n=c + 1),
               [float(values[c, 0]) for values in known if values is not None], "px", digits=7,
               help=tr("Principal distance after the iteration."))
        for c in range(min(cameras, MOST_CAMERAS))
    ]  # fmt: skip


def step_sentence(records: Sequence[IterationRecord], number: int) -> str:
    """Say in words what an iteration did."""
    now = records[number]
    cost = format_value(now.cost, digits=6)
    if number == 0:
        return tr("Start: the cost of the approximate values is {cost}.", cost=cost)
    before = records[number - 1]
    damping = format_value(now.damping, digits=2)
    if not now.accepted:
        return tr(
            "The step would have raised the cost and was refused; the damping becomes {damping}.",
            damping=damping,
        )
    share = 100 * (before.cost - now.cost) / before.cost if before.cost > 0 else 0.0
    return tr("The step was taken: the cost falls by {share} % to {cost}; damping {damping}, largest gradient {gradient}.",
              share=format_value(share, digits=2), cost=cost, damping=damping,
              gradient=format_value(now.gradient, digits=2))  # fmt: skip
