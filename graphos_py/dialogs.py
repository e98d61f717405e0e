"""The few questions the window asks, and the dialog for a bug."""

from __future__ import annotations

import platform
import traceback
from pathlib import Path

from PySide6.QtCore import QStandardPaths, Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QGridLayout,
    QLabel,
    QLineEdit,
    QMessageBox,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core import __version__
from graphos_core.errors import UserError
from graphos_py.messages import sentences
from graphos_py.translation import tr

SEED_LIMIT = 2**31


def documents() -> Path:
    """Return the person's document folder."""
    place = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.DocumentsLocation)
    return Path(place) if place else Path.home()


def free_folder(wanted: Path) -> Path:
    """Return `wanted`, or with a number behind it the first that does not exist."""
    number, folder = 2, wanted
    while folder.exists():
        folder = wanted.with_name(f"{wanted.name} {number}")
        number += 1
    return folder


class NewProject(QDialog):
    """Asks for photos, project folder, and what is known about the camera; wrong answers are said below."""

    def __init__(self, parent: QWidget | None = None, photos: Path | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr("New project"))
        self.setMinimumWidth(620)
        grid = QGridLayout()
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(8)
        self.photos = self._line(grid, 0, tr("Folder of photos"), "", browse=True)
        self.folder = self._line(grid, 1, tr("Project folder"), "", browse=True)
        self.focal = self._line(grid, 2, tr("Principal distance"), tr("from EXIF"), unit="px")
        self.seed = self._line(grid, 3, tr("Seed of random steps"), "0")
        grid.setColumnStretch(1, 1)
        hint = QLabel(
            tr("The photos stay where they are and are never changed. Results go into the project folder.")
        )
        hint.setProperty("role", "caption")
        hint.setWordWrap(True)
        self.problem = QLabel()
        self.problem.setProperty("role", "error")
        self.problem.setWordWrap(True)
        buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        self._ok = buttons.button(QDialogButtonBox.StandardButton.Ok)
        self._ok.setText(tr("Make project"))
        self._ok.setProperty("role", "primary")
        buttons.button(QDialogButtonBox.StandardButton.Cancel).setText(tr("Cancel"))
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setSpacing(12)
        column.addLayout(grid)
        column.addWidget(hint)
        column.addWidget(self.problem)
        column.addWidget(buttons)
        self._suggested = ""
        self.photos.textChanged.connect(self._suggest)
        for line in (self.photos, self.folder, self.focal, self.seed):
            line.textChanged.connect(self._check)
        if photos is not None:
            self.photos.setText(str(photos))
        self._check()

    def _line(
        self,
        grid: QGridLayout,
        row: int,
        label: str,
        placeholder: str,
        *,
        browse: bool = False,
        unit: str = "",
    ) -> QLineEdit:
        line = QLineEdit()
        line.setPlaceholderText(placeholder)
        name = QLabel(label)
        name.setBuddy(line)
        grid.addWidget(name, row, 0)
        grid.addWidget(line, row, 1)
        if browse:
            button = QPushButton(tr("Choose …"))
            button.clicked.connect(lambda: self._browse(line, label))
            grid.addWidget(button, row, 2)
        elif unit:
            caption = QLabel(unit)
            caption.setProperty("role", "caption")
            grid.addWidget(caption, row, 2)
        return line

    def _browse(self, line: QLineEdit, label: str) -> None:
        chosen = QFileDialog.getExistingDirectory(self, label, line.text() or str(documents()))
        if chosen:
            line.setText(chosen)

    def _suggest(self, photos: str) -> None:
        if self.folder.text() in ("", self._suggested) and photos.strip():
            source = Path(photos.strip())
            self._suggested = str(free_folder(documents() / "GRAPHOS" / (source.name or "project")))
            self.folder.setText(self._suggested)

    def _check(self) -> None:
        self.problem.setText(self._sentence())
        self._ok.setEnabled(not self.problem.text())

    def _sentence(self) -> str:
        photos, folder = self.photos.text().strip(), self.folder.text().strip()
        if not photos:
            return tr("Choose the folder with your photos.")
        if not Path(photos).is_dir():
            return tr("This folder of photos does not exist: {folder}", folder=photos)
        if not folder:
            return tr("Choose a folder for the project.")
        try:
            self.settings()
        except ValueError:
            return tr("Principal distance and seed are numbers; empty means automatic.")
        return ""

    def settings(self) -> dict[str, float | int]:
        """Return what is known beside the folders; raises ValueError when a field is no number in range."""
        known: dict[str, float | int] = {}
        if self.focal.text().strip():
            known["focal_px"] = float(self.focal.text())
            if not 1 <= known["focal_px"] <= 1e6:
                raise ValueError
        if self.seed.text().strip():
            known["seed"] = int(self.seed.text())
            if not 0 <= known["seed"] < SEED_LIMIT:
                raise ValueError
        return known


