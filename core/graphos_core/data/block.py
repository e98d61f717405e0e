"""The oriented block and its adjustment."""

from __future__ import annotations

from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array, check_indices, check_shape, record
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
    unit : str
        ``"m"`` after georeferencing or scaling, ``"model units"`` before.
    failures : tuple of ItemFailure
        Photos that could not be oriented, with reasons.
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
    unit: str = "model units"
    failures: tuple[ItemFailure, ...] = ()

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
        check_indices("cameras", self.camera_of_photo, len(self.cameras))
        check_indices("photos", self.obs_photo, n)
        check_indices("points", self.obs_point, p)


@record
class IterationRecord:
    """One iteration of the adjustment.

    Attributes
    ----------
    iteration : int
    cost : float
        ½ Σ ρ(r²) in px², robustly weighted as adjusted.
    step : float
        Norm of the parameter step relative to the norm of the parameters.
    damping : float
        Levenberg–Marquardt damping λ.
    gradient : float
        Largest element of the gradient, absolute.
    accepted : bool
    """

    iteration: int
    cost: float
    step: float
    damping: float
    gradient: float
    accepted: bool


@record
class Adjustment:
    """An adjusted block with its statistics.

    Attributes
    ----------
    block : Block
        Adjusted; its cameras carry `Camera.sigmas`.
    sigma0_px : float
        A posteriori standard deviation of unit weight (1 px a priori), ``sqrt(vᵀPv / r)``, px.
    redundancy : int
        observations − unknowns + datum conditions.
    observations, unknowns : int
        Numbers in the least-squares sense: two per image point; datum defect not subtracted.
    datum : str
        How the datum was defined, in words.
    rms_px : float
        Root mean square of the image residuals per coordinate, over all observations, px of the full photo.
    residuals : float64 (m, 2)
        Projected − measured, px, in the order of the block's observations.
    weights : float64 (m,)
        Final robust weight of each observation, 0 to 1.
    sigma_rotations : float64 (n, 3)
        Standard deviations of small rotations about the camera's x, y, z axes, radians; 0 where not oriented.
    sigma_centres : float64 (n, 3)
        Standard deviations of the projection centres, in the block's unit; 0 where not oriented.
    sigma_points : float64 (p, 3)
        Standard deviations of the object points, in the block's unit.
    iterations : tuple of IterationRecord
    converged : bool
    stop_reason : str
    """

    block: Block
    sigma0_px: float
    redundancy: int
    observations: int
    unknowns: int
    datum: str
    rms_px: float
    residuals: Array
    weights: Array
    sigma_rotations: Array
    sigma_centres: Array
    sigma_points: Array
    iterations: tuple[IterationRecord, ...]
    converged: bool
    stop_reason: str
