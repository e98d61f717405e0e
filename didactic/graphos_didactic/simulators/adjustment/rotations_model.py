"""A photo that is turned above the ground: the parameters, and what the engine says about its rotation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal

import numpy as np

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.rotation import (
    FLIP,
    angle_between,
    matrix_from_opk,
    matrix_from_turns,
    matrix_from_vector,
    opk_from_matrix,
    quaternion_from_matrix,
    turn_axes,
    turns_from_matrix,
    vector_from_matrix,
)
from graphos_core.params import About, Params
from graphos_didactic.simulators.usual_controls import orbit_about, photo_about

WIDTH, HEIGHT, FOCAL = 1200, 900, 800.0
"""Format and principal distance of the camera, px."""
ABOVE = 2.4
"""Height of the projection centre above the ground, m."""
MARKS = np.array([[-1.1, 0.8, 0.0], [1.2, 0.9, 0.0], [1.0, -0.8, 0.0], [-1.2, -0.9, 0.0], [0.25, 0.3, 0.0]])
"""Marks on the ground, m."""
LESSON = "adjustment/rotations"


def _turn(label: str, symbol: str, high: float, axis: str, help_: str) -> About:
    return About(label=label, symbol=symbol, unit="°", low=-high, high=high, step=1, group="Turns", help=help_,
                 effect=f"Positive: right-handed about {axis}.", learn=LESSON)  # fmt: skip


def _true(label: str, symbol: str, high: float) -> About:
    return About(label=label, symbol=symbol, unit="°", low=-high, high=high, step=1, group="True orientation",
                 level="expert", help="The orientation in which the photo was really taken: the rings.",
                 effect="Larger: the rings lie elsewhere.", learn=LESSON)  # fmt: skip


class RotationsParams(Params):
    """Three turns of a photo whose frame is x right, y up, z backward; without turns it looks straight down."""

    omega: Annotated[float, _turn("Omega", r"\omega", 180, "x", "Turn about the x axis.")] = 25.0
    phi: Annotated[float, _turn("Phi", r"\varphi", 90, "y", "Turn about the y axis.")] = -20.0
    kappa: Annotated[float, _turn("Kappa", r"\kappa", 180, "z", "Turn about the z axis.")] = 35.0
    order: Annotated[
        Literal["xyz", "zyx"],
        About(
            label="Order of the turns",
            group="Turns",
            choices={"xyz": "ω, φ, κ", "zyx": "κ, φ, ω"},
            help="Each turn is about an axis that the turns before have already moved.",
            effect="Reversed: another orientation from the same three angles.",
            learn=LESSON,
        ),
    ] = "xyz"
    part: Annotated[
        float,
        About(label="Part of the way", symbol="t", unit="parts", low=0, high=1, step=0.02, group="Turns",
              help="How far the photo has come on the shortest way from level to here: the thin axes.",
              effect="Larger: nearer to the orientation.", learn=LESSON),
    ] = 0.5  # fmt: skip
    true_omega: Annotated[float, _true("True omega", r"\omega", 180)] = 8.0
    true_phi: Annotated[float, _true("True phi", r"\varphi", 90)] = 6.0
    true_kappa: Annotated[float, _true("True kappa", r"\kappa", 180)] = 15.0
    orbit: Annotated[float, orbit_about()] = -30.0
    photo: Annotated[bool, photo_about("Lay a photo on the ground.", "On: the camera sees it.")] = False


@dataclass(frozen=True, eq=False)
class TurnedPhoto:
    """The photo of a parameter sheet after some of its three turns."""

    params: RotationsParams
    turns: int = 3

    @property
    def camera(self) -> Camera:
        """The camera, without distortion."""
        values = np.array([FOCAL, (WIDTH - 1) / 2, (HEIGHT - 1) / 2])
        return Camera(model="pinhole", width=WIDTH, height=HEIGHT, values=values)

    @property
    def centre(self) -> Array:
        """Projection centre, float64 (3,), m."""
        return np.array([0.0, 0.0, ABOVE])

    @cached_property
    def angles(self) -> Array:
        """The angles in the order of the turns, float64 (3,), radians; 0 for turns not yet done."""
        p = self.params
        named = {"x": p.omega, "y": p.phi, "z": p.kappa}
        return np.radians([named[axis] if n < self.turns else 0.0 for n, axis in enumerate(p.order)])

    @cached_property
    def frame(self) -> Array:
        """``world_from_image``, float64 (3, 3): its columns are the photo's axes."""
        return matrix_from_turns(self.params.order, self.angles)

    @property
    def rotation(self) -> Array:
        """``cam_from_world``, float64 (3, 3)."""
        return FLIP @ self.frame.T

    @cached_property
    def axes(self) -> Array:
        """Axes about which each angle turns, one per row, float64 (3, 3)."""
        return turn_axes(self.params.order, self.angles)

    @property
    def independence(self) -> float:
        """Volume of the three axes: 1 where they are at right angles, 0 in gimbal lock."""
        return abs(float(np.linalg.det(self.axes)))

    @cached_property
    def opk(self) -> Array:
        """Omega, phi, kappa of this orientation, degrees, whatever the order of the sheet."""
        return np.round(np.degrees(opk_from_matrix(self.rotation)), 9) + 0.0

    @cached_property
    def one_turn(self) -> tuple[Array, float]:
        """Axis, float64 (3,), and angle, degrees, of the one turn that does it all; a zero axis without a turn."""
        vector = vector_from_matrix(self.frame)
        length = float(np.linalg.norm(vector))
        return (vector / length if length > 1e-9 else np.zeros(3)), float(np.degrees(length))

    @property
    def quaternion(self) -> Array:
        """Quaternion (w, x, y, z) of ``world_from_image``."""
        return quaternion_from_matrix(self.frame)

    @property
    def reversed_turn(self) -> float:
        """Angle, degrees, between this orientation and that of the reversed order."""
        other = matrix_from_turns(self.params.order[::-1], self.angles[::-1])
        return float(np.degrees(angle_between(self.frame, other)))

    @cached_property
    def true_rotation(self) -> Array:
        """``cam_from_world`` of the true orientation."""
        p = self.params
        return matrix_from_opk(*np.radians([p.true_omega, p.true_phi, p.true_kappa]).tolist())

    @property
    def error(self) -> float:
        """Angle of the turn from the true orientation to this one, degrees."""
        return float(np.degrees(angle_between(self.true_rotation, self.rotation)))

    def image(self, rotation: Array, points: Array) -> Array:
        """Return the images of points (n, 3) for an orientation, px; NaN behind the camera."""
        return pixel_from_ray(self.camera, (points - self.centre) @ rotation.T)

    def on_the_way(self, parts: Array) -> tuple[Array, Array]:
        """Return frames (n, 3, 3) and angles (n, 3), degrees, in the order of the sheet, on the shortest way."""
        axis, angle = self.one_turn
        frames = np.stack([matrix_from_vector(axis * np.radians(angle) * part) for part in parts])
        return frames, np.degrees([turns_from_matrix(self.params.order, frame) for frame in frames])


def with_frame(params: RotationsParams, frame: Array) -> dict[str, float]:
    """Return the values of omega, phi, kappa, degrees, that give ``world_from_image`` in the order of the sheet."""
    angles = np.degrees(turns_from_matrix(params.order, frame))
    named = dict(zip(params.order, angles.tolist(), strict=True))
    return {"omega": named["x"], "phi": named["y"], "kappa": named["z"]}
