"""Measuring in a cloud by picking points: coordinates, distance, angle. Knows no Qt widgets."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.number_format import THIN_SPACE, format_value, group_thousands
from graphos_core.quality.measure import Measured, PickedPoint, angle, distance, point_in_cloud
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

    def place(self, index: int) -> PickedPoint:
        """Return a point of the cloud with its standard deviations, or the reason why there are none."""
        xyz, sigmas = self.scene.points[index], self.scene.sigmas
        if sigmas is None or not (np.isfinite(sigmas[index]).all() and (sigmas[index] > 0).all()):
            return point_in_cloud(xyz, self.scene.unit)
        return PickedPoint(xyz=xyz, sigma=sigmas[index], unit=self.scene.unit)

    def distance(self) -> Measured | None:
        """Return the distance of two points in the cloud's unit; None for another number of points."""
        return distance(*map(self.place, self.points)) if len(self.points) == 2 else None

    def angle(self) -> Measured | None:
        """Return the angle at the second of three points, degrees; None for another number of points."""
        return angle(*map(self.place, self.points)) if len(self.points) == 3 else None

    def text(self) -> str:
        """Return what is measured, for people; empty without points."""
        length, corner = self.distance(), self.angle()
        if length is not None:
            shown = length_text(self.scene, length.value)
            if length.sigma is not None:
                shown = format_value(length.value, length.sigma, length.unit)
            return tr("distance {d}", d=shown)
        if corner is not None:
            shown = (
                f"{corner.value:.2f}" if corner.sigma is None else format_value(corner.value, corner.sigma)
            )
            return tr("angle at the second point {a}°", a=shown)
        return self.coordinates(self.points[0]) if self.points else ""

    def reason(self) -> str:
        """Return why what is measured has no standard deviation; empty where it has one, or nothing is measured."""
        measured = self.distance() or self.angle()
        if measured is not None:
            return tr(measured.reason)
        return tr(self.place(self.points[0]).reason) if self.points else ""

    def coordinates(self, index: int) -> str:
        """Return the coordinates of a point for people, with standard deviations where they are known."""
        sigma = self.place(index).sigma
        if sigma is None:
            return coordinates_text(self.scene, index)
        shown = [format_value(v, s) for v, s in zip(self.scene.points[index], sigma, strict=True)]
        return f"X {shown[0]}   Y {shown[1]}   Z {shown[2]}{THIN_SPACE}{self.scene.unit}"


def coordinates_text(scene: CloudScene, index: int) -> str:
    """Return the coordinates of a point for people."""
    x, y, z = (group_thousands(f"{v:.{_decimals(scene)}f}") for v in scene.points[index])
    return f"X {x}   Y {y}   Z {z}{THIN_SPACE}{scene.unit}"


def length_text(scene: CloudScene, length: float) -> str:
    """Return a length for people, to some 1 : 10 000 of the scene."""
    return f"{group_thousands(f'{length:.{_decimals(scene)}f}')}{THIN_SPACE}{scene.unit}"


def _decimals(scene: CloudScene) -> int:
    return max(0, min(9, 4 - math.floor(math.log10(scene.extent()))))
