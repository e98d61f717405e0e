"""Two cameras above a point: the parameters, and what the engine says about them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.intersection_precision import (
    IntersectionPrecision,
    intersection_angle,
    intersection_precision,
)
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.triangulation import triangulate
from graphos_core.params import About, Params

WIDTH, HEIGHT = 4000, 3000
"""Format of both cameras, px."""
DRAWS = 80
"""Repetitions of the noisy measurement."""
REACH = 6.0
"""Cameras stand at most this far to both sides of the point, m."""


class IntersectionParams(Params):
    """Two cameras above a point, in a section with X to the right and Z upwards; the point is at (0, 0)."""

    a_x: Annotated[
        float,
        About(
            label="Camera A, position",
            symbol="X_A",
            unit="m",
            low=-6,
            high=6,
            step=0.1,
            group="Cameras",
            help="Place of camera A along the ground.",
            effect="Away from camera B: longer base, smaller σ_Z.",
            learn="adjustment/intersection",
        ),
    ] = -1.5
    a_z: Annotated[
        float,
        About(
            label="Camera A, height",
            symbol="Z_A",
            unit="m",
            low=2,
            high=12,
            step=0.1,
            group="Cameras",
            help="Height of camera A above the point.",
            effect="Higher: larger σ_X and much larger σ_Z.",
            learn="adjustment/intersection",
        ),
    ] = 10.0
    b_x: Annotated[
        float,
        About(
            label="Camera B, position",
            symbol="X_B",
            unit="m",
            low=-6,
            high=6,
            step=0.1,
            group="Cameras",
            help="Place of camera B along the ground.",
            effect="Away from camera A: longer base, smaller σ_Z.",
            learn="adjustment/intersection",
        ),
    ] = 1.5
    b_z: Annotated[
        float,
        About(
            label="Camera B, height",
            symbol="Z_B",
            unit="m",
            low=2,
            high=12,
            step=0.1,
            group="Cameras",
            help="Height of camera B above the point.",
            effect="Higher: larger σ_X and much larger σ_Z.",
            learn="adjustment/intersection",
        ),
    ] = 10.0
    aim: Annotated[
        Literal["point", "down"],
        About(
            label="Cameras look",
            group="Cameras",
            choices={"point": "at the point", "down": "straight down"},
            help="Convergent axes, or the normal case with parallel axes.",
            effect="At the point: it stays in both photos however long the base is.",
        ),
    ] = "point"
    focal_px: Annotated[
        float,
        About(
            label="Principal distance",
            symbol="f",
            unit="px",
            low=1500,
            high=8000,
            step=100,
            group="Measurement",
            help="Principal distance of both cameras.",
            effect="Longer: smaller errors, smaller field of view.",
            learn="adjustment/intersection",
        ),
    ] = 3000.0
    sigma_px: Annotated[
        float,
        About(
            label="Image precision",
            symbol=r"\sigma",
            unit="px",
            low=0.05,
            high=2,
            step=0.05,
            group="Measurement",
            help="Standard deviation of a measured image coordinate.",
            effect="Larger: all errors grow with it.",
            learn="adjustment/intersection",
        ),
    ] = 0.5
    exaggeration: Annotated[
        int,
        About(
            label="Errors drawn",
            unit="times",
            low=10,
            high=1000,
            step=10,
            group="Drawing",
            level="student",
            help="How much larger than true the error is drawn in the section.",
            effect="Larger: bigger drawing; the numbers stay.",
        ),
    ] = 100
    seed: Annotated[
        int,
        About(
            label="Noise",
            symbol="seed",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Drawing",
            level="student",
            help="Seed of the simulated measuring errors.",
            effect="Another number: other errors, same size.",
        ),
    ] = 0
    photo: Annotated[
        bool,
        About(
            label="Show the photos",
            unit="",
            group="Drawing",
            level="student",
            help="Lay a photo on the ground and show what both cameras see.",
            effect="On: two photos appear.",
        ),
    ] = False


@dataclass(frozen=True, eq=False)
class Pair:
    """The two cameras of a parameter sheet, in an object frame with Y away from the reader of the section."""

    params: IntersectionParams

    @cached_property
    def camera(self) -> Camera:
        """Both cameras are the same."""
        values = np.array([self.params.focal_px, (WIDTH - 1) / 2, (HEIGHT - 1) / 2])
        return Camera(model="pinhole", width=WIDTH, height=HEIGHT, values=values)

    @cached_property
    def centres(self) -> Array:
        """Projection centres, float64 (2, 3), m."""
        p = self.params
        return np.array([[p.a_x, 0.0, p.a_z], [p.b_x, 0.0, p.b_z]])

    @cached_property
    def rotations(self) -> Array:
        """``cam_from_world`` of both, float64 (2, 3, 3)."""
        down = np.array([0.0, 0.0, -1.0])
        targets = self.centres + down if self.params.aim == "down" else np.zeros((2, 3))
        north = np.array([0.0, 1.0, 0.0])
        return np.stack([look_at(c, t, north) for c, t in zip(self.centres, targets, strict=True)])

    @cached_property
    def pixels(self) -> Array:
        """True image of the point in both photos, float64 (2, 2), px."""
        point = np.einsum("nij,nj->ni", self.rotations, -self.centres)
        return pixel_from_ray(self.camera, point)

    @property
    def in_photo(self) -> Array:
        """Whether the point lies in the format of each photo, bool (2,)."""
        return np.all((self.pixels >= -0.5) & (self.pixels <= (WIDTH - 0.5, HEIGHT - 0.5)), axis=1)

    @cached_property
    def precision(self) -> IntersectionPrecision:
        """The engine's covariance of the intersected point."""
        cameras = [self.camera, self.camera]
        return intersection_precision(
            cameras, list(self.rotations), list(self.centres), np.zeros(3), self.params.sigma_px
        )

    @cached_property
    def angle(self) -> float:
        """Intersection angle, radians."""
        return intersection_angle(list(self.centres), np.zeros(3))

    @property
    def base(self) -> float:
        """Distance of the projection centres, m."""
        return float(np.linalg.norm(self.centres[1] - self.centres[0]))

    @property
    def span(self) -> float:
        """Horizontal distance of the projection centres, m."""
        return abs(self.params.b_x - self.params.a_x)

    @property
    def height(self) -> float:
        """Mean height of the cameras above the point, m."""
        return float(self.centres[:, 2].mean())

    @cached_property
    def estimates(self) -> Array:
        """Points intersected from noisy measurements, float64 (n, 3), m; none where the depth is not determined."""
        if not self.precision.determined:
            return np.empty((0, 3))
        noise = np.random.default_rng(self.params.seed).normal(size=(DRAWS, 2, 2)) * self.params.sigma_px
        rays = ray_from_pixel(self.camera, (self.pixels + noise).reshape(-1, 2))[:, :2]
        found = triangulate(
            np.arange(0, 2 * DRAWS + 1, 2), np.tile([0, 1], DRAWS), rays, np.full(2, self.params.focal_px),
            self.rotations, self.centres,
        )  # fmt: skip
        return found.points[found.ok]


