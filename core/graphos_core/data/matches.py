"""Matches between photos."""

from __future__ import annotations

from graphos_core.data.record import Array, check_indices, check_shape, record


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
    kind : {"essential", "fundamental", "none"}
        Which matrix was estimated.
    matrix : float64 (3, 3)
        ``x_bᵀ F x_a = 0`` in px for a fundamental matrix; the same with rays in the camera frames
        (``y_bᵀ E y_a = 0``) for an essential matrix; zeros where none.
    threshold_px : float
        Largest distance from the epipolar line of a verified match, px.
    reason : str
        Why the pair is not used; empty where it is.
    """

    a: int
    b: int
    matches: Array
    candidates: int
    kind: str
    matrix: Array
    threshold_px: float = 0.0
    reason: str = ""


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
