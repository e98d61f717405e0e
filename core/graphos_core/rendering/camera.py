"""The camera a person looks through: it orbits a target, pans and zooms."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.rotation import matrix_from_vector


@dataclass(frozen=True, eq=False)
class ViewCamera:
    """A central projection that looks at a target.

    Attributes
    ----------
    target : float64 (3,)
        Point in the middle of the picture, in the object frame.
    rotation : float64 (3, 3)
        ``cam_from_world``; camera frame x right, y down, z forward.
    distance : float
        From the projection centre to the target, in the unit of the cloud.
    field_of_view : float
        Angle over the smaller side of the picture, radians.
    up : float64 (3,)
        Direction that stays upright while orbiting, object frame.
    """

    target: Array
    rotation: Array
    distance: float
    field_of_view: float = math.radians(40.0)
    up: Array = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        up = np.array([0.0, 0.0, 1.0]) if self.up is None else np.asarray(self.up, dtype=np.float64)
        object.__setattr__(self, "up", up / np.linalg.norm(up))
        object.__setattr__(self, "target", np.asarray(self.target, dtype=np.float64))
        object.__setattr__(self, "rotation", np.asarray(self.rotation, dtype=np.float64))

    @property
    def centre(self) -> Array:
        """Projection centre, float64 (3,) in the object frame."""
        return self.target - self.distance * self.rotation[2]

    @property
    def near(self) -> float:
        """Depth below which nothing is drawn."""
        return 1e-3 * self.distance

    def focal_px(self, width: int, height: int) -> float:
        """Principal distance in px of a picture of this size; the principal point is its middle."""
        return 0.5 * min(width, height) / math.tan(0.5 * self.field_of_view)

    def project(self, points: Array, width: int, height: int) -> Array:
        """Return (n, 3): x, y in px (centre of the top-left pixel is (0, 0)) and the depth, of points (n, 3).

        x and y are NaN where the depth is below `near`.
        """
        local = (np.asarray(points, dtype=np.float64).reshape(-1, 3) - self.centre) @ self.rotation.T
        depth = local[:, 2]
        front = np.where(depth > self.near, depth, np.nan)
        f = self.focal_px(width, height)
        x = f * local[:, 0] / front + 0.5 * (width - 1)
        y = f * local[:, 1] / front + 0.5 * (height - 1)
        return np.stack([x, y, depth], axis=1)

    def point_at(self, x: float, y: float, depth: float, width: int, height: int) -> Array:
        """Return the object point (3,) seen at pixel (x, y) with the given depth: the inverse of `project`."""
        f = self.focal_px(width, height)
        local = depth * np.array([(x - 0.5 * (width - 1)) / f, (y - 0.5 * (height - 1)) / f, 1.0])
        return self.centre + self.rotation.T @ local

    def orbited(self, right: float, down: float, about: Array | None = None) -> ViewCamera:
        """Turn about a point (default: the target), which keeps its place in the picture.

        `right` turns about the upright direction and `down` about the picture's x axis, in radians; what lies in
        front of the point follows a drag to the right and down. The view never tips over the zenith.
        """
        tilt = math.asin(
            float(np.clip(-self.rotation[2] @ self.up, -1.0, 1.0))
        )  # elevation above the horizon
        limit = math.radians(89.5)
        down = min(max(tilt + down, -limit), limit) - tilt if abs(tilt) <= limit else 0.0
        about_up = matrix_from_vector(right * self.up)
        about_x = matrix_from_vector(np.array([down, 0.0, 0.0]))
        rotation = _orthonormal(about_x @ self.rotation @ about_up)
        pivot = self.target if about is None else np.asarray(about, dtype=np.float64)
        target = pivot + rotation.T @ self.rotation @ (self.target - pivot)
        return replace(self, rotation=rotation, target=target)

    def rolled(self, angle: float) -> ViewCamera:
        """Turn about the viewing direction by `angle` radians, clockwise on the screen; `up` turns along."""
        rotation = _orthonormal(matrix_from_vector(np.array([0.0, 0.0, angle])) @ self.rotation)
        return replace(self, rotation=rotation, up=rotation.T @ self.rotation @ self.up)

    def panned(self, x: float, y: float, width: int, height: int, depth: float | None = None) -> ViewCamera:
        """Shift so that what lies at `depth` (default: the target's) follows a drag by (x, y) px."""
        scale = (self.distance if depth is None else depth) / self.focal_px(width, height)
        return replace(self, target=self.target - scale * (x * self.rotation[0] + y * self.rotation[1]))

    def zoomed(self, factor: float, at: Array | None = None) -> ViewCamera:
        """Go nearer by `factor` (> 1); the object point `at` keeps its place in the picture."""
        at = self.target if at is None else np.asarray(at, dtype=np.float64)
        return replace(self, target=at + (self.target - at) / factor, distance=self.distance / factor)

    def focused(self, point: Array) -> ViewCamera:
        """Make `point` the target, from the same direction, half as far away as it is now."""
        point = np.asarray(point, dtype=np.float64)
        distance = float(np.linalg.norm(point - self.centre))
        return replace(self, target=point, distance=max(0.6 * distance, 1e-9))

    def fitted(self, points: Array, width: int, height: int, share: float = 0.9) -> ViewCamera:
        """Keep the direction and move so that points (n, 3) fill `share` of the picture; NaN rows are ignored."""
        points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            return self
        local = points @ self.rotation.T
        half = share * np.array([width, height]) * 0.5 / self.focal_px(width, height)
        # The frustum must hold every point: x − half·z bounded on both sides, solved for the centre per axis.
        centre = np.zeros(3)
        needed = []
        for axis in range(2):
            upper = float((local[:, axis] - half[axis] * local[:, 2]).max())
            lower = float((local[:, axis] + half[axis] * local[:, 2]).min())
            centre[axis] = 0.5 * (upper + lower)
            needed.append((lower - upper) / (2.0 * half[axis]))
        extent = float(np.linalg.norm(np.ptp(local, axis=0)))
        centre[2] = min(min(needed), float(local[:, 2].min()) - 1e-3 * extent - 1e-12)
        middle = 0.5 * float(local[:, 2].min() + local[:, 2].max())
        distance = max(middle - centre[2], 1e-9)
        target = self.rotation.T @ (centre + np.array([0.0, 0.0, distance]))
        return replace(self, target=target, distance=distance)

    @staticmethod
    def looking(direction: Array, up: Array = (0.0, 0.0, 1.0)) -> ViewCamera:  # type: ignore[assignment]
        """Return a camera at unit distance from the origin that looks along `direction` with `up` upright."""
        return ViewCamera(
            np.zeros(3), rotation_looking(direction, up), 1.0, up=np.asarray(up, dtype=np.float64)
        )


def rotation_looking(direction: Array, up: Array) -> Array:
    """Return ``cam_from_world`` (3, 3) of a camera that looks along `direction` with `up` upright."""
    z = np.asarray(direction, dtype=np.float64)
    z = z / np.linalg.norm(z)
    x = np.cross(z, np.asarray(up, dtype=np.float64))
    if np.linalg.norm(x) < 1e-9:
        x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x = x / np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def _orthonormal(rotation: Array) -> Array:
    u, _, vt = np.linalg.svd(rotation)
    return u @ vt