def with_base(params: IntersectionParams, base: float) -> IntersectionParams:
    """Return the sheet with both cameras at `base` from each other along X, their middle unchanged, in limits."""
    middle = (params.a_x + params.b_x) / 2
    sign = -1.0 if params.a_x > params.b_x else 1.0
    half = min(base / 2, REACH - abs(middle))
    return params.replace(a_x=middle - sign * half, b_x=middle + sign * half)


def sigmas_of_bases(params: IntersectionParams, bases: Array) -> Array:
    """Return σ_X and σ_Z (n, 2), m, for every horizontal base, by the engine's covariance.

    The cameras keep their heights and stand to both sides of the point; bases may exceed the limits of the sheet.
    """
    normal = Pair(params).camera
    down = np.array([0.0, 0.0, -1.0])
    north = np.array([0.0, 1.0, 0.0])
    curve = np.empty((len(bases), 2))
    for i, base in enumerate(bases):
        centres = np.array([[-base / 2, 0.0, params.a_z], [base / 2, 0.0, params.b_z]])
        targets = centres + down if params.aim == "down" else np.zeros((2, 3))
        rotations = [look_at(c, t, north) for c, t in zip(centres, targets, strict=True)]
        found = intersection_precision(
            [normal, normal], rotations, list(centres), np.zeros(3), params.sigma_px
        )
        curve[i] = found.sigma_xyz[[0, 2]]
    return curve
