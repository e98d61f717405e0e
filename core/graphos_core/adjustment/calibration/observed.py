"""What was measured of the test field in one photo."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array, record


@record
class TargetObservations:
    """Measured points of the test field in one photo; false in a condition when it was not found.

    Attributes
    ----------
    photo : str
        Name of the photo.
    point : int32 (m,)
        Index into the board's points.
    xy : float64 (m, 2)
        Measured position, px.
    sigma : float64 (m,)
        Standard deviation of each coordinate from the grey values around the point, px.
    area : float64 (m,)
        Area of each circle, px²; zero of corners.
    mirrored : bool
        Whether the board is the mirror image of its description (shifted circles).
    reason : str
        Why nothing was measured; empty where something was.
    """

    photo: str
    point: Array
    xy: Array
    sigma: Array
    area: Array
    mirrored: bool = False
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason


def nothing(photo: str, reason: str) -> TargetObservations:
    """Return the observations of a photo in which the test field was not found, with the reason."""
    none = np.zeros(0)
    return TargetObservations(
        photo=photo, point=np.zeros(0, np.int32), xy=np.zeros((0, 2)), sigma=none, area=none, reason=reason
    )
