"""Measuring in a cloud by picking points: coordinates, distance, angle. Knows no Qt widgets."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.data.record import Array
from graphos_core.number_format import THIN_SPACE, group_thousands
from graphos_py.translation import tr
from graphos_py.views.cloud_scene import CloudScene


class Measurement:
    """Up to three picked points of a scene; a fourth one starts anew.

    Attributes
    ----------
    scene : CloudScene
    points : list of int
        Indices into the cloud.
    """

    def __init__(self, scene: CloudScene) -> None:
        self.scene = scene
        self.points: list[int] = []

    def add(self, index: int) -> None:
        """Add a point."""
        self.points = [*self.points, index] if len(self.points) < 3 else [index]

    def distance(self) -> float | None:
        """Return the distance of two points in the cloud's unit; None for another number of points."""
        if len(self.points) != 2:
            return None
        a, b = self._places()
        return float(np.linalg.norm(b - a))

    def angle(self) -> float | None:
        """Return the angle at the second of three points, radians; None for another number of points."""
        if len(self.points) != 3:
            return None
        first, middle, last = self._places()
        a, b = first - middle, last - middle
        return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))

    def text(self) -> str:
        """Return what is measured, for people; empty without points."""
        distance, angle = self.distance(), self.angle()
        if distance is not None:
            return tr("distance {d}", d=length_text(self.scene, distance))
        if angle is not None:
            return tr("angle at the second point {a}°", a=f"{math.degrees(angle):.2f}")
        return coordinates_text(self.scene, self.points[0]) if self.points else ""

    def _places(self) -> Array:
        return self.scene.points[self.points]


def coordinates_text(scene: CloudScene, index: int) -> str:
    """Return the coordinates of a point for people."""
    x, y, z = (group_thousands(f"{v:.{_decimals(scene)}f}") for v in scene.points[index])
    return f"X {x}   Y {y}   Z {z}{THIN_SPACE}{scene.unit}"


def length_text(scene: CloudScene, length: float) -> str:
    """Return a length for people, to some 1 : 10 000 of the scene."""
    return f"{group_thousands(f'{length:.{_decimals(scene)}f}')}{THIN_SPACE}{scene.unit}"


def _decimals(scene: CloudScene) -> int:
    return max(0, min(9, 4 - math.floor(math.log10(scene.extent()))))
