"""Two pictures of the same patch, the second turned and lit otherwise, described by the engine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.features.descriptor import (
    CELLS,
    DIRECTIONS,
    Described,
    bin_shares,
    describe,
    orientation_peaks,
)
from graphos_core.preprocessing.grey import luma
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.features.descriptor_params import DescriptorParams
from graphos_didactic.simulators.kept_results import KeptResults
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

SIDE = 240
"""Width and height of both pictures, px."""
MIDDLE = (SIDE - 1) / 2
EMPTY = 90.0
"""Grey beside a turned picture."""

_kept = KeptResults(most=3)


@dataclass(frozen=True)
class Shares:
    """How one pixel of the patch is shared out.

    Attributes
    ----------
    size : float
        Gradient times weight, grey levels per px of the patch.
    direction : float
        Of the gradient, radians counter-clockwise from the keypoint's direction.
    rows, columns, directions : mapping of int to float
        Bins and shares.
    """

    size: float
    direction: float
    rows: dict[int, float]
    columns: dict[int, float]
    directions: dict[int, float]

    def table(self) -> list[tuple[int, int, int, float]]:
        """Return row, column, direction and share of every bin that gets something, largest first."""
        rows = [
            (r, c, d, a * b * e)
            for r, a in self.rows.items() for c, b in self.columns.items() for d, e in self.directions.items()
        ]  # fmt: skip
        return sorted((row for row in rows if row[3] > 0), key=lambda row: -row[3])


@dataclass(frozen=True, eq=False)
class Compared:
    """A keypoint in two pictures, and what the engine makes of both."""

    params: DescriptorParams
    setting: Setting

    @cached_property
    def first(self) -> Array:
        """The first picture, float32 (240, 240)."""
        p = self.params
        if p.picture == "photo":
            photo = photo_or_simulated(self.setting)[0]
            made: Array = _kept.get("photo", (photo,), lambda: _middle(photo))
            return made
        drawn: Array = _kept.get("drawn", (p.picture,), lambda: _drawn(p.picture))
        return drawn

    @cached_property
    def second(self) -> Array:
        """The second picture: turned about its middle, with other contrast and brightness, and noise."""
        p = self.params
        key = (self.first, p.turn, p.gain, p.offset, p.noise, p.seed)
        made: Array = _kept.get("second", key, self._changed)
        return made

    def _changed(self) -> Array:
        p = self.params
        cos, sin = math.cos(math.radians(p.turn)), math.sin(math.radians(p.turn))
        back = np.array([
            [cos, sin, MIDDLE * (1 - cos - sin)],
            [-sin, cos, MIDDLE * (1 - cos + sin)],
        ])  # fmt: skip
        turned = cv2.warpAffine(
            self.first, back, (SIDE, SIDE), flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP, borderValue=EMPTY
        )
        noise = np.random.default_rng(p.seed).normal(size=turned.shape) * p.noise
        return np.clip(p.gain * turned + p.offset + noise, 0.0, 255.0).astype(np.float32)

    @property
    def at_first(self) -> tuple[float, float]:
        """The keypoint in the first picture, px."""
        return self.params.x / 100 * (SIDE - 1), self.params.y / 100 * (SIDE - 1)

    @property
    def at_second(self) -> tuple[float, float]:
        """The same place in the second picture, px; kept inside of it."""
        x, y = self.at_first
        cos, sin = math.cos(math.radians(self.params.turn)), math.sin(math.radians(self.params.turn))
        dx, dy = x - MIDDLE, y - MIDDLE
        place = MIDDLE + cos * dx - sin * dy, MIDDLE + sin * dx + cos * dy
        return min(max(place[0], 0.0), SIDE - 1.0), min(max(place[1], 0.0), SIDE - 1.0)

    def unturned(self, which: int) -> Described:
        """Return the keypoint of picture 0 or 1 before it has a direction: at angle 0."""
        grey, at = ((self.first, self.at_first), (self.second, self.at_second))[which]
        made: Described = _kept.get(
            f"unturned {which}",
            (grey, *at, self.params.size),
            lambda: describe(grey, *at, self.params.size, 0.0),
        )
        return made

    def peaks(self, which: int) -> Array:
        """Return the directions of the keypoints at this place, radians; 0 only where nothing stands out."""
        if self.params.orientation == "upright":
            return np.zeros(1)
        found = orientation_peaks(self.unturned(which).orientation, self.params.share)
        return found if len(found) else np.zeros(1)

    @cached_property
    def a(self) -> Described:
        """The first keypoint at its strongest direction."""
        return self._described(0, float(self.peaks(0)[0]))

    @cached_property
    def b(self) -> Described:
        """The second keypoint: of all its directions the one whose descriptor is nearest to the first."""
        every = [self._described(1, float(angle)) for angle in self.peaks(1)[:4]]
        return min(every, key=lambda other: float(np.linalg.norm(other.final - self.a.final)))

    def _described(self, which: int, angle: float) -> Described:
        grey, at = ((self.first, self.at_first), (self.second, self.at_second))[which]
        key = (grey, *at, self.params.size, angle)
        made: Described = _kept.get(
            f"described {which}", key, lambda: describe(grey, *at, self.params.size, angle)
        )
        return made

    @property
    def distance(self) -> float:
        """Distance of the two descriptors of length 1; √2 would have nothing in common."""
        return float(np.linalg.norm(self.a.final - self.b.final))

    @property
    def turn_found(self) -> float:
        """Turn between the two directions, degrees, −180 to 180."""
        return (math.degrees(self.b.angle - self.a.angle) + 180.0) % 360.0 - 180.0

    @property
    def turn_error(self) -> float:
        """Found minus true turn, degrees, −180 to 180."""
        return (self.turn_found - self.params.turn + 180.0) % 360.0 - 180.0

    @cached_property
    def shares(self) -> Shares:
        """How the marked pixel of the first patch is shared out."""
        a, p = self.a, self.params
        side = a.patch.shape[0]
        column, row = (min(int((value / CELLS + 0.5) * side), side - 1) for value in (p.u, p.v))
        size = float(a.magnitude[row, column] * a.weight[row, column])
        turned = -float(a.direction[row, column]) % (2 * math.pi)
        half = (CELLS - 1) / 2
        return Shares(
            size, turned, bin_shares(p.v + half, CELLS), bin_shares(p.u + half, CELLS),
            bin_shares(turned * DIRECTIONS / (2 * math.pi), DIRECTIONS, circular=True),
        )  # fmt: skip


def _middle(photo: Array) -> Array:
    """Return the middle of a photo, grey, reduced so that the picture shows most of it."""
    grey = luma(photo)
    short = min(grey.shape)
    top, left = (max(0, (size - 2 * short) // 2) for size in grey.shape)
    grey = grey[top : top + 2 * short, left : left + 2 * short]  # of a panorama only the middle
    factor = 1.3 * SIDE / min(grey.shape)
    size = (max(SIDE, round(grey.shape[1] * factor)), max(SIDE, round(grey.shape[0] * factor)))
    small = cv2.resize(grey, size, interpolation=cv2.INTER_AREA)
    top, left = (small.shape[0] - SIDE) // 2, (small.shape[1] - SIDE) // 2
    return np.ascontiguousarray(small[top : top + SIDE, left : left + SIDE]).astype(np.float32)


def _drawn(picture: str) -> Array:
    grey = np.full((SIDE, SIDE), EMPTY, np.float32)
    if picture == "round":
        y, x = np.mgrid[0:SIDE, 0:SIDE]
        grey += 120.0 * np.exp(-0.5 * ((x - 0.47 * (SIDE - 1)) ** 2 + (y - 0.46 * (SIDE - 1)) ** 2) / 14.0**2)
        return grey.astype(np.float32)
    for box in ((86, 62, 104, 178), (86, 62, 152, 80), (86, 104, 138, 120)):
        cv2.rectangle(grey, box[:2], box[2:], 225.0, -1)
    cv2.circle(grey, (150, 150), 9, 20.0, -1)
    return np.asarray(cv2.GaussianBlur(grey, (0, 0), 1.5))
