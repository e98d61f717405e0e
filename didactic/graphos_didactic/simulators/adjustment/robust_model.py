"""Rays to one point: what least squares, robust weights and random samples make of them, by the engine."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphos_core.adjustment.bundle.robust import ROBUST, RobustFunction
from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_core.geometry.consensus import samples_needed
from graphos_core.geometry.intersection_precision import image_derivatives, intersection_precision
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.triangulation import ray_distances_px, triangulate
from graphos_didactic.simulators.adjustment.robust_params import (
    LARGEST_PX,
    MOST_DRAWS,
    RAYS,
    RobustParams,
    blunders,
)

WIDTH, HEIGHT, FOCAL_PX = 4000, 3000, 3000.0
DISTANCE = 10.0
"""Of every camera from the point, m."""
SPREAD = np.radians(58.0)
"""The outermost cameras stand this far from the vertical."""
TINY = 1e-6
"""A step shorter than this ends the iteration, m."""
CAMERA = Camera(
    model="pinhole",
    width=WIDTH,
    height=HEIGHT,
    values=np.array([FOCAL_PX, (WIDTH - 1) / 2, (HEIGHT - 1) / 2]),
)
_ANGLES = np.linspace(-SPREAD, SPREAD, RAYS)
CENTRES = DISTANCE * np.stack([np.sin(_ANGLES), np.zeros(RAYS), np.cos(_ANGLES)], axis=1)
ROTATIONS = np.stack([look_at(c, np.zeros(3), np.array([0.0, 1.0, 0.0])) for c in CENTRES])
WAYS = -CENTRES[:, [0, 2]] / DISTANCE
"""Direction of each ray in the section, float64 (n, 2)."""


def _aside() -> Array:
    """Return where a larger image x lies in the section, unit vectors (n, 2), by the camera's own rays."""
    step = ray_from_pixel(CAMERA, np.array([[CAMERA.values[1] + 1.0, CAMERA.values[2]]]))[0]
    across = np.einsum("nji,j->ni", ROTATIONS, step)[:, [0, 2]]
    across -= np.einsum("ni,ni->n", across, WAYS)[:, None] * WAYS
    return across / np.linalg.norm(across, axis=1, keepdims=True)


ASIDE = _aside()
METRES_PER_PX = DISTANCE / FOCAL_PX


@dataclass(frozen=True)
class Fit:
    """One state of the reweighting.

    Attributes
    ----------
    point : float64 (3,)
    residuals, weights : float64 (n,)
        Projected − measured in image x, px, and the weights that follow from them.
    cost : float
        ½ Σ ρ(v²/σ²).
    """

    point: Array
    residuals: Array
    weights: Array
    cost: float


