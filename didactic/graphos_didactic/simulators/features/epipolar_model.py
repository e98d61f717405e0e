"""Two cameras and a point: what the engine says about them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.epipolar import (
    epipolar_curve,
    epipolar_lines,
    epipoles,
    fundamental_from_cameras,
    line_distances,
)
from graphos_core.geometry.rotation import look_at
from graphos_didactic.simulators.features.epipolar_params import (
    FAR,
    HEIGHT,
    NEAR,
    WALL_Y,
    WIDTH,
    EpipolarParams,
)

__all__ = ["FAR", "HEIGHT", "NEAR", "WALL_Y", "WIDTH", "EpipolarParams", "TwoCameras"]


@dataclass(frozen=True, eq=False)
class TwoCameras:
    """The cameras and the point of a parameter sheet."""

    params: EpipolarParams

    @cached_property
    def camera(self) -> Camera:
        """Both cameras are the same, without distortion."""
        values = np.array([self.params.focal_px, (WIDTH - 1) / 2, (HEIGHT - 1) / 2])
        return Camera(model="pinhole", width=WIDTH, height=HEIGHT, values=values)

    @cached_property
    def centres(self) -> Array:
        """Projection centres, float64 (2, 3), m."""
        p = self.params
        return np.array([[p.a_x, p.a_y, 0.0], [p.b_x, p.b_y, p.b_z]])

    @cached_property
    def rotations(self) -> Array:
        """``cam_from_world``, float64 (2, 3, 3)."""
        turns = np.radians([self.params.a_turn, self.params.b_turn])
        ahead = np.stack([np.sin(turns), np.cos(turns), np.zeros(2)], axis=1)
        return np.stack([look_at(c, c + d) for c, d in zip(self.centres, ahead, strict=True)])

    @property
    def point(self) -> Array:
        """The point, float64 (3,), m."""
        return np.array([self.params.p_x, self.params.p_y, self.params.p_z])

    @property
    def base(self) -> float:
        """Distance of the projection centres, m."""
        return float(np.linalg.norm(self.centres[1] - self.centres[0]))

    def image(self, which: int, points: Array) -> Array:
        """Return the images of points (n, 3) in photo 0 or 1, px; NaN behind the camera."""
        return pixel_from_ray(self.camera, (points - self.centres[which]) @ self.rotations[which].T)

    @cached_property
    def pixels(self) -> Array:
        """True images of the point in both photos, float64 (2, 2), px; NaN behind a camera."""
        return np.concatenate([self.image(i, self.point[None]) for i in (0, 1)])

    @cached_property
    def measured(self) -> Array:
        """Measured partner in photo B, float64 (2,), px: the true one with the error of the seed."""
        error = np.random.default_rng(self.params.seed).normal(size=2) * self.params.noise_px
        return self.pixels[1] + error

    @cached_property
    def fundamental(self) -> Array:
        """The engine's fundamental matrix, zeros without a base."""
        eyes = self.rotations, self.centres
        return fundamental_from_cameras(
            self.camera, eyes[0][0], eyes[1][0], self.camera, eyes[0][1], eyes[1][1]
        )

    @cached_property
    def epipoles(self) -> tuple[Array | None, Array | None]:
        """The engine's epipoles in both photos, px; None at infinity or without a base."""
        if not self.fundamental.any():
            return None, None
        found = [e[:2] / e[2] if abs(e[2]) > 1e-9 else None for e in epipoles(self.fundamental)]
        return found[0], found[1]

    @property
    def on_base_line(self) -> bool:
        """Whether the point lies on the base line, so that it has no epipolar line of its own."""
        epipole = self.epipoles[0]
        return epipole is not None and float(np.hypot(*(self.pixels[0] - epipole))) < 1.0

    def line_in_b(self, xy: Array) -> Array | None:
        """Return the engine's epipolar line (3,) in photo B of a point (2,) of photo A; None where there is none."""
        if not self.fundamental.any() or not np.isfinite(xy).all():
            return None
        line = epipolar_lines(self.fundamental, xy[None])[0]
        return line if np.isfinite(line).all() else None

    @cached_property
    def line(self) -> Array | None:
        """Epipolar line of the point in photo B; None where it is not defined."""
        return None if self.on_base_line else self.line_in_b(self.pixels[0])

    @cached_property
    def miss(self) -> float:
        """Distance of the measured partner from the epipolar line, px; NaN without one."""
        if self.line is None:
            return float("nan")
        return float(line_distances(self.fundamental, self.pixels[:1], self.measured[None])[1][0])

    def images_of_depths(self, depths: Array) -> Array:
        """Return the images in B, (n, 2) px, of the ray through the point's image in A, at depths in A, m."""
        eyes = self.rotations, self.centres
        return epipolar_curve(
            self.pixels[0], self.camera, eyes[0][0], eyes[1][0], self.camera, eyes[0][1], eyes[1][1], depths
        )

    @property
    def depth(self) -> float:
        """Depth of the point in camera A, m."""
        return float(self.rotations[0][2] @ (self.point - self.centres[0]))

    def on_ray(self, xy: Array, depth: float) -> Array:
        """Return the point, float64 (3,), at a depth in camera A on the ray of a pixel of photo A."""
        ray = ray_from_pixel(self.camera, np.asarray(xy, dtype=np.float64).reshape(1, 2))[0]
        return self.centres[0] + depth * ray @ self.rotations[0]
