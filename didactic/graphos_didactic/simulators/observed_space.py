"""Space as somebody beside sees it: a camera of the engine that goes round, and the marks it makes of things in space."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.rotation import look_at
from graphos_didactic.scene import AnyMark, Dash, Handle, Line, Panel, Point, Points, Polygon, Role

HALF_WIDTH, HALF_HEIGHT = 200.0, 165.0
"""The observer's picture, from its middle, px."""
FARTHEST = 4000.0
"""Places farther from the middle than this count as this far, px."""


@dataclass(frozen=True, eq=False)
class Observer:
    """Somebody who looks at a place in space.

    Attributes
    ----------
    middle : float64 (3,)
        Where the observer looks, object frame.
    distance : float
        From there, in object units.
    orbit, height : float
        Degrees around the vertical from the negative Y axis, and above the horizon.
    focal : float
        Principal distance, px of the picture: larger makes things larger.
    half_height : float
        Of the picture, px; its half width is `HALF_WIDTH`.
    """

    middle: Array
    distance: float
    orbit: float
    height: float = 28.0
    focal: float = 440.0
    half_height: float = HALF_HEIGHT

    @cached_property
    def camera(self) -> Camera:
        """The observer's camera."""
        return Camera(model="pinhole", width=400, height=330, values=np.array([self.focal, 0.0, 0.0]))

    @cached_property
    def centre(self) -> Array:
        """Where the observer stands, float64 (3,)."""
        around, up = np.radians([self.orbit, self.height])
        way = np.array([np.sin(around) * np.cos(up), -np.cos(around) * np.cos(up), np.sin(up)])
        return np.asarray(self.middle) + self.distance * way

    @cached_property
    def rotation(self) -> Array:
        """``cam_from_world``, float64 (3, 3)."""
        return look_at(self.centre, self.middle)

    def seen(self, points: Array) -> Array:
        """Return where points (n, 3) appear, (n, 2) px from the middle; NaN behind the observer and for NaN."""
        return pixel_from_ray(self.camera, (np.asarray(points) - self.centre) @ self.rotation.T)

    def ray(self, x: float, y: float) -> Array:
        """Return the unit vector, object frame, from the observer through a place of the picture."""
        place = np.clip([[x, y]], -FARTHEST, FARTHEST)
        ray = ray_from_pixel(self.camera, place)[0] @ self.rotation
        return np.asarray(ray / np.linalg.norm(ray))

    def on_sphere(self, centre: Array, radius: float, x: float, y: float) -> Array:
        """Return the unit vector from `centre` to the nearer point of a sphere under (x, y), or nearest to the ray."""
        ray, offset = self.ray(x, y), np.asarray(centre) - self.centre
        along = float(ray @ offset)
        foot = along * ray - offset
        inside = radius**2 - float(foot @ foot)
        place = foot - np.sqrt(inside) * ray if inside > 0 else foot
        return np.asarray(place / max(float(np.linalg.norm(place)), 1e-12))

    def on_plane(self, origin: Array, normal: Array, x: float, y: float) -> Array | None:
        """Return the point of a plane under (x, y), float64 (3,); None where the ray does not meet it ahead."""
        ray = self.ray(x, y)
        across = float(ray @ normal)
        if abs(across) < 1e-9:
            return None
        along = float((np.asarray(origin) - self.centre) @ normal) / across
        return self.centre + along * ray if along > 0 else None

    def orbit_handle(self, panel: str = "space") -> Handle:
        """Return the handle that leads the observer round: the parameter ``orbit``, degrees."""
        return Handle(panel=panel, name="orbit", label="View from", role="neutral", freedom="x", nudge=(5.0, 0.0),
                      at=(self.orbit, self.half_height - 15.0), parameters=("orbit",),
                      move=lambda x, _: {"orbit": x})  # fmt: skip


def space_panel(
    title: str, rect: tuple[float, float, float, float], half_height: float = HALF_HEIGHT
) -> Panel:
    """Return the panel ``"space"`` of an observer."""
    return Panel(name="space", title=title, rect=rect, kind="picture", equal=True, y_down=True,
                 x_range=(-HALF_WIDTH, HALF_WIDTH), y_range=(-half_height, half_height))  # fmt: skip


def format_corners(camera: Camera) -> Array:
    """Return the outer corners of a camera's format, float64 (4, 2), px, clockwise from the top left."""
    right, bottom = camera.width - 0.5, camera.height - 0.5
    return np.array([[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom]])


def on_screen(camera: Camera, rotation: Array, centre: Array, pixels: Array, distance: float) -> Array:
    """Return where pixels (n, 2) of a photo lie that stands `distance` before its projection centre, (n, 3)."""
    rays = ray_from_pixel(camera, np.asarray(pixels, dtype=np.float64).reshape(-1, 2))
    return np.asarray(centre) + distance * rays @ rotation


def pyramid(
    observer: Observer,
    camera: Camera,
    rotation: Array,
    centre: Array,
    *,
    thing: str,
    role: Role,
    size: float,
    label: str = "",
    dash: Dash = "solid",
) -> list[AnyMark]:
    """Return a photo as a pyramid of height `size`: format, edges and projection centre."""
    screen = on_screen(camera, rotation, centre, format_corners(camera), size)
    edges = np.full((12, 3), np.nan)
    edges[0::3], edges[1::3] = centre, screen
    top = screen[:2].mean(axis=0) + 0.16 * (screen[0] - screen[3])
    tip = np.stack([screen[0] * 0.65 + screen[1] * 0.35, top, screen[0] * 0.35 + screen[1] * 0.65])
    return [
        Polygon(panel="space", thing=thing, role=role, xy=observer.seen(screen), fill=0.16, width=1.4, dash=dash),
        Polygon(panel="space", thing=thing, role=role, xy=observer.seen(tip), fill=0.5, width=0.8),
        Line(panel="space", thing=thing, role=role, xy=observer.seen(edges), width=1.2, dash=dash),
        Points(panel="space", thing=thing, role=role, xy=observer.seen(np.asarray(centre)[None]), size=8,
               marker="square", label=label),
    ]  # fmt: skip


def ground_lines(half: float, spacing: float, level: float = 0.0, pieces: int = 48) -> list[Array]:
    """Return the lines of a square grid on a horizontal plane, each float64 (pieces + 1, 3), around the Z axis."""
    along = np.linspace(-half, half, pieces + 1)
    lines = []
    for place in np.arange(-half, half + 1e-9, spacing):
        fixed, flat = np.full_like(along, place), np.full_like(along, level)
        lines += [np.stack([along, fixed, flat], axis=1), np.stack([fixed, along, flat], axis=1)]
    return lines


def clear_of(edge: float, xy: Array, camera: Camera) -> Array:
    """Whether points (n, 2) lie in a camera's format, at least `edge` px from its border, bool (n,)."""
    last: Point = (camera.width - 1 - edge, camera.height - 1 - edge)
    return np.all((xy >= edge) & (xy <= last), axis=1)
