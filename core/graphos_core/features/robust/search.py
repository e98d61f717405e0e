r"""Random sample consensus with exchangeable parts: sampler, cost and model.

Samples are drawn, solved and scored in small batches; a new best is fitted again to the matches that agree with it
(local optimisation, Chum, Matas and Kittler 2003). The search ends when a sample without a wrong match is as good as
certain (`samples_needed`). The final matrix is fitted to all that agree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from graphos_core.data import Array
from graphos_core.features.robust.models import Model
from graphos_core.features.robust.samplers import ProgressiveSampler, UniformSampler
from graphos_core.features.robust_scores import COSTS, magsac_weight, robust_sigma
from graphos_core.geometry.consensus import samples_needed

Method = Literal["ransac", "msac", "lmeds", "prosac", "magsac"]

BATCH = 20
"""Samples solved and scored together."""

SCORED = 500
"""At most so many matches, chosen at random, decide about a sample; the final fit uses all."""

FITS = 4
"""Rounds of fitting to what agrees."""

LMEDS_REACH = 2.5
"""LMedS: a match agrees within so many robust standard deviations (Rousseeuw and Leroy 1987, section 5.1)."""

SMALLEST_SIGMA = 1e-6
"""px; keeps a median of zero from rejecting everything."""

CHANCE = 0.05
"""PROSAC: probability that a match agrees with a wrong model, and of taking chance for structure (sections 2.2)."""


@dataclass(frozen=True)
class Improvement:
    """One improvement during a search: after how many samples, its cost, what agreed, how many samples it takes."""

    sample: int
    cost: float
    agreeing: int
    needed: float


@dataclass(frozen=True)
class Consensus:
    """Result of a search; false in a condition when no sample had a solution.

    Attributes
    ----------
    matrix : float64 (3, 3)
    squares : float64 (n,)
        Squared distance of every match from the matrix, px².
    inliers : bool (n,)
    threshold : float
        px; given, or with LMedS estimated.
    samples : int
        How many were drawn.
    trace : tuple of Improvement
    """

    matrix: Array
    squares: Array
    inliers: Array
    threshold: float
    samples: int
    trace: tuple[Improvement, ...]

    def __bool__(self) -> bool:
        return bool(self.matrix.any())


def search(
    model: Model, method: Method, threshold: float, *, confidence: float, most: int, seed: int
) -> Consensus:
    """Search the matrix that most matches agree with.

    Parameters
    ----------
    model : Model
        With the n matches; for PROSAC in the order of their quality, best first.
    method : {"ransac", "msac", "lmeds", "prosac", "magsac"}
    threshold : float
        Largest distance of an inlier, px; LMedS estimates its own.
    confidence : float
        Probability that a sample without a wrong match was drawn.
    most : int
        Largest number of samples.
    seed : int
    """
    count = len(model)
    nothing = Consensus(np.zeros((3, 3)), np.full(count, np.inf), np.zeros(count, bool), threshold, 0, ())
    if count <= model.sample:
        return nothing
    rng = np.random.default_rng(seed)
    sampler = (ProgressiveSampler if method == "prosac" else UniformSampler)(count, model.sample, rng)
    scored = model if count <= SCORED else model[np.sort(rng.permutation(count)[:SCORED])]
    best, lowest, needed, drawn = None, math.inf, float(most), 0
    trace: list[Improvement] = []
    while drawn < min(needed, most):
        picks = sampler.draw(BATCH)
        drawn += BATCH
        found, _ = model.solve(picks)
        found = found[np.isfinite(found).all(axis=(1, 2))]
        if not len(found):
            continue
        costs = COSTS[method](scored.squares(found), threshold)
        winner = int(np.argmin(costs))
        if not costs[winner] < lowest:
            continue
        best, lowest = _improved(scored, method, threshold, found[winner], float(costs[winner]))
        squares = scored.squares(best[None])[0]
        reach = _reach(method, squares, threshold, model.sample)
        good = squares <= reach**2
        needed = _needed(method, model, best, good, reach, confidence)
        trace.append(Improvement(drawn, lowest, int(good.sum()), needed))
    if best is None:
        return replace(nothing, samples=drawn)
    return _finished(model, method, threshold, best, drawn, tuple(trace))


def _reach(method: Method, squares: Array, threshold: float, sample: int) -> float:
    """Return the largest distance of an inlier, px."""
    if method != "lmeds":
        return threshold
    return LMEDS_REACH * max(robust_sigma(squares, sample), SMALLEST_SIGMA)


def _weights(method: Method, squares: Array, threshold: float, sample: int) -> Array:
    if method == "magsac":
        return magsac_weight(squares, threshold)
    return np.asarray(squares <= _reach(method, squares, threshold, sample) ** 2, dtype=np.float64)


def _improved(
    scored: Model, method: Method, threshold: float, matrix: Array, cost: float
) -> tuple[Array, float]:
    """Fit again to what agrees, as long as the cost falls."""
    for _ in range(FITS):
        weights = _weights(method, scored.squares(matrix[None])[0], threshold, scored.sample)
        fitted = scored.fit(matrix, weights)
        if fitted is None:
            break
        new = float(COSTS[method](scored.squares(fitted[None])[0], threshold))
        if not new < cost:
            break
        matrix, cost = fitted, new
    return matrix, cost


def _finished(
    model: Model, method: Method, threshold: float, matrix: Array, drawn: int, trace: tuple[Improvement, ...]
) -> Consensus:
    """Fit to all matches that agree and tell which do."""
    cost = float(COSTS[method](model.squares(matrix[None])[0], threshold))
    matrix, _ = _improved(model, method, threshold, matrix, cost)
    squares = model.squares(matrix[None])[0]
    reach = _reach(method, squares, threshold, model.sample)
    return Consensus(matrix, squares, squares <= reach**2, reach, drawn, trace)


def _needed(
    method: Method, model: Model, matrix: Array, good: Array, reach: float, confidence: float
) -> float:
    if method == "lmeds":  # made for half outliers, whatever was found
        return samples_needed(0.5, model.sample, confidence)
    if method == "prosac":
        agreeing = model.squares(matrix[None])[0] <= reach**2
        return samples_needed_in_order(agreeing, model.sample, confidence)
    return samples_needed(float(good.mean()), model.sample, confidence)


def samples_needed_in_order(agreeing: Array, size: int, confidence: float) -> float:
    """Return how many samples PROSAC needs: the least over all sets of n best matches (Chum and Matas 2005, 2.2).

    A set counts when more of it agree than by chance: ``I_n ≥ m + βn + 1.645 √(n β (1−β))`` (non-randomness, normal
    approximation), and needs ``ln(1−p) / ln(1 − Π (I_n − j)/(n − j))`` samples (maximality).

    Parameters
    ----------
    agreeing : bool (n,)
        In the order of quality.
    size : int
        m.
    confidence : float
        p.
    """
    n = np.arange(1, len(agreeing) + 1, dtype=np.float64)
    inliers = np.cumsum(agreeing)
    chance = size + CHANCE * n + 1.645 * np.sqrt(n * CHANCE * (1.0 - CHANCE))
    fit = (inliers >= chance) & (n > size)
    if not fit.any():
        return math.inf
    share = np.ones(int(fit.sum()))
    for j in range(size):
        share *= (inliers[fit] - j) / (n[fit] - j)
    clean = min(float(share.max()), 1.0)
    return samples_needed(clean, 1, confidence)
