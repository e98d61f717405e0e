"""A block with up to two wrong observations: what the engine's tests say about each observation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.statistics.reliability import critical_value, tau_limit
from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Adjustment, Block, Reliability
from graphos_core.data.record import Array
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.simulation.model import TheoreticalModel
from graphos_didactic.simulators.adjustment.four_photos import (
    CAMERA,
    CENTRES,
    POINTS_XYZ,
    ROTATIONS,
    four_photos,
)
from graphos_didactic.simulators.adjustment.snooping_params import PHOTOS, SnoopingParams


@dataclass(frozen=True, eq=False)
class Tested:
    """An adjustment with its tests, and which observations took part.

    Attributes
    ----------
    adjustment : Adjustment
    photo, point : int (m,)
        Of each observation, from 0.
    values : float64 (m, 2)
        w or τ of every coordinate, whichever is asked for.
    limit : float
        Of their absolute values.
    """

    adjustment: Adjustment
    photo: Array
    point: Array
    values: Array
    limit: float

    @property
    def reliability(self) -> Reliability:
        """Redundancy numbers, w, τ, minimal detectable biases."""
        found = self.adjustment.reliability
        assert found is not None
        return found

    @property
    def worst(self) -> tuple[int, int]:
        """Observation and coordinate with the largest absolute value."""
        i, j = np.unravel_index(int(np.argmax(np.abs(self.values))), self.values.shape)
        return int(i), int(j)

    @property
    def accused(self) -> Array:
        """Observations with a coordinate above the limit, bool (m,)."""
        return np.asarray((np.abs(self.values) > self.limit).any(axis=1))

    def find(self, photo: int, point: int) -> int | None:
        """Return the observation of a point in a photo, both counted from 1; None when it does not take part."""
        found = np.flatnonzero((self.photo == photo - 1) & (self.point == point - 1))
        return int(found[0]) if len(found) else None


@dataclass(frozen=True, eq=False)
class Snooping:
    """The block of a parameter sheet."""

    params: SnoopingParams

    @property
    def photos(self) -> int:
        """How many photos take part."""
        return min(max(self.params.photos, 2), PHOTOS)

    @cached_property
    def model(self) -> TheoreticalModel:
        """Truth and noise."""
        return four_photos(self.photos, self.params.sigma_px, self.params.seed)

    @cached_property
    def block(self) -> Block:
        """The measured block with its blunders, starting from the true values."""
        block, p = self.model.as_block(), self.params
        xy = np.array(block.obs_xy)
        for photo, point, shift in (
            (p.a_photo, p.a_point, (p.a_x, p.a_y)),
            (p.b_photo, p.b_point, (p.b_x, p.b_y)),
        ):
            xy[(block.obs_photo == photo - 1) & (block.obs_point == point - 1)] += shift
        return replace(block, obs_xy=xy, obs_sigma_px=np.full(len(xy), p.sigma_px))

    def _tested(self, block: Block, photo: Array, point: Array) -> Tested:
        p = self.params
        found = adjust_block(block, None, Options(reliability=True, alpha=p.alpha, power=p.power))
        assert found.reliability is not None
        tau = p.test == "tau"
        values = found.reliability.studentised if tau else found.reliability.standardised
        limit = tau_limit(p.alpha, found.redundancy) if tau else critical_value(p.alpha)
        return Tested(found, photo, point, values, limit)

    @cached_property
    def rounds(self) -> tuple[Tested, ...]:
        """The adjustments: with everything, then without the worst, and so on; ends when nothing is accused."""
        block = self.block
        photo, point = np.asarray(block.obs_photo), np.asarray(block.obs_point)
        done = [self._tested(block, photo, point)]
        for _ in range(self.params.removed):
            if not done[-1].accused.any():
                break
            keep = np.arange(len(photo)) != done[-1].worst[0]
            rays = np.bincount(point[keep], minlength=len(POINTS_XYZ))
            if rays.min() < 2:  # a point needs two rays
                break
            photo, point = photo[keep], point[keep]
            sigma = None if block.obs_sigma_px is None else np.asarray(block.obs_sigma_px)[keep]
            block = replace(
                block, obs_photo=photo, obs_point=point, obs_xy=block.obs_xy[keep], obs_sigma_px=sigma
            )
            done.append(self._tested(block, photo, point))
        return tuple(done)

    @property
    def result(self) -> Tested:
        """The last adjustment."""
        return self.rounds[-1]

    @property
    def dropped(self) -> list[tuple[int, int]]:
        """Photo and point of every removed observation, from 1, in order."""
        return [(int(t.photo[t.worst[0]]) + 1, int(t.point[t.worst[0]]) + 1) for t in self.rounds[:-1]]

    @cached_property
    def errors(self) -> Array:
        """Adjusted − true points after the best similarity onto the truth, float64 (n, 3), m."""
        points = np.asarray(self.result.adjustment.block.points)
        return estimate_similarity(points, POINTS_XYZ).apply(points) - POINTS_XYZ

    def true_pixels(self, photo: int) -> Array:
        """Return where all points really are in a photo (from 0), float64 (n, 2), px."""
        return pixel_from_ray(CAMERA, (POINTS_XYZ - CENTRES[photo]) @ ROTATIONS[photo].T)

    def size(self, name: str) -> float:
        """Length of a blunder, ``"a"`` or ``"b"``, px."""
        return float(np.hypot(getattr(self.params, f"{name}_x"), getattr(self.params, f"{name}_y")))
