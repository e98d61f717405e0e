"""The space of the epipolar simulator, seen by an observer: a third camera of the engine."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.rotation import look_at
from graphos_didactic.scene import AnyMark, Line, Points, Polygon, Role
from graphos_didactic.simulators.features.epipolar_model import (
    HEIGHT,
    WALL_Y,
    WIDTH,
    TwoCameras,
)
from graphos_didactic.simulators.format_edges import line_in_format

ROLES: tuple[Role, Role] = ("first", "second")
SCREEN = 1.7
"""The photos stand this far before their projection centres, m."""


def _observer(orbit: float) -> tuple[Camera, Array, Array]:
    camera = Camera(model="pinhole", width=400, height=240, values=np.array([440.0, 0.0, 0.0]))
    middle, angle = np.array([0.0, -1.0, 0.2]), np.radians(orbit)
    centre = middle + 17.0 * np.array([np.sin(angle) * 0.88, -np.cos(angle) * 0.88, 0.48])
    return camera, look_at(centre, middle), centre


def space_marks(both: TwoCameras, last: int) -> list[AnyMark]:
    """Return cameras, ray, point and, from step 2 on, the epipolar plane, as the observer sees them."""
    camera, rotation, centre = _observer(both.params.orbit)

    def seen(points: Array) -> Array:
        return pixel_from_ray(camera, (np.asarray(points) - centre) @ rotation.T)

    wall = np.array([[-5, WALL_Y, -3.4], [5, WALL_Y, -3.4], [5, WALL_Y, 3.4], [-5, WALL_Y, 3.4]])
    marks: list[AnyMark] = [
        Polygon(panel="space", thing="wall", role="muted", xy=seen(wall), fill=0.08, width=1.0)
    ]
    if last >= 2:
        corners = np.stack([both.centres[0], both.centres[1], both.point])
        marks.append(Polygon(panel="space", thing="plane", role="third", xy=seen(corners), fill=0.22, width=1.4,
                             dash="dashdot"))  # fmt: skip
    if both.depth > 0:
        ray = np.stack([both.centres[0], both.on_ray(both.pixels[0], min(14.0, 2.2 * both.depth))])
        marks.append(Line(panel="space", thing="ray", role="first", xy=seen(ray), width=1.8))
    for i, name in enumerate("ab"):
        marks += _pyramid(both, i, name, seen)
    if last >= 1 and both.line is not None:
        ends = line_in_format(both.line, both.camera)
        if ends is not None:
            line = _on_screen(both, 1, ends)
            marks.append(
                Line(panel="space", thing="ray", role="first", xy=seen(line), width=2.6, answer=True)
            )
    point = seen(both.point[None])
    marks.append(Points(panel="space", thing="point", role="truth", xy=point, size=9, label="P"))
    return marks


def _on_screen(both: TwoCameras, which: int, pixels: Array) -> Array:
    rays = ray_from_pixel(both.camera, pixels) @ both.rotations[which]
    return both.centres[which] + SCREEN * rays


def _pyramid(both: TwoCameras, which: int, name: str, seen: object) -> list[AnyMark]:
    corners = np.array([[-0.5, -0.5], [WIDTH - 0.5, -0.5], [WIDTH - 0.5, HEIGHT - 0.5], [-0.5, HEIGHT - 0.5]])
    screen = _on_screen(both, which, corners)
    role, dash = ROLES[which], ("solid", "dash")[which]
    assert callable(seen)
    edges = np.full((12, 3), np.nan)
    edges[0::3], edges[1::3] = both.centres[which], screen
    return [
        Polygon(panel="space", thing=f"camera_{name}", role=role, xy=seen(screen), fill=0.14, width=1.4,
                dash="solid" if dash == "solid" else "dash"),
        Line(panel="space", thing=f"camera_{name}", role=role, xy=seen(edges), width=1.2,
             dash="solid" if dash == "solid" else "dash"),
        Points(panel="space", thing=f"camera_{name}", role=role, xy=seen(both.centres[which][None]), size=8,
               marker="square" if which else "circle", label=name.upper()),
    ]  # fmt: skip
