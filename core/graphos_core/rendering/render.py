"""Draw a cloud, lines and photo quads into a picture, on the processor, over several threads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from graphos_core.data.record import Array
from graphos_core.rendering.camera import ViewCamera
from graphos_core.rendering.pyramids import Quads

Colour = tuple[int, int, int]
WHITE: Colour = (255, 255, 255)


@dataclass(frozen=True, eq=False)
class Lines:
    """Straight lines in the object frame.

    Attributes
    ----------
    starts, ends : float64 (k, 3)
    colours : uint8 (k, 3)
    width : float
        In px.
    on_top : bool
        Drawn over everything, for measurements.
    """

    starts: Array
    ends: Array
    colours: Array
    width: float = 1.5
    on_top: bool = False


@dataclass(frozen=True, eq=False)
class PreparedCloud:
    """A cloud ready to be drawn: near its own origin, in single precision, along a space-filling curve.

    Attributes
    ----------
    points : float32 (n, 3)
        Minus `origin`, in drawing order; points that are not finite are left out.
    colours : uint32 (n,)
        ``0xFFRRGGBB``, in drawing order.
    order : int64 (n,)
        Index in the original cloud of each drawn point.
    origin : float64 (3,)
    """

    points: Array
    colours: Array
    order: Array
    origin: Array

    def recoloured(self, colours: Array) -> PreparedCloud:
        """Return the same cloud with colours uint8 (n, 3) given in the original order."""
        return PreparedCloud(self.points, _packed(np.asarray(colours)[self.order]), self.order, self.origin)


@dataclass(frozen=True, eq=False)
class Frame:
    """A drawn picture and what is seen in every pixel.

    Attributes
    ----------
    bgrx : uint8 (h, w, 4)
        Blue, green, red, 255.
    keys : uint64 (h, w)
        See `graphos_core.rendering.kernels`.
    order : int64 (n,)
        Original index of each drawn point.
    """

    bgrx: Array
    keys: Array
    order: Array

    @property
    def image(self) -> Array:
        """The picture, uint8 (h, w, 3) RGB."""
        return np.ascontiguousarray(self.bgrx[:, :, 2::-1])

    def pick(self, x: float, y: float, radius: int = 4) -> tuple[str, int, float] | None:
        """Return what is seen at pixel (x, y) or next to it.

        The pixel itself counts first, then the nearest one that shows something within `radius` px.

        Returns
        -------
        (kind, index, depth) or None
            ``"point"`` and the index in the original cloud, or ``"quad"`` and the index of the quad.
        """
        column, row = round(x), round(y)
        left, top = max(column - radius, 0), max(row - radius, 0)
        window = self.keys[top : row + radius + 1, left : column + radius + 1]
        if not window.size or column < -radius or row < -radius:
            return None
        rows, columns = np.nonzero(window != np.uint64(0xFFFFFFFFFFFFFFFF))
        if not len(rows):
            return None
        squared = (rows + top - y) ** 2 + (columns + left - x) ** 2
        squared = np.where(squared <= 0.5, 0.0, squared)
        keys = window[rows, columns]
        best = int(np.lexsort((keys, squared))[0])
        if squared[best] > (radius + 0.5) ** 2:
            return None
        key = int(keys[best])
        index, depth = key & 0xFFFFFFFF, float(np.uint32(key >> 32).view(np.float32))
        if index >= len(self.order):
            return "quad", index - len(self.order), depth
        return "point", int(self.order[index]), depth


def prepare_cloud(points: Array, colours: Array | None = None) -> PreparedCloud:
    """Bring a cloud into the form that draws fast.

    Parameters
    ----------
    points : float (n, 3)
        Rows that are not finite are never drawn.
    colours : uint8 (n, 3) or None
        RGB; None draws light grey.

    Returns
    -------
    PreparedCloud
    """
    points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    order = np.flatnonzero(np.isfinite(points).all(axis=1))
    if colours is None:
        colours = np.full((len(points), 3), 200, np.uint8)
    kept = points[order]
    origin = kept.mean(axis=0) if len(kept) else np.zeros(3)
    local = (kept - origin).astype(np.float32)
    curve = np.argsort(_morton(local), kind="stable")
    order = order[curve]
    return PreparedCloud(
        np.ascontiguousarray(local[curve]), _packed(np.asarray(colours, np.uint8)[order]), order, origin
    )


def render_cloud(
    points: Array,
    colours: Array | None,
    camera: ViewCamera,
    width: int,
    height: int,
    point_size: float = 2.0,
    lines: Sequence[Lines] = (),
    background: Colour = WHITE,
    quads: Quads | None = None,
    shading: float = 1.0,
    threads: int = 2,
) -> Array:
    """Draw a cloud once, without a screen.

    Parameters
    ----------
    points : float (n, 3)
        Object frame.
    colours : uint8 (n, 3) or None
        RGB.
    camera : ViewCamera
    width, height : int
        Size of the picture, px.
    point_size : float
        Side of a point, px.
    lines : sequence of Lines
    background : (red, green, blue)
    quads : Quads or None
        Photos, see `camera_pyramids`.
    shading : float
        Strength of the eye-dome lighting; 0 for plain colours.
    threads : int
        The picture does not depend on it.

    Returns
    -------
    uint8 (height, width, 3)
        RGB.
    """
    prepared = prepare_cloud(points, colours)
    return render_frame(
        prepared, camera, width, height, point_size, lines=lines, quads=quads, background=background,
        shading=shading, threads=threads,
    ).image  # fmt: skip


def render_frame(
    cloud: PreparedCloud,
    camera: ViewCamera,
    width: int,
    height: int,
    point_size: float = 2.0,
    *,
    world_size: float = 0.0,
    lines: Sequence[Lines] = (),
    quads: Quads | None = None,
    background: Colour = WHITE,
    shading: float = 1.0,
    step: int = 1,
    threads: int = 2,
) -> Frame:
    """Draw a prepared cloud; parameters as in `render_cloud`.

    Parameters
    ----------
    world_size : float
        Side of a point in the unit of the cloud: points near the camera grow to close the surface; 0 for none.
    step : int
        Draw every step-th point only (along the curve, so evenly in space): for motion.
    """
    from graphos_core.rendering import kernels

    threads = max(1, threads)
    optics = np.array([camera.focal_px(width, height), 0.5 * (width - 1), 0.5 * (height - 1), camera.near])
    pose = np.concatenate(
        [camera.rotation, (camera.rotation @ (cloud.origin - camera.centre))[:, None]], axis=1
    ).astype(np.float32)
    sizes = np.array([point_size, world_size], np.float32)
    count = len(cloud.points)
    buffers = np.empty((threads, height, width), np.uint64)
    cuts = [count * i // threads // step * step for i in range(threads)] + [count]

    def draw(part: int) -> None:
        kernels.clear(buffers[part])
        kernels.splat(
            cloud.points,
            cuts[part],
            cuts[part + 1],
            step,
            pose,
            optics.astype(np.float32),
            sizes,
            buffers[part],
        )

    _in_threads(threads, draw)
    keys = buffers[0]
    rows = [height * i // threads for i in range(threads + 1)]
    if threads > 1:
        _in_threads(threads, lambda part: kernels.merge(buffers, keys, rows[part], rows[part + 1]))
    picture = np.empty((height, width), np.uint32)
    ground = np.uint32(_packed(np.array([background], np.uint8))[0])
    palette = cloud.colours if count else np.zeros(1, np.uint32)

    def colour(part: int) -> None:
        kernels.shade(keys, palette, ground, float(shading), picture, rows[part], rows[part + 1])

    _in_threads(threads, colour)
    _draw_flat(camera, quads, lines, count, optics, keys, picture)
    return Frame(picture.view(np.uint8).reshape(height, width, 4), keys, cloud.order)


def _draw_flat(
    camera: ViewCamera,
    quads: Quads | None,
    lines: Sequence[Lines],
    count: int,
    optics: Array,
    keys: Array,
    picture: Array,
) -> None:
    from graphos_core.rendering import kernels

    def local(points: Array) -> Array:
        points = np.asarray(points, np.float64).reshape(-1, 3)
        return np.ascontiguousarray((points - camera.centre) @ camera.rotation.T)

    if quads is not None:
        for i, texture in enumerate(quads.textures):
            corner = quads.corners[i]
            edges = corner[1:] @ camera.rotation.T
            placed = np.concatenate([local(corner[0]), edges])
            kernels.quad(placed, texture, quads.opacity, count + i, optics, keys, picture)
    for group in lines:
        colours = np.array(group.colours, np.uint8, order="C")
        kernels.lines(
            local(group.starts), local(group.ends), colours, group.width, group.on_top, optics, keys, picture
        )


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="render")


def _in_threads(threads: int, work: Callable[[int], Any]) -> None:
    if threads == 1:
        work(0)
    else:
        list(_pool(threads).map(work, range(threads)))


def _packed(colours: Array) -> Array:
    c = colours.astype(np.uint32)
    return np.ascontiguousarray(np.uint32(0xFF000000) | c[:, 0] << 16 | c[:, 1] << 8 | c[:, 2])


def _morton(points: Array) -> Array:
    """Return the place of points (n, 3) along a Z-order curve (Morton 1966) with 10 bits per axis, uint32 (n,)."""
    if not len(points):
        return np.zeros(0, np.uint32)
    low, span = points.min(axis=0), float(np.ptp(points, axis=0).max())
    cells = ((points - low) * np.float32(1023.0 / span if span > 0 else 0.0)).astype(np.uint32)
    code = np.zeros(len(points), np.uint32)
    for axis in range(3):
        c = cells[:, axis]
        for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
            c = (c | (c << np.uint32(shift))) & np.uint32(mask)
        code |= c << np.uint32(axis)
    return code
