"""Converting a camera file: what it is, what it becomes, and what that costs in px over the format."""

from __future__ import annotations

import math
import shutil
import tempfile
from pathlib import Path

import numpy as np
from PySide6.QtWidgets import (
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.errors import UserError
from graphos_core.exchange.camera_formats import (
    CAMERA_FORMATS,
    OWN,
    ConvertedCamera,
    convert_camera,
    guess_camera_format,
)
from graphos_core.exchange.formulas import Format
from graphos_core.exchange.table_preview import number
from graphos_core.number_format import format_value
from graphos_core.text import Text
from graphos_py.convert.source_line import SourceLine, format_chooser
from graphos_py.dialogs import documents
from graphos_py.messages import sentences
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.image_view import ImageView

OWN_FORMAT = (OWN, "GRAPHOS (TOML)")


class CameraPage(QWidget):
    """Source, target, residual over the format, Save."""

    def __init__(self) -> None:
        super().__init__()
        self._folder = tempfile.TemporaryDirectory(prefix="graphos-convert-")
        self.converted: ConvertedCamera | None = None
        self.source = SourceLine()
        written = [(f.name, f.label) for f in CAMERA_FORMATS.values() if f.choose is not None]
        self.of = format_chooser([*((f.name, f.label) for f in CAMERA_FORMATS.values()), OWN_FORMAT], True)
        self.to = format_chooser([*written, OWN_FORMAT], False)
        self.across, self.down, self.pitch = QLineEdit(), QLineEdit(), QLineEdit()
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.image = ImageView()
        self.image.set_empty_text(
            tr("What the conversion costs, over the whole format"), tr("Choose a camera file and a target.")
        )
        self.save = QPushButton(tr("Save as …"))
        self.save.setProperty("role", "primary")
        self.save.clicked.connect(self._save)
        column = QVBoxLayout(self)
        column.addLayout(self._form())
        column.addWidget(self.image, 1)
        column.addWidget(self.said)
        column.addWidget(self.save)
        self.source.changed.connect(self.convert)
        for combo in (self.of, self.to):
            combo.activated.connect(self.convert)
        for line in (self.across, self.down, self.pitch):
            line.editingFinished.connect(self.convert)
        self.convert()

    def _form(self) -> QFormLayout:
        form = QFormLayout()
        form.addRow(tr("Camera file"), self.source)
        form.addRow(tr("Its format"), self.of)
        form.addRow(tr("Becomes"), self.to)
        size = QHBoxLayout()
        for line, text in (
            (self.across, tr("width, px")),
            (self.down, tr("height, px")),
            (self.pitch, tr("pixel, µm")),
        ):
            line.setPlaceholderText(text)
            size.addWidget(line)
        form.addRow(tr("Photo, if the file does not tell"), size)
        return form

    def frame(self) -> Format | None:
        """Return the format of the photos that was typed.

        Raises
        ------
        UserError
            When it is typed in part, or makes no sense.
        """
        texts = [line.text().strip() for line in (self.across, self.down)]
        if not any(texts):
            return None
        width, height = (number(text, ".") for text in texts)
        if not (width >= 1 and height >= 1):
            raise UserError("Width and height of the photo are whole numbers of pixels.")
        pitch = number(self.pitch.text().strip().replace(",", "."), ".")
        return Format(int(width), int(height), pitch / 1000 if pitch > 0 and math.isfinite(pitch) else None)

    def convert(self) -> None:
        """Convert into a temporary file and show what it costs."""
        self.converted = None
        path = self.source.path
        problem = "" if path is not None else tr("Choose the file of a calibrated camera.")
        if path is not None:
            target = Path(self._folder.name) / f"camera{self._suffix()}"
            try:
                name = str(self.of.currentData()) or guess_camera_format(path)
                self.converted = convert_camera(
                    path, target, str(self.to.currentData()), of=name, frame=self.frame()
                )
            except UserError as error:
                problem = sentences(error)
        self.said.setProperty("role", "error" if problem and path is not None else "")
        self.said.style().polish(self.said)
        self.save.setEnabled(self.converted is not None)
        self._show(problem)

    def _show(self, problem: str) -> None:
        found = self.converted
        if found is None:
            self.image.set_image(None)
            self.said.setText(problem)
            return
        colour = 40 if theme().name == "dark" else 224
        self.image.set_image(np.full((found.camera.height, found.camera.width), colour, np.uint8))
        if found.max_px > 0:
            self.image.set_overlay(found.pixels, found.residuals, None, tr("difference"))
        self.said.setText(" ".join([cost_sentence(found), *(tr(remark) for remark in found.remarks)]))

    def _suffix(self) -> str:
        name = str(self.to.currentData())
        return ".toml" if name == OWN else CAMERA_FORMATS[name].suffix

    def _save(self) -> None:
        if self.converted is None:
            return
        start = str(documents() / self.converted.file.name)
        name, _ = QFileDialog.getSaveFileName(self, tr("Save the camera"), start)
        if name:
            try:
                shutil.copyfile(self.converted.file, name)
            except OSError as problem:
                self.said.setText(tr("{name} could not be written: {why}.", name=name, why=problem.strerror))
                return
            self.said.setText(tr("Written: {path}", path=name))


def cost_sentence(found: ConvertedCamera) -> str:
    """Say what a conversion costs."""
    text = Text("{source} → {target}: largest difference over the format {most}, RMS per coordinate {rms}.",
                source=found.source, target=found.target, most=format_value(found.max_px, unit="px", digits=2),
                rms=format_value(found.rms_px, unit="px", digits=2))  # fmt: skip
    said = tr(text)
    if found.without_image:
        said += " " + tr("{n} places of the format have no image in the target.", n=found.without_image)
    return said
