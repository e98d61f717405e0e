"""Masks drawn on the photo: polygons are added, moved and deleted with the mouse, and every change is saved at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QFileDialog, QHBoxLayout, QLabel, QMenu, QToolButton, QVBoxLayout, QWidget

from graphos_core.data import Array, Photo
from graphos_core.errors import UserError
from graphos_core.masks import LEARN, PhotoMask, Polygon, PolygonKind, photo_mask, read_masks, write_masks
from graphos_core.number_format import THIN_SPACE
from graphos_py.icons import bind_icon
from graphos_py.masks.layer import MaskLayer
from graphos_py.masks.shapes import (
    Grip,
    copied_to_all,
    corner_at,
    edge_at,
    masked_share,
    moved,
    polygon_at,
    with_corner,
    with_new_corner,
    without_corner,
)
from graphos_py.session import Session
from graphos_py.translation import tr
from graphos_py.views.pixel_canvas import PixelCanvas

REACH = 9.0
"""How near, in px of the screen, the mouse takes a corner or an edge."""

SHOWN_SIDE = 1600
"""Longer side of the picture that shows an imported mask."""

Masks = dict[str, PhotoMask]


class MaskEditor(QWidget):
    """The bar above a photo with the tools for its mask; draws and listens on the photo's canvas.

    Parameters
    ----------
    session : Session
    canvas : PixelCanvas
        Shows the photo; its layers and events are used.

    Signals
    -------
    lesson(name)
        The person wants to know more.
    """

    lesson = Signal(str)

    def __init__(self, session: Session, canvas: PixelCanvas) -> None:
        super().__init__()
        self.session, self.canvas = session, canvas
        self.layer = MaskLayer(canvas)
        canvas.layers = [*canvas.layers, self.layer.paint]
        canvas.installEventFilter(self)
        self.masks: Masks = {}
        self.photo: Photo | None = None
        self._kind: PolygonKind | None = None
        self._drag: tuple[Grip, tuple[float, float]] | None = None
        self._past: list[Masks] = []
        self._future: list[Masks] = []
        self.said = QLabel()
        self.said.setProperty("role", "caption")
        self.said.setWordWrap(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 4, 8, 4)
        column.setSpacing(4)
        column.addLayout(self._bar())
        column.addWidget(self.said)

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setSpacing(4)
        self.excluding = self._button(
            "mask", tr("Exclude"), tr("Draw a part in which nothing is measured (E)")
        )
        self.keeping = self._button(
            "mask kept", tr("Keep"), tr("Draw the part in which alone is measured (K)")
        )
        for button, kind in ((self.excluding, "excluded"), (self.keeping, "kept")):
            button.setCheckable(True)
            button.clicked.connect(lambda on, k=kind: self.draw(k if on else None))
            bar.addWidget(button)
        steps: list[tuple[str, str, str, Callable[[], None]]] = [
            ("trash", "", tr("Delete the selected corner or polygon (Delete)"), self.delete),
            ("undo", "", tr("Undo (Ctrl+Z)"), self.undo),
            ("redo", "", tr("Redo (Ctrl+Y)"), self.redo),
        ]
        self.steps = []
        for symbol, text, tip, act in steps:
            button = self._button(symbol, text, tip)
            button.clicked.connect(act)
            self.steps.append(button)
            bar.addWidget(button)
        bar.addStretch(1)
        self.copying = self._button("copy", tr("To all photos"), tr("Give these polygons to all photos of this size, "
                                    "for what stands still in the picture, such as the leg of a drone"))  # fmt: skip
        self.copying.clicked.connect(self.copy_to_all)
        bar.addWidget(self.copying)
        self.importing = self._button("open", tr("Import"), tr("Take masks from pictures or another project"))
        menu = QMenu(self.importing)
        menu.addAction(tr("Folder with pictures or masks.toml …"), lambda: self._ask(folder=True))
        menu.addAction(tr("One picture for all photos …"), lambda: self._ask(folder=False))
        self.importing.setMenu(menu)
        self.importing.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        bar.addWidget(self.importing)
        more = self._button("explain", "", tr("What masks are for: the lesson"))
        more.clicked.connect(lambda: self.lesson.emit(LEARN))
        bar.addWidget(more)
        return bar

    def _button(self, symbol: str, text: str, tip: str) -> QToolButton:
        button = QToolButton()
        button.setProperty("role", "flat")
        button.setToolTip(tip)
        button.setAccessibleName(text or tip)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        bind_icon(button, symbol, "text")
        if text:
            button.setText(text)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        return button

    # ------------------------------------------------------------------------------------------------- what is shown

    def show_photo(self, photo: Photo | None) -> None:
        """Edit the mask of another photo; masks are read anew, so that what another program wrote is not lost."""
        if photo is None or self.photo is None or photo.name != self.photo.name:
            self.draw(None)
            self.layer.selected = self.layer.corner = -1
        self.photo = photo
        try:
            self.masks = read_masks(self.folder) if self.session.project is not None else {}
        except UserError as problem:
            self.masks, self.photo = {}, None
            self.session.tell(problem)
        self._show()

    @property
    def folder(self) -> Path:
        """Folder of the project."""
        assert self.session.project is not None
        return self.session.project.folder

    @property
    def own(self) -> PhotoMask:
        """Mask of the photo."""
        return self.masks.get(self.photo.name, PhotoMask()) if self.photo is not None else PhotoMask()

    def _show(self) -> None:
        mask = self.own
        self.layer.polygons = mask.polygons
        if self.layer.selected >= len(mask.polygons):
            self.layer.selected = self.layer.corner = -1
        self.layer.set_picture(self._picture())
        there = self.photo is not None
        for button in (self.excluding, self.keeping, self.importing):
            button.setEnabled(there)
        self.steps[0].setEnabled(self.layer.selected >= 0 or bool(mask.picture))
        self.steps[1].setEnabled(bool(self._past))
        self.steps[2].setEnabled(bool(self._future))
        self.copying.setEnabled(bool(mask.polygons))
        self.tell()
        self.canvas.update()

    def _picture(self) -> Array | None:
        if self.photo is None or not self.own.picture:
            return None
        try:
            free = photo_mask(self.folder, replace(self.own, polygons=()), self.photo)
        except UserError as problem:
            self.session.tell(problem)
            return None
        scale = min(1.0, SHOWN_SIDE / max(free.shape))
        small = cv2.resize(free.astype(np.uint8), None, fx=scale, fy=scale, interpolation=cv2.INTER_NEAREST)
        return np.asarray(small > 0)

    def tell(self) -> None:
        """Say what can be done now, and how much of the photo is masked."""
        if self._kind is not None:
            more = tr(
                "Click the corners; a click on the first one, a double click or Enter closes it. Escape gives up."
            )
            self.said.setText(more)
            return
        if self.photo is None:
            self.said.setText("")
            return
        mask = self.own
        if not mask:
            self.said.setText(tr("No mask: the whole photo is used. Exclude what moves or is not the object, such as sky, "
                                 "water, people."))  # fmt: skip
            return
        share = masked_share(mask.polygons, self.photo.width, self.photo.height)
        text = tr(
            "{share} % of the photo is masked by polygons.",
            share=f"{100 * share:.0f}".replace(" ", THIN_SPACE),
        )
        if share >= 1.0:
            text = tr("The mask covers the whole photo: it gets no points and cannot be oriented.")
        if mask.picture:
            text += " " + tr("A picture masks more of it ({name}).", name=mask.picture)
        self.said.setText(text + " " + tr("Drag corners or polygons; double click on a line adds a corner."))

    # -------------------------------------------------------------------------------------------------- what is done

    def draw(self, kind: PolygonKind | None) -> None:
        """Begin to draw a polygon of a kind; None gives up."""
        self._kind = kind if self.photo is not None else None
        self.layer.drawing, self.layer.cursor = [], None
        self.excluding.setChecked(self._kind == "excluded")
        self.keeping.setChecked(self._kind == "kept")
        if self._kind is not None:
            self.layer.selected = self.layer.corner = -1
            self.canvas.setCursor(Qt.CursorShape.CrossCursor)
            self.canvas.setFocus()
        else:
            self.canvas.unsetCursor()
        self.tell()
        self.canvas.update()

    def close_polygon(self) -> None:
        """End drawing: three corners or more become a polygon."""
        points, kind = tuple(self.layer.drawing), self._kind
        if kind is None or len(points) < 3:
            return
        self.draw(None)
        self._change((*self.own.polygons, Polygon(points, kind)))
        self.layer.selected = len(self.own.polygons) - 1
        self._show()

    def _change(self, polygons: tuple[Polygon, ...]) -> None:
        if self.photo is not None:
            self._save({**self.masks, self.photo.name: replace(self.own, polygons=polygons)})

    def _save(self, masks: Masks, *, undoing: bool = False) -> bool:
        """Write the masks; False where that failed and nothing was changed."""
        try:
            write_masks(self.folder, masks)
        except UserError as problem:
            self.session.tell(problem)
            self._show()
            return False
        if not undoing:
            self._past.append(self.masks)
            self._future.clear()
        self.masks = masks
        self.session.masks_changed()
        self._show()
        return True

    def delete(self) -> None:
        """Delete the selected corner, else the selected polygon, else the imported picture."""
        index, polygons = self.layer.selected, list(self.own.polygons)
        if self.photo is None:
            return
        if index < 0:
            if self.own.picture:
                self._save({**self.masks, self.photo.name: replace(self.own, picture="")})
            return
        smaller = without_corner(polygons[index], self.layer.corner) if self.layer.corner >= 0 else None
        self.layer.corner = -1
        if smaller is None:
            del polygons[index]
            self.layer.selected = -1
        else:
            polygons[index] = smaller
        self._change(tuple(polygons))

    def undo(self) -> None:
        """Take the last change back."""
        self._travel(self._past, self._future)

    def redo(self) -> None:
        """Do again what was taken back."""
        self._travel(self._future, self._past)

    def _travel(self, source: list[Masks], target: list[Masks]) -> None:
        if source:
            now = self.masks
            if self._save(source[-1], undoing=True):
                target.append(now)
                source.pop()
                self._show()

    def forget(self) -> None:
        """Forget the history, when another project is opened."""
        self._past, self._future, self.photo = [], [], None

    def copy_to_all(self) -> None:
        """Give the polygons of this photo to all photos of its size."""
        if self.photo is None or self.session.project is None:
            return
        made, given, other = copied_to_all(self.masks, self.photo.name, self.session.project.photo_set.photos)
        if self._save(made):
            text = tr("Copied to {count} photos.", count=given)
            if other:
                text += " " + tr("{count} photos have another size and keep their masks.", count=other)
            self.said.setText(text)

    def _ask(self, folder: bool) -> None:
        start = str(self.folder.parent)
        if folder:
            chosen = QFileDialog.getExistingDirectory(self, tr("Folder with masks"), start)
        else:
            chosen, _ = QFileDialog.getOpenFileName(self, tr("Picture of the mask"), start, "PNG (*.png)")
        if chosen:
            self.import_from(Path(chosen))

    def import_from(self, source: Path) -> None:
        """Take masks from a folder, another project or a picture."""
        from graphos_core.mask_import import import_masks

        if self.session.project is None:
            return
        before = self.masks
        try:
            taken, failures = import_masks(source, self.folder, self.session.project.photo_set.photos)
        except UserError as problem:
            self.session.tell(problem)
            return
        for failure in failures:
            self.session.message.emit("warning", f"{failure.item}: {tr(failure.reason)}")
        self._past.append(before)
        self._future.clear()
        self.session.masks_changed()
        self.show_photo(self.photo)
        self.said.setText(tr("Masks for {count} photos were taken over.", count=len(taken)))

    # ------------------------------------------------------------------------------------------------- mouse and keys

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take what concerns the mask before the canvas pans and zooms with it."""
        if self.photo is None or self.canvas.array is None:
            return super().eventFilter(watched, event)
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            return self._key(event) or super().eventFilter(watched, event)
        if isinstance(event, QMouseEvent):
            place = self.canvas.to_image(event.position().x(), event.position().y())
            left = event.button() == Qt.MouseButton.LeftButton
            taken = False
            if event.type() == QEvent.Type.MouseButtonDblClick and left:
                taken = self._double(place)
            elif event.type() == QEvent.Type.MouseButtonPress and left:
                taken = self._press(place)
            elif event.type() == QEvent.Type.MouseMove:
                taken = self._move(place)
            elif event.type() == QEvent.Type.MouseButtonRelease and left:
                taken = self._release()
            if taken:
                self.canvas.update()
                return True
        return super().eventFilter(watched, event)

    @property
    def _reach(self) -> float:
        return REACH / self.canvas.zoom

    def _press(self, place: tuple[float, float]) -> bool:
        if self._kind is not None:
            points = self.layer.drawing
            if len(points) >= 3 and np.hypot(*np.subtract(points[0], place)) <= self._reach:
                self.close_polygon()
            else:
                points.append(self._within(place))
            return True
        grip = corner_at(self.own.polygons, *place, self._reach)
        index = grip.polygon if grip is not None else polygon_at(self.own.polygons, *place)
        if grip is None and index >= 0 and index != self.layer.selected:
            self.layer.selected, self.layer.corner = (
                index,
                -1,
            )  # first a click selects; then it can be dragged
            self._show()
            return True
        if index < 0:
            if self.layer.selected >= 0:
                self.layer.selected = self.layer.corner = -1
                self._show()
            return False
        self.layer.selected, self.layer.corner = index, grip.corner if grip is not None else -1
        self._drag = (Grip(index, self.layer.corner), place)
        self.steps[0].setEnabled(True)
        return True

    def _move(self, place: tuple[float, float]) -> bool:
        if self._kind is not None:
            self.layer.cursor = self._within(place)
            self.canvas.update()
            return False
        if self._drag is None:
            return False
        (index, corner), start = self._drag
        polygons = list(self.own.polygons)
        if corner >= 0:
            polygons[index] = with_corner(polygons[index], corner, *self._within(place))
        else:
            polygons[index] = moved(polygons[index], place[0] - start[0], place[1] - start[1])
        self.layer.polygons = tuple(polygons)
        return True

    def _release(self) -> bool:
        if self._kind is not None:
            return True
        if self._drag is None:
            return False
        self._drag = None
        if self.layer.polygons != self.own.polygons:
            self._change(self.layer.polygons)
        return True

    def _double(self, place: tuple[float, float]) -> bool:
        if self._kind is not None:
            self.close_polygon()
            return True
        grip = edge_at(self.own.polygons, *place, self._reach)
        if grip is None:
            return polygon_at(self.own.polygons, *place) >= 0
        polygons = list(self.own.polygons)
        polygons[grip.polygon] = with_new_corner(polygons[grip.polygon], grip.corner, *place)
        self._drag = None
        self.layer.selected, self.layer.corner = grip.polygon, grip.corner + 1
        self._change(tuple(polygons))
        return True

    def _within(self, place: tuple[float, float]) -> tuple[float, float]:
        """Return the place, at most a little outside the photo, so that its border can be reached."""
        width, height = self.canvas.image_size
        return (min(max(place[0], -0.5), width - 0.5), min(max(place[1], -0.5), height - 0.5))

    def _key(self, event: QKeyEvent) -> bool:
        key, control = event.key(), bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        if control:
            action = {Qt.Key.Key_Z: self.undo, Qt.Key.Key_Y: self.redo}.get(Qt.Key(key))
        elif self._kind is not None:
            action = {
                Qt.Key.Key_Return: self.close_polygon, Qt.Key.Key_Enter: self.close_polygon,
                Qt.Key.Key_Escape: lambda: self.draw(None), Qt.Key.Key_Backspace: self._one_back,
            }.get(Qt.Key(key))  # fmt: skip
        else:
            action = {
                Qt.Key.Key_Delete: self.delete, Qt.Key.Key_Backspace: self.delete,
                Qt.Key.Key_E: lambda: self.draw("excluded"), Qt.Key.Key_K: lambda: self.draw("kept"),
            }.get(Qt.Key(key))  # fmt: skip
        if action is not None:
            action()
        return action is not None

    def _one_back(self) -> None:
        if self.layer.drawing:
            self.layer.drawing.pop()
        self.canvas.update()
