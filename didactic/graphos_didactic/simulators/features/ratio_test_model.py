"""The candidates of a pair of photos, what the engine's matcher accepts of them, and what is true."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from graphos_core.data import Candidates, Features
from graphos_core.data.record import Array
from graphos_core.features.detectors.sift import SiftParams
from graphos_core.features.matchers.mutual import nearest_two
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.features.ratio_test_params import RatioTestParams
from graphos_didactic.simulators.pictured_pair import SeenPair, View, matches_of, seen_pair, wall_picture

POINTS = SiftParams(maximum=300, reduction=1.0, contrast=0.06)
"""How features are found."""
THRESHOLDS = np.linspace(0.3, 1.0, 29)
"""Ratios of the curve of precision and recall."""


@dataclass(frozen=True)
class Counts:
    """What a threshold makes of the candidates: true and false ones, accepted and rejected."""

    true_accepted: int
    false_accepted: int
    true_rejected: int
    false_rejected: int

    @property
    def accepted(self) -> int:
        """Accepted candidates."""
        return self.true_accepted + self.false_accepted

    @property
    def precision(self) -> float:
        """Share of the accepted that are true, %; NaN where nothing is accepted."""
        return 100.0 * self.true_accepted / self.accepted if self.accepted else float("nan")

    @property
    def recall(self) -> float:
        """Share of the true candidates that are accepted, %; NaN where there are none."""
        true = self.true_accepted + self.true_rejected
        return 100.0 * self.true_accepted / true if true else float("nan")


@lru_cache(maxsize=256)
def _matched(a: Features, b: Features, ratio: float, both: bool) -> Candidates:
    return matches_of(a, b, ratio, both=both)


@dataclass(frozen=True, eq=False)
class Judged:
    """The pair of a parameter sheet and its matches."""

    params: RatioTestParams
    setting: Setting

    @cached_property
    def wall(self) -> tuple[Array, str]:
        """The wall's picture and its name."""
        return wall_picture(self.params.pattern, self.setting)

    @cached_property
    def pair(self) -> SeenPair:
        """Both photos with the engine's features."""
        p = self.params
        view = View(tilt=p.tilt, swing=0.0, aside=p.aside, noise=p.noise, seed=p.seed)
        return seen_pair(self.wall[0], view, POINTS)

    @cached_property
    def nearest(self) -> Candidates:
        """Each feature of A with the nearest of B, without any test; the engine drops only exact ties."""
        return _matched(self.pair.a, self.pair.b, 1.0, False)

    @cached_property
    def true(self) -> Array:
        """Which candidates are true, bool (n,)."""
        found = self.nearest.matches
        miss = self.pair.b.xy[found[:, 1]] - self.pair.partners[found[:, 0]]
        return np.asarray(np.hypot(*miss.T) <= self.params.tolerance)

    @cached_property
    def second_distance(self) -> Array:
        """Distance of each candidate's second nearest descriptor, float64 (n,); NaN where the first is 0."""
        ratio = self.nearest.ratio.astype(np.float64)
        return np.asarray(self.nearest.distance / np.where(ratio > 0, ratio, np.nan))

    @cached_property
    def decisive(self) -> Array:
        """Ratio below which each candidate is accepted, (n,): with both directions the larger, infinite if not mutual."""
        ratio = self.nearest.ratio.astype(np.float64)
        if not self.params.mutual:
            return ratio
        back = _matched(self.pair.b, self.pair.a, 1.0, False)
        partner = np.full(len(self.pair.b.xy), -1)
        other = np.full(len(self.pair.b.xy), np.inf)
        partner[back.matches[:, 0]], other[back.matches[:, 0]] = back.matches[:, 1], back.ratio
        a, b = self.nearest.matches.T
        return np.where(partner[b] == a, np.maximum(ratio, other[b]), np.inf)

    def accepted_by(self, rule: str, threshold: float) -> Array:
        """Return which candidates a rule accepts, bool (n,)."""
        if rule == "ratio":
            return self.decisive < threshold
        return np.isfinite(self.decisive) & (self.nearest.distance < threshold)

    @property
    def threshold(self) -> float:
        """The threshold of the present rule."""
        return self.params.ratio if self.params.rule == "ratio" else self.params.limit

    @cached_property
    def accepted(self) -> Array:
        """Which candidates are accepted, bool (n,): by the engine's own test, as far as it has one."""
        p = self.params
        if p.rule == "distance":
            return self.accepted_by(p.rule, p.limit)
        passed = _matched(self.pair.a, self.pair.b, p.ratio, p.mutual).matches[:, 0]
        return np.isin(self.nearest.matches[:, 0], passed)

    def count(self, accepted: Array) -> Counts:
        """Return how many true and false candidates are accepted."""
        true = self.true
        return Counts(
            int((true & accepted).sum()), int((~true & accepted).sum()),
            int((true & ~accepted).sum()), int((~true & ~accepted).sum()),
        )  # fmt: skip

    @cached_property
    def counts(self) -> Counts:
        """Of the present rule and threshold."""
        return self.count(self.accepted)

    def curve(self, rule: str) -> Array:
        """Return recall and precision, float64 (n, 2), %, for thresholds from strict to generous."""
        if rule == "ratio":
            thresholds = THRESHOLDS
        else:
            distances = self.nearest.distance if len(self.nearest.distance) else np.zeros(1)
            thresholds = np.quantile(distances, np.linspace(0.02, 1.0, 40)) + 1e-3
        counts = [self.count(self.accepted_by(rule, float(t))) for t in thresholds]
        rows = np.array([[c.recall, c.precision] for c in counts])
        return rows[np.isfinite(rows).all(axis=1)]

    def limit_for(self, count: int) -> float:
        """Return the distance below which so many candidates lie, or nearly so many."""
        distances = np.sort(self.nearest.distance[np.isfinite(self.decisive)])
        if not len(distances):
            return 0.0
        k = min(max(count, 0), len(distances))
        if k == len(distances):
            return float(distances[-1]) + 1.0
        return float((distances[max(k - 1, 0)] + distances[k]) / 2.0)

    @cached_property
    def looked_at(self) -> int | None:
        """The candidate whose point in A is nearest to the place looked at; None where there is none."""
        if not len(self.nearest):
            return None
        at = self.pair.a.xy[self.nearest.matches[:, 0]]
        return int(np.argmin(np.hypot(*(at - (self.params.look_x, self.params.look_y)).T)))

    @cached_property
    def second(self) -> int | None:
        """Feature of B that is second nearest to the point looked at: the nearest of all at other places."""
        if self.looked_at is None:
            return None
        first, best = (int(i) for i in self.nearest.matches[self.looked_at])
        a, b = self.pair.a, self.pair.b
        elsewhere = np.flatnonzero((b.xy != b.xy[best]).any(axis=1))
        if not len(elsewhere):
            return None
        here = (a.xy == a.xy[first]).all(axis=1)
        score, _, index = nearest_two(a.descriptors[here], b.descriptors[elsewhere])[0]
        return int(elsewhere[index[np.argmax(score)]])
