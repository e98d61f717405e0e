"""Matches between photos."""

from __future__ import annotations

from dataclasses import field

import numpy as np

from graphos_core.data.record import Array, check_indices, check_shape, record


@record
class PairSelection:
    """The pairs of photos that are matched.

    Attributes
    ----------
    pairs : int32 (n, 2)
        Photo indices a < b, sorted.
    score : float32 (n,)
        Why each was chosen, in the unit of the method (shared points, similarity, metres); NaN where all are taken.
    possible : int
        Pairs there would be if every photo met every other.
    said : str
        One sentence on how they were chosen.
    """

    pairs: Array
    score: Array
    possible: int
    said: str = ""

    def check_arrays(self) -> None:
        """Raise `ValueError` when arrays do not belong together; called on what was read from disk."""
        check_shape("pairs", self.pairs, None, 2)
        check_shape("scores of pairs", self.score, len(self.pairs))


@record
class Candidates:
    """Matches of one pair before verification, with what the matcher knows about each.

    Attributes
    ----------
    matches : int32 (n, 2)
        Feature indices in a and b, sorted by the first.
    distance : float32 (n,)
        Between the descriptors, in their metric.
    ratio : float32 (n,)
        Distance of the nearest through that of the second nearest (seen from a), 0 to 1: small is distinctive; 1
        where there is no second.
    steps : tuple of (str, int)
        What was left after each step of the matcher, in order: ``(("nearest", 8192), ("ratio", 2711), …)``.
    """

    matches: Array
    distance: Array
    ratio: Array
    steps: tuple[tuple[str, int], ...] = ()

    def __len__(self) -> int:
        return len(self.matches)

    @classmethod
    def of(cls, matches: Array) -> Candidates:
        """Return matches int32 (n, 2) of which nothing else is known: distance 0, ratio 1."""
        n = len(matches)
        return cls(matches=matches, distance=np.zeros(n, np.float32), ratio=np.ones(n, np.float32))

    @classmethod
    def none(cls, steps: tuple[tuple[str, int], ...] = ()) -> Candidates:
        """Return no candidates."""
        empty = np.zeros(0, np.float32)
        return cls(matches=np.zeros((0, 2), np.int32), distance=empty, ratio=empty, steps=steps)


@record
class PairMatches:
    """Verified matches of one pair of photos, or the reason why there are none.

    Attributes
    ----------
    a, b : int
        Indices of the two photos, a < b.
    matches : int32 (n, 2)
        Feature indices in a and b of the verified matches.
    candidates : int
        Matches before verification.
    kind : {"essential", "fundamental", "homography", "none"}
        Which matrix was estimated.
    matrix : float64 (3, 3)
        ``x_bᵀ F x_a = 0`` in px for a fundamental matrix; the same with rays in the camera frames
        (``y_bᵀ E y_a = 0``) for an essential matrix; ``x_b ∝ H x_a`` in px for a
        homography; zeros where none.
    threshold_px : float
        Largest distance from the epipolar line (homography: from the mapped point) of a verified match, px.
    reason : str
        Why the pair is not used; empty where it is.
    ratio : float32 (n,)
        `Candidates.ratio` of each verified match; empty where unknown.
    scene : {"", "general", "planar", "rotation"}
        What the geometry of the matches says: space is seen from two places; only a plane is seen; the camera only
        turned, so that the pair determines no object points. Empty where nobody asked.
    steps : tuple of (str, int)
        The funnel: what was left after each step from nearest neighbours to the matches kept.
    """

    a: int
    b: int
    matches: Array
    candidates: int
    kind: str
    matrix: Array
    threshold_px: float = 0.0
    reason: str = ""
    ratio: Array = field(default_factory=lambda: np.zeros(0, np.float32))
    scene: str = ""
    steps: tuple[tuple[str, int], ...] = ()


@record
class Tracks:
    """Features joined over photos: each track is one object point seen in several photos.

    Attributes
    ----------
    photo, feature, track : int32 (m,)
        Observation i is feature ``feature[i]`` of photo ``photo[i]`` and belongs to track ``track[i]``. Sorted by
        track, then photo; at most one observation per track and photo.
    xy : float64 (m, 2)
        Measured position, px of the full photo.
    colour : uint8 (t, 3)
        RGB of each track.
    count : int
        Number of tracks t.
    conflicts : int
        Tracks dropped or cut because they had two features in one photo.
    components : tuple of tuple of int
        Photos that hang together by verified pairs, largest group first.
    """

    photo: Array
    feature: Array
    track: Array
    xy: Array
    colour: Array
    count: int
    conflicts: int = 0
    components: tuple[tuple[int, ...], ...] = ()

    def check_arrays(self) -> None:
        """Raise `ValueError` when arrays do not belong together; called on what was read from disk."""
        m = len(self.track)
        check_shape("photos of tracks", self.photo, m)
        check_shape("features of tracks", self.feature, m)
        check_shape("positions of tracks", self.xy, m, 2)
        check_shape("colours of tracks", self.colour, self.count, 3)
        check_indices("tracks", self.track, self.count)
        check_indices("photos", self.photo, 2**31)
