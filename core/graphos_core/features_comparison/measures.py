"""Counts against a known homography: what is right, what is repeated.

Source: Mikolajczyk and Schmid 2005, A performance evaluation of local descriptors (precision, matching score);
Mikolajczyk et al. 2005, A comparison of affine region detectors (repeatability), simplified: two points correspond when
their positions do, whatever the shape of their regions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from graphos_core.data import Array, Features
from graphos_core.features_comparison.truth import mapped

RIGHT_PX = 3.0
"""A match is right when the mapped point of photo 1 is nearer than this to its partner in photo 2."""

CELL_PX = 2.0
"""Side of the cells of photo 1 in which several right matches count once."""

REPEATED_PX = 1.5
"""A point is repeated when a point of the other photo lies so near (Schmid, Mohr and Bauckhage 2000)."""


@dataclass(frozen=True)
class AgainstTruth:
    """Counts of a pair with known homography.

    Attributes
    ----------
    matches, correct_3px : int
        Matches of the matcher, before verification, and those of them that are right.
    correct_cells_2px : int
        Cells of photo 1 with a right match.
    common : int
        The smaller of the two numbers of distinct points in the part that both photos show.
    repeated : int
        Points of that part that have a partner by position, one to one.
    """

    matches: int
    correct_3px: int
    correct_cells_2px: int
    common: int
    repeated: int

    @property
    def repeatability(self) -> float | None:
        """Repeated points of all in the common part; None where there are none."""
        return self.repeated / self.common if self.common else None

    @property
    def precision(self) -> float | None:
        """Right matches of all matches; None where there are none."""
        return self.correct_3px / self.matches if self.matches else None

    @property
    def matching_score(self) -> float | None:
        """Right matches, once per cell, of all points in the common part; None where there are none."""
        return min(1.0, self.correct_cells_2px / self.common) if self.common else None


def against_truth(a: Features, b: Features, matches: Array, homography: Array) -> AgainstTruth:
    """Count what is right in the matches of a pair.

    Parameters
    ----------
    a, b : Features
        Of photo 1 and photo 2.
    matches : int32 (n, 2)
        Candidate matches: indices in a and b.
    homography : float64 (3, 3)
        From photo 1 to photo 2, px.
    """
    right = right_matches(a, b, matches, homography)
    repeated, common = repeated_points(a, b, homography)
    return AgainstTruth(
        matches=len(matches),
        correct_3px=int(right.sum()),
        correct_cells_2px=occupied_cells(a.xy[matches[right, 0]]),
        common=common,
        repeated=repeated,
    )


def right_matches(
    a: Features, b: Features, matches: Array, homography: Array, tolerance: float = RIGHT_PX
) -> Array:
    """Return which matches are nearer than `tolerance`, px of photo 2, to the truth; bool (n,)."""
    xy, _ = mapped(homography, a.xy[matches[:, 0]].astype(np.float64), (b.width, b.height))
    return np.asarray(np.linalg.norm(xy - b.xy[matches[:, 1]], axis=1) < tolerance)


def occupied_cells(xy: Array, side: float = CELL_PX) -> int:
    """Return how many square cells of a photo hold a point, so that points at one place count once."""
    return len(np.unique(np.floor((xy.astype(np.float64) + 0.5) / side).astype(np.int64), axis=0))


def repeated_points(
    a: Features, b: Features, homography: Array, tolerance: float = REPEATED_PX
) -> tuple[int, int]:
    """Return how many points correspond by position, and the smaller number of points in the common part.

    Points at one place (several directions, several levels) count once. Correspondences are one to one: each point is
    the nearest of the other, at most `tolerance` px of photo 2 apart. The more points there are, the more correspond
    by chance: compare detectors with about the same number of points.
    """
    first, second = _places(a), _places(b)
    there, visible = mapped(homography, first, (b.width, b.height))
    _, seen = mapped(np.linalg.inv(homography), second, (a.width, a.height))
    there, second = there[visible], second[seen]
    common = min(len(there), len(second))
    if common == 0:
        return 0, 0
    away, partner = cKDTree(second).query(there)
    _, back = cKDTree(there).query(second)
    mutual = back[partner] == np.arange(len(there))
    return int((mutual & (away <= tolerance)).sum()), common


def _places(features: Features) -> Array:
    """Return the distinct positions, to a hundredth of a pixel, float64 (n, 2)."""
    return np.unique(np.round(features.xy.astype(np.float64), 2), axis=0)
