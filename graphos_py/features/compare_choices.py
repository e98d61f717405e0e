"""What is compared: the form beside the comparison."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.params import Level
from graphos_core.registry import algorithms
from graphos_py.icons import bind_icon
from graphos_py.settings import LEVELS
from graphos_py.translation import tr

USUAL = ("sift", "akaze", "orb", "fast", "harris")
"""Chosen at first: one of each kind, all fast."""


@dataclass(frozen=True)
class Wanted:
    """What the person chose.

    Attributes
    ----------
    detectors : tuple of str
    everything : bool
        All photos; otherwise the selected one and the next.
    homography : Path or None
    disturbed : bool
        Also on changed versions of the first photo.
    assignments : tuple of str
        Values to try, as on the command line.
    """

    detectors: tuple[str, ...]
    everything: bool
    homography: Path | None
    disturbed: bool
    assignments: tuple[str, ...]


class CompareChoices(QWidget):
    """Detectors, photos, truth, disturbances, values to try; `changed` when any of it is another."""

    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._file: Path | None = None
        self.list = QListWidget()
        self.list.setAccessibleName(tr("Detectors to compare"))
        for algorithm in algorithms("features", "detector"):
            item = QListWidgetItem(tr(algorithm.label))
            item.setData(Qt.ItemDataRole.UserRole, algorithm.name)
            item.setToolTip(f"{tr(algorithm.summary)}\n{algorithm.source}")
            item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
            item.setCheckState(Qt.CheckState.Checked if algorithm.name in USUAL else Qt.CheckState.Unchecked)
            self.list.addItem(item)
        self.list.itemChanged.connect(lambda _: self.changed.emit())
        self.list.itemActivated.connect(_toggle)
        self.photos = QComboBox()
        self.photos.addItem(tr("this one and the next"), False)
        self.photos.addItem(tr("all"), True)
        self.photos.setToolTip(
            tr("All pairs of the photos are matched; the selected photo is in the thumbnails.")
        )
        self.photos.currentIndexChanged.connect(lambda _: self._photos_changed())
        self.disturbed = QCheckBox(tr("also changed versions"))
        self.disturbed.setToolTip(
            tr(
                "The first photo, reduced, is tilted, reduced, turned, blurred, made noisy and darkened: the truth is known."
            )
        )
        self.disturbed.toggled.connect(lambda _: self.changed.emit())
        self.values = QLineEdit()
        self.values.setPlaceholderText("sift.contrast=0.02,0.04")
        self.values.setToolTip(
            tr("ALGORITHM.PARAMETER=VALUE,VALUE …, each value in turn; “detector” stands for every detector.")
        )
        self.values.textEdited.connect(lambda _: self.changed.emit())
        self._lay_out()

    def _lay_out(self) -> None:
        self.truth = QLabel(tr("not known"))
        self.open = QToolButton()
        self.open.setToolTip(tr("Homography from the first photo to the second, from a file"))
        self.open.setAccessibleName(self.open.toolTip())
        self.open.setProperty("role", "flat")
        bind_icon(self.open, "open", "text")
        self.open.clicked.connect(self.choose_homography)
        self.forget = QToolButton()
        self.forget.setToolTip(tr("No homography"))
        self.forget.setAccessibleName(self.forget.toolTip())
        self.forget.setProperty("role", "flat")
        bind_icon(self.forget, "remove", "text")
        self.forget.clicked.connect(lambda: self.set_homography(None))
        self.forget.hide()
        row = QHBoxLayout()
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.truth, 1)
        row.addWidget(self.open)
        row.addWidget(self.forget)
        self.form = QFormLayout()
        self.form.setContentsMargins(0, 0, 0, 0)
        self.form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        self.form.addRow(tr("Photos"), self.photos)
        self.form.addRow(tr("Homography"), row)
        self.form.addRow("", self.disturbed)
        self.form.addRow(tr("Values to try"), self.values)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 8, 8, 8)
        column.setSpacing(8)
        heading = QLabel(tr("Detectors"))
        heading.setProperty("role", "heading")
        column.addWidget(heading)
        column.addWidget(self.list, 1)
        column.addLayout(self.form)

    # ------------------------------------------------------------------------------------------------ public

    def wanted(self) -> Wanted:
        """Return what is chosen."""
        items = [self.list.item(i) for i in range(self.list.count())]
        return Wanted(
            detectors=tuple(
                str(item.data(Qt.ItemDataRole.UserRole))
                for item in items
                if item.checkState() == Qt.CheckState.Checked
            ),
            everything=bool(self.photos.currentData()),
            homography=self._file,
            disturbed=self.disturbed.isChecked(),
            assignments=tuple(_assignment(word) for word in self.values.text().split()),
        )

    def set_homography(self, path: Path | None) -> None:
        """Take a file, or none."""
        self._file = path
        self.truth.setText(path.name if path is not None else tr("not known"))
        self.truth.setToolTip(str(path) if path is not None else "")
        self.forget.setVisible(path is not None)
        self.changed.emit()

    def choose_homography(self) -> None:
        """Ask for a file with the homography."""
        name, _ = QFileDialog.getOpenFileName(
            self,
            tr("Homography"),
            "",
            f"{tr('Homography')} (*.xml *.yml *.yaml *.json *.txt);;{tr('All files')} (*)",
        )
        if name:
            self.photos.setCurrentIndex(0)
            self.set_homography(Path(name))

    def set_level(self, level: Level) -> None:
        """Fold what only experts need."""
        self.form.setRowVisible(self.values, LEVELS.index(level) >= LEVELS.index("student"))

    def _photos_changed(self) -> None:
        if self.photos.currentData() and self._file is not None:
            self.set_homography(None)  # it belongs to two photos
        self.changed.emit()


def _toggle(item: QListWidgetItem) -> None:
    checked = item.checkState() == Qt.CheckState.Checked
    item.setCheckState(Qt.CheckState.Unchecked if checked else Qt.CheckState.Checked)


def _assignment(word: str) -> str:
    """Return an assignment with its room: ``sift.contrast=0.02`` belongs to features."""
    path = word.partition("=")[0]
    return word if path.startswith(("features.", "preprocessing.")) else f"features.{word}"
