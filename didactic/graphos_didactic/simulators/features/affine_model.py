"""Simulated views of photo A, their matches with photo B, and what is true."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np

from graphos_core.data import Features
from graphos_core.data.record import Array
from graphos_core.features.detectors.affine_simulation import (
    Simulation,
    fully_inside,
    keypoints_in_photo,
    simulate,
    views,
)
from graphos_core.features.detectors.sift import SiftParams, sift
from graphos_core.run import Run
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.features.affine_params import AffineParams
from graphos_didactic.simulators.pictured_pair import (
    HEIGHT,
    WIDTH,
    PicturedPair,
    View,
    matches_of,
    points_of,
    wall_picture,
)

POINTS = SiftParams(maximum=220, reduction=1.0, contrast=0.06)
TOLERANCE = 3.0
"""A match is true within this distance in photo B, px."""
CELL = 2.0
"""Matches of several views in one cell of this size in photo A count once, px."""


@dataclass(frozen=True, eq=False)
class ViewOfA:
    """A simulated view of photo A with its features.

    Attributes
    ----------
    simulation : Simulation
    features : Features
        As found in the simulated view.
    in_photo : float64 (n, 2)
        The same places in photo A, px.
    """

    simulation: Simulation
    features: Features
    in_photo: Array


class _Kept:
    """The features of simulated views of the last wall; a camera that moves needs none of them anew."""

    def __init__(self) -> None:
        self._wall: Array | None = None
        self._photo: Array | None = None
        self._views: dict[tuple[float, float], ViewOfA] = {}

    def photo(self, wall: Array) -> Array:
        """Return photo A, uint8 (h, w, 3)."""
        if self._wall is not wall or self._photo is None:
            self._wall, self._photo, self._views = wall, PicturedPair(wall, View()).photo_a, {}
        return self._photo

    def view(self, wall: Array, tilt: float, longitude: float) -> ViewOfA:
        """Return a simulated view with features that do not depend on what lies outside photo A."""
        photo = self.photo(wall)
        if (tilt, longitude) not in self._views:
            made = simulate(cv2.cvtColor(photo, cv2.COLOR_RGB2GRAY), tilt, longitude)
            found = sift(made.image, made.image, POINTS, run=Run(threads=1))
            xy = found.xy.astype(np.float64)
            keep = fully_inside(made, xy, found.scale / 2.0)
            chosen = _subset(found, keep)
            back, _, _ = keypoints_in_photo(made, xy[keep], found.scale[keep].astype(float), found.angle[keep].astype(float))  # fmt: skip
            self._views[tilt, longitude] = ViewOfA(made, chosen, back)
        return self._views[tilt, longitude]


_kept = _Kept()


def _subset(found: Features, keep: Array) -> Features:
    return Features(
        xy=found.xy[keep], scale=found.scale[keep], angle=found.angle[keep], response=found.response[keep],
        descriptors=found.descriptors[keep], colour=found.colour[keep], width=found.width, height=found.height,
        found=found.found,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Matched:
    """Matches of one or of several views with photo B.

    Attributes
    ----------
    a, b : float64 (n, 2)
        Places in photos A and B, px.
    true : bool (n,)
    view : int (n,)
        Which view found each.
    """

    a: Array
    b: Array
    true: Array
    view: Array

    @property
    def right(self) -> int:
        """True matches."""
        return int(self.true.sum())

    @property
    def wrong(self) -> int:
        """False matches."""
        return int((~self.true).sum())


class _Recent:
    """What was found last, of each kind, so that going round the hemisphere finds nothing anew."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[tuple[Any, ...], Any]] = {}

    def get(self, kind: str, key: tuple[Any, ...], make: Callable[[], Any]) -> Any:
        """Return the value of a key, whose first entry is compared by identity; made unless it is the last one."""
        known = self._known.get(kind)
        if known is None or known[0][0] is not key[0] or known[0][1:] != key[1:]:
            known = self._known[kind] = (key, make())
        return known[1]


_recent = _Recent()


