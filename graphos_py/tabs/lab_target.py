"""Labs with a test field: the student's own photos, and the pictures and reports of the calibrations."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QPixmap, QResizeEvent
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from graphos_core.adjustment.calibration.target import TargetParams
from graphos_didactic.lab_calibration import SELECTIONS, Bench
from graphos_py.dialogs import documents
from graphos_py.icons import bind_icon
from graphos_py.theme import theme
from graphos_py.translation import tr

LARGEST_PICTURE = 460
REPORT_LABELS = {
    "all": "Report: all photos", "even": "Report: one half", "odd": "Report: the other half",
    "facing": "Report: facing photos",
}  # fmt: skip


class OwnPhotos(QWidget):
    """Folder of the student's own photos of a test field, and what is on the board; empty for simulated photos.

    Signals
    -------
    changed
    """

    changed = Signal()

    def __init__(self, target: TargetParams, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.folder = QLineEdit()
        self.folder.setPlaceholderText(tr("empty: photos are made for you"))
        self.kind = QComboBox()
        self.board = QWidget()
        declared = TargetParams.declarations()
        for name, label in declared["target"].about.choices.items():
            self.kind.addItem(tr(label), name)
        self.kind.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self.kind.setMinimumWidth(self.kind.sizeHint().width())
        self.kind.setCurrentIndex(self.kind.findData(target.target))
        self.columns, self.rows = QSpinBox(), QSpinBox()
        for box, name in ((self.columns, "columns"), (self.rows, "rows")):
            about = declared[name].about
            box.setRange(int(about.low or 0), int(about.high or 0))
            box.setValue(getattr(target, name))
            box.setToolTip(tr(about.help))
            box.setAccessibleName(tr(about.label))
        self.square = QDoubleSpinBox()
        self.square.setRange(0.01, 10000.0)
        self.square.setDecimals(2)
        self.square.setValue(target.square_mm)
        self.square.setSuffix(" mm")
        self.square.setToolTip(tr(declared["square_mm"].about.help))
        self._lay()
        self.folder.textChanged.connect(self._folder_changed)
        self._folder_changed()

    def _lay(self) -> None:
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 0, 0)
        row = QHBoxLayout()
        row.addWidget(self.folder, 1)
        choose = QPushButton(tr("Choose …"))
        choose.clicked.connect(self._choose)
        row.addWidget(choose)
        form.addRow(tr("Photos of your own"), row)
        line = QHBoxLayout(self.board)
        line.setContentsMargins(0, 0, 0, 0)
        for widget in (
            self.kind,
            self.columns,
            QLabel("×"),
            self.rows,
            QLabel(tr("inner corners, square")),
            self.square,
        ):
            line.addWidget(widget)
        line.addStretch(1)
        form.addRow(tr("Board"), self.board)

    def _choose(self) -> None:
        chosen = QFileDialog.getExistingDirectory(self, tr("Folder of the photos"), str(documents()))
        if chosen:
            self.folder.setText(chosen)

    def _folder_changed(self) -> None:
        for widget in (self.board, self.square):
            widget.setEnabled(bool(self.folder.text().strip()))
        self.changed.emit()

    def own(self) -> dict[str, Any]:
        """Return what `LabSession.own` keeps; empty for simulated photos."""
        folder = self.folder.text().strip()
        if not folder:
            return {}
        return {
            "photos": str(Path(folder).expanduser().absolute()), "target": self.kind.currentData(),
            "columns": self.columns.value(), "rows": self.rows.value(), "square_mm": self.square.value(),
        }  # fmt: skip


class CalibrationResults(QWidget):
    """Pictures of one calibration, and buttons that open the reports of all there are."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.buttons = {name: QPushButton(tr(REPORT_LABELS[name])) for name in SELECTIONS}
        self.pictures = [QLabel(), QLabel()]
        self._pixmaps: list[QPixmap] = []
        self._bench: Bench | None = None
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        row = QHBoxLayout()
        for name, button in self.buttons.items():
            bind_icon(button, "open")
            button.clicked.connect(partial(self._open, name))
            row.addWidget(button)
        row.addStretch(1)
        column.addLayout(row)
        images = QHBoxLayout()
        for label, name in zip(
            self.pictures, ("Residuals over the format", "Coverage of the format"), strict=True
        ):
            label.setAccessibleName(tr(name))
            label.setAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop)
            label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
            images.addWidget(label, 1)
        column.addLayout(images)

    def show_bench(self, bench: Bench, selection: str) -> None:
        """Show the pictures of one calibration where there is one; reports of all that were made."""
        self._bench = bench
        for name, button in self.buttons.items():
            button.setVisible((bench.place(name) / "report.html").is_file())
        folder = bench.place(selection) / "pictures" if selection else None
        files = [folder / "residuals_1.png", folder / "coverage_1.png"] if folder is not None else []
        self._pixmaps = [QPixmap(str(file)) for file in files if file.is_file()]
        self._fit()

    def _open(self, name: str) -> None:
        if self._bench is not None:
            page = self._bench.place(name) / "report.html"
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(page)))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the pictures as wide as there is room."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        width = min(max(self.width() // 2 - 8, 120), theme().px(LARGEST_PICTURE))
        for i, label in enumerate(self.pictures):
            if i < len(self._pixmaps) and not self._pixmaps[i].isNull():
                scaled = self._pixmaps[i].scaledToWidth(width, Qt.TransformationMode.SmoothTransformation)
                label.setPixmap(scaled)
                label.setFixedHeight(scaled.height())
                label.show()
            else:
                label.clear()
                label.hide()
