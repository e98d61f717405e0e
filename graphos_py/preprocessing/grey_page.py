"""Every way to grey on the selected photo: contrast kept, keypoints found, and the picture of the chosen row."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from graphos_core.data import Array
from graphos_core.preprocessing.grey_variants import GreyVariant, compare_grey_variants
from graphos_core.run import Run
from graphos_py.icons import bind_icon
from graphos_py.jobs import Job
from graphos_py.session import Session
from graphos_py.translation import tr
from graphos_py.views.table_view import Column, TableView


def keypoint_counter(run: Run) -> Any:
    """Return a function that counts the keypoints the default SIFT finds on a grey photo."""
    from graphos_core.registry import find

    sift = find("features", "sift")

    def count(grey: Array) -> int:
        found = sift.function(grey, np.repeat(grey[:, :, None], 3, axis=2), sift.params(), run=run)
        return int(found.found)

    return count


def compared(read: Callable[[], Array], run: Run) -> tuple[GreyVariant, ...] | None:
    """Compare the ways to grey on a photo that `read` reads; None for a photo without colour."""
    pixels = read()
    if pixels.ndim != 3 or pixels.shape[2] != 3:
        return None
    return compare_grey_variants(pixels, keypoint_counter(run), run=run)


class GreyPage(QWidget):
    """A button, a table, and one button more that puts the chosen row into the recipe."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.rows: tuple[GreyVariant, ...] = ()
        self._job: Job | None = None
        self._asked = ""
        self.button = QPushButton(tr("Compare the ways to grey on this photo"))
        bind_icon(self.button, "run", "text")
        self.button.clicked.connect(self.compare)
        self.use = QPushButton(tr("Use the selected one"))
        self.use.clicked.connect(self.apply)
        self.note = QLabel()
        self.note.setWordWrap(True)
        self.note.setProperty("role", "caption")
        self.table = TableView()
        self.table.set_empty_text(
            tr("Here you will see how much colour contrast each way to grey keeps"),
            tr("Compare them on the selected photo to fill the table."),
        )
        self.table.row_selected.connect(lambda _: self._buttons())
        row = QHBoxLayout()
        row.addWidget(self.button)
        row.addWidget(self.use)
        row.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 8, 12, 8)
        column.setSpacing(8)
        column.addLayout(row)
        column.addWidget(self.note)
        column.addWidget(self.table, 1)
        session.photo_selected.connect(lambda _: self._forget())
        session.project_changed.connect(self._forget)
        self._forget()

    def compare(self) -> None:
        """Compare in the background on the selected photo."""
        project = self.session.project
        if project is None or self._job is not None or self.session.photo >= len(project.photo_set.photos):
            return
        photo = project.photo_set.photos[self.session.photo]
        seed = self.session.recipe.seed if self.session.recipe is not None else 0
        self._asked = photo.name
        read = self.session.filter_reader(photo)
        job = Job(lambda run: compared(read, run), name="ways to grey", seed=seed)
        job.succeeded.connect(self.show_rows)
        job.failed.connect(self.session.tell)
        job.finished.connect(self._over)
        self._job = self.session.jobs.start(job)
        self.note.setText(tr("Comparing on {name} …", name=photo.name))
        self._buttons()

    def show_rows(self, rows: tuple[GreyVariant, ...] | None) -> None:
        """Show what was compared; None for a photo without colour."""
        self.rows = rows or ()
        if rows is None:
            self.note.setText(tr("{name} has no colour: there is one way to grey only.", name=self._asked))
        else:
            self.note.setText(
                tr(
                    "{name} · means over contrast thresholds 1 to 15; keypoints: all that the default SIFT finds "
                    "before it limits their number. More keypoints are not better by themselves.",
                    name=self._asked,
                )
            )
        self.table.set_table(
            [
                Column(tr("way to grey"), [tr(r.label) for r in self.rows]),
                Column("CCPR", [r.ccpr for r in self.rows], decimals=3,
                       help=tr("Share of the contrasts in colour that are contrasts in grey, too.")),
                Column("CCFR", [r.ccfr for r in self.rows], decimals=3,
                       help=tr("Share of the contrasts in grey that are contrasts in colour, too.")),
                Column("E", [r.e_score for r in self.rows], decimals=3,
                       help=tr("Harmonic mean of CCPR and CCFR.")),
                Column(tr("keypoints"), [r.keypoints for r in self.rows]),
                Column(tr("time"), [1000.0 * r.seconds for r in self.rows], "ms", decimals=0),
            ]
            if self.rows
            else []
        )  # fmt: skip
        self._buttons()

    def apply(self) -> None:
        """Put the selected way to grey first into the chain, in place of others."""
        chosen = self.table.selected_rows()
        recipe = self.session.recipe
        if not chosen or recipe is None:
            return
        row = self.rows[chosen[0]]
        ways = {r.algorithm for r in self.rows}
        rest = [name for name in recipe.chosen("preprocessing", "filter") if name not in ways]
        if row.choice:
            sheet = recipe.params("preprocessing", row.algorithm).replace(weights=row.choice)
            self.session.set_params("preprocessing", row.algorithm, sheet)
        self.session.choose("preprocessing", "filter", (row.algorithm, *rest))

    def _forget(self) -> None:
        self.rows = ()
        self.note.setText(
            tr("Luma weighs the channels as the eye does; colours that are equally bright fall together.")
        )
        self.table.set_table([])
        self._buttons()

    def _over(self) -> None:
        self._job = None
        self._buttons()

    def _buttons(self) -> None:
        self.button.setEnabled(self.session.project is not None and self._job is None)
        self.use.setEnabled(bool(self.rows) and bool(self.table.selected_rows()))
        self.use.setToolTip("" if self.use.isEnabled() else tr("Select a row of the table first."))
