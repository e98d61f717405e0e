r"""Which matches a sample is made of: any at random, or the most distinctive first.

PROSAC (Chum and Matas 2005) takes samples from a growing set of the best matches: the t-th sample consists of the
n-th best match and m − 1 of those before it, where n grows so that after T samples everything is drawn as often as by
plain random sampling.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array

PLAIN_SAMPLES = 200_000
"""T_N: after so many samples PROSAC is plain RANSAC (Chum and Matas 2005, section 2.1)."""


@dataclass
class UniformSampler:
    """Samples of m different matches of n, all alike (Fischler and Bolles 1981)."""

    count: int
    size: int
    rng: np.random.Generator

    def draw(self, number: int) -> Array:
        """Return the next samples, int64 (number, size)."""
        return distinct(self.rng, np.full(number, self.count), self.size)


@dataclass
class ProgressiveSampler:
    """Samples of the best matches first; match 0 is the best."""

    count: int
    size: int
    rng: np.random.Generator
    drawn: int = 0

    def __post_init__(self) -> None:
        self._last = growth(self.count, self.size)

    def draw(self, number: int) -> Array:
        """Return the next samples, int64 (number, size)."""
        t = np.arange(self.drawn + 1, self.drawn + 1 + number)
        self.drawn += number
        reach = self.size + np.searchsorted(self._last, t)  # n of each sample
        late = reach > self.count
        reach = np.minimum(reach, self.count)
        picks = np.empty((number, self.size), np.int64)
        early = np.flatnonzero(~late)
        picks[early, 0] = reach[early] - 1
        picks[early, 1:] = distinct(self.rng, reach[early] - 1, self.size - 1)
        if late.any():
            picks[late] = distinct(self.rng, reach[late], self.size)
        return picks


def growth(count: int, size: int) -> Array:
    """Return up to which sample the n best are used, for n = size, size + 1, … count: T'ₙ, int64.

    ``T_{n+1} = T_n (n+1)/(n+1−m)`` and ``T'_{n+1} = T'_n + ⌈T_{n+1} − T_n⌉`` with ``T'_m = 1`` (Chum and Matas
    2005, equations 3 and 4).
    """
    n = np.arange(size, count + 1, dtype=np.float64)
    share = np.concatenate([[1.0], np.cumprod(n[1:] / (n[1:] - size))])
    mean = PLAIN_SAMPLES * share / share[-1]
    return np.cumsum(np.concatenate([[1.0], np.ceil(np.diff(mean))])).astype(np.int64)


def distinct(rng: np.random.Generator, limits: Array, size: int) -> Array:
    """Return rows of `size` different numbers below each limit, all equally likely, int64 (len(limits), size).

    Rows with a number twice are drawn again.
    """
    picks = rng.integers(0, limits[:, None], (len(limits), size))
    while True:
        ordered = np.sort(picks, axis=1)
        again = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
        if not len(again):
            return picks
        picks[again] = rng.integers(0, limits[again, None], (len(again), size))
