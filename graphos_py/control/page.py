"""The Control page: table on top, photo below, and beside it the photos of the chosen point and the distances."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QLabel, QSplitter, QTabWidget, QVBoxLayout, QWidget

from graphos_core.adjustment.measuring.object_residuals import object_residuals
from graphos_core.adjustment.measuring.prediction import Intersection
from graphos_core.adjustment.measuring.sights import Sight, Standing, marks_of_point, standing
from graphos_core.data import Array, Block
from graphos_core.errors import UserError
from graphos_core.exchange.control_sheet import SheetPoint
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_py.control.desk import ControlDesk
from graphos_py.control.distances import DistancesPanel
from graphos_py.control.measuring import MeasuringView, next_photo
from graphos_py.control.table import ControlTable
from graphos_py.session import Session
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.background import Background
from graphos_py.views.table_view import Column, TableView

STATE_LABELS = {
    "measured": "measured", "predicted": "expected", "line": "on a line", "out of sight": "out of sight",
    "not oriented": "not oriented", "nothing known": "–",
}  # fmt: skip


class ControlPage(QWidget):
    """Table of control points and measuring in the photos."""

    def __init__(self, session: Session, level: Level = "student") -> None:
        super().__init__()
        self.session = session
        self.desk = ControlDesk(session, self)
        self.result: Any = None
        self._sights: list[Sight] = []
        self._standing_of = ""
        self._raw: tuple[Block, Block] | None = None
        self._serial = 0
        self._background = Background(self)
        self.table = ControlTable(self.desk, level)
        for action in self.table.history_actions:
            self.addAction(action)  # undo and redo work wherever the page has the focus
        self.distances = DistancesPanel(self.desk)
        self.upper = QTabWidget()
        self.upper.setDocumentMode(True)
        self.upper.tabBar().setDrawBase(False)
        self.upper.addTab(self.table, tr("Points"))
        self.upper.addTab(self.distances, tr("Distances"))
        self.measuring = MeasuringView(self.desk)
        self.photos = TableView()
        self.photos.set_empty_text(tr("Photos of the chosen point"), tr("Choose a point above."))
        self.point_text = QLabel()
        self.point_text.setWordWrap(True)
        self.point_text.setContentsMargins(8, 6, 8, 0)
        side = QWidget()
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addWidget(self.point_text)
        column.addWidget(self.photos, 1)
        lower = QSplitter(Qt.Orientation.Horizontal)
        lower.addWidget(self.measuring)
        lower.addWidget(side)
        lower.setStretchFactor(0, 3)
        lower.setStretchFactor(1, 1)
        lower.setSizes([theme().px(560), theme().px(260)])
        whole = QSplitter(Qt.Orientation.Vertical)
        whole.addWidget(self.upper)
        whole.addWidget(lower)
        whole.setSizes([theme().px(210), theme().px(420)])
        whole.setChildrenCollapsible(False)
        box = QVBoxLayout(self)
        box.setContentsMargins(0, 0, 0, 0)
        box.addWidget(whole)
        self.desk.changed.connect(self.refresh)
        self.desk.point_chosen.connect(self.refresh)
        self.photos.row_selected.connect(self._photo_row)
        self.measuring.photo_wanted.connect(self._step)
        self.desk.load()

    # ------------------------------------------------------------------------------------------------ public

    def set_level(self, level: Level) -> None:
        """Show the columns of a level."""
        self.table.set_level(level)

    def show_result(self, result: Any) -> None:
        """Take the result of the adjustment: it predicts places and gives the residuals; None for none."""
        self.result = result
        self.refresh()

    def take_distance(self, points: tuple[int, int]) -> None:
        """Make measured points of two object points of the block, and ask for their distance."""
        block = self.block
        if block is None:
            return
        sheet, names = self.desk.sheet, []
        for point in points:
            name = sheet.free_name("D")
            sheet = sheet.with_points([SheetPoint(name)])
            for photo, mark in marks_of_point(block, point).items():
                sheet = sheet.marked(name, photo, mark)
            names.append(name)
        self.desk.edit(sheet, tr("Take {a} and {b} from the cloud", a=names[0], b=names[1]))
        self.upper.setCurrentWidget(self.distances)
        self.distances.offer(names[0], names[1])

    def show_photo(self, index: int) -> None:
        """Show another photo."""
        photos = self._photos()
        if 0 <= index < len(photos) and self.isVisible():
            self.measuring.show_photo(photos[index])
            self._show_present()

    def refresh(self) -> None:
        """Bring table, list and photo up to date; when seen.

        What the block says is computed in a thread of the views, because its first call may compile.
        """
        if not self.isVisible():
            return
        names = [photo.name for photo in self._photos()]
        sheet, name, block = self.desk.sheet, self.desk.point, self.block
        self._serial += 1
        if block is None:
            self._show_standing(standing(sheet, name, names, None, None))
            return
        if self._standing_of != name:  # what the block says of another point comes in a moment
            self._show_point(standing(sheet, name, names, None, None))
        else:
            self._show_now(name)
        serial, georeference = self._serial, self.result.georeference

        def work() -> Standing | None:
            late = serial != self._serial
            return None if late else standing(sheet, name, names, block, georeference)

        self._background.run(work, lambda found: self._standing_found(serial, found), lane="measuring")

    @property
    def block(self) -> Block | None:
        """The oriented block of the photos as taken, in which people measure, if there is one."""
        if self.result is None:
            return None
        block: Block = self.result.adjustment.block
        if self._raw is None or self._raw[0] is not block:
            from graphos_core.seen_photos import block_as_taken

            pipeline = self.session.pipeline
            self._raw = (block, block)
            with suppress(UserError):  # a calibration that is gone
                self._raw = (block, block if pipeline is None else block_as_taken(pipeline, block))
        return self._raw[1]

    # --------------------------------------------------------------------------------------------- reacting

    def showEvent(self, event: QShowEvent) -> None:
        """Catch up with what happened while hidden."""
        super().showEvent(event)
        self.refresh()
        self.show_photo(self.session.photo)

    def _photos(self) -> Any:
        return self.session.project.photo_set.photos if self.session.project is not None else ()

    def _show_present(self) -> None:
        """Show the chosen point in another photo: its sights are known already, unless the point is another one."""
        if self._standing_of != self.desk.point:
            self.refresh()
            return
        here = next((s for s in self._sights if s.photo == self.measuring.photo), None)
        self.measuring.show_sight(here)
        names = [photo.name for photo in self._photos()]
        if self.measuring.photo in names and self._sights:
            self.photos.select_rows([names.index(self.measuring.photo)])

    def _show_now(self, name: str) -> None:
        """Show the mark of the chosen point where it is now; its residual follows."""
        last = next((s for s in self._sights if s.photo == self.measuring.photo), None)
        if last is not None:
            mark = self.desk.sheet.marks.get((name, self.measuring.photo))
            last = replace(last, mark=mark, state="measured" if mark is not None else last.state)
        self.measuring.show_sight(last)

    def _standing_found(self, serial: int, found: object) -> None:
        if isinstance(found, Standing) and serial == self._serial:
            self._show_standing(found)
        elif isinstance(found, Exception):
            self.session.tell(found)

    def _show_standing(self, found: Standing) -> None:
        """Show the chosen point in all photos and in the present one, and the residuals of all points."""
        residuals: Mapping[str, Array] = {}
        if self.result is not None:
            residuals = object_residuals(self.result.adjustment, self.result.georeference)
        self.table.model.set_residuals(residuals, found.image_rms)
        self.distances.show_block(self.block, found.distances)
        self._show_point(found)
        self.point_text.setText(point_sentence(found.name, found.meeting, self.block))

    def _show_point(self, found: Standing) -> None:
        """Show the chosen point in the list of photos and in the present photo."""
        names = [photo.name for photo in self._photos()]
        self._sights, self._standing_of = found.sights, found.name
        with QSignalBlocker(self.photos):
            self.photos.set_table(sight_columns(found.sights))
            if self.measuring.photo in names and found.sights:
                self.photos.select_rows([names.index(self.measuring.photo)])
        here = next((s for s in found.sights if s.photo == self.measuring.photo), None)
        self.measuring.show_sight(here)

    def _photo_row(self, row: int) -> None:
        if 0 <= row < len(self._sights) and self._sights[row].photo != self.measuring.photo:
            self._go(self._sights[row].photo)

    def _step(self, step: int) -> None:
        order = self._sights or [Sight(p.name, "nothing known", None, None, None) for p in self._photos()]
        self._go(next_photo(order, self.measuring.photo, step))

    def _go(self, name: str) -> None:
        names = [photo.name for photo in self._photos()]
        if name in names:
            index = names.index(name)
            self.session.select_photo(index)
            if self.measuring.photo != name:
                self.show_photo(index)


def sight_columns(found: list[Sight]) -> list[Column]:
    """Return one row per photo: what is known of the point there, and its residual."""
    if not found:
        return []
    nan = float("nan")
    lengths = [nan if s.residual is None else float(np.hypot(*s.residual)) for s in found]
    return [
        Column(tr("photo"), [s.photo for s in found]),
        Column("v", lengths, "px", decimals=2, help=tr("Length of the image residual, at once.")),
        Column(tr("point"), [tr(STATE_LABELS[s.state]) for s in found]),
        Column("vx", [nan if s.residual is None else float(s.residual[0]) for s in found], "px", decimals=2),
        Column("vy", [nan if s.residual is None else float(s.residual[1]) for s in found], "px", decimals=2),
        Column("σ", [nan if s.mark is None else s.mark.sigma_px for s in found], "px", decimals=2),
    ]


def point_sentence(name: str, meeting: Intersection | None, block: Block | None) -> str:
    """Say how well the rays of the chosen point meet."""
    if not name:
        return tr("No point is chosen.")
    if block is None:
        return tr("{point}: run the adjustment, then its place is predicted in every photo.", point=name)
    if meeting is None or meeting.xyz is None:
        return tr("{point}: two rays that meet predict it in every photo.", point=name)
    assert meeting.sigma is not None
    angle = format_value(float(np.degrees(meeting.angle)), unit="°", digits=2)
    rms = format_value(meeting.rms_px, unit="px", digits=2)
    spread = _length(float(meeting.sigma.max()), block.unit)
    return tr("{point}: {n} rays, RMS {rms}, angle {angle}; 1 px moves it by up to {spread}.", point=name,
              n=len(meeting.residuals), rms=rms, angle=angle, spread=spread)  # fmt: skip


def _length(value: float, unit: str) -> str:
    return (
        format_value(1000 * value, unit="mm", digits=2)
        if unit == "m"
        else format_value(value, unit=tr(unit), digits=2)
    )
