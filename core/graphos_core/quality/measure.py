"""Coordinates, distances and angles of picked points, with standard deviations where they are known."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import ray_from_pixel
from graphos_core.data import Adjustment, Array, Block, DepthMap, record
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


def tie_point(adjustment: Adjustment, index: int) -> PickedPoint:
    """Return an object point of the adjusted block with its standard deviations."""
    block = adjustment.block
    sigma = np.asarray(adjustment.sigma_points[index])
    if not (np.isfinite(sigma).all() and (sigma > 0).all()):
        return PickedPoint(
            xyz=block.points[index], sigma=None, unit=block.unit,
            reason=Text("No standard deviation: the adjustment did not compute one for this point."),
        )  # fmt: skip
    return PickedPoint(xyz=block.points[index], sigma=sigma, unit=block.unit)


def nearest_tie_point(adjustment: Adjustment, photo: int, xy: Array, *, within_px: float = 8.0) -> int | None:
    """Return the object point measured nearest to a pixel of a photo, or None where none is near.

    Parameters
    ----------
    adjustment : Adjustment
    photo : int
    xy : float64 (2,)
        Px of the full photo.
    within_px : float
    """
    block = adjustment.block
    mine = np.flatnonzero(block.obs_photo == photo)
    if len(mine) == 0:
        return None
    away = np.linalg.norm(block.obs_xy[mine] - np.asarray(xy), axis=1)
    best = int(np.argmin(away))
    return int(block.obs_point[mine[best]]) if away[best] <= within_px else None


def point_from_photo(block: Block, depth_map: DepthMap, xy: Array) -> PickedPoint | None:
    """Return the object point seen at a pixel of a full photo, by its depth map; None where no depth is known.

    Parameters
    ----------
    block : Block
    depth_map : DepthMap
        Of the photo.
    xy : float64 (2,)
        Px of the full, distorted photo.
    """
    photo = depth_map.photo
    camera = block.cameras[int(block.camera_of_photo[photo])]
    ray = ray_from_pixel(camera, np.asarray(xy, dtype=np.float64).reshape(1, 2))[0]
    if not np.isfinite(ray).all():
        return None
    x = round(float(ray[0] * depth_map.focal_px + depth_map.cx))
    y = round(float(ray[1] * depth_map.focal_px + depth_map.cy))
    h, w = depth_map.depth.shape
    if not (0 <= x < w and 0 <= y < h) or not np.isfinite(depth_map.depth[y, x]):
        return None
    xyz = ray * float(depth_map.depth[y, x]) @ block.rotations[photo] + block.centres[photo]
    return point_in_cloud(xyz, block.unit)


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
