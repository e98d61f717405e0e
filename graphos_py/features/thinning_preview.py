"""What a thinning would keep of a pair's matches, before it is run on all of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QComboBox, QLabel, QVBoxLayout, QWidget

from graphos_core.data import Array, Features, PairMatches
from graphos_core.features.coverage import occupancy
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_core.run import Run
from graphos_py.jobs import Job
from graphos_py.session import Session
from graphos_py.translation import tr

CELLS = 12
"""Cells along the longer side of the photo in which matches are counted before and after."""


@dataclass(frozen=True)
class Thinned:
    """Which matches of a pair a thinning keeps, and in how many cells of photo a there are any."""

    kept: Array
    cells_before: int
    cells_after: int
    cells: int


def thin(pair: PairMatches, a: Features, b: Features, choice: tuple[Any, Any], run: Run) -> Thinned:
    """Return what a thinning algorithm with its parameters keeps of the verified matches of a pair."""
    after: PairMatches = choice[0].function(pair, a, b, choice[1], run=run)
    wide = int(max(np.asarray(pair.matches).max(initial=0), np.asarray(after.matches).max(initial=0))) + 1
    code = np.asarray(pair.matches, np.int64) @ np.array([wide, 1])
    kept = np.isin(code, np.asarray(after.matches, np.int64) @ np.array([wide, 1]))
    xy = np.asarray(a.xy)[np.asarray(pair.matches)[:, 0]]
    before, left = (occupancy(points, a.width, a.height, CELLS) for points in (xy, xy[kept]))
    return Thinned(kept, int((before > 0).sum()), int((left > 0).sum()), before.size)


class ThinningPreview(QWidget):
    """Choice of a thinning and the numbers before and after.

    Signals
    -------
    previewed(kept)
        Bool (n,) of the pair's matches; None for no preview.
    """

    previewed = Signal(object)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self._pair: tuple[PairMatches, Features, Features] | None = None
        self._job: Job | None = None
        self._again = False
        self.choice = QComboBox()
        self.choice.setAccessibleName(tr("Preview of a thinning"))
        self.choice.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.choice.setMinimumContentsLength(5)
        self.choice.setToolTip(
            tr(
                "Greys out the matches that it would leave out, with its parameters in the form; nothing is changed."
            )
        )
        self.choice.activated.connect(self._preview)
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setProperty("role", "caption")
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 2, 8, 4)
        column.setSpacing(2)
        heading = QLabel(tr("Preview of a thinning"))
        heading.setProperty("role", "caption")
        heading.setWordWrap(True)
        column.addWidget(heading)
        column.addWidget(self.choice)
        column.addWidget(self.said)
        self.said.hide()
        session.recipe_changed.connect(self._recipe_changed)

    def show_pair(self, pair: PairMatches | None, a: Features | None, b: Features | None) -> None:
        """Preview on another pair; None for none."""
        self._pair = None if pair is None or a is None or b is None else (pair, a, b)
        if self.choice.count() == 0:
            self._fill()
        self._preview()

    def _fill(self) -> None:
        from graphos_core import registry

        self.choice.addItem(tr("none"), "")
        for algorithm in registry.algorithms("features", "thinning"):
            if algorithm.name != "every":
                self.choice.addItem(tr(algorithm.label), algorithm.name)

    def _recipe_changed(self, stage: str) -> None:
        if stage == "features" and self.choice.currentData():
            self._preview()

    def _preview(self) -> None:
        name, recipe = self.choice.currentData(), self.session.recipe
        self.said.setVisible(bool(name))
        if not name or self._pair is None or recipe is None:
            self.said.setText("")
            self.previewed.emit(None)
            return
        if self._job is not None:
            self._again = True
            return
        from graphos_core import registry

        pair, a, b = self._pair
        choice = (registry.find("features", name), recipe.params("features", name))
        job = Job(lambda run: (pair, thin(pair, a, b, choice, run)), name="thinning", seed=recipe.seed)
        job.succeeded.connect(self._thinned)
        job.failed.connect(self.session.tell)
        job.finished.connect(self._over)
        self._job = self.session.jobs.start(job)

    def _thinned(self, done: tuple[PairMatches, Thinned]) -> None:
        pair, thinned = done
        if self._pair is None or pair is not self._pair[0] or not self.choice.currentData():
            return
        self.said.setText(
            tr("Keeps {n} of {all} matches, in {after} of the {before} cells of the first photo that had any.",
               n=format_value(int(thinned.kept.sum())), all=format_value(len(thinned.kept)),
               after=thinned.cells_after, before=thinned.cells_before).replace(THIN_SPACE, "\u202f")
        )  # fmt: skip
        self.previewed.emit(thinned.kept)

    def _over(self) -> None:
        self._job = None
        if self._again:
            self._again = False
            self._preview()
