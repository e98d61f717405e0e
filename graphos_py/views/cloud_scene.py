"""What the 3D view shows, apart from the widget: cloud, cameras, grid, and how each is coloured. Knows no Qt."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.rendering import (
    Lines,
    PreparedCloud,
    Quads,
    ViewCamera,
    camera_pyramids,
    colours_of_values,
    prepare_cloud,
)

RGB, HEIGHT, VIEWS, NORMALS, VALUES = "rgb", "height", "views", "normals", "values"
THUMBNAIL_PX = 256
GRID_LINES = 10
AXIS_COLOURS = np.array([[214, 69, 65], [56, 158, 78], [58, 116, 214]], np.uint8)


@dataclass(frozen=True)
class Legend:
    """Range and meaning of a colour mode.

    Attributes
    ----------
    title, unit, table : str
    low, high : float
    """

    title: str
    unit: str
    low: float
    high: float
    table: str = "viridis"


@dataclass
class CloudScene:
    """Cloud and cameras of one 3D view.

    Attributes
    ----------
    points : float64 (n, 3)
    colours : uint8 (n, 3)
    normals : float32 (n, 3) or None
    views : uint8 (n,) or None
    sigmas : float64 (n, 3) or None
        Standard deviations of the coordinates, in `unit`.
    values : float (n,) or None
        Any figure per point, such as the distance from a reference.
    unit : str
    up : float64 (3,)
    rotations, centres, cameras, names : cameras as in `Block`, oriented ones only
    thumbnails : tuple of uint8 (h, w, 3)
    """

    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    colours: Array = field(default_factory=lambda: np.zeros((0, 3), np.uint8))
    normals: Array | None = None
    views: Array | None = None
    sigmas: Array | None = None
    values: Array | None = None
    value_legend: Legend | None = None
    unit: str = "model units"
    up: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    rotations: Array = field(default_factory=lambda: np.zeros((0, 3, 3)))
    centres: Array = field(default_factory=lambda: np.zeros((0, 3)))
    cameras: tuple[Camera, ...] = ()
    names: tuple[str, ...] = ()
    thumbnails: tuple[Array, ...] = ()
    box: Array = field(default_factory=lambda: np.array([[-1.0] * 3, [1.0] * 3]))
    _pyramids: tuple[Array, Array, Array] | None = None
    _heights: tuple[float, float] | None = None

    # cloud

    def set_points(self, points: Array, colours: Array | None) -> None:
        """Take a new cloud; what is known of the points of the last one is dropped."""
        self.points = np.asarray(points, np.float64).reshape(-1, 3)
        grey = np.full((len(self.points), 3), 170, np.uint8)
        self.colours = grey if colours is None else np.asarray(colours, np.uint8).reshape(-1, 3)
        self.normals = self.views = self.sigmas = self.values = self.value_legend = None
        self._measure_box()

    def prepare(self, mode: str) -> PreparedCloud:
        """Return the cloud ready to be drawn in a colour mode: slow, for a worker thread."""
        return prepare_cloud(self.points, self.colours_in(mode))

    def modes(self) -> list[str]:
        """Return the colour modes for which there are data."""
        found = [RGB, HEIGHT]
        found += [VIEWS] if self.views is not None and len(self.views) else []
        found += [NORMALS] if self.normals is not None and len(self.normals) else []
        found += [VALUES] if self.values is not None else []
        return found

    def legend(self, mode: str) -> Legend | None:
        """Return the range of a colour mode; None for modes that are not figures."""
        if not len(self.points):
            return None
        if mode == HEIGHT:
            if self._heights is None:
                sample = self.points[:: max(len(self.points) // 200_000, 1)] @ self.up
                low, high = (float(v) for v in np.nanpercentile(sample, [1, 99]))
                self._heights = (low, high)
            return Legend("height", self.unit, *self._heights)
        if mode == VIEWS and self.views is not None and len(self.views):
            return Legend(
                "photos that confirm the point", "", float(self.views.min()), float(self.views.max())
            )
        return self.value_legend if mode == VALUES else None

    def colours_in(self, mode: str) -> Array:
        """Return RGB uint8 (n, 3) of every point in a colour mode."""
        legend = self.legend(mode)
        if legend is not None:
            figures = (
                self.points @ self.up if mode == HEIGHT else self.views if mode == VIEWS else self.values
            )
            return colours_of_values(np.asarray(figures), legend.low, legend.high, legend.table)
        if mode == NORMALS and self.normals is not None and len(self.normals):
            return np.clip(127.5 + 127.5 * self.normals, 0, 255).astype(np.uint8)
        return self.colours

    def spacing(self) -> float:
        """Return a rough distance between neighbouring points on a surface, in the unit of the cloud."""
        area = float(np.sort(np.ptp(self.box, axis=0))[1:].prod())
        return math.sqrt(area / max(len(self.points), 1))

    # cameras

    def set_cameras(
        self,
        rotations: Array,
        centres: Array,
        cameras: Sequence[Camera],
        names: Sequence[str],
        thumbnails: Sequence[Array] | None,
    ) -> None:
        """Take new cameras."""
        self.rotations = np.asarray(rotations, np.float64).reshape(-1, 3, 3)
        self.centres = np.asarray(centres, np.float64).reshape(-1, 3)
        self.cameras, self.names = tuple(cameras), tuple(names)
        self.thumbnails = tuple(_small_rgb(image) for image in thumbnails or ())
        if self.unit != "m" and len(self.rotations):
            up = -self.rotations[:, 1].mean(
                axis=0
            )  # nothing says where up is: photographers hold cameras upright
            if np.linalg.norm(up) > 0.2:
                self.up = up / np.linalg.norm(up)
        self._measure_box()

    def pyramid_size(self) -> float:
        """Return the longer side of a drawn photo: a part of the distance between neighbouring cameras."""
        extent = self.extent()
        if len(self.centres) < 2:
            return 0.1 * extent
        distance = np.linalg.norm(self.centres[:, None] - self.centres[None], axis=2)
        np.fill_diagonal(distance, np.inf)
        return float(np.clip(0.6 * np.median(distance.min(axis=1)), 0.015 * extent, 0.12 * extent))

    def pyramids(self) -> tuple[Array, Array, Array]:
        """Return edges (n, 8, 3) twice and photo corners (n, 3, 3) of all cameras."""
        if self._pyramids is None:
            self._pyramids = camera_pyramids(self.rotations, self.centres, self.cameras, self.pyramid_size())
        return self._pyramids

    def quads(self, opacity: float = 1.0) -> Quads | None:
        """Return the photos of the cameras; None where there are none."""
        if not self.thumbnails or len(self.thumbnails) != len(self.centres):
            return None
        return Quads(self.pyramids()[2], self.thumbnails, opacity)

    def pyramid_lines(
        self, ink: tuple[int, int, int], accent: tuple[int, int, int], selected: int
    ) -> list[Lines]:
        """Return the edges of all pyramids; the selected one in the accent colour and wider."""
        if not len(self.centres):
            return []
        starts, ends, _ = self.pyramids()
        plain = np.arange(len(starts)) != selected
        groups = []
        for which, colour, width in ((plain, ink, 1.3), (~plain, accent, 3.0)):
            count = 8 * int(which.sum())
            if count:
                colours = np.tile(np.array(colour, np.uint8), (count, 1))
                groups.append(Lines(starts[which].reshape(-1, 3), ends[which].reshape(-1, 3), colours, width))
        return groups

    def camera_at(self, camera: ViewCamera, x: float, y: float, width: int, height: int) -> tuple[int, float]:
        """Return the pyramid whose photo lies at pixel (x, y), and its depth; (−1, inf) for none."""
        best, nearest = -1, math.inf
        if not len(self.centres):
            return best, nearest
        for i, (corner, right, down) in enumerate(self.pyramids()[2]):
            outline = camera.project(
                np.array([corner, corner + right, corner + right + down, corner + down]), width, height
            )
            depth = float(outline[:, 2].mean())
            if not np.isfinite(outline).all() or depth >= nearest:
                continue
            if (
                cv2.pointPolygonTest(outline[:, :2].astype(np.float32).reshape(-1, 1, 2), (x, y), True)
                >= -3.0
            ):
                best, nearest = i, depth
        return best, nearest

    # frame of reference

    def extent(self) -> float:
        """Return the diagonal of the box round the cloud, in its unit."""
        return float(np.linalg.norm(self.box[1] - self.box[0])) or 1.0

    def corners(self) -> Array:
        """Return the corners (8, 3) of the box round the cloud."""
        choice = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
        return np.take_along_axis(self.box, choice, axis=0)

    def fit_points(self, with_cameras: bool = True) -> Array:
        """Return points (n, 3) that have to be in the picture: a sample of the cloud in its box, and the cameras."""
        sample = self.points[:: max(len(self.points) // 3000, 1)]
        inside = ((sample >= self.box[0]) & (sample <= self.box[1])).all(axis=1)
        return np.concatenate([sample[inside], self.centres]) if with_cameras else sample[inside]

    def first_camera(self) -> ViewCamera:
        """Return the first sight: as the cameras look at the cloud, a little from above and from the side."""
        up = self.up
        direction = self.rotations[:, 2].mean(axis=0) if len(self.rotations) else np.array([0.45, 0.8, -0.4])
        if np.linalg.norm(direction) < 0.3 or len(self.rotations) == 0:
            side = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
            side /= np.linalg.norm(side)
            direction = 0.45 * np.cross(up, side) + 0.8 * side - 0.4 * up
        camera = ViewCamera.looking(direction, up)
        return camera.orbited(0.35, 0.25) if len(self.rotations) else camera

    def grid(self, ink: tuple[int, int, int], step: float) -> Lines:
        """Return a grid with meshes of `step` at the foot of the cloud, and the three axes at its corner."""
        up = self.up
        e1 = np.eye(3)[int(np.argmin(np.abs(up)))]
        e1 = e1 - up * (e1 @ up)
        e1 /= np.linalg.norm(e1)
        e2 = np.cross(up, e1)
        flat = self.corners()
        foot = float((flat @ up).min()) * up
        spans = [
            (math.floor((flat @ e).min() / step) * step, math.ceil((flat @ e).max() / step) * step)
            for e in (e1, e2)
        ]
        starts, ends = [], []
        for along, across, span, other in ((e1, e2, spans[0], spans[1]), (e2, e1, spans[1], spans[0])):
            for value in np.arange(other[0], other[1] + 0.5 * step, step):
                starts.append(foot + across * value + along * span[0])
                ends.append(foot + across * value + along * span[1])
        colours = np.tile(np.array(ink, np.uint8), (len(starts), 1))
        return Lines(np.array(starts), np.array(ends), colours, 1.0)

    def _measure_box(self) -> None:
        self._pyramids = self._heights = None
        sample = self.points[:: max(len(self.points) // 100_000, 1)]
        sample = sample[np.isfinite(sample).all(axis=1)]
        if len(sample) > 50:
            self.box = np.percentile(sample, [0.5, 99.5], axis=0)
        elif len(sample):
            self.box = np.stack([sample.min(axis=0), sample.max(axis=0)])
        elif len(self.centres):
            self.box = np.stack([self.centres.min(axis=0), self.centres.max(axis=0)])


def _small_rgb(image: Array) -> Array:
    image = np.repeat(image[:, :, None], 3, axis=2) if image.ndim == 2 else image
    every = max(1, min(image.shape[:2]) // (4 * THUMBNAIL_PX))
    image = image[::every, ::every]  # photos in full size are thinned first: averaging them all would be felt
    scale = THUMBNAIL_PX / max(image.shape[:2])
    if scale < 1:
        image = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    return np.array(image, np.uint8, order="C")
