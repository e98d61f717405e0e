"""A photo of a control field: the parameters, and what the engine finds from points and pixels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Annotated, Literal

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.dlt import (
    Decomposed,
    DirectLinear,
    decompose_projection,
    direct_linear_transformation,
)
from graphos_core.geometry.resection import Resection, space_resection
from graphos_core.geometry.rotation import angle_between, look_at
from graphos_core.params import About, Params
from graphos_didactic.simulators.folded_wall import NEAR, FoldedWall
from graphos_didactic.simulators.usual_controls import noise_about, orbit_about, photo_about, seed_about

WIDTH, HEIGHT = 1200, 900
"""Format of the camera, px."""
X0, Y0 = (WIDTH - 1) / 2 + 24.0, (HEIGHT - 1) / 2 - 16.0
"""Principal point, px: not the middle of the format, as in any real camera."""
FOLDS = np.array([0.0, 0.1, 0.2, 0.35, 0.6, 1.0, 2.0, 4.0])
"""Depths of the control at which the errors are shown, m."""
LESSON = "adjustment/collinearity"


def _place(label: str, symbol: str, low: float, high: float, effect: str) -> About:
    return About(label=label, symbol=symbol, unit="m", low=low, high=high, step=0.1, group="Camera",
                 help="Projection centre: where the photo was taken.", effect=effect, learn=LESSON)  # fmt: skip


def _off(label: str, effect: str) -> About:
    return About(label=label, unit="px", low=-300, high=300, step=1, group="Measurement", level="expert",
                 help="Mistake of the measured point 1.", effect=effect, learn=LESSON)  # fmt: skip


class CollinearityParams(Params):
    """A camera before a folded wall with control points; x to the right, y forward, z upwards, m."""

    x: Annotated[float, _place("Projection centre, X", "X_0", -4, 4, "Higher: the camera moves right.")] = 1.6
    y: Annotated[float, _place("Projection centre, Y", "Y_0", -4, 3, "Higher: nearer to the wall.")] = -1.0
    z: Annotated[float, _place("Projection centre, Z", "Z_0", -2, 3, "Higher: the camera moves up.")] = 1.0
    aim: Annotated[
        Literal["object", "ahead"],
        About(label="Camera looks", group="Camera", choices={"object": "at the wall", "ahead": "straight ahead"},
              help="At the middle of the wall, or level along Y: then R only exchanges axes.",
              effect="At the wall: the points stay in the photo."),
    ] = "object"  # fmt: skip
    focal_px: Annotated[
        float,
        About(label="Principal distance", symbol="f", unit="px", low=700, high=2000, step=50, group="Camera",
              help="Distance of the projection centre from the image plane.",
              effect="Longer: larger image of the object.", learn=LESSON),
    ] = 1350.0  # fmt: skip
    fold: Annotated[
        float,
        About(label="Depth of the control", symbol="h", unit="m", low=0, high=4, step=0.05, group="Control",
              help="How far the wall with the control points is folded.",
              effect="Towards zero: coplanar control, the eleven parameters are not determined.", learn="adjustment/dlt"),
    ] = 2.0  # fmt: skip
    count: Annotated[
        int,
        About(label="Control points", symbol="n", unit="points", low=6, high=40, step=1, group="Control",
              help="Number of points with known coordinates.", effect="More: smaller errors, residuals that tell something.",
              learn="adjustment/dlt"),
    ] = 14  # fmt: skip
    sigma_px: Annotated[float, noise_about(4, LESSON)] = 0.8
    off_x: Annotated[float, _off("Point 1 moved in x", "Higher: to the right.")] = 0.0
    off_y: Annotated[float, _off("Point 1 moved in y", "Higher: downwards.")] = 0.0
    exaggeration: Annotated[
        int,
        About(label="Residuals drawn", unit="times", low=1, high=200, step=5, group="Drawing",
              help="How much longer than true residuals are drawn in the photo.",
              effect="Larger: longer lines; the numbers stay."),
    ] = 40  # fmt: skip
    seed: Annotated[int, seed_about("Seed of the points and of the measuring errors.")] = 5
    orbit: Annotated[float, orbit_about()] = -35.0
    photo: Annotated[bool, photo_about("Put a photo on the folded wall.")] = False


@dataclass(frozen=True, eq=False)
class ControlPhoto:
    """The photo of a parameter sheet."""

    params: CollinearityParams

    @property
    def camera(self) -> Camera:
        """The camera, without distortion."""
        return Camera(
            model="pinhole", width=WIDTH, height=HEIGHT, values=np.array([self.params.focal_px, X0, Y0])
        )

    @property
    def centre(self) -> Array:
        """Projection centre, float64 (3,), m."""
        return np.array([self.params.x, self.params.y, self.params.z])

    @cached_property
    def rotation(self) -> Array:
        """``cam_from_world``, float64 (3, 3)."""
        middle = np.array([0.0, NEAR + self.params.fold / 2, 0.0])
        return look_at(self.centre, middle if self.params.aim == "object" else self.centre + np.eye(3)[1])

    @property
    def wall(self) -> FoldedWall:
        """The object."""
        return FoldedWall(self.params.fold)

    @cached_property
    def points(self) -> Array:
        """Control points, float64 (n, 3), m."""
        return self.wall.points(self.params.count, self.params.seed)

    @cached_property
    def in_camera(self) -> Array:
        """Control points in the camera frame, ``R (X − C)``, float64 (n, 3), m."""
        return (self.points - self.centre) @ self.rotation.T

    @cached_property
    def true_pixels(self) -> Array:
        """True images, float64 (n, 2), px; NaN behind the camera."""
        return pixel_from_ray(self.camera, self.in_camera)

    @cached_property
    def pixels(self) -> Array:
        """Measured images, float64 (n, 2), px."""
        noise = np.random.default_rng(self.params.seed + 1).normal(size=self.true_pixels.shape)
        measured = self.true_pixels + self.params.sigma_px * noise
        measured[0] += (self.params.off_x, self.params.off_y)
        return measured

    @cached_property
    def used(self) -> Array:
        """Points that the format holds, bool (n,)."""
        return np.asarray(
            np.all((self.pixels >= -0.5) & (self.pixels <= (WIDTH - 0.5, HEIGHT - 0.5)), axis=1)
        )

    @cached_property
    def linear(self) -> DirectLinear:
        """The engine's direct linear transformation."""
        return direct_linear_transformation(self.points[self.used], self.pixels[self.used])

    @cached_property
    def decomposed(self) -> Decomposed | None:
        """Interior and exterior orientation from the eleven parameters; None where there are none."""
        if not self.linear:
            return None
        try:
            return decompose_projection(self.linear.matrix)
        except ValueError:
            return None

    @cached_property
    def resection(self) -> Resection:
        """The engine's space resection with the known interior orientation."""
        rays = ray_from_pixel(self.camera, self.pixels[self.used])[:, :2]
        threshold = (1.0 + 3.0 * self.params.sigma_px) / self.params.focal_px
        return space_resection(self.points[self.used], rays, threshold, seed=self.params.seed)

    @property
    def centre_errors(self) -> tuple[float, float]:
        """Distances of the projection centres from the true one, m: by DLT and by resection; NaN where none."""
        found = self.decomposed.centre if self.decomposed else np.full(3, np.nan)
        other = self.resection.centre if self.resection else np.full(3, np.nan)
        return float(np.linalg.norm(found - self.centre)), float(np.linalg.norm(other - self.centre))

    @property
    def turn_error(self) -> float:
        """Angle between the DLT's rotation and the true one, degrees."""
        return (
            float(np.degrees(angle_between(self.rotation, self.decomposed.rotation)))
            if self.decomposed
            else float("nan")
        )


@lru_cache(maxsize=32)
def _errors_of_folds(params: CollinearityParams) -> Array:
    return np.array([ControlPhoto(params.replace(fold=float(fold))).centre_errors for fold in FOLDS])


def errors_of_folds(params: CollinearityParams) -> Array:
    """Return the errors of the projection centre, m, (n, 2): by DLT and by resection, at every `FOLDS`."""
    return _errors_of_folds(params.replace(fold=0.0, orbit=0.0, photo=False, exaggeration=1))
