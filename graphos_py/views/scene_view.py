"""The only painter of scenes: draws a simulator's scene, and turns drags and keys into parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from PySide6.QtCore import QCoreApplication, QPointF, QSize, Qt, Signal
from PySide6.QtGui import (
    QFont,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from graphos_didactic.scene import Handle, Line, Mark, Points, Polygon, Scene
from graphos_didactic.scene_drawing import Look, draw, for_print, frames
from graphos_didactic.scene_handles import handle_at, inside
from graphos_didactic.scene_layout import Frame
from graphos_py.views.scene_canvas import QtCanvas

_ARROWS = {
    Qt.Key.Key_Left: (-1.0, 0.0),
    Qt.Key.Key_Right: (1.0, 0.0),
    Qt.Key.Key_Up: (0.0, -1.0),
    Qt.Key.Key_Down: (0.0, 1.0),
}
_TOUCH = 7.0
"""How near a click must come to a line or point to choose it, px at 100 % font scale."""


def tr(text: str) -> str:
    """Translate a text of this view."""
    return QCoreApplication.translate("SceneView", text)


class SceneView(QWidget):
    """Shows one scene.

    Mouse: drag a handle; click a thing to mark it in every panel. Keyboard: Tab and Shift+Tab choose a handle, the
    arrow keys move it (Shift: ten steps, Ctrl: a tenth), Escape lets it go.

    Signals
    -------
    dragged(handle, x, y)
        The person moved a handle to (x, y) of its panel; whoever made the scene answers with a new one.
    dropped()
        The movement is over: one entry for undo.
    chosen(thing)
        A thing was marked, or an empty text.
    """

    dragged = Signal(object, float, float)
    dropped = Signal()
    chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._scene: Scene | None = None
        self._look = Look()
        self._held: tuple[Handle, tuple[float, float]] | None = None
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(480, 320)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)

    def sizeHint(self) -> QSize:
        """Prefer a wide picture."""
        return QSize(1100, 700)

    @property
    def scene(self) -> Scene | None:
        """The scene that is shown."""
        return self._scene

    @property
    def look(self) -> Look:
        """How it is shown."""
        return self._look

    def show_scene(self, scene: Scene) -> None:
        """Show another scene; what is marked and held stays where it exists."""
        self._scene = scene
        self.setAccessibleDescription(scene.says)
        self.update()

    def set_look(self, look: Look) -> None:
        """Change theme, font, or what is visible."""
        self._look = look
        self.update()

    def choose(self, thing: str) -> None:
        """Mark a thing in every panel."""
        if thing != self._look.chosen:
            self.set_look(replace(self._look, chosen=thing))
            self.chosen.emit(thing)

    def image(self, size: QSize | None = None, scale: float = 2.0, *, clean: bool = True) -> QImage:
        """Return the scene as an image, in `scale` times the resolution of the screen; `clean` without handles."""
        size = size or self.size()
        image = QImage(size * scale, QImage.Format.Format_RGB32)
        image.setDevicePixelRatio(scale)
        painter = QPainter(image)
        self._draw(painter, size.width(), size.height(), for_print(self._look) if clean else self._look)
        painter.end()
        return image

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the scene."""
        painter = QPainter(self)
        try:
            self._draw(painter, self.width(), self.height(), self._look)
        finally:  # a painter left active takes the whole window down
            painter.end()

    def _draw(self, painter: QPainter, width: int, height: int, look: Look) -> None:
        canvas = QtCanvas(painter, QFont(self.font()))
        if self._scene is not None:
            draw(self._scene, canvas, width, height, look)

    def _frames(self) -> dict[str, Frame]:
        assert self._scene is not None
        return frames(self._scene, self.width(), self.height(), self._look.font)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take a handle, or mark a thing."""
        if self._scene is None or event.button() != Qt.MouseButton.LeftButton:
            return
        where, at = self._frames(), event.position()
        handle = handle_at(self._scene, where, at.x(), at.y(), self._look)
        if handle is None:
            self.choose(self._thing_at(where, at))
            return
        x, y = where[handle.panel].to_panel(at.x(), at.y())
        self._held = handle, (handle.at[0] - x, handle.at[1] - y)
        self.set_look(replace(self._look, active=handle.name))
        self.choose(handle.thing)
        self.setCursor(Qt.CursorShape.ClosedHandCursor)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag what is held, or show that something can be dragged."""
        if self._scene is None:
            return
        where, at = self._frames(), event.position()
        if self._held is None:
            over = handle_at(self._scene, where, at.x(), at.y(), self._look)
            self.setCursor(Qt.CursorShape.OpenHandCursor if over else Qt.CursorShape.ArrowCursor)
            self.setToolTip(self._tip(where, at, over))
            return
        handle, (dx, dy) = self._held
        x, y = where[handle.panel].to_panel(at.x(), at.y())
        self.dragged.emit(handle, x + dx, y + dy)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go."""
        if self._held is not None:
            self._held = None
            self.setCursor(Qt.CursorShape.OpenHandCursor)
            self.dropped.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Leave the wheel to the page."""
        event.ignore()

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Use Tab for the handles as long as there is a next one, then for the page."""
        return self._next_handle(1 if forward else -1) or super().focusNextPrevChild(forward)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the active handle by arrows."""
        handle = self.active_handle()
        way = _ARROWS.get(Qt.Key(event.key()))
        if event.key() == Qt.Key.Key_Escape and self._look.active:
            self.set_look(replace(self._look, active=""))
        elif handle is None or way is None or self._scene is None:
            super().keyPressEvent(event)
        else:
            many = 10.0 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1.0
            many = 0.1 if event.modifiers() & Qt.KeyboardModifier.ControlModifier else many
            down = 1.0 if self._scene.panel(handle.panel).y_down else -1.0
            x = handle.at[0] + way[0] * many * handle.nudge[0]
            y = handle.at[1] + way[1] * many * handle.nudge[1] * down
            self.dragged.emit(handle, x, y)
            self.dropped.emit()

    def active_handle(self) -> Handle | None:
        """Return the handle that has the keyboard."""
        handles = self._scene.handles if self._scene else ()
        return next((h for h in handles if h.name == self._look.active), None)

    def _next_handle(self, way: int) -> bool:
        names = (
            [h.name for h in self._scene.handles if self._look.answers or not h.answer] if self._scene else []
        )
        active = self._look.active
        start = -1 if way > 0 else len(names)
        index = (names.index(active) if active in names else start) + way
        inside_row = 0 <= index < len(names)
        self.set_look(replace(self._look, active=names[index] if inside_row else ""))
        if inside_row:
            self.choose(next(h.thing for h in self._scene.handles if h.name == names[index]))  # type: ignore[union-attr]
        return inside_row

    def _thing_at(self, where: dict[str, Frame], at: QPointF) -> str:
        """Return the thing under a position: the nearest point or line in reach, else the polygon around it."""
        assert self._scene is not None
        around, best = "", (_TOUCH * self._look.unit, "")
        for mark in self._scene.visible(truth=self._look.truth, answers=self._look.answers):
            frame = where.get(mark.panel)
            if not mark.thing or frame is None or not frame.contains(at.x(), at.y()):
                continue
            distance = _distance(mark, frame, at.x(), at.y())
            if distance < best[0]:
                best = distance, mark.thing
            if isinstance(mark, Polygon) and inside(frame.to_canvas(mark.xy), at.x(), at.y()):
                around = mark.thing
        return best[1] or around

    def _tip(self, where: dict[str, Frame], at: QPointF, handle: Handle | None) -> str:
        """Return what is under a position, in words."""
        thing = handle.thing if handle else self._thing_at(where, at)
        words = self._scene.things.get(thing, "") if self._scene else ""
        if handle is not None:
            return f"{handle.label}: {words}. " + tr("Drag, or use the arrow keys.")
        return words


def _distance(mark: Mark, frame: Frame, x: float, y: float) -> float:
    if not isinstance(mark, (Points, Line, Polygon)) or not len(mark.xy):
        return float("inf")
    xy = frame.to_canvas(mark.xy) - (x, y)
    if isinstance(mark, Points):
        return float(np.nanmin(np.hypot(xy[:, 0], xy[:, 1]), initial=np.inf))
    start, end = xy[:-1], xy[1:]
    along = end - start
    length = np.maximum((along**2).sum(axis=1), 1e-12)
    part = np.clip(-(start * along).sum(axis=1) / length, 0.0, 1.0)
    nearest = start + part[:, None] * along
    return float(np.nanmin(np.hypot(nearest[:, 0], nearest[:, 1]), initial=np.inf))
