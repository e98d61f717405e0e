"""Who was oriented on whom."""

from __future__ import annotations

from graphos_core.data.record import Array, check_indices, check_shape, record


@record
class OrientationTree:
    """The order in which the photos of a block were oriented, and what each was oriented on.

    Attributes
    ----------
    photo : int32 (k,)
        Photos in the order in which they were oriented.
    on : tuple of tuple of int
        For each of them the photos it was oriented on: the neighbour of a relative orientation, or the photos that
        see most of the points of a resection, those with most points first; empty for the first photo.
    method : tuple of str
        How, in words.
    points : int32 (k,)
        Points that agreed.
    rms_px : float64 (k,)
        Root mean square distance (2-D) of those points when the photo was added, px; NaN where there is none.
    """

    photo: Array
    on: tuple[tuple[int, ...], ...]
    method: tuple[str, ...]
    points: Array
    rms_px: Array

    def check_arrays(self) -> None:
        """Raise `ValueError` when arrays do not belong together; called on what was read from disk."""
        check_shape("points of the tree", self.points, len(self.photo))
        check_shape("distances of the tree", self.rms_px, len(self.photo))
        check_indices("photos of the tree", self.photo, 2**31)
        if not len(self.on) == len(self.method) == len(self.photo):
            raise ValueError("a tree whose parts have different lengths")

    def parents(self) -> dict[int, tuple[int, ...]]:
        """Return for each photo the photos it was oriented on."""
        return {int(photo): on for photo, on in zip(self.photo, self.on, strict=True)}
