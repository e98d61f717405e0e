"""Dense results."""

from __future__ import annotations

from graphos_core.data.record import Array, record


@record
class DepthMap:
    """The depth of every pixel of one undistorted, reduced photo.

    Attributes
    ----------
    photo : int
        Index of the photo in the block.
    depth : float32 (h, w)
        z in the camera frame, in the block's unit; NaN where unknown.
    confidence : float32 (h, w)
        Matching score of the winner, 0 to 1 (higher is better).
    focal_px, cx, cy : float
        Distortion-free camera of this map, px of the map.
    neighbours : tuple of int
        Photos it was matched with.
    """

    photo: int
    depth: Array
    confidence: Array
    focal_px: float
    cx: float
    cy: float
    neighbours: tuple[int, ...] = ()


@record
class Cloud:
    """A point cloud.

    Attributes
    ----------
    points : float64 (n, 3)
        Coordinates in `unit`.
    colours : uint8 (n, 3)
        RGB.
    normals : float32 (n, 3)
        Unit normals towards the cameras; zero rows where unknown; shape (0, 3) where there are none.
    views : uint8 (n,)
        Photos in which the point was confirmed; shape (0,) where unknown.
    unit : str
    """

    points: Array
    colours: Array
    normals: Array
    views: Array
    unit: str = "model units"


@record
class Mesh:
    """A triangle mesh.

    Attributes
    ----------
    vertices : float64 (v, 3)
        Coordinates in `unit`.
    triangles : int32 (t, 3)
        Vertex indices, counter-clockwise seen from outside.
    unit : str
    """

    vertices: Array
    triangles: Array
    unit: str = "m"