class KnownDistanceDialog(QDialog):
    """Asks for two names and their distance."""

    def __init__(
        self, names: list[str], now: tuple[str, str, float] | None, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr("Known distance"))
        grid = QGridLayout(self)
        grid.setSpacing(8)
        self._ends = [QComboBox(), QComboBox()]
        start = (now[0], now[1]) if now else (*names, "", "")[:2]
        for combo, name in zip(self._ends, start):
            combo.addItems(names)
            combo.setEditable(True)
            combo.setCurrentText(name)
        self._metres = QLineEdit(f"{now[2]:g}" if now else "")
        explain = QLabel(
            tr("Two control points measured in the photos, or two photos (their projection centres).")
        )
        explain.setWordWrap(True)
        explain.setProperty("role", "caption")
        grid.addWidget(explain, 0, 0, 1, 2)
        for row, (label, widget) in enumerate(
            ((tr("From"), self._ends[0]), (tr("To"), self._ends[1]), (tr("Distance in m"), self._metres)), 1
        ):
            grid.addWidget(QLabel(label), row, 0)
            grid.addWidget(widget, row, 1)
        buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        buttons.accepted.connect(self._accept)
        buttons.rejected.connect(self.reject)
        grid.addWidget(buttons, 5, 0, 1, 2)
        self._problem = QLabel()
        self._problem.setProperty("role", "error")
        grid.addWidget(self._problem, 4, 0, 1, 2)

    def _accept(self) -> None:
        try:
            if float(self._metres.text()) <= 0 or self._ends[0].currentText() == self._ends[1].currentText():
                raise ValueError
        except ValueError:
            self._problem.setText(tr("Two different points and a distance of more than 0 m are needed."))
            return
        self.accept()

    def value(self) -> tuple[str, str, float]:
        """Return the two names and the metres."""
        return self._ends[0].currentText(), self._ends[1].currentText(), float(self._metres.text())


def ask_where_photos_are(problem: UserError, expected: Path, parent: QWidget | None) -> Path | None:
    """Say that photos moved and ask where they are; None when the person gives up."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Question)
    box.setWindowTitle(tr("The photos moved"))
    box.setText(tr(problem.what))
    box.setInformativeText("\n".join(tr(part) for part in (problem.why, problem.todo) if part))
    where = box.addButton(tr("Choose their folder …"), QMessageBox.ButtonRole.AcceptRole)
    box.addButton(tr("Cancel"), QMessageBox.ButtonRole.RejectRole)
    box.exec()
    if box.clickedButton() is not where:
        return None
    start = next((str(p) for p in (expected, *expected.parents) if p.is_dir()), str(documents()))
    chosen = QFileDialog.getExistingDirectory(parent, tr("Where are the photos now?"), start)
    return Path(chosen) if chosen else None


def ask_to_close(stage: str, parent: QWidget | None) -> bool:
    """Ask whether to close although a stage runs."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Warning)
    box.setWindowTitle(tr("A step is running"))
    box.setText(tr("{stage} is still running.", stage=tr(stage)))
    box.setInformativeText(tr("Steps that are finished stay; this one would have to be run again."))
    stop = box.addButton(tr("Stop it and close"), QMessageBox.ButtonRole.DestructiveRole)
    stay = box.addButton(tr("Go on running"), QMessageBox.ButtonRole.RejectRole)
    box.setDefaultButton(stay)
    box.exec()
    return box.clickedButton() is stop


def ask(title: str, text: str, yes: str, parent: QWidget | None) -> bool:
    """Ask a question with one way to say yes."""
    box = QMessageBox(QMessageBox.Icon.Question, title, text, parent=parent)
    accept = box.addButton(yes, QMessageBox.ButtonRole.AcceptRole)
    box.addButton(tr("Cancel"), QMessageBox.ButtonRole.RejectRole)
    box.exec()
    return box.clickedButton() is accept


def bug_report(problem: BaseException) -> str:
    """Return what a developer needs to know; names no photo and no folder of the person."""
    import PySide6

    lines = traceback.format_exception(type(problem), problem, problem.__traceback__)
    home = str(Path.home())
    text = "".join(lines).replace(home, "~")
    return (
        f"GRAPHOS-Py {__version__}, Python {platform.python_version()}, PySide6 {PySide6.__version__}, "
        f"{platform.system()} {platform.machine()}\n\n{text}"
    )


class BugDialog(QDialog):
    """Says that the program is at fault, offers the report, and keeps the session."""

    def __init__(self, problem: BaseException, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr("An error in the program"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setMinimumSize(640, 380)
        column = QVBoxLayout(self)
        heading = QLabel(tr("Something went wrong that should not have."))
        heading.setProperty("role", "heading")
        text = QLabel(
            tr("It is an error in the program, not yours. Your project and all finished results are safe; you can "
               "go on. Please copy the report and send it to the developers.")
        )  # fmt: skip
        text.setWordWrap(True)
        self.report = QPlainTextEdit(bug_report(problem))
        self.report.setReadOnly(True)
        copy = QPushButton(tr("Copy the report"))
        copy.clicked.connect(self._copy)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.addButton(copy, QDialogButtonBox.ButtonRole.ActionRole)
        buttons.rejected.connect(self.close)
        for widget in (heading, text, self.report, buttons):
            column.addWidget(widget)

    def _copy(self) -> None:
        QGuiApplication.clipboard().setText(self.report.toPlainText())


def tell(problem: UserError, parent: QWidget | None) -> None:
    """Show three sentences where there is no message list in view yet."""
    box = QMessageBox(QMessageBox.Icon.Warning, tr("That did not work"), sentences(problem), parent=parent)
    box.exec()
