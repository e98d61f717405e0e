"""Coordinates, distances and angles of picked points, with standard deviations where they are known."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array, record
from graphos_core.text import Text

NOT_ADJUSTED = Text(
    "No standard deviation: points of the dense cloud are not part of the adjustment; tie points are."
)


@record
class PickedPoint:
    """A point in object space.

    Attributes
    ----------
    xyz : float64 (3,)
        Coordinates in `unit`.
    sigma : float64 (3,) or None
        Their standard deviations in `unit`; None where unknown.
    unit : str
    reason : str
        Why there is no standard deviation; empty where there is one.
    """

    xyz: Array
    sigma: Array | None
    unit: str
    reason: str = ""


@record
class Measured:
    """A measured quantity.

    Attributes
    ----------
    value : float
    sigma : float or None
        Standard deviation in `unit`; None where unknown.
    unit : str
        A length unit, or ``"°"``.
    reason : str
        Why there is no standard deviation; empty where there is one.
    """

    value: float
    sigma: float | None
    unit: str
    reason: str = ""


def point_in_cloud(xyz: Array, unit: str) -> PickedPoint:
    """Return a point picked in a dense cloud; its precision is not known."""
    return PickedPoint(xyz=np.asarray(xyz, dtype=np.float64), sigma=None, unit=unit, reason=NOT_ADJUSTED)


def distance(a: PickedPoint, b: PickedPoint) -> Measured:
    """Return the distance of two points; σ² = Σ (d_i / s)² (σ_ai² + σ_bi²), the points taken as uncorrelated."""
    d = b.xyz - a.xyz
    length = float(np.linalg.norm(d))
    if a.sigma is None or b.sigma is None:
        return Measured(value=length, sigma=None, unit=a.unit, reason=a.reason or b.reason)
    direction = d / length if length > 0 else np.full(3, 1.0 / np.sqrt(3.0))
    variance = (direction**2 * (a.sigma**2 + b.sigma**2)).sum()
    return Measured(value=length, sigma=float(np.sqrt(variance)), unit=a.unit)


def angle(a: PickedPoint, corner: PickedPoint, b: PickedPoint) -> Measured:
    """Return the angle at `corner` between `a` and `b`, degrees; σ by propagation, points taken as uncorrelated."""
    u, v = a.xyz - corner.xyz, b.xyz - corner.xyz
    lu, lv = float(np.linalg.norm(u)), float(np.linalg.norm(v))
    if lu == 0.0 or lv == 0.0:
        return Measured(
            value=float("nan"), sigma=None, unit="°", reason=Text("Two of the points are the same.")
        )
    across = float(np.linalg.norm(np.cross(u, v)))
    value = float(np.degrees(np.arctan2(across, float(u @ v))))
    reason = a.reason or corner.reason or b.reason
    if a.sigma is None or b.sigma is None or corner.sigma is None:
        return Measured(value=value, sigma=None, unit="°", reason=reason)
    if across < 1e-12 * lu * lv:
        return Measured(
            value=value, sigma=None, unit="°",
            reason=Text("No standard deviation: the points lie on one line."),
        )  # fmt: skip
    normal = np.cross(u, v) / across
    da, db = (
        np.cross(u, normal) / lu**2,
        np.cross(normal, v) / lv**2,
    )  # ∂angle/∂a, ∂angle/∂b, radians per unit
    variance = (da**2 * a.sigma**2 + db**2 * b.sigma**2 + (da + db) ** 2 * corner.sigma**2).sum()
    return Measured(value=value, sigma=float(np.degrees(np.sqrt(variance))), unit="°")
