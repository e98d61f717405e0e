"""What is known about the object: control, distances, positions and attitudes of photos, shapes, rigs."""

from __future__ import annotations

from graphos_core.data.record import Array, check_shape, record


@record
class Control:
    """Control and check points in object space.

    Attributes
    ----------
    names : tuple of str
    xyz : float64 (n, 3)
        Coordinates, m, in the control frame (less `origin`); NaN on an axis that is not known.
    check : bool (n,)
        True for a check point, which never takes part.
    origin : float64 (3,)
        Local origin subtracted from large coordinates, m.
    sigma : float64 (n, 3) or None
        A priori standard deviations, m; 0 holds a point fixed, NaN takes the default of the adjustment. None: all NaN.
    off : bool (n,) or None
        True for a point that is switched off: neither control nor check.
    crs : str
        Coordinate system the coordinates were given in, such as ``"EPSG:25832"``; empty for a local one.
    """

    names: tuple[str, ...]
    xyz: Array
    check: Array
    origin: Array
    sigma: Array | None = None
    off: Array | None = None
    crs: str = ""

    def check_arrays(self) -> None:
        """Raise `ValueError` when arrays do not belong together; called on what was read from disk."""
        n = len(self.names)
        check_shape("control points", self.xyz, n, 3)
        check_shape("roles of control points", self.check, n)
        if self.sigma is not None:
            check_shape("standard deviations of control points", self.sigma, n, 3)


@record
class ControlObservations:
    """Image measurements of control points and of other named points.

    Attributes
    ----------
    point : int32 (m,)
        Index into `Control.names`.
    photo : tuple of str
        Name of the photo of each measurement.
    xy : float64 (m, 2)
        Measured position, px.
    sigma_px : float64 (m,) or None
        A priori standard deviation per coordinate, px; NaN takes the default of the adjustment. None: all NaN.
    """

    point: Array
    photo: tuple[str, ...]
    xy: Array
    sigma_px: Array | None = None


@record
class KnownDistance:
    """A known distance between two named points measured in the photos, or two projection centres.

    Attributes
    ----------
    a, b : str
        Names of two points of the control observations, or of two photos (distance of projection centres).
    metres : float
    sigma : float or None
        A priori standard deviation, m; None takes the default of the adjustment.
    check : bool
        True for a distance that takes no part and only checks the scale.
    """

    a: str
    b: str
    metres: float
    sigma: float | None = None
    check: bool = False


@record
class KnownCentres:
    """Positions of photos, as a GNSS receiver gives them.

    Attributes
    ----------
    photo : tuple of str
    xyz : float64 (k, 3)
        Position of the antenna, m, in the control frame (less its origin).
    sigma : float64 (k, 3)
        A priori standard deviations, m.
    lever_arm : float64 (3,)
        Antenna in the camera frame (x right, y down, z forward), m: ``xyz = C + Rᵀ lever_arm``.
    lever_arm_free : bool
        Whether the lever arm is estimated from this start value.
    """

    photo: tuple[str, ...]
    xyz: Array
    sigma: Array
    lever_arm: Array
    lever_arm_free: bool = False


@record
class KnownAttitudes:
    """Attitudes of photos, as an inertial system gives them.

    Attributes
    ----------
    photo : tuple of str
    rotations : float64 (k, 3, 3)
        ``body_from_world``; where the boresight is the identity this is ``cam_from_world``.
    sigma : float64 (k, 3)
        A priori standard deviations of small rotations about the axes of the body, radians.
    boresight : float64 (3, 3)
        ``cam_from_body``.
    boresight_free : bool
        Whether the boresight is estimated from this start value.
    """

    photo: tuple[str, ...]
    rotations: Array
    sigma: Array
    boresight: Array
    boresight_free: bool = False


@record
class KnownShape:
    """Named points that lie on a shape.

    Attributes
    ----------
    kind : str
        ``"horizontal plane"`` (one Z, unknown unless `value` gives it), ``"plane"``, ``"line"``, ``"vertical line"``,
        ``"x axis"``, ``"y axis"``, ``"z axis"`` (from the first point to the second the direction is that axis).
    points : tuple of str
        Names of points of the control observations.
    sigma : float
        A priori standard deviation of a point's distance from the shape, m (or the block's unit).
    value : float or None
        Known Z of a horizontal plane.
    name : str
    """

    kind: str
    points: tuple[str, ...]
    sigma: float
    value: float | None = None
    name: str = ""


@record
class KnownRig:
    """Photos taken at one moment by cameras that are fixed to each other.

    Attributes
    ----------
    photos : tuple of tuple of str
        One tuple per moment with the photo of each camera, in the same order; ``""`` where one is missing. The
        first camera is the reference.
    rotations : float64 (c, 3, 3)
        ``cam_from_reference`` of each camera; start values where `free`.
    centres : float64 (c, 3)
        Projection centre of each camera in the frame of the reference camera, in the block's unit.
    sigma_rotation : float
        How rigid it is: standard deviation of a small rotation between two moments, radians.
    sigma_centre : float
        The same of a centre, in the block's unit.
    free : bool
        Whether the relative orientation is estimated.
    name : str
    """

    photos: tuple[tuple[str, ...], ...]
    rotations: Array
    centres: Array
    sigma_rotation: float
    sigma_centre: float
    free: bool = True
    name: str = ""


@record
class Known:
    """Everything known about the object beside the photos; nothing at all by default.

    Attributes
    ----------
    control : Control or None
    measured : ControlObservations or None
    distances : tuple of KnownDistance
    centres : KnownCentres or None
    attitudes : KnownAttitudes or None
    shapes : tuple of KnownShape
    rigs : tuple of KnownRig
    """

    control: Control | None = None
    measured: ControlObservations | None = None
    distances: tuple[KnownDistance, ...] = ()
    centres: KnownCentres | None = None
    attitudes: KnownAttitudes | None = None
    shapes: tuple[KnownShape, ...] = ()
    rigs: tuple[KnownRig, ...] = ()


@record
class Georeference:
    """The similarity that placed the block, and what is left over.

    Attributes
    ----------
    method : str
        ``"none"``, ``"control points"`` or ``"known distance"``.
    scale : float
        Metres per model unit.
    rotation : float64 (3, 3)
        ``world_from_model``.
    translation : float64 (3,)
        ``X_world = scale · rotation · X_model + translation``, m.
    names : tuple of str
        Control and check points that could be computed from two photos or more.
    check : bool (k,)
    residuals : float64 (k, 3)
        Computed − given, m.
    rms_m : float
        Per coordinate, over control points; NaN where there are none.
    check_rms_m : float
        Per coordinate, over check points; NaN where there are none.
    origin : float64 (3,)
        Local origin of the world coordinates, m.
    """

    method: str
    scale: float
    rotation: Array
    translation: Array
    names: tuple[str, ...]
    check: Array
    residuals: Array
    rms_m: float
    check_rms_m: float
    origin: Array
