"""Matched points on the format, how the engine says they cover it, and how well it can calibrate the camera from them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import cv2
import numpy as np

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.cameras import camera_model, pixel_from_ray, ray_from_pixel
from graphos_core.data import Adjustment, Block, Camera
from graphos_core.data.record import Array
from graphos_core.features.coverage import Coverage, coverage
from graphos_core.features.detectors.sift import SiftParams, sift
from graphos_core.run import Run
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.adjustment.network_model import ring
from graphos_didactic.simulators.adjustment.network_params import NetworkParams
from graphos_didactic.simulators.adjustment.small_block import Equations, equations
from graphos_didactic.simulators.features.coverage_params import (
    FOCAL_PX,
    GROUPS,
    HEIGHT,
    WIDTH,
    CoverageSimulatorParams,
)
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

NAMES = ("focal_px", "x0", "y0", "k1", "k2")
"""What is calibrated."""
CAMERA = Camera(
    model="brown", width=WIDTH, height=HEIGHT,
    values=np.array([FOCAL_PX, (WIDTH - 1) / 2 + 8, (HEIGHT - 1) / 2 - 6, -0.08, 0.03, 0, 0, 0, 0, 0, 0.0]),
)  # fmt: skip
HALF_DIAGONAL = 0.5 * float(np.hypot(WIDTH, HEIGHT))
PHOTOS = 4
STATIONS = ring(NetworkParams(tilt=25.0, roll=90.0, photos=PHOTOS), PHOTOS)
LEVELS = np.array([0.0, 0.6, 0.2, 1.0, 0.4])
"""Heights of the known points, m, in turn."""
RADII = np.linspace(0.0, 1.0, 41) * HALF_DIAGONAL
"""Where the uncertainty of the image is shown, px from the middle."""
_WAYS = np.arange(12) * np.pi / 6.0
WORTHLESS = 0.5 * HALF_DIAGONAL
"""A calibration that moves the corner by more than this at one standard deviation determines nothing, px."""


@lru_cache(maxsize=4)
def _unit_discs(seed: int) -> Array:
    """Return places in a disc of radius 1 for every photo, group and point, float64 (photos, 4, 50, 2)."""
    rng = np.random.default_rng([seed, 3])
    radius = np.sqrt(rng.random((PHOTOS, len(GROUPS), 50)))
    angle = rng.random(radius.shape) * 2.0 * np.pi
    return radius[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _folded(xy: Array) -> Array:
    """Fold places beyond the border back into the format."""
    size = np.array([WIDTH - 1.0, HEIGHT - 1.0])
    return size - np.abs(np.mod(xy, 2.0 * size) - size)


_features: tuple[Array, Array] | None = None


def _photo_features(photo: Array) -> Array:
    """Return the features of a photo, largest first, px of the format; the last photo's are kept."""
    global _features
    if _features is None or _features[0] is not photo:
        colour = photo if photo.ndim == 3 else np.repeat(photo[..., None], 3, axis=2)
        found = sift(cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), colour, SiftParams(maximum=3000), run=Run())
        order = np.argsort(-found.scale, kind="stable")
        scale = np.array([WIDTH / photo.shape[1], HEIGHT / photo.shape[0]])
        _features = photo, (found.xy[order].astype(np.float64) + 0.5) * scale - 0.5
    return _features[1]


