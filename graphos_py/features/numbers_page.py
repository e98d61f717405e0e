"""What became of the keypoints, in numbers: of all photos together and of each."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel

from graphos_core.number_format import format_value
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.translation import tr
from graphos_py.views.table_view import Column, TableView


class NumbersPage(ResultPage):
    """Counts of the whole block above, one row per photo below."""

    label = "Numbers"

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.funnel = QLabel()
        self.funnel.setMargin(12)
        self.funnel.setWordWrap(True)
        self.funnel.setTextFormat(Qt.TextFormat.RichText)
        self.table = TableView()
        self.table.row_selected.connect(self.photo_wanted)
        self.column.addWidget(self.funnel)
        self.column.addWidget(self.table, 1)

    def fill(self) -> None:
        """Fill counts and table."""
        result, project = self.result, self.session.project
        if result is None or project is None:
            self.funnel.setText("")
            self.table.set_table([])
            return
        names = [photo.name for photo in project.photo_set.photos]
        used = [pair for pair in result.pairs if not pair.reason]
        self._write_counts()
        mine = [[pair for pair in used if i in (pair.a, pair.b)] for i in range(len(names))]
        in_tracks = np.bincount(np.asarray(result.tracks.photo), minlength=len(names))
        self.table.set_table(
            [
                Column(tr("photo"), names),
                Column(tr("keypoints found"), [int(f.found or len(f.xy)) for f in result.features]),
                Column(tr("kept"), [len(f.xy) for f in result.features]),
                Column(tr("pairs"), [len(pairs) for pairs in mine]),
                Column(tr("verified matches"), [sum(len(p.matches) for p in pairs) for pairs in mine]),
                Column(tr("in tracks"), [int(n) for n in in_tracks]),
            ]
        )

    def _write_counts(self) -> None:
        result = self.result
        lengths = np.bincount(np.asarray(result.tracks.track)) if len(result.tracks.track) else np.zeros(0)
        counts = [
            ("keypoints found", sum(f.found or len(f.xy) for f in result.features)),
            ("keypoints kept", sum(len(f.xy) for f in result.features)),
            ("candidate matches", sum(pair.candidates for pair in result.pairs)),
            ("verified matches", sum(len(pair.matches) for pair in result.pairs if not pair.reason)),
            ("tracks", int(result.tracks.count)),
            ("tracks in 3 photos or more", int((lengths >= 3).sum())),
        ]
        cells = "".join(
            f"<td style='padding-right:28px'><span style='font-size:large'><b>{format_value(n)}</b></span>"
            f"<br>{tr(what)}</td>"
            for what, n in counts
        )
        parts = ""
        if len(result.tracks.components) > 1:
            sizes = ", ".join(str(len(c)) for c in result.tracks.components)
            parts = "<p>⚠ " + tr("The photos fall into {n} parts that do not hang together: {sizes} photos.",
                                 n=len(result.tracks.components), sizes=sizes) + "</p>"  # fmt: skip
        self.funnel.setText(f"<table><tr>{cells}</tr></table>{parts}")

    def show_photo(self, index: int) -> None:
        """Select the row of a photo."""
        if self.result is not None:
            self.table.select_rows([index])
