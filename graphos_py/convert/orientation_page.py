"""Converting orientations: a model of another program, or a table that is seen before it is taken."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QFormLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.exchange.attitudes import ORDERS, UNITS
from graphos_core.exchange.block_parts import Read
from graphos_core.exchange.camera_fit import from_foreign
from graphos_core.exchange.camera_formats import read_any_camera
from graphos_core.exchange.orientation_formats import (
    ORIENTATION_FORMATS,
    OrientationOptions,
    guess_orientation_format,
)
from graphos_core.exchange.orientation_table import read_orientation_table
from graphos_py.convert.orientation_preview import OrientationPreview, choices
from graphos_py.convert.source_line import SourceLine, format_chooser
from graphos_py.dialogs import documents
from graphos_py.messages import sentences
from graphos_py.translation import tr

TABLE = "table"


class OrientationPage(QWidget):
    """Source, camera where the format has none, preview of tables, target, Save."""

    def __init__(self) -> None:
        super().__init__()
        formats = [(f.name, f.label) for f in ORIENTATION_FORMATS.values()]
        self.source, self.camera = SourceLine(folders=True), SourceLine()
        written = [(f.name, f.label) for f in ORIENTATION_FORMATS.values() if f.written]
        self.of, self.to = format_chooser(formats, True), format_chooser(written, False)
        self.order, self.unit = choices(ORDERS), choices(UNITS)
        self.table = OrientationPreview()
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.save = QPushButton(tr("Save as …"))
        self.save.setProperty("role", "primary")
        self.save.clicked.connect(self._save)
        rows = QFormLayout()
        rows.addRow(tr("Orientations"), self.source)
        rows.addRow(tr("Their format"), self.of)
        rows.addRow(tr("Camera, if the format has none"), self.camera)
        rows.addRow(tr("Become"), self.to)
        rows.addRow(tr("Angles of a written table"), self.order)
        rows.addRow("", self.unit)
        column = QVBoxLayout(self)
        column.addLayout(rows)
        column.addWidget(self.table, 1)
        column.addWidget(self.said)
        column.addWidget(self.save)
        column.addStretch(0)
        self.source.changed.connect(self._source_changed)
        self.camera.changed.connect(self.judge)
        self.of.activated.connect(self._source_changed)
        self.to.activated.connect(self.judge)
        self.table.changed.connect(self.judge)
        self._source_changed()

    # ------------------------------------------------------------------------------------------------- reading

    def kind(self) -> str:
        """Return the format of the source, recognised if the person did not say it.

        Raises
        ------
        UserError
            When it is not recognised.
        """
        assert self.source.path is not None
        return str(self.of.currentData()) or guess_orientation_format(self.source.path)

    def read(self) -> Read:
        """Read the source as it is understood now.

        Raises
        ------
        UserError
            When it cannot be read.
        """
        path = self.source.path
        if path is None:
            raise UserError("Choose the orientations of another program: a file, or the folder of a model.")
        kind = self.kind()
        camera = self._camera()
        if kind == TABLE and self.table.form is not None:
            if camera is None:
                raise UserError("A table holds no cameras.", todo="Give the camera file of the photos.")
            return read_orientation_table(path, camera, self.table.form)
        return ORIENTATION_FORMATS[kind].read(path, OrientationOptions(camera=camera))

    def _camera(self) -> Camera | None:
        if self.camera.path is None:
            return None
        found = read_any_camera(self.camera.path)
        return found if isinstance(found, Camera) else from_foreign(found).camera

    def _source_changed(self) -> None:
        """Show the preview of a table, or hide it."""
        text = ""
        path = self.source.path
        try:
            if path is not None and path.is_file() and self.kind() == TABLE:
                text = path.read_bytes().decode("utf-8-sig", errors="replace")
        except (UserError, OSError):
            text = ""
        self.table.setVisible(bool(text))
        self.table.show_text(text)
        self.judge()

    def judge(self) -> None:
        """Say what would be written, or what is missing."""
        written = str(self.to.currentData())
        for widget in (self.order, self.unit):
            widget.setEnabled(written == TABLE)
        try:
            found = self.read()
        except UserError as problem:
            self._say(sentences(problem), self.source.path is not None)
            return
        block = found.block
        parts = [tr("{n} photos, {m} of them oriented, {p} points.", n=len(block.names), m=int(block.oriented.sum()),
                    p=len(block.points)), *(tr(remark) for remark in found.remarks)]  # fmt: skip
        if not ORIENTATION_FORMATS[written].cameras:
            parts.append(tr("The target holds no cameras: save the camera beside it."))
        if len(block.points) and not ORIENTATION_FORMATS[written].points:
            parts.append(tr("The target holds no points."))
        self._say(" ".join(parts), False, True)

    def _say(self, text: str, wrong: bool, ready: bool = False) -> None:
        self.said.setProperty("role", "error" if wrong else "")
        self.said.style().polish(self.said)
        self.said.setText(text)
        self.save.setEnabled(ready)

    def _save(self) -> None:
        target = ORIENTATION_FORMATS[str(self.to.currentData())]
        if target.folder:
            name = QFileDialog.getExistingDirectory(self, tr("Folder for the model"), str(documents()))
        else:
            name, _ = QFileDialog.getSaveFileName(self, tr("Save the orientations"), str(documents()))
        if name:
            self.write(Path(name))

    def write(self, path: Path) -> None:
        """Write the orientations and say what it cost."""
        target = ORIENTATION_FORMATS[str(self.to.currentData())]
        options = OrientationOptions(
            order=str(self.order.currentData()), angle_unit=str(self.unit.currentData())
        )
        try:
            written = target.write(self.read().block, path, options)
        except UserError as problem:
            self._say(sentences(problem), True)
            return
        said = [tr("Written: {path}", path=file) for file in written.files] + [tr(r) for r in written.remarks]
        self._say("\n".join(said), False, True)