@dataclass(frozen=True, eq=False)
class Covered:
    """The points of a parameter sheet and what follows from them."""

    params: CoverageSimulatorParams
    setting: Setting

    @property
    def middles(self) -> Array:
        """Middles of the groups, float64 (4, 2), px."""
        parts = np.array([[getattr(self.params, f"{g}_{axis}") for axis in "xy"] for g in GROUPS])
        return parts / 100.0 * (WIDTH - 1, HEIGHT - 1)

    @property
    def radius(self) -> float:
        """Radius of each group, px."""
        return self.params.spread / 100.0 * HALF_DIAGONAL

    @cached_property
    def of_photo(self) -> tuple[Array, ...]:
        """Points of each photo, float64 (n, 2), px."""
        each = self.params.points // len(GROUPS)
        if self.params.source == "simulated":
            places = self.middles[None, :, None] + self.radius * _unit_discs(self.params.seed)[:, :, :each]
            return tuple(_folded(p.reshape(-1, 2)) for p in places)
        found = _photo_features(photo_or_simulated(self.setting)[0])
        inside = np.hypot(*(found[:, None] - self.middles).transpose(2, 0, 1)) <= self.radius
        chosen = np.unique(np.concatenate([np.flatnonzero(column)[: PHOTOS * each] for column in inside.T]))
        return tuple(found[chosen[i::PHOTOS]] for i in range(PHOTOS))

    @cached_property
    def xy(self) -> Array:
        """Points of all photos one upon the other, float64 (m, 2), px."""
        return np.concatenate(self.of_photo)

    @cached_property
    def coverage(self) -> Coverage:
        """The engine's coverage of all photos."""
        return coverage(self.xy, WIDTH, HEIGHT, photos=PHOTOS)

    @cached_property
    def exact(self) -> Block:
        """Four photos of known points, each point in one photo, exactly where the points on the format are."""
        points = [_known_points(i, xy) for i, xy in enumerate(self.of_photo)]
        photo = np.repeat(np.arange(PHOTOS, dtype=np.int32), [len(p) for p in points])
        count = len(photo)
        return Block(
            cameras=(CAMERA,), names=STATIONS.names, camera_of_photo=np.zeros(PHOTOS, np.int32),
            oriented=np.ones(PHOTOS, bool), rotations=STATIONS.rotations, centres=STATIONS.centres,
            points=np.concatenate(points), colours=np.full((count, 3), 128, np.uint8),
            point_track=np.full(count, -1, np.int32), obs_photo=photo, obs_point=np.arange(count, dtype=np.int32),
            obs_xy=self.xy, unit="m",
        )  # fmt: skip

    @property
    def _freedom(self) -> Freedom:
        return Freedom(interior=(NAMES,), fixed_points=np.ones(len(self.xy), bool))

    @property
    def enough(self) -> bool:
        """Whether every photo has at least four points, which an orientation needs."""
        return min(len(xy) for xy in self.of_photo) >= 4

    @cached_property
    def equations(self) -> Equations:
        """The engine's normal equations."""
        return equations(self.exact, self._freedom)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of f, x0, y0, k1, k2, float64 (5, 5); NaN where they are not determined."""
        nothing = np.full((len(NAMES), len(NAMES)), np.nan)
        if not self.enough or not self.equations.determined:
            return nothing
        columns = [self.equations.of_camera[name] for name in NAMES]
        found = self.params.sigma_px**2 * self.equations.cofactors.reduced[np.ix_(columns, columns)]
        good = np.isfinite(found).all() and (found.diagonal() > 0).all()
        return found if good and image_sigma(found, RADII[-1:])[0] < WORTHLESS else nothing

    @property
    def sigmas(self) -> Array:
        """Standard deviations of f, x0, y0 in px and of k1, k2, float64 (5,); NaN where not determined."""
        return np.sqrt(self.covariance.diagonal())

    @cached_property
    def image_sigmas(self) -> Array:
        """Standard deviation of the image of a given ray at `RADII`, px; NaN where not determined."""
        return image_sigma(self.covariance, RADII)

    @cached_property
    def estimate(self) -> Adjustment | None:
        """The engine's adjustment of noisy measurements; None where the camera is not determined."""
        if not np.isfinite(self.covariance).all():
            return None
        noise = (
            np.random.default_rng([self.params.seed, 11]).normal(size=self.xy.shape) * self.params.sigma_px
        )
        noisy = replace(self.exact, obs_xy=self.xy + noise)
        return adjust_block(noisy, self._freedom, Options(statistics=False))

    @cached_property
    def image_errors(self) -> Array:
        """How far the estimated camera puts a ray from where the true one does, at `RADII`, px."""
        if self.estimate is None:
            return np.full(len(RADII), np.nan)
        camera = self.estimate.block.cameras[0]
        off = pixel_from_ray(camera, _RAYS) - pixel_from_ray(CAMERA, _RAYS)
        return np.sqrt((off.reshape(len(RADII), -1, 2) ** 2).sum(axis=2).mean(axis=1))

    def error(self, name: str) -> float:
        """Return estimate − truth of a parameter."""
        if self.estimate is None:
            return float("nan")
        i = camera_model(CAMERA.model).names.index(name)
        return float(self.estimate.block.cameras[0].values[i] - CAMERA.values[i])


def _known_points(photo: int, xy: Array) -> Array:
    """Return the known points that a photo shows at xy (n, 2), float64 (n, 3), m: on planes of several heights."""
    ways = ray_from_pixel(CAMERA, xy) @ STATIONS.rotations[photo]
    height = LEVELS[np.arange(len(xy)) % len(LEVELS)]
    centre = STATIONS.centres[photo]
    return centre + ways * ((height - centre[2]) / ways[:, 2])[:, None]


def _rays(radii: Array) -> Array:
    """Return rays of places at radii from the middle of the format, in twelve directions, float64 (12 n, 3)."""
    middle = np.array([(WIDTH - 1) / 2, (HEIGHT - 1) / 2])
    around = np.stack([np.cos(_WAYS), np.sin(_WAYS)], axis=1)
    return ray_from_pixel(CAMERA, (middle + radii[:, None, None] * around).reshape(-1, 2))


_RAYS = _rays(RADII)


@lru_cache(maxsize=1)
def _effects() -> Array:
    """Return what a unit of each parameter does to the image of each ray, float64 (5, 12 n, 2), by the camera model."""
    every = camera_model(CAMERA.model).names
    effects = []
    for name, step in zip(NAMES, (1e-2, 1e-2, 1e-2, 1e-5, 1e-5), strict=True):
        sides = []
        for sign in (1.0, -1.0):
            values = CAMERA.values.copy()
            values[every.index(name)] += sign * step
            sides.append(pixel_from_ray(replace(CAMERA, values=values), _RAYS))
        effects.append((sides[0] - sides[1]) / (2.0 * step))
    return np.array(effects)


def image_sigma(covariance: Array, radii: Array) -> Array:
    """Return the standard deviation of the image of a given ray at some of `RADII`, px, mean of all directions."""
    effects = _effects().reshape(len(NAMES), len(RADII), -1, 2)[:, np.searchsorted(RADII, radii)]
    variance = np.einsum("pq,prdk,qrdk->rd", covariance, effects, effects)
    return np.sqrt(variance.mean(axis=1))


@lru_cache(maxsize=8)
def even(points: int, sigma_px: float) -> tuple[Array, Array]:
    """Return the standard deviations, and those of the image, of as many points spread over the whole format."""
    places = {
        "a_x": 25.0,
        "a_y": 25.0,
        "b_x": 75.0,
        "b_y": 25.0,
        "c_x": 25.0,
        "c_y": 75.0,
        "d_x": 75.0,
        "d_y": 75.0,
    }
    params = CoverageSimulatorParams(points=points, sigma_px=sigma_px, spread=55.0).replace(**places)
    found = Covered(params, Setting())
    return found.sigmas, found.image_sigmas
