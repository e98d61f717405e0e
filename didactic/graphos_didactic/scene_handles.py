"""Handles: how they look, and which one a pointer takes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from graphos_core.data.record import Array
from graphos_didactic.scene import Handle, Scene
from graphos_didactic.scene_layout import Frame

if TYPE_CHECKING:
    from graphos_didactic.scene_drawing import Canvas, Look

REACH = 16.0
"""How near a pointer must come to take a handle, px at 100 % font scale."""


def draw_handles(scene: Scene, where: Mapping[str, Frame], canvas: Canvas, look: Look) -> None:
    """Draw every handle: a ring with the arrows of its freedom; a wide double ring when it has the keyboard."""
    for handle in scene.handles:
        frame = where[handle.panel]
        centre = frame.to_canvas(np.array([handle.at]))[0]
        if not frame.contains(*centre) or (handle.answer and not look.answers):
            continue
        colour, unit = look.colours[handle.role], look.unit
        canvas.discs(centre[None], 8.5 * unit, look.colours["surface"], colour, 2.2 * unit)
        canvas.discs(centre[None], 3.2 * unit, colour, colour, 0.0)
        for way in _ways(handle):
            tip, side = centre + way * 15 * unit, np.array([-way[1], way[0]]) * 3.6 * unit
            root = centre + way * 10.5 * unit
            canvas.polygon(np.array([tip, root + side, root - side]), colour, 1.0)
        if handle.name == look.active:
            canvas.discs(centre[None], 19 * unit, "", look.colours["text"], 1.4 * unit)
            canvas.discs(centre[None], 21.5 * unit, "", look.colours["selected"], 2.4 * unit)


def _ways(handle: Handle) -> Array:
    along = np.array([[1.0, 0.0], [-1.0, 0.0]])
    across = np.array([[0.0, 1.0], [0.0, -1.0]])
    if handle.freedom == "x":
        return along
    if handle.freedom == "y":
        return across
    if handle.freedom == "turn":
        return np.array([[0.7, 0.7], [-0.7, -0.7]])
    return np.concatenate([along, across])


def handle_at(scene: Scene, where: Mapping[str, Frame], x: float, y: float, look: Look) -> Handle | None:
    """Return the handle that a pointer at canvas position (x, y) takes: the nearest in reach, else by its grip."""
    near: tuple[float, Handle] | None = None
    grabbed: Handle | None = None
    for handle in scene.handles:
        frame = where[handle.panel]
        if handle.answer and not look.answers:
            continue
        centre = frame.to_canvas(np.array([handle.at]))[0]
        distance = float(np.hypot(*(centre - (x, y))))
        if distance < REACH * look.unit and (near is None or distance < near[0]):
            near = distance, handle
        if handle.grip is not None and frame.contains(x, y) and inside(frame.to_canvas(handle.grip), x, y):
            grabbed = handle
    return near[1] if near else grabbed


def inside(polygon: Array, x: float, y: float) -> bool:
    """Whether (x, y) lies in a polygon (n, 2), by the even-odd rule."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    rise = np.where(crosses, b[:, 1] - a[:, 1], 1.0)
    at = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return bool(np.count_nonzero(crosses & (x < at)) % 2)
