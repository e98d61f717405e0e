"""Ground control, known distances, and how they placed the block."""

from __future__ import annotations

from graphos_core.data.record import Array, record


@record
class Control:
    """Control and check points in object space.

    Attributes
    ----------
    names : tuple of str
    xyz : float64 (n, 3)
        Coordinates, m, in the control frame (less `origin`).
    check : bool (n,)
        True for a check point, which never takes part.
    origin : float64 (3,)
        Local origin subtracted from large coordinates, m.
    """

    names: tuple[str, ...]
    xyz: Array
    check: Array
    origin: Array


@record
class ControlObservations:
    """Image measurements of control points.

    Attributes
    ----------
    point : int32 (m,)
        Index into `Control.names`.
    photo : tuple of str
        Name of the photo of each measurement.
    xy : float64 (m, 2)
        Measured position, px.
    """

    point: Array
    photo: tuple[str, ...]
    xy: Array


@record
class KnownDistance:
    """A known distance between two points measured in the photos.

    Attributes
    ----------
    a, b : str
        Names of two points of the control observations, or of two photos (distance of projection centres).
    metres : float
    """

    a: str
    b: str
    metres: float


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
