"""How well the observations control each other, and which of them are suspected to be blunders."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QSplitter

from graphos_core.data import Adjustment, Array, Reliability
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_core.report.residual_figures import suspects
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.tabs.images import read_photo
from graphos_py.translation import tr
from graphos_py.views.image_view import ImageView
from graphos_py.views.table_view import Column, TableView

LISTED = 200
CLOSE_ZOOM = 4.0


class ReliabilityPage(ResultPage):
    """Suspected blunders in order; a click shows the observation in its photo."""

    label = "Reliability"
    level: Level = "expert"

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.rows: list[dict[str, Any]] = []
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setContentsMargins(12, 8, 12, 6)
        self.table = TableView()
        self.table.set_empty_text(
            tr("Which observations are suspected, and how well each is controlled"),
            tr("Run the adjustment; it tests every observation."),
        )
        self.table.row_selected.connect(self._row)
        self.image = ImageView()
        self.image.set_empty_text(tr("The chosen observation in its photo"), tr("Click a row."))
        splitter = QSplitter(Qt.Orientation.Vertical)
        splitter.addWidget(self.table)
        splitter.addWidget(self.image)
        splitter.setSizes([320, 260])
        self.column.addWidget(self.said)
        self.column.addWidget(splitter, 1)

    def fill(self) -> None:
        """Fill the table, the worst first."""
        adjustment: Adjustment | None = None if self.result is None else self.result.adjustment
        self.rows = [] if adjustment is None else suspects(adjustment, LISTED)
        self.image.set_image(None)
        found = None if adjustment is None else adjustment.reliability
        self.said.setText("" if found is None else reliability_sentence(found))
        self.table.set_table([] if adjustment is None else suspect_columns(self.rows, adjustment.block.unit))

    def show_observation(self, item: str) -> bool:
        """Select the observation that a finding names, ``"point 12 in a.jpg"``; say whether it is listed."""
        for number, row in enumerate(self.rows):
            if item.endswith(row["photo"]) and str(row["point"]).lstrip("#") in item.split():
                self.table.select_rows([number])
                self._row(number)
                return True
        return False

    def _row(self, row: int) -> None:
        """Show an observation in its photo."""
        project = self.session.project
        if not 0 <= row < len(self.rows) or project is None:
            return
        names = [photo.name for photo in project.photo_set.photos]
        name = self.rows[row]["photo"]
        if name in names:
            self.photo_wanted.emit(names.index(name))
            photo = project.photo_set.photos[names.index(name)]
            read_photo(self.session, photo, lambda read, r=row: self._read(r, read[1]))

    def _read(self, row: int, pixels: Array) -> None:
        if self.table.selected_rows()[:1] != [row] or row >= len(self.rows):
            return
        found = self.rows[row]
        place = np.asarray(found["position_px"])
        vector = self.result.adjustment.residuals[self._observation(found)]
        self.image.set_image(pixels, keep_view=True)
        self.image.canvas.focus_on(float(place[0]), float(place[1]), CLOSE_ZOOM)
        self.image.set_overlay(
            place[None], np.asarray(vector)[None], None, tr("residual"), [str(found["point"])]
        )

    def _observation(self, found: dict[str, Any]) -> int:
        """Return the index of a listed observation."""
        block = self.result.adjustment.block
        photo = block.names.index(found["photo"])
        mine = np.flatnonzero(np.asarray(block.obs_photo) == photo)
        distance = np.abs(np.asarray(block.obs_xy)[mine] - found["position_px"]).sum(axis=1)
        return int(mine[int(np.argmin(distance))])


def reliability_sentence(found: Reliability) -> str:
    """Say how many observations were tested, how many fail, and how many would by chance."""
    tested = int((found.redundancy > 1e-6).sum())
    beyond = int((np.abs(found.standardised) > found.critical).sum())
    return tr(
        "{beyond} of {tested} coordinates have |w| over {critical}; by chance alone it would be about {chance}. Mean "
        "redundancy number {r}; a blunder of the minimal detectable bias is found with a probability of {power} %.",
        beyond=format_value(beyond), tested=format_value(tested), critical=f"{found.critical:.2f}",
        chance=format_value(tested * found.alpha, digits=2), r=f"{float(found.redundancy.mean()):.2f}",
        power=format_value(100 * found.power, digits=2),
    )  # fmt: skip


def suspect_columns(rows: list[dict[str, Any]], unit: str) -> list[Column]:
    """Return one row per suspected coordinate."""
    if not rows:
        return []
    factor, shown = (1000.0, "mm") if unit == "m" else (1.0, tr(unit))

    def numbers(key: str, scale: float = 1.0) -> list[float]:
        return [scale * float(row[key]) for row in rows]

    return [
        Column(tr("photo"), [row["photo"] for row in rows]),
        Column(tr("point"), [str(row["point"]) for row in rows]),
        Column("", [row["coordinate"] for row in rows]),
        Column("v", numbers("residual_px"), "px", decimals=2, help=tr("Residual, projected − measured.")),
        Column("w", numbers("w"), decimals=2, help=tr("Baarda: v / (σ √r) with the a priori σ.")),
        Column("τ", numbers("tau"), decimals=2, help=tr("Pope: the same with the a posteriori σ0.")),
        Column("r", numbers("redundancy_number"), decimals=2, help=tr("Redundancy number, 0 to 1.")),
        Column("MDB", numbers("mdb_px"), "px", decimals=2,
               help=tr("Minimal detectable bias: a smaller blunder goes unnoticed.")),
        Column(tr("effect"), numbers("effect", factor), shown, digits=2,
               help=tr("How far an unnoticed blunder of that size moves the object point.")),
    ]  # fmt: skip
