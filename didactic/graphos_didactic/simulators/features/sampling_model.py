"""Matches of two photos, the engine's samples of them, what each costs, and when the search may end."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data.record import Array
from graphos_core.features.detectors.sift import SiftParams
from graphos_core.features.robust.models import FundamentalModel, HomographyModel
from graphos_core.features.robust.samplers import ProgressiveSampler, UniformSampler
from graphos_core.features.robust_scores import COSTS, magsac_loss, msac_loss, ransac_loss, robust_sigma
from graphos_core.geometry.consensus import samples_needed
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.features.sampling_params import MOST, SamplingParams
from graphos_didactic.simulators.pictured_pair import (
    CAMERA,
    FOCAL_PX,
    HEIGHT,
    WIDTH,
    PicturedPair,
    SeenPair,
    View,
    matches_of,
    seen_pair,
    wall_picture,
)

VIEW = View(tilt=28.0, swing=10.0, aside=20.0, noise=5.0)
POINTS = SiftParams(maximum=300, reduction=1.0, contrast=0.06)
LOOSE = 0.97
"""A ratio test that lets many false matches pass."""
LMEDS_REACH = 2.5
"""With the median, a match agrees within so many robust standard deviations (Rousseeuw and Leroy 1987)."""
LOSSES = {"ransac": ransac_loss, "msac": msac_loss, "magsac": magsac_loss}

Model = FundamentalModel | HomographyModel


@dataclass(frozen=True, eq=False)
class Matches:
    """Matches of two photos.

    Attributes
    ----------
    a, b : float64 (n, 2)
        Places in both photos, px; match 0 is the one that can be dragged.
    true_b : float64 (n, 2)
        Where the partners really are, px.
    quality : float64 (n,)
        Ratio of the two smallest distances: small is distinctive.
    """

    a: Array
    b: Array
    true_b: Array
    quality: Array


@lru_cache(maxsize=8)
def _scene(depth: float, count: int, seed: int) -> tuple[Array, Array]:
    """Return places in A and B, float64 (n, 2), px, of points seen in both, up to a depth (in parts of the distance) behind the wall."""
    rng = np.random.default_rng([seed, 41])
    rotation, centre = PicturedPair(np.zeros((3, 4, 3), np.uint8), VIEW).pose
    a, b = np.empty((0, 2)), np.empty((0, 2))
    while len(a) < count:
        xy = rng.uniform((6, 6), (WIDTH - 7, HEIGHT - 7), (2 * count, 2))
        nearer = 1.0 + depth * rng.random(len(xy))
        points = ray_from_pixel(CAMERA, xy) * (FOCAL_PX * nearer)[:, None]
        partner = pixel_from_ray(CAMERA, (points - centre) @ rotation.T)
        inside = np.all((partner > 5) & (partner < (WIDTH - 6, HEIGHT - 6)), axis=1)
        a, b = np.concatenate([a, xy[inside]]), np.concatenate([b, partner[inside]])
    return a[:count], b[:count]


def simulated(params: SamplingParams) -> Matches:
    """Return simulated matches: the first ``round(w n)`` are true, with noise; the rest lie anywhere in photo B."""
    p = params
    a, true_b = _scene(p.depth / 100.0, p.count, p.seed)
    rng = np.random.default_rng([p.seed, 43])
    noise, anywhere = (
        rng.normal(size=true_b.shape),
        rng.uniform((0, 0), (WIDTH - 1, HEIGHT - 1), true_b.shape),
    )
    draws = rng.random((2, p.count))
    good = np.arange(p.count) < round(p.good * p.count)
    b = np.where(good[:, None], true_b + p.noise_px * noise, anywhere)
    quality = np.where(good, 0.3 + 0.6 * draws[0], 0.6 + 0.4 * draws[1])
    return Matches(a, b, true_b, quality)


def matched(pair: SeenPair, count: int) -> Matches:
    """Return SIFT matches of a pictured pair, at most `count`, evenly taken from all."""
    found = matches_of(pair.a, pair.b, LOOSE, both=False)
    known = np.flatnonzero(np.isfinite(pair.photos.true_partner(pair.a.xy[found.matches[:, 0]])).all(axis=1))
    chosen = known[np.linspace(0, max(len(known) - 1, 0), min(count, len(known))).astype(int)]
    i, j = found.matches[chosen].T
    a, b = pair.a.xy[i].astype(np.float64), pair.b.xy[j].astype(np.float64)
    true_b = pair.photos.true_partner(a)
    first = np.argsort(np.hypot(*(b - true_b).T), kind="stable")  # a true one can be dragged
    return Matches(a[first], b[first], true_b[first], found.ratio[chosen][first].astype(np.float64))


@dataclass(frozen=True, eq=False)
class Drawn:
    """Samples and their models.

    Attributes
    ----------
    picks : int64 (MOST, m)
    matrices : float64 (MOST, 3, 3)
        The solution of each sample that costs least; zeros where there is none.
    squares : float64 (MOST, n)
        Squared distances, px²; infinite where there is no solution.
    costs : float64 (MOST,)
    """

    picks: Array
    matrices: Array
    squares: Array
    costs: Array


@dataclass(frozen=True, eq=False)
class Search:
    """The search of a parameter sheet."""

    params: SamplingParams
    setting: Setting

    @cached_property
    def wall(self) -> tuple[Array, str]:
        """The wall's picture and its name."""
        return wall_picture("photo", self.setting)

    @cached_property
    def photos(self) -> SeenPair | None:
        """The pair of photos; None for simulated matches."""
        return seen_pair(self.wall[0], VIEW, POINTS) if self.params.source == "photo" else None

    @cached_property
    def matches(self) -> Matches:
        """The matches, with the first one dragged."""
        p = self.params
        found = simulated(p) if self.photos is None else matched(self.photos, p.count)
        if not len(found.a):
            return found
        b = found.b.copy()
        b[0] = found.true_b[0] + (p.off_x, p.off_y)
        return Matches(found.a, b, found.true_b, found.quality)

    @cached_property
    def good(self) -> Array:
        """Which matches are true, bool (n,): within 3 px, or three standard deviations, of the true place."""
        limit = max(3.0, 3.0 * self.params.noise_px)
        return np.asarray(np.hypot(*(self.matches.b - self.matches.true_b).T) <= limit)

    @property
    def share(self) -> float:
        """True share of good matches."""
        return float(self.good.mean()) if len(self.good) else 0.0

    @cached_property
    def model(self) -> Model:
        """The engine's model with all matches."""
        kind = HomographyModel if self.params.model == "homography" else FundamentalModel
        return kind(self.matches.a, self.matches.b)

    @property
    def possible(self) -> bool:
        """Whether there are more matches than a sample takes."""
        return len(self.model) > self.model.sample

    @cached_property
    def drawn(self) -> Drawn:
        """All samples with the engine's solutions, squares and costs."""
        n, m = len(self.model), self.model.sample
        if not self.possible:
            none = np.zeros((MOST, m), int)
            return Drawn(none, np.zeros((MOST, 3, 3)), np.full((MOST, n), np.inf), np.full(MOST, np.inf))
        rng = np.random.default_rng([self.params.seed, 47])
        if self.params.order == "best":
            best_first = np.argsort(self.matches.quality, kind="stable")
            picks = best_first[ProgressiveSampler(n, m, rng).draw(MOST)]
        else:
            picks = UniformSampler(n, m, rng).draw(MOST)
        found, which = self.model.solve(picks)
        finite = np.isfinite(found).all(axis=(1, 2))
        found, which = found[finite], which[finite]
        squares = self.model.squares(found)
        costs = self.cost(squares)
        order = np.lexsort((costs, which))
        first = order[np.concatenate([[True], np.diff(which[order]) > 0])] if len(order) else order
        made = Drawn(picks, np.zeros((MOST, 3, 3)), np.full((MOST, n), np.inf), np.full(MOST, np.inf))
        made.matrices[which[first]] = found[first]
        made.squares[which[first]] = squares[first]
        made.costs[which[first]] = costs[first]
        return made

    def cost(self, squares: Array) -> Array:
        """Return the engine's cost of squared distances (k, n)."""
        return COSTS[self.params.cost](squares, self.params.threshold)

    @cached_property
    def best(self) -> Array:
        """Index of the best sample among the first i, int (MOST,)."""
        lowest = np.minimum.accumulate(self.drawn.costs)
        new = np.concatenate([[True], lowest[1:] < lowest[:-1]])
        return np.maximum.accumulate(np.where(new, np.arange(MOST), 0))

    def reach(self, squares: Array) -> float:
        """Return the largest distance of a match that agrees, px: the threshold, or by the median."""
        if self.params.cost != "lmeds":
            return self.params.threshold
        return LMEDS_REACH * max(robust_sigma(squares, self.model.sample), 1e-6)

    def agreeing(self, sample: int) -> Array:
        """Return which matches agree with a sample's model, bool (n,)."""
        squares = self.drawn.squares[sample]
        if not np.isfinite(squares).all():
            return np.zeros(len(squares), bool)
        return np.asarray(squares <= self.reach(squares) ** 2)

    @cached_property
    def counts(self) -> Array:
        """How many matches agree with each sample's model, int (MOST,)."""
        return np.array([self.agreeing(i).sum() for i in range(MOST)])

    @property
    def now(self) -> int:
        """Index of the present sample."""
        return self.params.draw - 1

    @property
    def leader(self) -> int:
        """Index of the best sample so far."""
        return int(self.best[self.now])

    def clean(self, sample: int) -> bool:
        """Whether a sample contains no false match."""
        return bool(self.possible and self.good[self.drawn.picks[sample]].all())

    def needed(self, share: float) -> float:
        """Return the engine's number of samples for a share of good matches."""
        return samples_needed(share, self.model.sample, self.params.confidence)

    @cached_property
    def adaptive(self) -> Array:
        """Needed number of samples as the search believes after each sample, (MOST,)."""
        shares = self.counts[self.best] / max(len(self.model), 1)
        return np.array([self.needed(float(w)) for w in shares])

    @cached_property
    def stop(self) -> int | None:
        """Number of samples after which the search may end; None where it goes on beyond the last."""
        done = np.flatnonzero(np.arange(1, MOST + 1) >= self.adaptive)
        return int(done[0]) + 1 if len(done) else None

    @cached_property
    def refined(self) -> Array | None:
        """The engine's fit to all that agree with the best sample so far; None where there is none."""
        start = self.drawn.matrices[self.leader]
        if not start.any():
            return None
        return self.model.fit(start, self.agreeing(self.leader).astype(float))

    @cached_property
    def checks(self) -> tuple[Array, Array]:
        """Places of check points in both photos, without noise, float64 (n, 2), px: on the plane, or in all of space."""
        depth = 0.0 if self.params.model == "homography" and self.params.depth == 0 else 40.0
        if self.params.source == "photo" and self.params.model == "homography":
            depth = 0.0
        return _scene((self.params.depth or depth) / 100.0, 40, self.params.seed + 1)

    def error(self, matrix: Array | None) -> float:
        """Return the root mean square distance of the check points from a model, px; NaN without one."""
        if matrix is None or not matrix.any():
            return float("nan")
        squares = type(self.model)(*self.checks).squares(matrix[None])[0]
        return float(np.sqrt(np.minimum(squares, 1e6).mean()))
