"""The table of a lab that compares detectors: one row for each that was run."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableWidget, QTableWidgetItem, QWidget

from graphos_didactic.lab_session import LabSession
from graphos_py.translation import tr

COLUMNS: tuple[tuple[str, str, str, float, int], ...] = (
    ("keypoints", "keypoints\nper photo", "Mean number of keypoints", 1.0, 0),
    ("seconds", "time\n[s per photo]", "Time to detect and describe one photo", 1.0, 2),
    ("matches", "matches", "Candidates of all pairs, before verification", 1.0, 0),
    ("verified", "verified", "Matches that agree with one geometry of their pair", 1.0, 0),
    ("inlier_share", "verified of\nmatches [%]", "Share of the matches that were verified", 100.0, 1),
    ("coverage", "coverage\n[%]", "Occupied cells of the format, mean of all photos", 100.0, 0),
    ("repeatability", "found again\n[%], truth", "Keypoints that the other photo shows and the detector found there too",
     100.0, 1),
    ("right", "right of the\nverified, truth", "Verified matches at the place where the surface point really is", 1.0, 0),
)  # fmt: skip
"""Key, heading, tip, factor and decimals of each column."""


class DetectorTable(QTableWidget):
    """What the detectors gave on the photos of a student; hidden in labs that compare none."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(tr("Detectors that were run"))
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setColumnCount(1 + len(COLUMNS))
        self.setHorizontalHeaderItem(0, QTableWidgetItem(tr("detector")))
        for column, (_, heading, tip, _, _) in enumerate(COLUMNS, start=1):
            item = QTableWidgetItem(tr(heading))
            item.setToolTip(tr(tip))
            self.setHorizontalHeaderItem(column, item)
        self.verticalHeader().hide()
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.hide()

    def show_lab(self, student: LabSession) -> None:
        """Show every detector of the lab that was run."""
        steps = [step for step in student.lab.steps if step.kind == "detect"]
        if not steps or not (student.simulation / "detectors").is_dir():
            self.hide()
            return
        from graphos_didactic.lab_detectors import kept, label

        found = [(step.detector, kept(Path(student.simulation), step.detector)) for step in steps]
        rows = [(label(name), numbers) for name, numbers in found if numbers is not None]
        self.setRowCount(len(rows))
        for row, (name, numbers) in enumerate(rows):
            self.setItem(row, 0, QTableWidgetItem(tr(name)))
            for column, (key, _, _, factor, decimals) in enumerate(COLUMNS, start=1):
                item = QTableWidgetItem(f"{factor * numbers[key]:.{decimals}f}")
                item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                self.setItem(row, column, item)
        self.setFixedHeight(
            self.horizontalHeader().sizeHint().height() + 4
            + sum(self.rowHeight(row) for row in range(len(rows)))
        )  # fmt: skip
        self.setMaximumWidth(self.horizontalHeader().length() + 4)
        self.setVisible(bool(rows))
