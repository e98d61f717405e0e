"""The oriented block."""

from __future__ import annotations

from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array, check_indices, check_shape, record
from graphos_core.data.tree import OrientationTree
from graphos_core.errors import ItemFailure


@record
class Block:
    """Cameras, exterior orientations, object points and observations in one object frame.

    Attributes
    ----------
    cameras : tuple of Camera
    names : tuple of str
        Names of all n photos of the project, oriented or not.
    camera_of_photo : int32 (n,)
        Index into `cameras`.
    oriented : bool (n,)
    rotations : float64 (n, 3, 3)
        ``cam_from_world``: ``p_cam = R (X − C)``; identity where not oriented.
    centres : float64 (n, 3)
        Projection centres C in the object frame, in `unit`; zero where not oriented.
    points : float64 (p, 3)
        Object points in the object frame, in `unit`.
    colours : uint8 (p, 3)
        RGB of each object point.
    point_track : int32 (p,)
        Track from which each point came; −1 where it came from elsewhere.
    obs_photo, obs_point : int32 (m,)
        Observation i is point ``obs_point[i]`` seen in photo ``obs_photo[i]``; sorted by point, then photo;
        no pair occurs twice.
    obs_xy : float64 (m, 2)
        Measured position, px.
    obs_sigma_px : float64 (m,) or None
        A priori standard deviation of each observation per coordinate, px; None where all are alike (1 px).
    unit : str
        ``"m"`` after georeferencing or scaling, ``"model units"`` before.
    failures : tuple of ItemFailure
        Photos that could not be oriented, with reasons.
    tree : OrientationTree or None
        Who was oriented on whom, where the orientation is known to have grown.
    others : tuple of Block
        Blocks of photos that could not be connected with this one, each in a frame of its own, largest first.
    """

    cameras: tuple[Camera, ...]
    names: tuple[str, ...]
    camera_of_photo: Array
    oriented: Array
    rotations: Array
    centres: Array
    points: Array
    colours: Array
    point_track: Array
    obs_photo: Array
    obs_point: Array
    obs_xy: Array
    obs_sigma_px: Array | None = None
    unit: str = "model units"
    failures: tuple[ItemFailure, ...] = ()
    tree: OrientationTree | None = None
    others: tuple[Block, ...] = ()

    def check_arrays(self) -> None:
        """Raise `ValueError` when arrays do not belong together; called on what was read from disk."""
        n, p, m = len(self.names), len(self.points), len(self.obs_photo)
        check_shape("rotations", self.rotations, n, 3, 3)
        check_shape("projection centres", self.centres, n, 3)
        check_shape("flags", self.oriented, n)
        check_shape("cameras of photos", self.camera_of_photo, n)
        check_shape("points", self.points, p, 3)
        check_shape("colours", self.colours, p, 3)
        check_shape("tracks", self.point_track, p)
        check_shape("photos of observations", self.obs_photo, m)
        check_shape("points of observations", self.obs_point, m)
        check_shape("observations", self.obs_xy, m, 2)
        if self.obs_sigma_px is not None:
            check_shape("standard deviations of observations", self.obs_sigma_px, m)
        check_indices("cameras", self.camera_of_photo, len(self.cameras))
        check_indices("photos", self.obs_photo, n)
        check_indices("points", self.obs_point, p)
