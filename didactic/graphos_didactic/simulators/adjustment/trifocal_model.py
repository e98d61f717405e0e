"""Three cameras and a point: what two photos tell about the third."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.dlt import compose_projection
from graphos_core.geometry.eight_point import longuet_higgins
from graphos_core.geometry.epipolar import essential_from_relative, line_transfer, relative_orientation
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.trifocal import (
    fundamentals,
    linear_trifocal,
    transfer_points,
    trifocal_from_projections,
)
from graphos_core.params import About, Params
from graphos_didactic.simulators.usual_controls import noise_about, orbit_about, photo_about, seed_about

WIDTH, HEIGHT, FOCAL = 1200, 900, 1000.0
"""Format and principal distance of the three cameras, px."""
WALL_Y = 6.0
"""A wall stands here, m."""
HEIGHTS = np.linspace(-1.6, 1.6, 65)
"""Heights of the point at which the errors are shown, m."""
DRAWS = 40
"""Repetitions of the measurement for the curve."""
LESSON = "adjustment/trifocal"


def _camera(name: str, axis: str, low: float, high: float, effect: str) -> About:
    return About(label=f"Camera {name}, {axis}", symbol=rf"{axis.upper()}_{name}", unit="m", low=low, high=high,
                 step=0.1, group="Cameras", level="expert", help=f"Place of camera {name}.", effect=effect,
                 learn=LESSON)  # fmt: skip


def _point(axis: str, low: float, high: float, effect: str) -> About:
    return About(label=f"Point, {axis}", symbol=rf"{axis.upper()}_P", unit="m", low=low, high=high, step=0.1,
                 group="Point", help="Place of the point P.", effect=effect, learn=LESSON)  # fmt: skip


def _guess(axis: str, high: float) -> About:
    return About(label=f"Your mark, {axis}", unit="px", low=0, high=high, step=1, group="Point", level="expert",
                 help="Where you expect P in photo C.", effect="Larger: to the right or downwards.")  # fmt: skip


class TrifocalParams(Params):
    """Three cameras that look at a point, in metres: x to the right, y forward, z upwards; A and B at height 0."""

    a_x: Annotated[float, _camera("A", "x", -5, 5, "Higher: to the right.")] = -2.5
    a_y: Annotated[float, _camera("A", "y", -6, 2, "Higher: nearer.")] = -4.0
    b_x: Annotated[float, _camera("B", "x", -5, 5, "Higher: to the right.")] = 0.0
    b_y: Annotated[float, _camera("B", "y", -6, 2, "Higher: nearer.")] = -5.2
    c_x: Annotated[float, _camera("C", "x", -5, 5, "Higher: to the right.")] = 2.6
    c_y: Annotated[float, _camera("C", "y", -6, 2, "Higher: nearer.")] = -3.6
    c_z: Annotated[
        float,
        About(label="Camera C, height", symbol="Z_C", unit="m", low=-2, high=2, step=0.1, group="Cameras",
              help="Height of camera C over the two others.", effect="Away from zero: the trifocal plane tilts.",
              learn=LESSON),
    ] = 0.0  # fmt: skip
    p_x: Annotated[float, _point("x", -2, 2, "Higher: to the right.")] = 0.3
    p_y: Annotated[float, _point("y", -1, 5, "Higher: farther away.")] = 1.0
    p_z: Annotated[
        float, _point("z", -1.6, 1.6, "Towards the trifocal plane: its epipolar lines fall together.")
    ] = 0.9
    source: Annotated[
        Literal["orientation", "points"],
        About(label="Tensor and lines from", group="Measurement",
              choices={"orientation": "orientation", "points": "other points"},
              help="From known orientations, or from points measured in all three photos.",
              effect="From points: their errors come in too.", learn=LESSON),
    ] = "orientation"  # fmt: skip
    count: Annotated[
        int,
        About(label="Other points", symbol="n", unit="points", low=8, high=60, step=1, group="Measurement",
              help="Points in all three photos from which the tensor is estimated.", effect="More: a better tensor.",
              learn=LESSON),
    ] = 20  # fmt: skip
    sigma_px: Annotated[float, noise_about(5, LESSON)] = 1.0
    seed: Annotated[int, seed_about()] = 2
    guess_x: Annotated[float, _guess("x", WIDTH)] = 600.0
    guess_y: Annotated[float, _guess("y", HEIGHT)] = 450.0
    guessing: Annotated[
        bool,
        About(label="Your mark in photo C", unit="", group="Point", level="expert",
              help="A mark to drag to where you expect P in photo C.", effect="On: the mark appears."),
    ] = False  # fmt: skip
    orbit: Annotated[float, orbit_about()] = -20.0
    photo: Annotated[bool, photo_about("Put a photo on the wall behind the point.")] = False


@dataclass(frozen=True, eq=False)
class ThreePhotos:
    """The cameras, the point and its transfer of a parameter sheet; all in rays (x/z, y/z, 1)."""

    params: TrifocalParams

    @property
    def camera(self) -> Camera:
        """All three are the same, without distortion."""
        values = np.array([FOCAL, (WIDTH - 1) / 2, (HEIGHT - 1) / 2])
        return Camera(model="pinhole", width=WIDTH, height=HEIGHT, values=values)

    @cached_property
    def centres(self) -> Array:
        """Projection centres, float64 (3, 3), m."""
        p = self.params
        return np.array([[p.a_x, p.a_y, 0.0], [p.b_x, p.b_y, 0.0], [p.c_x, p.c_y, p.c_z]])

    @cached_property
    def rotations(self) -> Array:
        """``cam_from_world``, float64 (3, 3, 3): all look at one place."""
        return np.stack([look_at(c, np.array([0.0, 1.5, 0.0])) for c in self.centres])

    @property
    def point(self) -> Array:
        """The point, float64 (3,), m."""
        return np.array([self.params.p_x, self.params.p_y, self.params.p_z])

    def images(self, points: Array) -> Array:
        """Return the images (3, n, 2) of points (n, 3) in the three photos, px; NaN behind a camera."""
        return np.stack([
            pixel_from_ray(self.camera, (points - c) @ r.T)
            for c, r in zip(self.centres, self.rotations, strict=True)
        ])  # fmt: skip

    @cached_property
    def pixels(self) -> Array:
        """True images of the point, float64 (3, 2), px."""
        return self.images(self.point[None])[:, 0]

    @cached_property
    def measured(self) -> Array:
        """Measured images of the point in A and B, float64 (2, 2), px."""
        noise = np.random.default_rng(self.params.seed).normal(size=(2, 2))
        return self.pixels[:2] + self.params.sigma_px * noise

    @cached_property
    def others(self) -> Array:
        """Measured rays of the other points, float64 (3, n, 3)."""
        draw = np.random.default_rng(self.params.seed + 1)
        points = draw.uniform([-1.8, 0.0, -1.3], [1.8, 5.0, 1.3], (self.params.count, 3))
        noise = draw.normal(size=(3, self.params.count, 2)) * self.params.sigma_px
        return np.stack([ray_from_pixel(self.camera, side) for side in self.images(points) + noise])

    @cached_property
    def tensor(self) -> Array:
        """The trifocal tensor, float64 (3, 3, 3), of norm 1; zeros where it is not determined."""
        if self.params.source == "points":
            return linear_trifocal(*self.others[..., :2]).tensor
        projections = [
            compose_projection(np.eye(3), r, c) for r, c in zip(self.rotations, self.centres, strict=True)
        ]
        return trifocal_from_projections(*projections)

    @cached_property
    def into_c(self) -> Array:
        """Essential matrices from a to c and from b to c, float64 (2, 3, 3); zeros without a base."""
        if self.params.source == "points":
            return np.stack([longuet_higgins(self.others[i], self.others[2]).matrix for i in (0, 1)])
        return np.stack([
            essential_from_relative(*relative_orientation(
                self.rotations[i], self.centres[i], self.rotations[2], self.centres[2]))
            for i in (0, 1)
        ])  # fmt: skip

    @cached_property
    def into_b(self) -> Array:
        """Essential matrix from a to b, float64 (3, 3), from the tensor."""
        return fundamentals(self.tensor)[0] if self.tensor.any() else np.zeros((3, 3))

    def transferred(self, xy_a: Array, xy_b: Array) -> tuple[Array, Array]:
        """Return where points measured in A and B lie in C, px, (n, 2): by two epipolar lines and by the tensor."""
        a, b = ray_from_pixel(self.camera, xy_a), ray_from_pixel(self.camera, xy_b)
        by_lines = line_transfer(self.into_c[0], self.into_c[1], a, b)
        by_tensor = transfer_points(self.tensor, a, b)
        return self._seen(by_lines), self._seen(by_tensor)

    def _seen(self, rays: Array) -> Array:
        """Return the pixels (n, 2) of homogeneous rays, whatever their sign; NaN for none."""
        ahead = rays * np.sign(rays[:, 2:])
        small = np.abs(ahead).max(axis=1) < 1e-13
        found = pixel_from_ray(self.camera, ahead)
        found[small] = np.nan
        return found

    @cached_property
    def found(self) -> tuple[Array, Array]:
        """The point in C by lines and by the tensor, float64 (2,) each, px."""
        by_lines, by_tensor = self.transferred(self.measured[:1], self.measured[1:])
        return by_lines[0], by_tensor[0]

    @property
    def errors(self) -> tuple[float, float]:
        """Distances of the transferred from the true image in C, px: by lines and by the tensor."""
        by_lines, by_tensor = (float(np.hypot(*(xy - self.pixels[2]))) for xy in self.found)
        return by_lines, by_tensor

    @cached_property
    def plane(self) -> Array | None:
        """Trifocal plane as unit normal and offset, ``n · X = d``, float64 (4,); None for centres on a line."""
        normal = np.cross(self.centres[1] - self.centres[0], self.centres[2] - self.centres[0])
        length = float(np.linalg.norm(normal))
        if length < 1e-6:
            return None
        normal = normal / length * (1.0 if normal[2] >= 0 else -1.0)
        return np.append(normal, normal @ self.centres[0])

    @property
    def above_plane(self) -> float:
        """Distance of the point from the trifocal plane, m; NaN without one."""
        return float(self.plane[:3] @ self.point - self.plane[3]) if self.plane is not None else float("nan")

    @property
    def height_in_plane(self) -> float:
        """Height at which the point would lie in the trifocal plane, m; NaN for a vertical one or none."""
        if self.plane is None or abs(self.plane[2]) < 1e-3:
            return float("nan")
        return float((self.plane[3] - self.plane[:2] @ self.point[:2]) / self.plane[2])

    def errors_of_heights(self) -> Array:
        """Return median errors in C, px, (n, 2) by lines and by the tensor, of repeated measurements at `HEIGHTS`."""
        points = np.tile(self.point, (len(HEIGHTS), 1))
        points[:, 2] = HEIGHTS
        images = self.images(points)
        noise = (
            np.random.default_rng(self.params.seed + 2).normal(size=(2, DRAWS, 1, 2)) * self.params.sigma_px
        )
        a, b = ((images[i] + noise[i]).reshape(-1, 2) for i in (0, 1))
        truth = np.tile(images[2], (DRAWS, 1))
        gaps = [np.hypot(*(xy - truth).T).reshape(DRAWS, -1) for xy in self.transferred(a, b)]
        return np.stack([np.median(np.nan_to_num(gap, nan=1e6), axis=0) for gap in gaps], axis=1)