@dataclass(frozen=True, eq=False)
class Simulated:
    """The photos of a parameter sheet, the simulated views, and all matches."""

    params: AffineParams
    setting: Setting

    @cached_property
    def wall(self) -> tuple[Array, str]:
        """The wall's picture and its name."""
        return wall_picture(self.params.pattern, self.setting)

    @cached_property
    def photos(self) -> PicturedPair:
        """Both photos."""
        p = self.params
        return PicturedPair(self.wall[0], View(p.tilt, p.swing, p.roll, 0.0, 1.0, p.noise, p.seed))

    @cached_property
    def photo_a(self) -> Array:
        """Photo A."""
        return _kept.photo(self.wall[0])

    @property
    def photo_b(self) -> Array:
        """Photo B."""
        return self._of_b[0]

    @property
    def of_b(self) -> Features:
        """Features of photo B."""
        return self._of_b[1]

    @cached_property
    def _of_b(self) -> tuple[Array, Features]:
        found: tuple[Array, Features] = _recent.get("photo", self._key(), self._taken)
        return found

    def _taken(self) -> tuple[Array, Features]:
        photo = self.photos.photo_b
        return photo, points_of(photo, POINTS)

    def _key(self, *names: str) -> tuple[Any, ...]:
        """Return what photo B depends on, and the given parameters."""
        p = self.params
        return self.wall[0], p.tilt, p.swing, p.roll, p.noise, p.seed, *(getattr(p, name) for name in names)

    @cached_property
    def angles(self) -> tuple[tuple[float, float], ...]:
        """The engine's tilts t and longitudes, radians, of all views; the photo itself is the first."""
        return views(self.params.tilts, float(np.radians(self.params.step)))

    @cached_property
    def views(self) -> tuple[ViewOfA, ...]:
        """All views of photo A."""
        return tuple(_kept.view(self.wall[0], t, phi) for t, phi in self.angles)

    @cached_property
    def matched(self) -> tuple[Matched, ...]:
        """Matches of each view with photo B."""
        found: tuple[Matched, ...] = _recent.get(
            "matches", self._key("tilts", "step", "ratio"), self._matched
        )
        return found

    def _matched(self) -> tuple[Matched, ...]:
        found = []
        for i, view in enumerate(self.views):
            pairs = matches_of(view.features, self.of_b, self.params.ratio, both=True).matches
            a, b = view.in_photo[pairs[:, 0]], self.of_b.xy[pairs[:, 1]].astype(np.float64)
            miss = np.hypot(*(b - self.photos.true_partner(a)).T)
            found.append(Matched(a, b, miss <= TOLERANCE, np.full(len(a), i)))
        return tuple(found)

    @property
    def alone(self) -> Matched:
        """Matches of photo A as it is: SIFT alone."""
        return once(self.matched[:1])

    @cached_property
    def together(self) -> Matched:
        """Matches of all views, each place of photo A once."""
        return once(self.matched)

    @cached_property
    def local_map(self) -> Array:
        """What the change from photo A to photo B does near the middle: linear part, float64 (2, 2), by the cameras."""
        middle = np.array([(WIDTH - 1) / 2, (HEIGHT - 1) / 2])
        steps = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        right, left, below, above = self.photos.true_partner(middle + steps)
        return np.stack([(right - left) / 2.0, (below - above) / 2.0], axis=1)

    @cached_property
    def remaining(self) -> Array:
        """Tilt that is left between each view and photo B, (n,): ratio of both singular values of the map; 1 for none."""
        left = []
        for view in self.views:
            change = self.local_map @ np.linalg.inv(view.simulation.simulated_from_photo[:, :2])
            large, small = np.linalg.svd(change, compute_uv=False)
            left.append(large / small)
        return np.array(left)

    @property
    def nearest(self) -> int:
        """View that is nearest to what camera B sees."""
        return int(np.argmin(self.remaining))

    @property
    def busiest(self) -> int:
        """View with most true matches."""
        return int(np.argmax([found.right for found in self.matched]))

    @property
    def true_tilt(self) -> float:
        """T = 1 / cos θ of camera B."""
        return float(1.0 / np.cos(np.radians(self.params.tilt)))


def once(found: tuple[Matched, ...]) -> Matched:
    """Join matches of several views; of those whose points in A share a cell the first true one stays, else the first."""
    a, b, true, view = (
        np.concatenate([getattr(m, name) for m in found]) for name in ("a", "b", "true", "view")
    )
    order = np.lexsort((np.arange(len(a)), ~true))
    _, first = np.unique(np.floor(a[order] / CELL), axis=0, return_index=True)
    keep = np.sort(order[first])
    return Matched(a[keep], b[keep], true[keep], view[keep])
