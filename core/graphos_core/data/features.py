"""Keypoints and descriptors of one photo."""

from __future__ import annotations

from graphos_core.data.record import Array, record


@record
class Features:
    """Keypoints of one photo, in pixels of the full upright photo.

    Attributes
    ----------
    xy : float32 (n, 2)
        Positions, px, centre of the top-left pixel is (0, 0).
    scale : float32 (n,)
        Diameter of the meaningful neighbourhood, px.
    angle : float32 (n,)
        Orientation, radians, from x towards y (clockwise on the screen), −π to π.
    response : float32 (n,)
        Strength given by the detector.
    descriptors : uint8 or float32 (n, d)
    colour : uint8 (n, 3)
        RGB of the pixel under the keypoint.
    width, height : int
        Size of the photo, px.
    found : int
        How many the detector found before the number was limited.
    metric : {"l2", "hamming"}
        How descriptors compare: Euclidean distance, or number of different bits (uint8 bytes of binary descriptors).
    """

    xy: Array
    scale: Array
    angle: Array
    response: Array
    descriptors: Array
    colour: Array
    width: int
    height: int
    found: int = 0
    metric: str = "l2"
