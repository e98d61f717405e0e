"""Where a point is to be found in another photo, and how well its measurements fit, in an oriented block."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from graphos_core.cameras import camera_model, pixel_from_ray
from graphos_core.data import Array, Block
from graphos_core.geometry.epipolar import epipolar_curve
from graphos_core.geometry.rays import joined, rays_of
from graphos_core.geometry.triangulation import intersect_rays

SMALLEST_ANGLE = np.radians(1.0)
"""Rays that meet under less than this do not make a point."""

CURVE_POINTS = 60
MARGIN = 2.0
"""An epipolar line is drawn from a half to twice the depths at which the photo sees points."""


@dataclass(frozen=True)
class Intersection:
    """A point measured in the photos of a block.

    Attributes
    ----------
    xyz : float64 (3,) or None
        Object frame of the block, in its unit; None before two rays of oriented photos meet.
    residuals : dict of int to float64 (2,)
        Projected − measured by photo, px; empty before.
    sigma : float64 (3,) or None
        Standard deviations for image coordinates of 1 px standard deviation and error-free orientations, in the
        block's unit.
    angle : float
        Largest intersection angle, radians.
    """

    xyz: Array | None
    residuals: Mapping[int, Array]
    sigma: Array | None
    angle: float

    @property
    def rms_px(self) -> float:
        """Root mean square of the residuals per coordinate, px; NaN without."""
        return (
            float(np.sqrt(np.mean(np.square(list(self.residuals.values())))))
            if self.residuals
            else float("nan")
        )


def intersect(block: Block, measured: Mapping[int, Array]) -> Intersection:
    """Intersect all rays of one point by least squares in the images; every measurement takes part.

    Parameters
    ----------
    block : Block
    measured : mapping of int to float64 (2,)
        Measured place by photo, px.
    """
    photos = [p for p in sorted(measured) if block.oriented[p]]
    if len(photos) < 2:
        return Intersection(None, {}, None, 0.0)
    xy = np.array([measured[p] for p in photos], dtype=np.float64)
    points, angles, ok = _meet(block, np.zeros(len(photos), dtype=np.int64), np.array(photos), xy, 1)
    if not ok[0]:
        return Intersection(None, {}, None, float(angles[0]))
    residuals = {p: project(block, p, points[0]) - place for p, place in zip(photos, xy, strict=True)}
    return Intersection(points[0], residuals, _sigma(block, photos, points[0]), float(angles[0]))


def intersect_many(block: Block, point: Array, photo: Array, xy: Array, count: int) -> tuple[Array, Array]:
    """Intersect many points at once; see `intersect`.

    Parameters
    ----------
    block : Block
    point, photo : int (m,)
        Point and oriented photo of each measurement, sorted by point.
    xy : float64 (m, 2)
        px.
    count : int
        Number of points.

    Returns
    -------
    float64 (count, 3)
        Object frame of the block.
    bool (count,)
        Whether two rays meet.
    """
    points, _, ok = _meet(block, point, photo, xy, count)
    return points, ok


def _meet(block: Block, point: Array, photo: Array, xy: Array, count: int) -> tuple[Array, Array, Array]:
    """Return points, largest angles and whether the points were found; every ray takes part."""
    parts = [
        (mine, rays_of(block.cameras[block.camera_of_photo[p]], xy[mine]))
        for p in np.unique(photo)
        if len(mine := np.flatnonzero(photo == p))
    ]
    rays = joined(parts, len(photo))
    use = np.flatnonzero(rays.valid)
    start = np.searchsorted(point[use], np.arange(count + 1))
    found = intersect_rays(
        start, photo[use], rays[use], block.rotations, block.centres, min_angle=SMALLEST_ANGLE
    )
    return found.points, found.angles, found.ok


def project(block: Block, photo: int, xyz: Array) -> Array:
    """Return the place (2,) of an object point in a photo, px; NaN where it has no image."""
    return project_many(block, photo, np.asarray(xyz)[None])[0]


def project_many(block: Block, photo: int, xyz: Array) -> Array:
    """Return the places (n, 2) of object points (n, 3) in a photo, px; NaN where they have no image."""
    in_camera = (np.asarray(xyz) - block.centres[photo]) @ np.asarray(block.rotations[photo]).T
    return pixel_from_ray(block.cameras[block.camera_of_photo[photo]], in_camera)


def inside(block: Block, photo: int, xy: Array) -> bool:
    """Say whether a place lies in the format of a photo."""
    camera = block.cameras[block.camera_of_photo[photo]]
    return bool(-0.5 <= xy[0] <= camera.width - 0.5 and -0.5 <= xy[1] <= camera.height - 0.5)


def epipolar(block: Block, source: int, xy: Array, target: int) -> Array:
    """Return the epipolar line of a place in photo `source` as it is seen in photo `target`.

    Returns
    -------
    float64 (n, 2)
        Pixels along the line within the format, for depths round those of the points the source photo sees; empty
        where a photo is not oriented.
    """
    if not (block.oriented[source] and block.oriented[target]):
        return np.zeros((0, 2))
    cameras = [block.cameras[block.camera_of_photo[p]] for p in (source, target)]
    low, high = depth_range(block, source)
    depths = np.geomspace(low / MARGIN, high * MARGIN, CURVE_POINTS)
    curve = epipolar_curve(
        np.asarray(xy), cameras[0], block.rotations[source], block.centres[source],
        cameras[1], block.rotations[target], block.centres[target], depths,
    )  # fmt: skip
    return curve[[bool(np.isfinite(place).all()) and inside(block, target, place) for place in curve]]


def depth_range(block: Block, photo: int) -> tuple[float, float]:
    """Return the depths (2nd and 98th percentile) of the points a photo sees, in the block's unit.

    Depth is the z of the camera frame, for a camera with a field of any angle the distance from its centre.
    """
    mine = np.asarray(block.obs_point)[np.asarray(block.obs_photo) == photo]
    rays = np.asarray(block.points)[mine] - block.centres[photo]
    wide = camera_model(block.cameras[block.camera_of_photo[photo]].model).wide
    depths = np.linalg.norm(rays, axis=1) if wide else rays @ np.asarray(block.rotations[photo])[2]
    depths = depths[depths > 0]
    if not len(depths):
        spread = float(np.ptp(np.asarray(block.centres)[np.asarray(block.oriented)], axis=0).max()) or 1.0
        return 0.5 * spread, 10.0 * spread
    low, high = np.percentile(depths, [2, 98])
    return float(low), float(high)


def _sigma(block: Block, photos: list[int], xyz: Array, step: float = 1e-6) -> Array:
    """Return the standard deviations of an intersected point for 1 px, by the normal matrix of its projections."""
    scale = step * max(float(np.linalg.norm(xyz - block.centres[photos[0]])), 1e-12)
    normal = np.zeros((3, 3))
    for photo in photos:
        columns = [
            (project(block, photo, xyz + scale * e) - project(block, photo, xyz - scale * e)) / (2 * scale)
            for e in np.eye(3)
        ]
        jacobian = np.column_stack(columns)
        normal += jacobian.T @ jacobian
    return np.sqrt(np.diag(np.linalg.inv(normal)))


@dataclass(frozen=True)
class Prediction:
    """Where a point is expected in a photo.

    Attributes
    ----------
    xy : float64 (2,) or None
        px; None where only lines, or nothing, can be said.
    source : {"rays", "coordinates", "lines", ""}
        Two rays or more of other photos, its known coordinates, epipolar lines of other photos, or nothing.
    lines : tuple of float64 (n, 2)
        Epipolar lines, px.
    inside : bool
        Whether the place, or a part of a line, lies in the format.
    """

    xy: Array | None
    source: str
    lines: tuple[Array, ...] = ()
    inside: bool = False


def predict(block: Block, measured: Mapping[int, Array], photo: int, xyz: Array | None = None) -> Prediction:
    """Predict a point in a photo from its measurements in the others.

    Parameters
    ----------
    block : Block
    measured : mapping of int to float64 (2,)
        Measured place by photo, px; that in `photo` itself is not used.
    photo : int
    xyz : float64 (3,) or None
        Known coordinates in the frame of the block; used before two rays meet.
    """
    if not block.oriented[photo]:
        return Prediction(None, "")
    others = {p: xy for p, xy in measured.items() if p != photo and block.oriented[p]}
    meeting = intersect(block, others).xyz
    if meeting is not None:
        return _at(block, photo, meeting, "rays")
    if xyz is not None and np.isfinite(xyz).all():
        return _at(block, photo, xyz, "coordinates")
    lines = tuple(line for p, xy in others.items() if len(line := epipolar(block, p, xy, photo)) > 1)
    return Prediction(None, "lines" if lines else "", lines, bool(lines))


def _at(block: Block, photo: int, xyz: Array, source: str) -> Prediction:
    xy = project(block, photo, xyz)
    if not np.isfinite(xy).all():
        return Prediction(None, source)
    return Prediction(xy, source, (), inside(block, photo, xy))
