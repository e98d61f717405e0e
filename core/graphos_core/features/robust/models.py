"""What a robust search looks for: fundamental matrix, essential matrix or homography of one pair of photos.

All three offer the same: the size of the smallest sample, the solutions of many samples at once, the squared distances
of all matches from many solutions, and a fit to weighted matches.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from graphos_core.data import Array
from graphos_core.geometry.eight_point import decompose_essential, eight_point_fundamental
from graphos_core.geometry.five_point import five_point
from graphos_core.geometry.homography import four_point, homography, transfer_squares
from graphos_core.geometry.normalisation import homogeneous, normalise
from graphos_core.geometry.relative_orientation import RayPairs, in_front, refined
from graphos_core.geometry.rotation import skew
from graphos_core.geometry.seven_point import seven_point


class Model(Protocol):
    """A geometric model of the matches of one pair."""

    @property
    def sample(self) -> int:
        """Matches in the smallest sample."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: Array) -> Model: ...

    def solve(self, picks: Array) -> tuple[Array, Array]:
        """Return all solutions (k, 3, 3) of samples (s, m) of matches, and the sample (k,) of each."""

    def squares(self, matrices: Array) -> Array:
        """Return the squared distances, px², of all matches from each of k matrices: (k, n)."""

    def fit(self, start: Array, weights: Array) -> Array | None:
        """Return the matrix that fits all matches best with weights (n,) of their squares; None for none."""


@dataclass(frozen=True)
class FundamentalModel:
    """``x_bᵀ F x_a = 0`` in distortion-free pixels; seven matches (`seven_point`), the distance from the lines."""

    xy_a: Array
    xy_b: Array
    sample: int = 7

    def __len__(self) -> int:
        return len(self.xy_a)

    def __getitem__(self, index: Array) -> FundamentalModel:
        return FundamentalModel(self.xy_a[index], self.xy_b[index])

    @cached_property
    def _normalised(self) -> tuple[Array, Array, Array, Array]:
        return *normalise(self.xy_a), *normalise(self.xy_b)

    @cached_property
    def _terms(self) -> Array:
        """What turns nine elements into ``x_bᵀ F x_a`` and its derivatives by x_a, y_a, x_b, y_b: (5, 9, n)."""
        a, b = homogeneous(self.xy_a), homogeneous(self.xy_b)
        unit = np.eye(3)
        sides = [(b, a), *((b, np.tile(u, (len(a), 1))) for u in unit[:2]), *((np.tile(u, (len(a), 1)), a) for u in unit[:2])]  # fmt: skip
        return np.stack([(left[:, :, None] * right[:, None, :]).reshape(-1, 9).T for left, right in sides])

    def solve(self, picks: Array) -> tuple[Array, Array]:
        """Seven-point solutions, in pixels."""
        a, from_a, b, from_b = self._normalised
        found, which = seven_point(a[picks], b[picks])
        found = from_b.T @ found @ from_a
        return found / np.linalg.norm(found, axis=(1, 2), keepdims=True), which

    def squares(self, matrices: Array) -> Array:
        """Squares of the larger distance of a match from its epipolar line, of both photos."""
        return line_squares(matrices, self._terms)

    def fit(self, start: Array, weights: Array) -> Array | None:
        """Normalised eight points, reweighted by the gradients of the start: Sampson distances (Luong 1996)."""
        used = np.flatnonzero(weights > 0.0)
        if len(used) < 8:
            return None
        matrix = start
        for _ in range(2):
            slopes = np.stack([matrix.ravel() @ term for term in self._terms[1:][:, :, used]])
            found = eight_point_fundamental(
                self.xy_a[used], self.xy_b[used], weights[used] / np.maximum((slopes**2).sum(axis=0), 1e-300)
            )
            if not found:
                return None
            matrix = found.matrix
        return matrix


@dataclass(frozen=True)
class EssentialModel:
    """``y_bᵀ E y_a = 0`` with rays of any camera; five matches (`five_point`), the distance in px of each photo."""

    pairs: RayPairs
    threshold: float
    sample: int = 5

    def __len__(self) -> int:
        return len(self.pairs.a)

    def __getitem__(self, index: Array) -> EssentialModel:
        return EssentialModel(self.pairs[index], self.threshold)

    @cached_property
    def _terms(self) -> Array:
        (ya, spread_a), (yb, spread_b) = self.pairs.tips
        sides = [
            (yb, ya),
            *((yb, spread_a[:, :, p]) for p in (0, 1)),
            *((spread_b[:, :, p], ya) for p in (0, 1)),
        ]
        return np.stack([(b[:, :, None] * a[:, None, :]).reshape(-1, 9).T for b, a in sides])

    def solve(self, picks: Array) -> tuple[Array, Array]:
        """Five-point solutions."""
        return five_point(self.pairs.a.directions[picks], self.pairs.b.directions[picks])

    def squares(self, matrices: Array) -> Array:
        """Squares of the larger distance of a match from its epipolar line, of both photos."""
        return line_squares(matrices, self._terms)

    def fit(self, start: Array, weights: Array) -> Array | None:
        """Gauss–Newton on the Sampson distances over rotation and direction of the base."""
        used = np.flatnonzero(weights > 0.0)
        if len(used) < 6:
            return None
        pairs = self.pairs[used]
        rotation, translation = in_front(decompose_essential(start), pairs, self.threshold)
        rotation, translation = refined(rotation, translation, pairs, weights=weights[used])
        essential = skew(translation) @ rotation
        return np.asarray(essential / np.linalg.norm(essential))


@dataclass(frozen=True)
class HomographyModel:
    """``x_b ∝ H x_a`` in distortion-free pixels; four matches (`four_point`), the distance of the mapped point."""

    xy_a: Array
    xy_b: Array
    sample: int = 4

    def __len__(self) -> int:
        return len(self.xy_a)

    def __getitem__(self, index: Array) -> HomographyModel:
        return HomographyModel(self.xy_a[index], self.xy_b[index])

    @cached_property
    def _normalised(self) -> tuple[Array, Array, Array, Array]:
        return *normalise(self.xy_a), *normalise(self.xy_b)

    def solve(self, picks: Array) -> tuple[Array, Array]:
        """Four-point solutions, in pixels."""
        a, from_a, b, from_b = self._normalised
        found, which = four_point(a[picks], b[picks])
        found = np.linalg.inv(from_b) @ found @ from_a
        return found / np.linalg.norm(found, axis=(1, 2), keepdims=True), which

    def squares(self, matrices: Array) -> Array:
        """Squares of the larger distance of a point from the mapped one, in b or mapped back in a."""
        return np.maximum(*transfer_squares(matrices, self.xy_a, self.xy_b))

    def fit(self, start: Array, weights: Array) -> Array | None:
        """Normalised linear solution, reweighted to transfer distances (`homography`)."""
        used = np.flatnonzero(weights > 0.0)
        if len(used) < 5:
            return None
        return homography(self.xy_a[used], self.xy_b[used], weights[used])


def line_squares(matrices: Array, terms: Array) -> Array:
    """Return the squares (k, n) of the larger distance of each match from its line, px².

    ``(x_bᵀ F x_a)² / min(|∂/∂x_a|², |∂/∂x_b|²)``.

    Parameters
    ----------
    matrices : float64 (k, 3, 3)
    terms : float64 (5, 9, n)
        Coefficients of the misfit and its four derivatives.
    """
    misfit, ax, ay, bx, by = np.asarray(matrices).reshape(-1, 9) @ terms
    return np.asarray(misfit**2 / np.maximum(np.minimum(ax**2 + ay**2, bx**2 + by**2), 1e-300))
