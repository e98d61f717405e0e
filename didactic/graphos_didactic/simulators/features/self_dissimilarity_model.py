"""A picture, the self-dissimilarity of its patches and the points that stand out: the engine's."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.features.detectors.self_dissimilarity import (
    maxima,
    nearest_patches,
    pyramid,
    refined,
    saliency,
)
from graphos_core.preprocessing.grey import luma
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.features.self_dissimilarity_params import (
    FACTOR,
    MOST_LEVELS,
    SelfDissimilarityParams,
)
from graphos_didactic.simulators.kept_results import KeptResults
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

WIDTH, HEIGHT = 220, 165
"""Size of the simulated pictures, px; a photo is reduced to this width."""
PERIOD = 10
"""Side of a tile, px."""
MARKS = np.array([[54.6, 64.3], [172.3, 45.7], [168.0, 118.0]])
"""Middles of the three marks, px."""
NEAR = 4.0
"""A point within this distance of a mark found it, px."""

_kept = KeptResults(most=3)


@dataclass(frozen=True, eq=False)
class Compared:
    """What the engine finds in the picture of a parameter sheet, on the level looked at."""

    params: SelfDissimilarityParams
    setting: Setting

    @cached_property
    def grey(self) -> Array:
        """The picture, uint8 (h, w)."""
        p = self.params
        if p.picture == "photo":
            photo = photo_or_simulated(self.setting)[0]
            made: Array = _kept.get("photo", (photo,), lambda: _small(photo))
            return made
        drawn: Array = _kept.get("drawn", (p.picture, p.noise, p.seed), lambda: _drawn(p))
        return drawn

    @cached_property
    def image(self) -> Array:
        """The level looked at, or the smallest that holds the search area, uint8 (h, w)."""
        levels: list[Array] = _kept.get(
            "levels", (self.grey,), lambda: pyramid(self.grey, FACTOR, MOST_LEVELS)
        )
        large = [image for image in levels if min(image.shape) > 2 * self.reach]
        return large[min(self.params.level, len(large) - 1)]

    @property
    def pixel(self) -> tuple[float, float]:
        """Width and height of a pixel of the level, px of the picture."""
        return self.grey.shape[1] / self.image.shape[1], self.grey.shape[0] / self.image.shape[0]

    @property
    def reach(self) -> int:
        """Pixels of the level around the point that are looked at."""
        return self.params.patch + self.params.search

    @property
    def at(self) -> tuple[int, int]:
        """Column and row of the point on the level, as near to the border as the search area allows."""
        rows, columns = self.image.shape
        column, row = round(self.params.x / 100 * (columns - 1)), round(self.params.y / 100 * (rows - 1))
        return (
            min(max(column, self.reach), max(columns - 1 - self.reach, self.reach)),
            min(max(row, self.reach), max(rows - 1 - self.reach, self.reach)),
        )

    @property
    def handle(self) -> tuple[float, float]:
        """Where the point was dragged to, px of the picture: it may be nearer to the border than `at`."""
        rows, columns = self.grey.shape
        return self.params.x / 100 * (columns - 1), self.params.y / 100 * (rows - 1)

    def in_picture(self, xy: Array) -> Array:
        """Return places (n, 2) of the level in px of the picture."""
        return (np.asarray(xy, dtype=np.float64) + 0.5) * self.pixel - 0.5

    @cached_property
    def every(self) -> tuple[Array, Array]:
        """All shifts (n, 2) of the search area and their distances (n,), nearest first."""
        p = self.params
        count = (2 * p.search + 1) ** 2 - 1
        made: tuple[Array, Array] = _kept.get(
            "every", (self.image, self.at, p.patch, p.search),
            lambda: nearest_patches(self.image, *self.at, p.patch, p.search, count),
        )  # fmt: skip
        return made

    @property
    def count(self) -> int:
        """How many nearest patches there are: k, or all of a small search area."""
        return min(self.params.neighbours, len(self.every[1]))

    @property
    def dissimilarity(self) -> float:
        """Self-dissimilarity at the point: mean of the k smallest distances, squared grey levels."""
        return float(self.every[1][: self.count].mean())

    @cached_property
    def map(self) -> Array:
        """Self-dissimilarity of every pixel of the level, float32 (h, w)."""
        p = self.params
        key = (self.image, p.patch, p.search, self.count)
        made: Array = _kept.get("map", key, lambda: saliency(self.image, p.patch, p.search, self.count))
        return made

    @cached_property
    def tops(self) -> tuple[Array, Array]:
        """Pixels (n, 2) of all maxima of the level, and whether each is above the threshold."""
        p = self.params
        pixels: Array = _kept.get(
            "tops", (self.map, p.nms), lambda: maxima([self.map], 0, 1e-3, p.nms, 0, FACTOR)
        )
        return pixels, self.map[pixels[:, 1], pixels[:, 0]] > p.threshold

    @cached_property
    def points(self) -> Array:
        """The points found on this level, fitted between the pixels, float64 (n, 2), px of the picture."""
        pixels, strong = self.tops
        xy, good = refined(self.map, pixels[strong])
        return self.in_picture(xy[good])

    @property
    def marks(self) -> Array:
        """Places of the marks (n, 2) px of the picture; none in a photo or in stripes."""
        return MARKS if self.params.picture == "tiles" else np.empty((0, 2))

    @cached_property
    def errors(self) -> Array:
        """Distance of every mark to the nearest point, px; infinite without points."""
        if not len(self.points):
            return np.full(len(self.marks), np.inf)
        return np.linalg.norm(self.marks[:, None] - self.points[None], axis=2).min(axis=1)

    @property
    def marked(self) -> int:
        """How many marks were found."""
        return int((self.errors < NEAR).sum())

    @property
    def elsewhere(self) -> int:
        """How many points lie on none of the marks."""
        if not len(self.points):
            return 0
        if not len(self.marks):
            return len(self.points)
        return int(
            (np.linalg.norm(self.points[:, None] - self.marks[None], axis=2).min(axis=1) >= NEAR).sum()
        )


def _small(photo: Array) -> Array:
    grey = luma(photo)
    factor = WIDTH / max(grey.shape)
    size = (max(48, round(grey.shape[1] * factor)), max(48, round(grey.shape[0] * factor)))
    return np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA))


def _drawn(p: SelfDissimilarityParams) -> Array:
    """Draw tiles with marks, or stripes, four times as fine and reduced: edges lie between pixels too."""
    fine = 4
    y, x = (np.mgrid[0 : HEIGHT * fine, 0 : WIDTH * fine] + 0.5) / fine - 0.5
    if p.picture == "stripes":
        grey = 140.0 + 60.0 * np.sign(np.sin(2 * np.pi * (x + 0.5 * y) / 7.0))
    else:
        tiles = x < 118
        joint = (np.mod(x, PERIOD) < 2) | (np.mod(y, PERIOD) < 2)
        grey = np.where(tiles & joint, 80.0, 150.0)
        grey[x > 138] = 205.0
        for (column, row), level, radius in zip(MARKS[:2], (235.0, 70.0), (3.2, 5.0), strict=True):
            grey[np.hypot(x - column, y - row) < radius] = level
        u, v = np.abs(x - MARKS[2, 0]), np.abs(y - MARKS[2, 1])
        grey[(np.minimum(u, v) < 1.2) & (np.maximum(u, v) < 6)] = 60.0
    small = cv2.resize(grey, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    small = cv2.GaussianBlur(small, (0, 0), 0.6)
    small += p.noise * np.random.default_rng(p.seed).normal(size=small.shape)
    return np.clip(np.rint(small), 0, 255).astype(np.uint8)
