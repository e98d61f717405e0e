"""The 3D view: cloud, cameras with their photos, measuring."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QAction, QKeyEvent, QPalette
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget

from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.number_format import format_value
from graphos_core.rendering import Lines, PreparedCloud
from graphos_py.views.cloud_bar import CloudBar
from graphos_py.views.cloud_canvas import CloudCanvas
from graphos_py.views.cloud_overlay import CloudOverlay
from graphos_py.views.cloud_picture import Picture
from graphos_py.views.cloud_scene import RGB, VALUES, CloudScene, Legend
from graphos_py.views.export import Writer, export_menu, write_csv, write_png, write_svg
from graphos_py.views.measurement import Measurement
from graphos_py.views.painting import is_dark, round_step

DENSE_FROM = 60_000
"""Clouds with more points than this cover their surface, so edges in depth can be shaded."""


class CloudView(QWidget):
    """Points, cameras and measurements in space.

    Signals
    -------
    point_picked(index)
        Index of the point that was clicked, −1 for none.
    camera_clicked(index), camera_double_clicked(index)
        Index into the arrays given to `set_cameras`.
    measured(text)
        What is measured, for people; empty when cleared.
    """

    point_picked = Signal(int)
    camera_clicked = Signal(int)
    camera_double_clicked = Signal(int)
    measured = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("cloud")
        self.scene = CloudScene()
        self.mode = RGB
        self.picked = -1
        self.selected_camera = -1
        self.measurement = Measurement(self.scene)
        self.more_lines: Callable[[], list[Lines]] = list
        self._prepared: PreparedCloud | None = None
        self._prepared_mode = ""
        self._dense = False
        self.canvas = CloudCanvas(self._describe, self)
        self.canvas.fit_points = lambda: self.scene.fit_points(self.bar.cameras.isChecked())
        self.canvas.pivot_point = lambda: self.scene.box.mean(axis=0)
        self.canvas.empty = (
            self.tr("Here you will see the object in space, and where the photos were taken"),
            self.tr("Run the adjustment, or open a point cloud."),
        )
        self.overlay = CloudOverlay(self)
        self.canvas.layers = [self.overlay.paint]
        self.bar = CloudBar(self)
        self.bar.changed.connect(self.canvas.refresh)
        self.bar.mode_chosen.connect(self.set_mode)
        self.bar.fit_wanted.connect(self.canvas.fit)
        self.bar.measure.toggled.connect(self.clear_measurement)
        self.bar.offer_modes(self.scene, self.mode)
        self._text, self._state = QLabel(), QLabel()
        footer = QHBoxLayout()
        footer.setContentsMargins(8, 2, 8, 2)
        footer.addWidget(self._text, 1)
        footer.addWidget(self._state)
        box = QVBoxLayout(self)
        box.setContentsMargins(0, 0, 0, 0)
        box.setSpacing(0)
        box.addWidget(self.bar)
        box.addWidget(self.canvas, 1)
        box.addLayout(footer)
        self.setFocusProxy(self.canvas)
        self.canvas.clicked.connect(self._on_click)
        self.canvas.double_clicked.connect(self._on_double_click)
        self.canvas.hovered.connect(self._on_hover)
        self.canvas.menu_wanted.connect(self._show_menu)
        self._write()

    # what is shown

    def set_cloud(
        self,
        points: Array,
        colours: Array | None = None,
        normals: Array | None = None,
        views: Array | None = None,
        unit: str = "model units",
    ) -> None:
        """Show a cloud; the camera stays where the person put it.

        Parameters
        ----------
        points : float64 (n, 3)
            In `unit`.
        colours : uint8 (n, 3) or None
            RGB.
        normals : float32 (n, 3) or None
        views : uint8 (n,) or None
            Photos in which each point was confirmed.
        unit : str
            ``"m"`` or ``"model units"``.
        """
        if unit != self.scene.unit:
            self.canvas.touched = False
            self.scene.up = np.array([0.0, 0.0, 1.0])
        self.scene.unit = unit
        self.scene.set_points(points, colours)
        count = len(self.scene.points)
        if (count >= DENSE_FROM) != self._dense:
            self._dense = count >= DENSE_FROM
            self.bar.shading.setChecked(self._dense)
        self.scene.normals = normals if normals is not None and len(normals) == count else None
        self.scene.views = views if views is not None and len(views) == count else None
        self.picked = -1
        self.measurement.points = []
        self.mode = self.bar.offer_modes(self.scene, self.mode)
        self._forget_prepared()
        self._first_sight()
        self._write()

    def set_sigmas(self, sigmas: Array) -> None:
        """Tell the standard deviations (n, 3) of the points of the present cloud, in its unit, for measuring."""
        if len(sigmas) == len(self.scene.points):
            self.scene.sigmas = np.asarray(sigmas, np.float64)

    def set_cameras(
        self,
        rotations: Array,
        centres: Array,
        cameras: Sequence[Camera],
        names: Sequence[str],
        thumbnails: Sequence[Array] | None = None,
    ) -> None:
        """Show cameras as pyramids.

        Parameters
        ----------
        rotations : float64 (n, 3, 3)
            ``cam_from_world``.
        centres : float64 (n, 3)
        cameras : sequence of n Camera
            The camera of each photo.
        names : sequence of n str
        thumbnails : sequence of n uint8 (h, w, 3) or (h, w), or None
            Shown on the base of each pyramid; made small here.
        """
        self.scene.set_cameras(rotations, centres, cameras, names, thumbnails)
        self.bar.offer_modes(self.scene, self.mode)
        self.selected_camera = -1
        self._first_sight()
        self._write()

    def set_values(
        self, values: Array, low: float, high: float, title: str, unit: str = "", table: str = "viridis"
    ) -> None:
        """Colour the present cloud by a figure per point, such as distances with ``table="diverging"``."""
        self.scene.values = np.asarray(values)
        self.scene.value_legend = Legend(title, unit, low, high, table)
        self._prepared_mode = ""
        self.mode = self.bar.offer_modes(self.scene, self.mode)
        self.set_mode(VALUES)

    def clear(self) -> None:
        """Show nothing."""
        self.scene = CloudScene()
        self.measurement = Measurement(self.scene)
        self.canvas.touched = False
        self.picked = self.selected_camera = -1
        self.measurement.points = []
        self.mode = self.bar.offer_modes(self.scene, self.mode)
        self._forget_prepared()
        self.canvas.refresh()
        self._write()

    def show_cameras(self, shown: bool) -> None:
        """Show or hide the cameras; the person can switch them too."""
        self.bar.cameras.setChecked(shown)

    def set_mode(self, mode: str) -> None:
        """Colour by ``rgb``, ``height``, ``views``, ``normals`` or ``values``."""
        self.mode = self.bar.offer_modes(self.scene, mode)
        self.canvas.refresh()

    def select_camera(self, index: int) -> None:
        """Highlight a camera; −1 for none. Emits nothing."""
        self.selected_camera = index
        self.canvas.refresh()
        self._write()

    def select_point(self, index: int) -> None:
        """Mark a point; −1 for none. Emits nothing."""
        self.picked = index
        self.canvas.update()
        self._write()

    def _filled(self) -> bool:
        return bool(len(self.scene.points) or len(self.scene.centres))

    def _first_sight(self) -> None:
        if not self.canvas.touched and self._filled():
            camera = self.scene.first_camera()
            self.canvas.set_camera(
                camera.fitted(self.canvas.fit_points(), *self.canvas.size_px()), touched=False
            )
        else:
            self.canvas.refresh()

    # drawing

    def _forget_prepared(self) -> None:
        self._prepared, self._prepared_mode = None, ""

    def _prepare(self, scene: CloudScene, mode: str) -> PreparedCloud:
        """Return the cloud to draw; runs in the worker thread, one picture at a time."""
        cloud = self._prepared
        if scene is not self.scene or cloud is None:
            cloud = scene.prepare(mode)
        elif mode != self._prepared_mode:
            cloud = cloud.recoloured(scene.colours_in(mode))
        if scene is self.scene:
            self._prepared, self._prepared_mode = cloud, mode
        return cloud

    def _describe(self, canvas: CloudCanvas, moving: bool) -> Picture | None:
        if not self._filled():
            return None
        scene, palette = self.scene, self.palette()
        accent = palette.color(QPalette.ColorRole.Highlight)
        dark = is_dark(palette)
        lines = []
        if self.bar.grid.isChecked():
            lines.append(scene.grid((58, 62, 68) if dark else (202, 205, 209), self.grid_step()))
        quads = None
        if self.bar.cameras.isChecked():
            ink = (200, 205, 210) if dark else (70, 76, 84)
            lines += scene.pyramid_lines(
                ink, (accent.red(), accent.green(), accent.blue()), self.selected_camera
            )
            quads = scene.quads() if self.bar.photos.isChecked() else None
        lines += self.more_lines()
        width, height = canvas.size_px()
        size = self.bar.size_slider.value()
        return Picture(
            prepare=partial(self._prepare, scene, self.mode),
            camera=canvas.camera,
            width=width,
            height=height,
            ratio=1.0 if moving else canvas.devicePixelRatioF(),
            point_size=float(size),
            world_size=0.6 * scene.spacing() * (size - 1),
            shading=1.0 if self.bar.shading.isChecked() else 0.0,
            background=self.background(),
            lines=lines,
            quads=quads,
            step=canvas.moving_step() if moving else 1,
        )

    def background(self) -> tuple[int, int, int]:
        """Return the ground behind the cloud: a grey on which light and dark points both show."""
        base = self.palette().color(QPalette.ColorRole.Base)
        if is_dark(self.palette()):
            return base.red(), base.green(), base.blue()
        return base.red() * 90 // 100, base.green() * 91 // 100, base.blue() * 92 // 100

    def grid_step(self) -> float:
        """Return the mesh of the grid, in the unit of the cloud."""
        return round_step(self.scene.extent() / 6.0)

    # measuring

    def clear_measurement(self) -> None:
        """Forget the measured points."""
        self.measurement.points = []
        self._tell_measurement()

    def add_measure_point(self, index: int) -> None:
        """Add a point to the measurement; a fourth one starts anew."""
        self.measurement.add(index)
        self._tell_measurement()

    def _tell_measurement(self) -> None:
        self.measured.emit(self.measurement.text())
        self.canvas.update()
        self._write()

    # people

    def _camera_under(self, x: float, y: float) -> int:
        if not self.bar.cameras.isChecked():
            return -1
        hit = self.canvas.pick(x, y)
        if hit is not None and hit[0] == "quad":
            return hit[1]
        index, depth = self.scene.camera_at(self.canvas.shown_camera, x, y, *self.canvas.size_px())
        return index if hit is None or depth < hit[2] else -1

    def _on_click(self, x: float, y: float) -> None:
        hit = self.canvas.pick(x, y)
        camera = -1 if self.bar.measure.isChecked() else self._camera_under(x, y)
        if camera >= 0:
            self.select_camera(camera)
            self.camera_clicked.emit(camera)
            return
        index = hit[1] if hit is not None and hit[0] == "point" else -1
        if self.bar.measure.isChecked() and index >= 0:
            self.add_measure_point(index)
        self.select_point(index)
        self.point_picked.emit(index)

    def _on_double_click(self, x: float, y: float) -> None:
        camera = self._camera_under(x, y)
        if camera >= 0:
            self.camera_double_clicked.emit(camera)
        elif self.canvas.pick(x, y, 12) is not None:
            self.canvas.set_camera(self.canvas.camera.focused(self.canvas.object_point(x, y)))

    def _on_hover(self, x: float, y: float) -> None:
        self.overlay.hovered_camera = self._camera_under(x, y) if self.scene.names else -1
        self.canvas.setToolTip("")
        self.canvas.update()

    def look_through(self, index: int) -> None:
        """Look from the projection centre of a camera in its direction, as far as the cloud."""
        rotation, centre = self.scene.rotations[index], self.scene.centres[index]
        camera = self.scene.cameras[index]
        middle = 0.5 * (self.scene.box[0] + self.scene.box[1])
        distance = max(float((middle - centre) @ rotation[2]), 0.1 * self.scene.extent())
        view = 2 * math.atan(0.5 * min(camera.width, camera.height) / camera.focal_px)
        made = type(self.canvas.camera)(
            centre + distance * rotation[2], rotation, distance, view, -rotation[1]
        )
        self.canvas.set_camera(made)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """M measures, Escape clears."""
        if event.key() == Qt.Key.Key_M:
            self.bar.measure.toggle()
        elif event.key() == Qt.Key.Key_Escape:
            self.select_point(-1)
            self.clear_measurement()
        else:
            super().keyPressEvent(event)

    def _show_menu(self, x: float, y: float) -> None:
        actions = []
        camera = self._camera_under(x, y)
        if camera >= 0:
            through = QAction(self.tr("Look through {name}").format(name=self.scene.names[camera]), self)
            through.triggered.connect(lambda: self.look_through(camera))
            actions.append(through)
        export_menu(self, self.exports(), actions).exec(self.canvas.mapToGlobal(QPoint(int(x), int(y))))

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        unit = self.scene.unit
        header = (f"X [{unit}]", f"Y [{unit}]", f"Z [{unit}]", "red", "green", "blue")
        return {
            "png": lambda path: write_png(self.canvas, path),
            "svg": lambda path: write_svg(self.canvas, path),
            "csv": lambda path: write_csv(
                path,
                header,
                ((*p, *c) for p, c in zip(self.scene.points.tolist(), self.scene.colours.tolist())),
            ),
        }

    def _write(self) -> None:
        if self.measurement.points:
            self._text.setText("   ".join(filter(None, (self.measurement.text(), self.measurement.reason()))))
        elif self.picked >= 0:
            self._text.setText(f"#{self.picked}   {self.measurement.coordinates(self.picked)}")
        elif self.bar.measure.isChecked():
            self._text.setText(self.tr("Click a point: its coordinates; a second: distance; a third: angle"))
        elif 0 <= self.selected_camera < len(self.scene.names):
            self._text.setText(self.scene.names[self.selected_camera])
        else:
            self._text.setText("")
        parts = []
        if len(self.scene.points):
            parts.append(self.tr("{n} points").format(n=format_value(len(self.scene.points))))
        if len(self.scene.centres):
            parts.append(self.tr("{n} photos").format(n=format_value(len(self.scene.centres))))
        self._state.setText("      ".join(parts))
