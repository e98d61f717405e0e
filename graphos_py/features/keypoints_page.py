"""The keypoints of the selected photo: drawn, filtered by strength and scale, and in a table linked with the picture."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QPushButton, QSplitter, QVBoxLayout, QWidget

from graphos_core.data import Array, Features
from graphos_core.features.keypoint_figures import pairs_of_keypoints, rays_of_keypoints
from graphos_py.features.photo_pixels import PhotoPixels
from graphos_py.icons import bind_icon
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.translation import tr
from graphos_py.views.export import ask_and_write
from graphos_py.views.image_view import ImageView
from graphos_py.views.range_filter import RangeFilter
from graphos_py.views.table_view import Column, TableView

ALL, MATCHED, UNMATCHED, TOLD_APART = "all", "matched", "unmatched", "told apart"
SHOWN = {
    TOLD_APART: "Matched and others",
    ALL: "All alike",
    MATCHED: "Only matched ones",
    UNMATCHED: "Only those without a match",
}


class KeypointsPage(ResultPage):
    """Picture, filters and table of one photo's keypoints.

    Signals
    -------
    keypoint_chosen(index)
        A keypoint of the selected photo; −1 for none.
    descriptor_wanted(index)
        The person wants to see its descriptor.
    """

    label = "Keypoints"
    keypoint_chosen = Signal(int)
    descriptor_wanted = Signal(int)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.features: Features | None = None
        self.chosen = -1
        self._sized = False
        self._rows: Array = np.zeros(0, np.int64)
        self._matched: Array | None = None
        self._seen: tuple[Array | None, Array | None] = (None, None)
        self._figures: tuple[Array, Array] = (np.zeros(0, np.int32), np.zeros(0, np.int32))
        self._pixels = PhotoPixels(session, self)
        self._later = QTimer(self, singleShot=True, interval=40)
        self._later.timeout.connect(self._show_passing)
        self.image = ImageView()
        self.image.keypoint_selected.connect(self._clicked)
        self.strength = RangeFilter(tr("strength"))
        self.scale = RangeFilter(tr("diameter"), "px")
        self.table = TableView()
        self.table.setObjectName("keypoints")
        self.table.set_empty_text(
            tr("No keypoint passes the filters"), tr("Drag the handles of strength and diameter apart.")
        )
        self.table.row_selected.connect(self._row_chosen)
        self.table.row_activated.connect(lambda row: self.descriptor_wanted.emit(int(self._rows[row])))
        self._lay()

    def _lay(self) -> None:
        filters = QHBoxLayout()
        filters.setContentsMargins(0, 0, 0, 0)
        filters.setSpacing(0)
        for one in (self.strength, self.scale):
            one.changed.connect(self._later.start)
            filters.addWidget(one, 1)
        lower = QWidget()
        column = QVBoxLayout(lower)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addLayout(filters)
        column.addWidget(self.table, 1)
        splitter = QSplitter(Qt.Orientation.Vertical)
        splitter.addWidget(self.image)
        splitter.addWidget(lower)
        splitter.setStretchFactor(0, 3)
        splitter.setStretchFactor(1, 2)
        splitter.setSizes([380, 240])
        self.column.addLayout(self._bar())
        self.column.addWidget(splitter, 1)

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 4, 8, 4)
        bar.setSpacing(8)
        self.shown = QComboBox()
        self.shown.setAccessibleName(tr("Which keypoints are shown"))
        for key, label in SHOWN.items():
            self.shown.addItem(tr(label), key)
        self.shown.setToolTip(
            tr(
                "Yellow, with the line of the orientation: with a verified match in another photo. Rose circle: without."
            )
        )
        self.shown.activated.connect(self._show_passing)
        bar.addWidget(self.shown)
        bar.addStretch(1)
        self.descriptor = QPushButton(tr("Descriptor"))
        self.descriptor.setToolTip(tr("See what the selected keypoint is compared by (Return in the table)"))
        self.descriptor.clicked.connect(lambda: self.descriptor_wanted.emit(self.chosen))
        self.export = QPushButton(tr("CSV …"))
        self.export.setAccessibleName(tr("Export as CSV"))
        self.export.setToolTip(tr("Export the keypoints in the table as CSV"))
        bind_icon(self.export, "save", "text")
        self.export.clicked.connect(self._export)
        for button in (self.descriptor, self.export):
            button.setEnabled(False)
            bar.addWidget(button)
        return bar

    # ------------------------------------------------------------------------------------------------ public

    @property
    def matched_in(self) -> Array:
        """In how many pairs each keypoint of the photo has a verified match, int32 (n,)."""
        return self._figures[0]

    def fill(self) -> None:
        """Show the keypoints of the selected photo."""
        self.show_photo(self.session.photo)

    def show_photo(self, index: int) -> None:
        """Show the keypoints of another photo."""
        if not self.isVisible():
            self._stale = True
            return
        features = self.result.features if self.result is not None else ()
        if index >= len(features):
            self._take(None)
            self.image.set_image(None)
            return
        if features[index] is not self.features:
            count = len(features[index].xy)
            self._figures = (
                pairs_of_keypoints(self.result.pairs, index, count),
                rays_of_keypoints(self.result.tracks, index, count),
            )
            self._take(features[index])
        self._pixels.read(index, self._read)

    def show_found(self, index: int, features: Features) -> None:
        """Show keypoints while they are found, before anything is matched."""
        if not self.isVisible():
            return
        self._figures = (np.zeros(len(features.xy), np.int32),) * 2
        self._take(features)
        self._stale = True
        self._pixels.read(index, self._read)

    def choose(self, index: int) -> None:
        """Select a keypoint in picture and table; −1 for none. Emits nothing."""
        self.chosen = index
        self.image.show_keypoint(index)
        rows = np.flatnonzero(self._rows == index)
        self.table.select_rows(rows.tolist())
        self.descriptor.setEnabled(index >= 0)

    # --------------------------------------------------------------------------------------------- reacting

    def _take(self, features: Features | None) -> None:
        self.features, self.chosen = features, -1
        self._sized = False
        self.descriptor.setEnabled(False)
        self.export.setEnabled(features is not None)
        empty = np.zeros(0)
        self.strength.set_values(empty if features is None else np.asarray(features.response))
        self.scale.set_values(empty if features is None else np.asarray(features.scale))
        self._matched = self._figures[0] > 0 if features is not None and self._figures[0].any() else None
        self.image.set_keypoints(features)
        self._show_passing()

    def _read(self, index: int, pixels: Array) -> None:
        self.image.set_image(pixels, keep_view=True)
        self.image.set_keypoints(self.features, *self._seen)
        self.image.select_keypoint(self.chosen)

    def _show_passing(self) -> None:
        """Show what passes the filters, in the picture and in the table."""
        if self.features is None:
            self._rows = np.zeros(0, np.int64)
            self.table.set_table([])
            return
        passing, kind = self.strength.passing & self.scale.passing, self.shown.currentData()
        matched = self._matched
        if matched is not None and kind in (MATCHED, UNMATCHED):
            passing &= matched if kind == MATCHED else ~matched
        self._rows = np.flatnonzero(passing)
        self._seen = (passing, matched if kind in (TOLD_APART, UNMATCHED) else None)
        self.image.filter_keypoints(*self._seen)
        self.table.set_table(self._columns(self.features, self._rows), keep_widths=self._sized)
        self._sized = len(self._rows) > 0
        self.table.select_rows(np.flatnonzero(self._rows == self.chosen).tolist())

    def _columns(self, f: Features, rows: Array) -> list[Column]:
        pairs, rays = self._figures
        return [
            Column("#", rows, help=tr("Number of the keypoint in its photo.")),
            Column("x", np.asarray(f.xy, np.float64)[rows, 0], "px", decimals=2),
            Column("y", np.asarray(f.xy, np.float64)[rows, 1], "px", decimals=2),
            Column("⌀", np.asarray(f.scale, np.float64)[rows], "px", decimals=1,
                   help=tr("Diameter of the neighbourhood that it describes.")),
            Column("∠", np.degrees(np.asarray(f.angle, np.float64)[rows]), "°", decimals=0,
                   help=tr("Orientation, from x towards y: clockwise on the screen.")),
            Column(tr("strength"), np.asarray(f.response, np.float64)[rows], digits=3,
                   help=tr("Response of the detector, in its own measure.")),
            Column(tr("pairs"), pairs[rows], help=tr("Pairs of photos in which it has a verified match.")),
            Column(tr("rays"), rays[rows], help=tr("Photos that see its object point; 0: it belongs to none.")),
        ]  # fmt: skip

    def _clicked(self, index: int) -> None:
        self.choose(index)
        self.keypoint_chosen.emit(index)

    def _row_chosen(self, row: int) -> None:
        index = int(self._rows[row]) if 0 <= row < len(self._rows) else -1
        self.chosen = index
        self.image.show_keypoint(index)
        self.descriptor.setEnabled(index >= 0)
        self.keypoint_chosen.emit(index)

    def _export(self) -> None:
        ask_and_write(self.table, "csv", self.table.exports()["csv"])
