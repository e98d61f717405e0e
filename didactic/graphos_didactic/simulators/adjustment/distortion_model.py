"""Lens distortion of a parameter sheet: cameras, grid, profiles, and the lens that is really there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.cameras.chain import without_distortion
from graphos_core.cameras.model import CameraModel, camera_model
from graphos_core.cameras.profile import (
    FormatGrid,
    Profile,
    balanced_profile,
    decentring_profile,
    distortion_grid,
    half_diagonal,
    largest_effects,
    radial_profile,
)
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_didactic.simulators.adjustment.distortion_params import BASE_PX, HEIGHT, WIDTH, DistortionParams

COLUMNS, ROWS = 13, 10
"""Lines of the grid."""
GROUPS = ("interior", "radial", "decentring", "affinity")
"""Groups of terms in the order in which the steps add them."""
MIDDLE = np.array([(WIDTH - 1) / 2, (HEIGHT - 1) / 2])
"""Principal point, px."""


CORNER = half_diagonal(Camera(model="pinhole", width=WIDTH, height=HEIGHT, values=np.zeros(3)))
"""Radius of the corner of the format, px."""
RADII = np.linspace(0.0, CORNER, 61)


@dataclass(frozen=True, eq=False)
class Lens:
    """A lens of a parameter sheet; `groups` of its terms are used, the others are zero."""

    params: DistortionParams
    groups: int = len(GROUPS)

    @property
    def model(self) -> CameraModel:
        """Its camera model."""
        return camera_model(self.params.model)

    @cached_property
    def camera(self) -> Camera:
        """The camera with all groups of terms that are used."""
        p, used = self.params, GROUPS[: self.groups]
        given = {"focal_px": p.focal_px, "x0": MIDDLE[0], "y0": MIDDLE[1], "base_px": BASE_PX}
        values = []
        for parameter in self.model.parameters:
            group = {"centre": "decentring", "polynomial": "radial"}.get(parameter.group, parameter.group)
            value = given.get(parameter.name, getattr(p, parameter.name, 0.0))
            if parameter.group == "polynomial":
                value = p.amount_px if parameter.name == self.term else 0.0
            values.append(value if parameter.name in given or group in used else 0.0)
        return Camera(model=p.model, width=WIDTH, height=HEIGHT, values=np.array(values))

    @property
    def term(self) -> str:
        """Name of the polynomial term that is used; empty where the model has none."""
        names = [x.name for x in self.model.parameters if x.group == "polynomial"]
        return names[(self.params.term - 1) % len(names)] if names else ""

    @property
    def plain(self) -> Camera:
        """The same camera without distortion."""
        return without_distortion(self.camera)

    @cached_property
    def truth(self) -> Camera:
        """The lens that is really there: central perspective with four coefficients."""
        p = self.params
        model = camera_model("complete")
        given = {"focal_px": p.focal_px, "x0": MIDDLE[0], "y0": MIDDLE[1], "k1": p.true_k1, "k2": p.true_k2,
                 "p1": p.true_p1, "p2": p.true_p2}  # fmt: skip
        values = np.array([given.get(name, 0.0) for name in model.names])
        return Camera(model="complete", width=WIDTH, height=HEIGHT, values=values)

    @cached_property
    def grid(self) -> FormatGrid:
        """A grid over the format without and with distortion."""
        return grid_of(self.camera)

    @property
    def times(self) -> int:
        """How much larger than true the grid is bent; a fish-eye's own projection bends it enough."""
        return 1 if self.model.wide else self.params.exaggeration

    @cached_property
    def true_grid(self) -> FormatGrid:
        """The same grid by the lens that is really there."""
        return distortion_grid(self.truth, (COLUMNS, ROWS))

    @cached_property
    def off_px(self) -> Array:
        """Distances of the grid from that of the true lens, px, finite ones only."""
        gap = np.hypot(*np.moveaxis(self.grid.measured_px - self.true_grid.measured_px, 2, 0))
        return np.asarray(gap[np.isfinite(gap)])

    @property
    def rms_px(self) -> float:
        """Root mean square of those distances; NaN for a projection that is not central, with which none compares."""
        return float("nan") if self.model.wide else float(np.sqrt((self.off_px**2).mean()))

    @cached_property
    def gaussian(self) -> Profile:
        """Radial profile with f as it is."""
        return radial_profile(self.camera, radius_px=RADII)

    @cached_property
    def balanced(self) -> Profile:
        """Radial profile that is zero at a chosen radius."""
        return balanced_profile(self.camera, zero_px=self.params.zero_px, radius_px=RADII)

    @cached_property
    def decentring(self) -> Profile:
        """Tangential profile."""
        return decentring_profile(self.camera, radius_px=RADII)

    @property
    def effects(self) -> dict[str, float]:
        """Largest displacement over the format by each term, px, terms that are zero left out."""
        found = largest_effects(self.camera, self.camera.values)
        names = [x.name for x in self.model.parameters if x.group != "interior" and x.default != "constant"]
        return {name: found[name] for name in names if found[name] > 1e-9}

    def with_value(self, name: str, value: float) -> Camera:
        """Return the camera with another value of one parameter."""
        values = np.array(self.camera.values)
        values[self.model.index(name)] = value
        return replace(self.camera, values=values)

    def wished(self, name: str, measure: Callable[[Camera], float], goal: float) -> float:
        """Return the value of a parameter for which a measure of the camera reaches a goal.

        One step of Newton's method, exact where the measure is linear in the parameter.
        """
        value, step = float(self.camera.values[self.model.index(name)]), 1e-3
        here = measure(self.camera)
        slope = (measure(self.with_value(name, value + step)) - here) / step
        return value + (goal - here) / slope if abs(slope) > 1e-9 else value

    def image_radius(self, camera: Camera, angles: Array) -> Array:
        """Return the distance from the principal point, px, of rays at angles off the axis, towards the right."""
        rays = np.stack([np.sin(angles), np.zeros_like(angles), np.cos(angles)], axis=1)
        return pixel_from_ray(camera, rays)[:, 0] - MIDDLE[0]


def radial_at(camera: Camera, radius: float) -> float:
    """Return the Gaussian radial displacement at a radius, px."""
    return float(radial_profile(camera, radius_px=np.array([radius])).displacement_px[0])


def grid_of(camera: Camera) -> FormatGrid:
    """Return a grid of straight lines over the format and where the camera images their rays.

    For central perspective the grid without distortion; for other projections that of a pinhole camera with the same f.
    """
    if not camera_model(camera.model).wide:
        return distortion_grid(camera, (COLUMNS, ROWS))
    straight = Camera(model="pinhole", width=camera.width, height=camera.height, values=camera.values[:3])
    ideal = distortion_grid(straight, (COLUMNS, ROWS)).ideal_px
    seen = pixel_from_ray(camera, ray_from_pixel(straight, ideal.reshape(-1, 2)))
    return FormatGrid(ideal, seen.reshape(ideal.shape))
