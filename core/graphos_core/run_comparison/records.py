"""What a comparison of two adjustments consists of; differences are always B − A."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class ParameterDifference:
    """A choice or parameter that differs: ``where`` is ``"adjustment.schur"``; None where the algorithm is not used."""

    where: str
    parameter: str
    label: str
    unit: str
    a: Any
    b: Any


@dataclass(frozen=True)
class NumberDifference:
    """A figure of both adjustments with its definition; `better` is "a", "b" or "" (no better or worse, or alike)."""

    key: str
    label: str
    unit: str
    a: float | None
    b: float | None
    definition: str
    better: str = ""


@dataclass(frozen=True)
class CameraParameterDifference:
    """One parameter of one camera.

    Attributes
    ----------
    camera, name, symbol, label, unit : str
    a, sigma_a, b, sigma_b : float or None
        None where the model has no such parameter; a σ of None where it was held fixed.
    difference : float or None
        B − A.
    sigma : float or None
        ``sqrt(σ_A² + σ_B²)``, as if the two were independent. They share observations, so this is on the safe side.
    significant : bool or None
        |difference| > 1.96 σ (5 %); None where no σ is known.
    """

    camera: str
    name: str
    symbol: str
    label: str
    unit: str
    a: float | None
    sigma_a: float | None
    b: float | None
    sigma_b: float | None
    difference: float | None
    sigma: float | None
    significant: bool | None


@dataclass(frozen=True)
class CalibrationDifference:
    """How far the two calibrations of a camera put the same rays apart, px, after the best common rotation."""

    camera: str
    rms_px: float
    largest_px: float


@dataclass(frozen=True)
class PhotoDifference:
    """A photo oriented in both.

    Attributes
    ----------
    name : str
    centre : tuple of float
        B − A, in A's frame and unit.
    sigma_centre : tuple of float
        ``sqrt(σ_A² + σ_B²)`` per axis; 0 where not known.
    rotation_deg : float
        Angle of the rotation from A to B.
    rms_a_px, rms_b_px : float
        Residual RMS per coordinate.
    observations_a, observations_b : int
    """

    name: str
    centre: tuple[float, float, float]
    sigma_centre: tuple[float, float, float]
    rotation_deg: float
    rms_a_px: float
    rms_b_px: float
    observations_a: int
    observations_b: int


@dataclass(frozen=True)
class PointsDifference:
    """Object points that both have, recognised by a common image measurement.

    Attributes
    ----------
    common, only_a, only_b : int
    rms : tuple of float
        Root mean square of B − A per axis, in A's unit.
    median, q95, largest : float
        Of the length of B − A.
    sigma_a, sigma_b : float
        Median standard deviation per coordinate of the common points in A and in B (B in A's unit); NaN where not
        computed.
    """

    common: int
    only_a: int
    only_b: int
    rms: tuple[float, float, float]
    median: float
    q95: float
    largest: float
    sigma_a: float
    sigma_b: float


@dataclass(frozen=True)
class CheckDifference:
    """Check points, computed − given, m: number and RMS per axis in A and in B."""

    count_a: int
    count_b: int
    rms_a: tuple[float, float, float] | None
    rms_b: tuple[float, float, float] | None


@dataclass(frozen=True)
class FrameDifference:
    """How B was moved onto A; `moved` is False where both are in the frame of the control points.

    Attributes
    ----------
    moved : bool
    scale : float
        A per B.
    rotation_deg : float
    shift : float
        Length of the translation, in A's unit.
    unit : str
        Unit of A, in which differences are given.
    how : str
    """

    moved: bool
    scale: float
    rotation_deg: float
    shift: float
    unit: str
    how: str


@dataclass(frozen=True)
class Comparison:
    """Everything that differs between two adjustments; see the classes of the parts."""

    a: str
    b: str
    recipe: tuple[ParameterDifference, ...]
    numbers: tuple[NumberDifference, ...]
    cameras: tuple[CameraParameterDifference, ...]
    calibrations: tuple[CalibrationDifference, ...]
    frame: FrameDifference
    photos: tuple[PhotoDifference, ...]
    only_a: tuple[str, ...]
    only_b: tuple[str, ...]
    points: PointsDifference
    check: CheckDifference
    notes: tuple[str, ...]
    statement: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data, as ``comparison.json`` holds it: the fields of the classes are the keys."""
        from graphos_core.report import plain

        found: dict[str, Any] = plain({"schema": 1, "difference": "B − A", **asdict(self)})
        return found
