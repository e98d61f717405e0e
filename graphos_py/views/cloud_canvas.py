"""The surface of the 3D view: asks a worker thread for pictures, shows the latest, and moves the camera."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import (
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from graphos_core.data.record import Array
from graphos_core.rendering.camera import ViewCamera
from graphos_py.views.background import Background
from graphos_py.views.cloud_picture import Picture, Shown, draw
from graphos_py.views.painting import paint_empty_state

DRAG_STARTS = 4.0
REST_MS = 160
MOVING_BUDGET_S = 0.04


class CloudCanvas(QWidget):
    """Shows pictures of a cloud and turns mouse and keys into a camera.

    Left drag orbits, right or middle drag pans, the wheel zooms at the cursor, Shift with left drag rolls.

    Signals
    -------
    camera_changed()
    drawn()
        A new picture is on the screen.
    clicked(x, y), double_clicked(x, y), hovered(x, y)
        Widget px.
    menu_wanted(x, y)
        Right click without drag.
    """

    camera_changed = Signal()
    drawn = Signal()
    clicked = Signal(float, float)
    double_clicked = Signal(float, float)
    hovered = Signal(float, float)
    menu_wanted = Signal(float, float)

    def __init__(
        self, describe: Callable[[CloudCanvas, bool], Picture | None], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.camera = ViewCamera.looking(np.array([0.45, 0.8, -0.4]))
        self.touched = False
        self.shown: Shown | None = None
        self.failure: str = ""
        self.empty = ("", "")
        self.layers: list[Callable[[QPainter], None]] = []
        self.fit_points: Callable[[], Array] = lambda: np.zeros((0, 3))
        self.pivot_point: Callable[[], Array] = lambda: self.camera.target
        self._describe = describe
        self._image: QImage | None = None
        self._serial = 0
        self._busy = False
        self._again = False
        self._moving = False
        self._full_seconds = 0.0
        self._button = Qt.MouseButton.NoButton
        self._pressed = self._last = QPointF()
        self._dragging = False
        self._pan_depth: float | None = None
        self._pivot: Array | None = None
        self._background = Background(self)
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.timeout.connect(self._on_rest)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(120, 120)

    # pictures

    @property
    def busy(self) -> bool:
        """Whether a picture is being drawn or waits to be."""
        return self._busy or self._again or self._rest.isActive()

    def refresh(self) -> None:
        """Ask for a new picture; while one is being drawn, only the latest wish is kept."""
        if self._busy:
            self._again = True
            return
        picture = self._next(self._moving)
        if picture is None:
            self._image = self.shown = None
            self.update()
            return
        if self._image is None:
            self.update()
        self._busy = True
        self._background.run(partial(draw, picture), self._on_picture)

    def draw_now(self) -> None:
        """Draw at once in this thread, for screenshots and exports; may take seconds the first time."""
        picture = self._next(False)
        if picture is not None:
            self._show(draw(picture))

    def _next(self, moving: bool) -> Picture | None:
        picture = self._describe(self, moving)
        self._serial += 1
        return None if picture is None else replace(picture, serial=self._serial)

    def _on_picture(self, result: object) -> None:
        self._busy = False
        if isinstance(result, Shown):
            if self.shown is None or result.picture.serial > self.shown.picture.serial:
                self._show(result)
        else:
            self.failure = str(result)
            self.update()
        if self._again:
            self._again = False
            self.refresh()

    def _show(self, shown: Shown) -> None:
        self.shown = shown
        self.failure = ""
        pixels = shown.frame.bgrx
        height, width = pixels.shape[:2]
        self._image = QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_RGB32)
        self._image.setDevicePixelRatio(shown.picture.ratio)
        whole = shown.seconds * shown.picture.step
        self._full_seconds = whole if shown.picture.step == 1 else min(self._full_seconds, whole)
        self.update()
        self.drawn.emit()

    def moving_step(self) -> int:
        """Return which share of the points is drawn in motion: every step-th."""
        return max(1, math.ceil(self._full_seconds / MOVING_BUDGET_S - 0.25))

    def _on_rest(self) -> None:
        self._moving = False
        self.refresh()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the latest picture and the layers."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Base))
        if self._image is None:
            title, hint = self.empty
            if self.failure:
                title, hint = self.tr("The picture could not be drawn"), self.failure
            elif self._busy:
                title, hint = (
                    self.tr("Preparing the 3D view…"),
                    self.tr("The first time takes a few seconds."),
                )
            paint_empty_state(painter, self.rect(), self.palette(), title, hint)
            return
        painter.drawImage(QPointF(0, 0), self._image)
        for layer in self.layers:
            painter.save()
            layer(painter)
            painter.restore()

    # camera

    def set_camera(self, camera: ViewCamera, touched: bool = True) -> None:
        """Look through another camera; `touched` means that the person chose it."""
        self.camera = camera
        self.touched = self.touched or touched
        self._moving = touched
        if touched:
            self._rest.start(REST_MS)
        self.refresh()
        self.camera_changed.emit()

    def fit(self) -> None:
        """Bring everything into the picture, from the same direction."""
        self.set_camera(self.camera.fitted(self.fit_points(), *self.size_px()))

    @property
    def shown_camera(self) -> ViewCamera:
        """The camera of the picture on the screen, which may lag behind `camera` by one picture."""
        return self.camera if self.shown is None else self.shown.picture.camera

    def size_px(self) -> tuple[int, int]:
        """Return width and height, at least one logical px."""
        return max(self.width(), 1), max(self.height(), 1)

    def pick(self, x: float, y: float, radius: int = 5) -> tuple[str, int, float] | None:
        """Return what the latest picture shows at a widget position; see `Frame.pick`."""
        if self.shown is None:
            return None
        ratio = self.shown.picture.ratio
        return self.shown.frame.pick((x + 0.5) * ratio - 0.5, (y + 0.5) * ratio - 0.5, round(radius * ratio))

    def object_point(self, x: float, y: float) -> Array:
        """Return the object point under a widget position: on what is seen there, else at the target's depth."""
        hit = self.pick(x, y, 12)
        depth = hit[2] if hit is not None else self.shown_camera.distance
        return self.shown_camera.point_at(x, y, depth, *self.size_px())

    # people

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Draw in the new size."""
        if not self.touched and len(self.fit_points()):
            self.camera = self.camera.fitted(self.fit_points(), *self.size_px())
        self.refresh()

    def changeEvent(self, event: QEvent) -> None:
        """Draw again when the theme changes."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.refresh()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom at the cursor."""
        at = event.position()
        factor = 1.0015 ** event.angleDelta().y()
        self.set_camera(self.camera.zoomed(factor, self.object_point(at.x(), at.y())))
        event.accept()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a click or a drag."""
        self._button = event.button()
        self._pressed = self._last = event.position()
        self._dragging = False
        hit = self.pick(event.position().x(), event.position().y(), 12)
        self._pan_depth = None if hit is None else hit[2]
        at = (event.position().x(), event.position().y())
        self._pivot = self.object_point(*at) if hit is not None else self.pivot_point()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Orbit, roll or pan."""
        position = event.position()
        if self._button == Qt.MouseButton.NoButton:
            self.hovered.emit(position.x(), position.y())
            return
        if not self._dragging and (position - self._pressed).manhattanLength() <= DRAG_STARTS:
            return
        self._dragging = True
        moved = position - self._last
        self._last = position
        if self._button != Qt.MouseButton.LeftButton:
            self.set_camera(self.camera.panned(moved.x(), moved.y(), *self.size_px(), self._pan_depth))
            return
        per_px = math.pi / min(self.size_px())
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            self.set_camera(self.camera.rolled(moved.x() * per_px))
        else:
            self.set_camera(self.camera.orbited(moved.x() * per_px, moved.y() * per_px, self._pivot))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Tell a click, or the wish for a menu."""
        if not self._dragging and event.button() == self._button:
            x, y = event.position().x(), event.position().y()
            if event.button() == Qt.MouseButton.LeftButton:
                self.clicked.emit(x, y)
            elif event.button() == Qt.MouseButton.RightButton:
                self.menu_wanted.emit(x, y)
        self._button = Qt.MouseButton.NoButton
        self._dragging = False

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Tell a double click."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.double_clicked.emit(event.position().x(), event.position().y())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """F fits, T looks from above, R from the front, + and − zoom, arrows orbit, with Shift pan."""
        key, camera = event.key(), self.camera
        arrows = {
            Qt.Key.Key_Left: (-1.0, 0.0), Qt.Key.Key_Right: (1.0, 0.0),
            Qt.Key.Key_Up: (0.0, -1.0), Qt.Key.Key_Down: (0.0, 1.0),
        }  # fmt: skip
        if key == Qt.Key.Key_F:
            self.fit()
        elif key in (Qt.Key.Key_T, Qt.Key.Key_R):
            tilt = math.asin(float(np.clip(-camera.rotation[2] @ camera.up, -1, 1)))
            wanted = math.radians(89.0) if key == Qt.Key.Key_T else 0.0
            self.set_camera(camera.orbited(0.0, wanted - tilt, self.pivot_point()))
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal):
            self.set_camera(camera.zoomed(1.25))
        elif key == Qt.Key.Key_Minus:
            self.set_camera(camera.zoomed(0.8))
        elif key in arrows:
            right, down = arrows[Qt.Key(key)]
            if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
                self.set_camera(camera.panned(40 * right, 40 * down, *self.size_px()))
            else:
                self.set_camera(
                    camera.orbited(math.radians(8) * right, math.radians(8) * down, self.pivot_point())
                )
        else:
            super().keyPressEvent(event)
