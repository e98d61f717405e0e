"""Measuring the chosen point in the photos: magnifier, keys, snapping, the expected place, residuals at once."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QKeyEvent, QWheelEvent
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from graphos_core.adjustment.measuring.sights import Sight
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.exchange.control_sheet import Mark
from graphos_core.number_format import format_value
from graphos_py.control.desk import ControlDesk
from graphos_py.control.loupe import FACTORS, Loupe
from graphos_py.control.marks_layer import MarksLayer
from graphos_py.icons import bind_icon
from graphos_py.tabs.images import read_photo
from graphos_py.translation import tr
from graphos_py.views.pixel_canvas import PixelCanvas

KEPT_PHOTOS = 4
NUDGE_PX, SHIFT_NUDGE_PX = 0.1, 1.0
SIGMA_FLOOR_PX = 0.05
"""A snapped place is not trusted further than this: flatness of targets and the lens limit it, not the grey levels."""

CLOSE_ZOOM = 3.0
SNAPS = {"": "No snap", "circle": "Circle", "cross": "Cross", "corner": "Corner"}
NUDGES = {
    Qt.Key.Key_Left: (-1.0, 0.0), Qt.Key.Key_Right: (1.0, 0.0), Qt.Key.Key_Up: (0.0, -1.0), Qt.Key.Key_Down: (0.0, 1.0),
}  # fmt: skip


class MeasuringView(QWidget):
    """One photo with the marks of all points in it; a click measures the chosen point.

    Signals
    -------
    photo_wanted(step)
        The next (+1) or previous (−1) photo in which the point can be measured.
    """

    photo_wanted = Signal(int)

    def __init__(self, desk: ControlDesk) -> None:
        super().__init__()
        self.desk = desk
        self.photo = ""
        self.sight: Sight | None = None
        self.canvas = PixelCanvas(self)
        self.canvas.empty = (
            tr("Measure the chosen point in the photos"),
            tr("Choose or make a point above and a photo below; a click measures, arrow keys nudge."),
        )
        self.marks, self.loupe = MarksLayer(self.canvas), Loupe(self.canvas)
        self.canvas.layers = [self.marks.paint, self.loupe.paint]
        self.canvas.cursor_moved.connect(self._moved)
        self.canvas.clicked.connect(self._clicked)
        self.canvas.installEventFilter(self)
        self._pixels: OrderedDict[str, Array] = OrderedDict()
        self._centred = ("", "")
        self.said = QLabel()
        self.said.setProperty("role", "caption")
        self.said.setWordWrap(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addLayout(self._bar())
        column.addWidget(self.canvas, 1)
        column.addWidget(self.said)
        self.setFocusProxy(self.canvas)

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 4, 8, 0)
        for symbol, tip, step in (("previous", tr("Previous photo of this point (Page up)"), -1),
                                  ("right", tr("Next photo of this point (Page down)"), 1)):  # fmt: skip
            button = QToolButton()
            button.setProperty("role", "flat")
            button.setToolTip(tip)
            button.setAccessibleName(tip)
            bind_icon(button, symbol, "text")
            button.clicked.connect(lambda _=False, s=step: self.photo_wanted.emit(s))
            bar.addWidget(button)
        self.title = QLabel()
        self.title.setProperty("role", "heading")
        bar.addWidget(self.title, 1)
        self.snapping = QComboBox()
        for key, label in SNAPS.items():
            self.snapping.addItem(tr(label), key)
        self.snapping.setToolTip(
            tr(
                "What a click snaps to, with sub-pixel accuracy (S goes through the list). No snap takes the cursor."
            )
        )
        self.zoom = QComboBox()
        for factor in FACTORS:
            self.zoom.addItem(f"{factor}×", factor)
        self.zoom.setCurrentIndex(FACTORS.index(self.loupe.factor))
        self.zoom.setToolTip(tr("Magnifier (Ctrl and wheel)"))
        self.zoom.activated.connect(self._set_factor)
        for label, widget in ((tr("Snap"), self.snapping), (tr("Magnifier"), self.zoom)):
            name = QLabel(label)
            name.setBuddy(widget)
            bar.addWidget(name)
            bar.addWidget(widget)
        return bar

    # ------------------------------------------------------------------------------------------- what is shown

    def show_photo(self, photo: Any) -> None:
        """Show a `Photo` of the project; its pixels come in the background."""
        self.photo = photo.name
        if photo.digest in self._pixels:
            self._pixels.move_to_end(photo.digest)
            self._show_pixels(self._pixels[photo.digest])
            return
        read_photo(self.desk.session, photo, lambda read: self._read(photo.name, read), as_taken=True)

    def _read(self, name: str, read: tuple[str, Array]) -> None:
        digest, pixels = read
        self._pixels[digest] = pixels
        while len(self._pixels) > KEPT_PHOTOS:
            self._pixels.popitem(last=False)
        if name == self.photo:
            self._show_pixels(pixels)

    def _show_pixels(self, pixels: Array) -> None:
        self.canvas.set_array(pixels, keep_view=True)
        self._centre()

    def show_sight(self, sight: Sight | None) -> None:
        """Show the chosen point in the present photo."""
        self.sight = sight
        self.marks.marks = self.desk.sheet.marks_in(self.photo)
        self.marks.current = self.desk.point
        self.marks.prediction = sight.prediction if sight is not None else None
        self.marks.residual = sight.residual if sight is not None else None
        self.loupe.marks = [(m.x, m.y) for m in self.marks.marks.values()]
        self.title.setText(" · ".join(part for part in (self.photo, self.desk.point) if part))
        self._centre()
        self._tell()
        self.canvas.update()

    def _centre(self) -> None:
        """Bring the chosen point to the middle, once per point and photo."""
        place = self.place()
        key = (self.photo, self.desk.point)
        if place is None or self.canvas.array is None or key == self._centred:
            return
        self._centred = key
        self.canvas.focus_on(float(place[0]), float(place[1]), max(self.canvas.zoom, CLOSE_ZOOM))
        self.loupe.at = (float(place[0]), float(place[1]))

    def place(self) -> Array | None:
        """Return where the chosen point is measured, else where it is expected, px."""
        if self.sight is None:
            return None
        if self.sight.mark is not None:
            return self.sight.mark.xy
        found = self.sight.prediction
        return found.xy if found is not None and found.inside else None

    def _tell(self) -> None:
        self.said.setText(sight_sentence(self.desk.point, self.sight))

    # -------------------------------------------------------------------------------------------------- people

    def _moved(self, x: float, y: float) -> None:
        place = self.place()
        if math.isfinite(x):
            self.loupe.at = (x, y)
        elif place is not None:
            self.loupe.at = (float(place[0]), float(place[1]))
        self.canvas.update()

    def _clicked(self, x: float, y: float) -> None:
        other = self.marks.nearest(x, y)
        if other and other != self.desk.point:
            self.desk.choose(other)
        elif not self.desk.point:
            self.said.setText(tr("Choose the point first, or make a new one with +."))
        else:
            self.measure(x, y)

    def measure(self, x: float, y: float) -> None:
        """Measure the chosen point at a place, or at the target there."""
        if self.canvas.array is None or not self.desk.point:
            return
        width, height = self.canvas.image_size
        if not (-0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5):
            return
        target, mark = str(self.snapping.currentData()), Mark(round(x, 4), round(y, 4))
        if target:
            found = self._snap(target, x, y)
            if found is None:
                return
            mark = found
        self._centred = (self.photo, self.desk.point)
        self._put(mark, tr("Measure {point} in {photo}", point=self.desk.point, photo=self.photo))

    def _snap(self, target: str, x: float, y: float) -> Mark | None:
        from graphos_core.adjustment.measuring.snapping import snap

        assert self.canvas.array is not None
        try:
            found = snap(self.canvas.array, np.array([x, y]), target)  # type: ignore[arg-type]
        except UserError as problem:
            self.said.setText(tr(str(problem)))
            return None
        sigma = max(found.sigma_px, SIGMA_FLOOR_PX)
        return Mark(round(float(found.xy[0]), 4), round(float(found.xy[1]), 4), round(sigma, 4))

    def _put(self, mark: Mark | None, text: str, merge: tuple[str, ...] = ()) -> None:
        self.desk.edit(self.desk.sheet.marked(self.desk.point, self.photo, mark), text, merge)

    def nudge(self, dx: float, dy: float) -> bool:
        """Move the mark of the chosen point; False where there is none."""
        mark = self.sight.mark if self.sight is not None else None
        if mark is None:
            return False
        moved = replace(mark, x=round(mark.x + dx, 4), y=round(mark.y + dy, 4))
        self.loupe.at = (moved.x, moved.y)
        self._put(moved, tr("Move {point}", point=self.desk.point), ("nudge", self.desk.point, self.photo))
        return True

    def take_expected(self) -> None:
        """Measure where the point is expected, snapping if that is on."""
        place = self.place()
        if place is not None and (self.sight is None or self.sight.mark is None):
            self.measure(float(place[0]), float(place[1]))

    def remove_mark(self) -> None:
        """Take the measurement of the chosen point in this photo away."""
        if self.sight is not None and self.sight.mark is not None:
            self._put(None, tr("Remove {point} from {photo}", point=self.desk.point, photo=self.photo))

    def _set_factor(self) -> None:
        self.loupe.factor = int(self.zoom.currentData())
        self.canvas.update()

    def _next_snap(self) -> None:
        self.snapping.setCurrentIndex((self.snapping.currentIndex() + 1) % self.snapping.count())

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take the keys for measuring before the canvas takes them for panning."""
        if event.type() == QEvent.Type.Wheel and isinstance(event, QWheelEvent):
            if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
                step = 1 if event.angleDelta().y() > 0 else -1
                self.zoom.setCurrentIndex(min(max(self.zoom.currentIndex() + step, 0), len(FACTORS) - 1))
                self._set_factor()
                return True
        elif event.type() == QEvent.Type.KeyPress and isinstance(event, QKeyEvent):
            return self._key(event) or super().eventFilter(watched, event)
        return super().eventFilter(watched, event)

    def _key(self, event: QKeyEvent) -> bool:
        key = event.key()
        if key in NUDGES:
            step = SHIFT_NUDGE_PX if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else NUDGE_PX
            dx, dy = NUDGES[Qt.Key(key)]
            return self.nudge(step * dx, step * dy)
        actions = {
            Qt.Key.Key_PageDown: lambda: self.photo_wanted.emit(1), Qt.Key.Key_PageUp: lambda: self.photo_wanted.emit(-1),
            Qt.Key.Key_N: lambda: self.photo_wanted.emit(1), Qt.Key.Key_B: lambda: self.photo_wanted.emit(-1),
            Qt.Key.Key_S: self._next_snap, Qt.Key.Key_Space: self.take_expected, Qt.Key.Key_Return: self.take_expected,
            Qt.Key.Key_Delete: self.remove_mark, Qt.Key.Key_Backspace: self.remove_mark,
        }  # fmt: skip
        action = actions.get(Qt.Key(key))
        if action is not None:
            action()
        return action is not None