@dataclass(frozen=True, eq=False)
class Bundle:
    """The rays of a parameter sheet, in the section X to the right, Z upwards; the true point is at (0, 0)."""

    params: RobustParams

    @property
    def function(self) -> RobustFunction:
        """The chosen robust function."""
        return ROBUST[self.params.function]

    @cached_property
    def errors_px(self) -> Array:
        """Noise and blunder of each measurement in image x, float64 (n,), px."""
        noise = np.random.default_rng([self.params.seed, 1]).standard_normal(RAYS) * self.params.sigma_px
        return np.asarray(noise + blunders(self.params))

    @cached_property
    def pixels(self) -> Array:
        """Measured places, float64 (n, 2), px."""
        true = pixel_from_ray(CAMERA, np.einsum("nij,nj->ni", ROTATIONS, -CENTRES))
        return true + np.stack([self.errors_px, np.zeros(RAYS)], axis=1)

    @cached_property
    def _ideal(self) -> Array:
        return ray_from_pixel(CAMERA, self.pixels)[:, :2]

    def residuals(self, point: Array) -> Array:
        """Return projected − measured in image x of points (..., 3), float64 (..., n), px."""
        seen = np.einsum("nij,...nj->...ni", ROTATIONS, np.asarray(point)[..., None, :] - CENTRES)
        flat = pixel_from_ray(CAMERA, seen.reshape(-1, 3))[:, 0]
        return flat.reshape(seen.shape[:-1]) - self.pixels[:, 0]

    def fit(self, point: Array, function: RobustFunction) -> Fit:
        """Return residuals and weights at a point."""
        residuals = self.residuals(point)
        rho, weights = function((residuals / self.params.sigma_px) ** 2, self.params.scale)
        return Fit(point, residuals, weights, 0.5 * float(rho.sum()))

    def reweighted(self, start: Array, function: RobustFunction, times: int) -> list[Fit]:
        """Return the states from `start`: weights renewed, point computed again (Gauss–Newton with weights).

        Ends early when the point stays, or when hardly a ray has weight left.
        """
        states = [self.fit(start, function)]
        for _ in range(times):
            state = states[-1]
            if (state.weights > 1e-9).sum() < 2:
                break
            sigmas = self.params.sigma_px / np.sqrt(np.maximum(state.weights, 1e-18))
            around = [CAMERA] * RAYS, list(ROTATIONS), list(CENTRES)
            cofactors = intersection_precision(*around, state.point, list(sigmas)).covariance
            gradient = np.zeros(3)
            for k in range(RAYS):
                slope = image_derivatives(CAMERA, ROTATIONS[k], CENTRES[k], state.point)
                if slope is not None:
                    gradient += slope[0] * state.residuals[k] / sigmas[k] ** 2
            step = -cofactors @ gradient
            if not np.isfinite(step).all():
                break
            states.append(self.fit(state.point + step, function))
            if float(np.linalg.norm(step)) < TINY:
                break
        return states

    @cached_property
    def least_squares(self) -> Array:
        """The point by least squares, float64 (3,): the engine's intersection of all rays."""
        found = triangulate(
            np.array([0, RAYS]), np.arange(RAYS), self._ideal, np.full(RAYS, FOCAL_PX), ROTATIONS, CENTRES
        )
        return self.reweighted(found.points[0], ROBUST["none"], 3)[-1].point

    @cached_property
    def path(self) -> list[Fit]:
        """The states of the reweighting, as often as the sheet says."""
        begin = self.sampled if self.params.start == "ransac" else self.least_squares
        return self.reweighted(begin, self.function, self.params.iterations)

    @property
    def robust(self) -> Fit:
        """Where the reweighting ended."""
        return self.path[-1]

    @cached_property
    def samples(self) -> Array:
        """Pairs of rays in the order they are drawn, int (draws, 2)."""
        rng = np.random.default_rng([self.params.seed, 2])
        return np.array([rng.choice(RAYS, 2, replace=False) for _ in range(MOST_DRAWS)])

    @cached_property
    def _candidates(self) -> tuple[Array, Array]:
        """Points of all samples, (draws, 3), and the distance of every ray from each, (draws, n), px."""
        photo, starts = self.samples.ravel(), np.arange(0, 2 * MOST_DRAWS + 1, 2)
        focal = np.full(RAYS, FOCAL_PX)
        found = triangulate(starts, photo, self._ideal[photo], focal, ROTATIONS, CENTRES).points
        point, every = np.repeat(np.arange(MOST_DRAWS), RAYS), np.tile(np.arange(RAYS), MOST_DRAWS)
        away = ray_distances_px(
            point, every, np.tile(self._ideal, (MOST_DRAWS, 1)), focal, ROTATIONS, CENTRES, found
        )
        return found, away.reshape(MOST_DRAWS, RAYS)

    @property
    def sample_points(self) -> Array:
        """Intersection of every sample drawn so far, float64 (draws, 3)."""
        return self._candidates[0][: self.params.draws]

    @cached_property
    def agreeing(self) -> Array:
        """Which rays agree with each sample drawn so far, bool (draws, n)."""
        limit = self.params.threshold * self.params.sigma_px
        return np.asarray(self._candidates[1][: self.params.draws] <= limit)

    @property
    def votes(self) -> Array:
        """Rays that agree with each sample drawn so far, int (draws,)."""
        return np.asarray(self.agreeing.sum(axis=1))

    @property
    def best(self) -> int:
        """The first sample with the most votes."""
        return int(np.argmax(self.votes))

    @cached_property
    def sampled(self) -> Array:
        """Result of RANSAC: least squares of the rays that agree with the best sample, float64 (3,)."""
        keep = np.flatnonzero(self.agreeing[self.best])
        found = triangulate(
            np.array([0, len(keep)]), keep, self._ideal[keep], np.full(RAYS, FOCAL_PX), ROTATIONS, CENTRES
        )
        return np.asarray(found.points[0])

    @property
    def needed(self) -> float:
        """Draws that are needed for the share of votes that the best sample has."""
        return samples_needed(float(self.votes[self.best]) / RAYS, 2, self.params.confidence)

    @cached_property
    def good(self) -> Array:
        """Rays without a blunder, bool (n,): known only because this is a simulation."""
        return np.asarray(np.abs(blunders(self.params)) < 1e-9)

    @cached_property
    def landscape(self) -> Array:
        """Cost over the zoom, float64 (rows, columns), on `GRID` (mm)."""
        x, z = np.meshgrid(GRID, GRID)
        points = np.stack([x, np.zeros_like(x), z], axis=-1) * 1e-3
        square = (self.residuals(points) / self.params.sigma_px) ** 2
        knots = (
            np.linspace(0.0, np.sqrt(square.max()), 400) ** 2
        )  # ρ is smooth: a table is exact enough to draw
        rho, _ = self.function(knots, self.params.scale)
        return np.asarray(0.5 * np.interp(square, knots, rho).sum(axis=-1))


REACH_MM = 160.0
"""Half the width of the zoom, mm."""
GRID = np.linspace(-REACH_MM, REACH_MM, 49)


def mm(point: Array) -> Array:
    """Return X and Z of points (..., 3), m, in mm."""
    return 1e3 * np.asarray(point)[..., [0, 2]]


def aimed_at(x_mm: float, z_mm: float, rays: tuple[int, ...]) -> dict[str, float]:
    """Return the blunders, by parameter name, that make rays (numbered from 1) pass (x, z) instead of the point."""
    shift = ASIDE @ np.array([x_mm, z_mm]) * 1e-3 / METRES_PER_PX
    return {f"ray_{k}": float(np.clip(shift[k - 1], -LARGEST_PX, LARGEST_PX)) for k in rays}
