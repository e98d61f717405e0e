"""Two photos of a folded wall: the points, the relative orientations that the engine finds, and their errors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.eight_point import (
    EightPoint,
    coplanarity,
    decompose_essential,
    longuet_higgins,
)
from graphos_core.geometry.epipolar import (
    epipolar_lines,
    essential_from_relative,
    fundamental_from_essential,
    line_distances,
)
from graphos_core.geometry.epipolar import relative_orientation as relative_of_exterior
from graphos_core.geometry.relative_orientation import depths, relative_orientation
from graphos_core.geometry.rotation import angle_between, look_at
from graphos_didactic.simulators.adjustment.coplanarity_params import CoplanarityParams
from graphos_didactic.simulators.folded_wall import FoldedWall

WIDTH, HEIGHT, FOCAL = 1200, 900, 1250.0
"""Format and principal distance of both cameras, px."""
FOLDS = np.array([0.0, 0.2, 0.5, 1.1, 2.2, 4.0])
"""Depths of the object at which the errors are shown, m."""

Relative = tuple[Array, Array]
"""R (3, 3) and t (3,) of length 1, ``b_from_a``."""


@dataclass(frozen=True, eq=False)
class TwoPhotos:
    """Both photos of a parameter sheet."""

    params: CoplanarityParams

    @property
    def camera(self) -> Camera:
        """Both cameras are the same, without distortion."""
        values = np.array([FOCAL, (WIDTH - 1) / 2, (HEIGHT - 1) / 2])
        return Camera(model="pinhole", width=WIDTH, height=HEIGHT, values=values)

    @property
    def centres(self) -> Array:
        """Projection centres, float64 (2, 3), m."""
        p = self.params
        return np.array([[0.0, 0.0, 0.0], [p.base_x, p.base_y, p.base_z]])

    @cached_property
    def rotations(self) -> Array:
        """``cam_from_world``, float64 (2, 3, 3)."""
        turn, tilt = np.radians([self.params.turn, self.params.tilt])
        ahead = np.array([np.sin(turn) * np.cos(tilt), np.cos(turn) * np.cos(tilt), np.sin(tilt)])
        return np.stack([look_at(self.centres[0], np.array([0.0, 1, 0])), look_at(self.centres[1], self.centres[1] + ahead)])  # fmt: skip

    @property
    def wall(self) -> FoldedWall:
        """The object."""
        return FoldedWall(self.params.fold)

    @cached_property
    def points(self) -> Array:
        """Points on the wall, float64 (n, 3), m; the first is near its middle."""
        return self.wall.points(self.params.count, self.params.seed)

    @cached_property
    def true_pixels(self) -> Array:
        """True images, float64 (2, n, 2), px; NaN behind a camera."""
        seen = [(self.points - c) @ r.T for c, r in zip(self.centres, self.rotations, strict=True)]
        return np.stack([pixel_from_ray(self.camera, side) for side in seen])

    @cached_property
    def pixels(self) -> Array:
        """Measured images, float64 (2, n, 2), px."""
        noise = np.random.default_rng(self.params.seed + 1).normal(size=self.true_pixels.shape)
        measured = self.true_pixels + self.params.sigma_px * noise
        measured[1, 0] += (self.params.off_x, self.params.off_y)
        return measured

    @cached_property
    def used(self) -> Array:
        """Points that both formats hold, bool (n,)."""
        inside = (self.pixels >= -0.5) & (self.pixels <= (WIDTH - 0.5, HEIGHT - 0.5))
        return np.asarray(inside.all(axis=(0, 2)))

    @cached_property
    def rays(self) -> Array:
        """Measured rays (x/z, y/z, 1), float64 (2, m, 3), of the points that both photos hold."""
        return np.stack([ray_from_pixel(self.camera, side[self.used]) for side in self.pixels])

    @cached_property
    def truth(self) -> Relative:
        """True relative orientation; t is zero without a base."""
        rotation, base = relative_of_exterior(
            self.rotations[0], self.centres[0], self.rotations[1], self.centres[1]
        )
        length = float(np.linalg.norm(base))
        return rotation, base / length if length > 1e-9 else np.zeros(3)

    @property
    def base(self) -> float:
        """Length of the base, m."""
        return float(np.linalg.norm(self.centres[1]))

    @cached_property
    def linear(self) -> EightPoint:
        """The engine's eight-point solution."""
        return longuet_higgins(*self.rays)

    @cached_property
    def by_eight(self) -> Relative | None:
        """Relative orientation from eight or more points: the decomposition with most points before both cameras."""
        if not self.linear:
            return None
        choices = decompose_essential(self.linear.matrix)
        return max(choices, key=lambda choice: self.before_both(choice).sum())

    @cached_property
    def by_five(self) -> Relative | None:
        """Relative orientation from samples of five points, refined with all that agree."""
        if self.used.sum() < 6:
            return None
        a, b = self.rays[..., :2]
        threshold = (1.0 + 3.0 * self.params.sigma_px) / FOCAL
        found = relative_orientation(a, b, threshold, seed=self.params.seed)
        return (found.rotation, found.translation) if found else None

    @property
    def essential(self) -> Array:
        """Essential matrix of the five-point solution, of Frobenius norm 1; zeros where there is none."""
        return essential_from_relative(*self.by_five) / np.sqrt(2.0) if self.by_five else np.zeros((3, 3))

    @cached_property
    def fundamental(self) -> Array:
        """Fundamental matrix of the five-point solution; zeros where there is none."""
        return fundamental_from_essential(self.essential, self.camera, self.camera)

    @property
    def line(self) -> Array | None:
        """Epipolar line (3,) of point 1 in photo B; None where there is none."""
        if not self.fundamental.any():
            return None
        found = epipolar_lines(self.fundamental, self.pixels[0, :1])[0]
        return found if np.isfinite(found).all() else None

    @property
    def miss(self) -> float:
        """Distance of the measured point 1 in photo B from its epipolar line, px."""
        if self.line is None:
            return float("nan")
        return float(line_distances(self.fundamental, self.pixels[0, :1], self.pixels[1, :1])[1][0])

    @property
    def volume(self) -> float:
        """Volume of base and rays of point 1, all of length 1, by the true orientation."""
        rays = [ray_from_pixel(self.camera, side[:1]) for side in self.pixels]
        unit = [ray / np.linalg.norm(ray) for ray in rays]
        return float(coplanarity(*self.truth, *unit)[0])

    def nearest(self) -> Array | None:
        """Return the nearest points of the two rays of point 1, float64 (2, 3), m; None for parallel rays."""
        a, b = (ray_from_pixel(self.camera, side[:1]) for side in self.pixels)
        rotation, base = self.truth
        lengths = np.array(depths(rotation, base * self.base, a[:, :2], b[:, :2]))[:, 0]
        if not np.isfinite(lengths).all() or self.base < 1e-9:
            return None
        return self.centres + lengths[:, None] * np.einsum(
            "nij,ni->nj", self.rotations, np.concatenate([a, b])
        )

    def before_both(self, choice: Relative) -> Array:
        """Whether each intersected point lies before both cameras, bool (m,)."""
        z_a, z_b = depths(*choice, *self.rays[..., :2])
        return np.asarray((z_a > 0) & (z_b > 0))

    @cached_property
    def four(self) -> list[Relative]:
        """The four decompositions of the essential matrix; empty where there is none."""
        return decompose_essential(self.essential) if self.essential.any() else []

    @property
    def right_one(self) -> int:
        """Which of the four puts most points before both cameras, from 0; −1 without any."""
        return int(np.argmax([self.before_both(c).sum() for c in self.four])) if self.four else -1

    def errors(self, found: Relative | None) -> tuple[float, float]:
        """Return the errors of the base's direction and of the rotation, degrees; NaN where not determined."""
        if found is None:
            return float("nan"), float("nan")
        turn = float(np.degrees(angle_between(self.truth[0], found[0])))
        if not self.truth[1].any():
            return float("nan"), turn
        return float(np.degrees(np.arccos(np.clip(found[1] @ self.truth[1], -1.0, 1.0)))), turn


@lru_cache(maxsize=32)
def _errors_of_folds(params: CoplanarityParams) -> Array:
    rows = []
    for fold in FOLDS:
        pair = TwoPhotos(params.replace(fold=float(fold)))
        rows.append([pair.errors(pair.by_eight)[0], pair.errors(pair.by_five)[0]])
    return np.array(rows)


def errors_of_folds(params: CoplanarityParams) -> Array:
    """Return the errors of the base's direction, degrees, (n, 2): by eight and by five points, at every `FOLDS`."""
    return _errors_of_folds(params.replace(fold=0.0, orbit=0.0, photo=False))