def sight_sentence(point: str, sight: Sight | None) -> str:
    """Say in one sentence where the point stands in the photo and what to do."""
    if not point:
        return tr("Choose a point in the table, or make a new one with +; then click its place in the photo.")
    if sight is None:
        return ""
    if sight.mark is not None:
        text = tr("Measured at {x}, {y}.", x=f"{sight.mark.x:.2f}", y=f"{sight.mark.y:.2f}")
        if math.isfinite(sight.mark.sigma_px):
            text += " " + tr("σ {s}.", s=format_value(sight.mark.sigma_px, unit="px", digits=2))
        if sight.residual is not None:
            length = format_value(float(np.hypot(*sight.residual)), unit="px", digits=2)
            text += " " + tr("Residual {length}.", length=length)
        return text + " " + tr("Arrows move it by 0.1 px, with Shift by 1 px; Delete removes it.")
    sentences = {
        "predicted": "Expected in the dashed circle: click there, or press Space.",
        "line": "It lies on the yellow line (its ray from another photo): a second ray predicts the place.",
        "out of sight": "By its other rays it is outside this photo.",
        "not oriented": "This photo is not oriented: the place cannot be predicted. Click where you see the point.",
        "nothing known": "Click where you see the point.",
    }
    return tr(sentences.get(sight.state, ""))


def next_photo(sights: Sequence[Sight], now: str, step: int) -> str:
    """Return the next photo in which the point is measured or expected, going round; the next one if nowhere."""
    names = [sight.photo for sight in sights]
    if not names:
        return now
    start = names.index(now) if now in names else 0
    order = [(start + step * i) % len(names) for i in range(1, len(names) + 1)]
    good = ("measured", "predicted", "line")
    wanted = [i for i in order if sights[i].state in good] or order
    return names[wanted[0]]
