"""Two photos of a pictured wall, the second from anywhere on a hemisphere: features by the engine, truth by its cameras."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import Literal

import cv2
import numpy as np
from threadpoolctl import ThreadpoolController

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Camera, Candidates, Features
from graphos_core.data.record import Array
from graphos_core.features.detectors.sift import SiftParams, sift
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.geometry.rotation import look_at, matrix_from_vector
from graphos_core.run import Run
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph
from graphos_didactic.simulators.simulated_photo import simulated_photo

Pattern = Literal["photo", "windows", "texture"]

WIDTH, HEIGHT = 352, 264
"""Format of both photos, px."""
FOCAL_PX = 370.0
CAMERA = Camera(
    model="pinhole", width=WIDTH, height=HEIGHT,
    values=np.array([FOCAL_PX, (WIDTH - 1) / 2, (HEIGHT - 1) / 2]),
)  # fmt: skip
WALL_WIDTH = 564.0
"""Width of the wall in pixels of photo A, which shows its middle part at this scale."""
WINDOW = (slice(72, 192), slice(262, 414))
"""Rows and columns of a window in the simulated photo."""


@dataclass(frozen=True)
class View:
    """Where photo B is taken from, and how well.

    Attributes
    ----------
    tilt, swing, roll : float
        Angle between the ray to the camera and the wall's normal; direction of that ray around the normal, 0 to the
        right, 90 upwards; turn of the camera about its axis. Degrees.
    aside : float
        How far beside the middle of photo A the camera looks, px of photo A.
    zoom : float
        Size of the wall's details in B, in the middle, by their size in A.
    noise : float
        Standard deviation of B's grey levels.
    seed : int
        Of the noise.
    """

    tilt: float = 0.0
    swing: float = 0.0
    roll: float = 0.0
    aside: float = 0.0
    zoom: float = 1.0
    noise: float = 0.0
    seed: int = 0


@dataclass(frozen=True, eq=False)
class PicturedPair:
    """Photo A from the front, photo B as the view says; frame of camera A, unit: pixels of photo A on the wall."""

    wall: Array
    view: View

    @cached_property
    def plane(self) -> Plane:
        """The wall."""
        middle = np.array([0.0, 0.0, FOCAL_PX])
        return Plane.centred(middle, np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), WALL_WIDTH, self.wall)

    @cached_property
    def pose(self) -> tuple[Array, Array]:
        """``cam_from_world`` (3, 3) and centre (3,) of photo B."""
        v = self.view
        tilt, swing = np.radians(v.tilt), np.radians(v.swing)
        target = np.array([v.aside, 0.0, FOCAL_PX])
        way = np.array([np.sin(tilt) * np.cos(swing), -np.sin(tilt) * np.sin(swing), -np.cos(tilt)])
        centre = target + way * FOCAL_PX / v.zoom
        rotation = look_at(centre, target, np.array([0.0, -1.0, 0.0]))
        return matrix_from_vector(np.array([0.0, 0.0, np.radians(v.roll)])) @ rotation, centre

    @cached_property
    def photo_a(self) -> Array:
        """Photo A, uint8 (h, w, 3)."""
        return photograph(CAMERA, np.eye(3), np.zeros(3), self.plane, self.wall, columns=WIDTH)

    @cached_property
    def photo_b(self) -> Array:
        """Photo B, uint8 (h, w, 3)."""
        seen = photograph(CAMERA, *self.pose, self.plane, self.wall, columns=WIDTH)
        if self.view.noise <= 0:
            return seen
        noise = np.random.default_rng(self.view.seed).normal(size=seen.shape[:2]) * self.view.noise
        return np.clip(np.rint(seen + noise[..., None]), 0, 255).astype(np.uint8)

    def true_partner(self, xy: Array) -> Array:
        """Return where photo B shows what photo A shows at xy (n, 2), float64 (n, 2), px; NaN behind camera B."""
        rotation, centre = self.pose
        rays = ray_from_pixel(CAMERA, np.asarray(xy, dtype=np.float64))
        return pixel_from_ray(CAMERA, (rays * FOCAL_PX - centre) @ rotation.T)

    def common(self, xy: Array, edge: float = 0.0) -> Array:
        """Return which points of photo A (n, 2) photo B shows too, bool (n,)."""
        partner = self.true_partner(xy)
        return np.asarray(
            np.all((partner >= edge) & (partner <= (WIDTH - 1 - edge, HEIGHT - 1 - edge)), axis=1)
        )


def wall_picture(pattern: Pattern, setting: Setting) -> tuple[Array, str]:
    """Return what is on the wall and its name: a photo, a façade of equal windows, or a surface rich in texture."""
    if pattern == "windows":
        return _windows(), "equal windows"
    if pattern == "texture":
        return _texture(), "rich texture"
    return photo_or_simulated(setting)


@lru_cache(maxsize=1)
def _windows() -> Array:
    window = np.ascontiguousarray(simulated_photo()[WINDOW])
    return np.ascontiguousarray(
        np.tile(cv2.resize(window, (80, 64), interpolation=cv2.INTER_AREA), (8, 8, 1))
    )


@lru_cache(maxsize=1)
def _texture() -> Array:
    rng, total = np.random.default_rng(3), np.zeros((480, 640))
    for cells in (10, 20, 40, 80):
        grid = rng.normal(size=(cells * 3 // 4, cells))
        total += cv2.resize(grid, (640, 480), interpolation=cv2.INTER_CUBIC)
    grey = np.clip(128 + 42 * total, 0, 255).astype(np.uint8)
    return np.ascontiguousarray(np.repeat(grey[..., None], 3, axis=2))


def points_of(photo: Array, params: SiftParams) -> Features:
    """Return the engine's SIFT features of a small photo at its full size."""
    grey = cv2.cvtColor(photo, cv2.COLOR_RGB2GRAY)
    return sift(grey, photo, params, run=Run(threads=1))


@cache
def _threads() -> ThreadpoolController:
    return ThreadpoolController()


def matches_of(a: Features, b: Features, ratio: float, *, both: bool) -> Candidates:
    """Return the engine's mutual matches of few features; a second thread would cost more than it brings."""
    with _threads().limit(limits=1, user_api="blas"):
        return mutual(a, b, MutualParams(ratio=ratio, mutual=both), run=Run(threads=1))


class _Last:
    """The last pairs, so that a control that does not change the photos does not detect anew."""

    def __init__(self) -> None:
        self._kept: list[tuple[Array, View, SiftParams, SeenPair]] = []

    def get(self, wall: Array, view: View, params: SiftParams) -> SeenPair:
        """Return the pair with its features."""
        first: Features | None = None
        for known, seen, how, pair in self._kept:
            if known is wall and how == params:
                if seen == view:
                    return pair
                first = pair.a
        made = PicturedPair(wall, view)
        a = first if first is not None else points_of(made.photo_a, params)
        found = SeenPair(made, a, points_of(made.photo_b, params))
        self._kept = [(wall, view, params, found), *self._kept[:2]]
        return found


@dataclass(frozen=True, eq=False)
class SeenPair:
    """A pair with the features of both photos."""

    photos: PicturedPair
    a: Features
    b: Features

    @cached_property
    def partners(self) -> Array:
        """True places in B of all features of A, float64 (n, 2), px; NaN outside photo B."""
        xy = self.a.xy.astype(np.float64)
        partner = self.photos.true_partner(xy)
        partner[~self.photos.common(xy)] = np.nan
        return partner


_last = _Last()


def seen_pair(wall: Array, view: View, params: SiftParams) -> SeenPair:
    """Return a pair of photos with its features; the last ones are kept."""
    return _last.get(wall, view, params)
