"""Observations of object points: control coordinates, distances, planes, lines and axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.known.group import Columns, Entries, Extra, chosen
from graphos_core.data.record import Array

NOBODY = np.empty(0, dtype=np.int64)


@dataclass(frozen=True)
class Coordinates:
    """Given coordinates of object points (control points).

    Attributes
    ----------
    point : int64 (k,)
        Point of the block.
    axis : int64 (k,)
        0, 1, 2 for X, Y, Z.
    observed, sigma : float64 (k,)
        m, or the block's unit.
    labels : tuple of str
    """

    point: Array
    axis: Array
    observed: Array
    sigma: Array
    labels: Sequence[str]
    unit: str = "m"
    kind: str = "control coordinates"
    photos: ClassVar[Array] = NOBODY
    extras: tuple[Extra, ...] = ()

    @property
    def points(self) -> Array:
        """Points concerned."""
        return np.unique(self.point)

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """Keep what is there."""
        keep = np.flatnonzero(point[self.point])
        if not len(keep):
            return None
        return replace(self, point=self.point[keep], axis=self.axis[keep], observed=self.observed[keep],
                       sigma=self.sigma[keep], labels=chosen(self.labels, keep))  # fmt: skip

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the coordinates themselves."""
        column = at.point_column[self.point]
        entries.add(np.arange(len(self.point)), np.where(column < 0, -1, column + self.axis), np.array(1.0))
        found: Array = scene.points[at.point[self.point], self.axis]
        return found


@dataclass(frozen=True)
class Distances:
    """Distances between two points, or between two projection centres.

    Attributes
    ----------
    a, b : int64 (k,)
        Points of the block, or photos.
    of_photos : bool
    """

    a: Array
    b: Array
    observed: Array
    sigma: Array
    labels: Sequence[str]
    of_photos: bool = False
    unit: str = "m"
    kind: str = "distances"
    extras: tuple[Extra, ...] = ()

    @property
    def points(self) -> Array:
        """Points concerned."""
        return NOBODY if self.of_photos else np.unique(np.concatenate([self.a, self.b]))

    @property
    def photos(self) -> Array:
        """Photos concerned."""
        return np.unique(np.concatenate([self.a, self.b])) if self.of_photos else NOBODY

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """Keep what is there."""
        there = photo if self.of_photos else point
        keep = np.flatnonzero(there[self.a] & there[self.b])
        if not len(keep):
            return None
        return replace(self, a=self.a[keep], b=self.b[keep], observed=self.observed[keep], sigma=self.sigma[keep],
                       labels=chosen(self.labels, keep))  # fmt: skip

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the distances; their derivative is the unit vector."""
        if self.of_photos:
            places, columns = scene.centres, np.where(at.photo < 0, -1, at.photo + 3)
            pa, pb, ca, cb = places[self.a], places[self.b], columns[self.a], columns[self.b]
        else:
            pa, pb = scene.points[at.point[self.a]], scene.points[at.point[self.b]]
            ca, cb = at.point_column[self.a], at.point_column[self.b]
        apart = pb - pa
        length = np.linalg.norm(apart, axis=1)
        direction = (apart / np.maximum(length, 1e-300)[:, None])[:, None, :]
        rows = np.arange(len(self.a))
        entries.add_blocks(rows, cb, direction)
        entries.add_blocks(rows, ca, -direction)
        return length


@dataclass(frozen=True)
class Flat:
    """Points on a plane or line: in a frame of the shape, some coordinates are linear functions of the others.

    With ``q = F (X − X₀)`` the distances are ``q_i − (c_i + Σ_j s_ij q_j)`` for the normal axes i and, where the
    shape may still tilt, the axes j along it; divided by ``√(1 + Σ s²)`` they are perpendicular to first order.

    Attributes
    ----------
    point : int64 (k,)
        Points of the block.
    origin : float64 (3,)
        X₀.
    frame : float64 (3, 3)
        F; the first `normals` rows are the normals.
    normals : int
        1 for a plane, 2 for a line.
    tilts : bool
        Whether the slopes s are unknown; False for horizontal planes and vertical lines.
    given : bool
        Whether the offsets c are known to be 0.
    sigma : float64 (k · normals,)
    labels : tuple of str
    extras : tuple of Extra
    """

    point: Array
    origin: Array
    frame: Array
    normals: int
    tilts: bool
    given: bool
    sigma: Array
    labels: Sequence[str]
    extras: tuple[Extra, ...]
    kind: str = "planes"
    unit: str = "m"
    photos: ClassVar[Array] = NOBODY

    @property
    def observed(self) -> Array:
        """Distances from the shape: 0."""
        return np.zeros(len(self.sigma))

    @property
    def points(self) -> Array:
        """Points concerned."""
        return np.unique(self.point)

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """Keep what is there."""
        keep = np.flatnonzero(point[self.point])
        if not len(keep):
            return None
        rows = (keep[:, None] * self.normals + np.arange(self.normals)).ravel()
        return replace(self, point=self.point[keep], sigma=self.sigma[rows], labels=chosen(self.labels, rows))  # fmt: skip

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the distances from the shape."""
        q = (scene.points[at.point[self.point]] - self.origin) @ self.frame.T
        k, m = len(q), self.normals
        along = np.arange(m, 3) if self.tilts else np.arange(0)
        out = np.empty((k, m))
        for i in range(m):
            place = 0 if self.given else i * (1 + len(along))
            own = scene.extra[at.extra_value + place : at.extra_value + place + 1 + len(along)]
            offset, slopes = (0.0, np.zeros(0)) if self.given else (own[0], own[1:])
            scale = 1.0 / np.sqrt(1.0 + slopes @ slopes)
            direct = q[:, i] - offset - q[:, along] @ slopes
            out[:, i] = scale * direct
            normal = scale * (self.frame[i] - slopes @ self.frame[along])
            rows = np.arange(k) * m + i
            entries.add_blocks(rows, at.point_column[self.point], np.broadcast_to(normal, (k, 1, 3)))
            if not self.given:
                first = at.extra + place
                entries.add(rows, np.array(first), np.array(-scale))
                for j, axis in enumerate(along):
                    value = -scale * q[:, axis] - direct * scale**3 * slopes[j]
                    entries.add(rows, np.array(first + 1 + j), value)
        return out.ravel()


@dataclass(frozen=True)
class Directions:
    """The direction from one point to another is an axis of the object frame: two differences are zero.

    Attributes
    ----------
    a, b : int64 (k,)
        Points of the block.
    axis : int64 (k,)
        The coordinate whose difference is zero.
    """

    a: Array
    b: Array
    axis: Array
    sigma: Array
    labels: Sequence[str]
    kind: str = "axes"
    unit: str = "m"
    photos: ClassVar[Array] = NOBODY
    extras: tuple[Extra, ...] = ()

    @property
    def observed(self) -> Array:
        """Differences: 0."""
        return np.zeros(len(self.a))

    @property
    def points(self) -> Array:
        """Points concerned."""
        return np.unique(np.concatenate([self.a, self.b]))

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """Keep what is there."""
        keep = np.flatnonzero(point[self.a] & point[self.b])
        if not len(keep):
            return None
        return replace(self, a=self.a[keep], b=self.b[keep], axis=self.axis[keep], sigma=self.sigma[keep],
                       labels=chosen(self.labels, keep))  # fmt: skip

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the differences."""
        rows = np.arange(len(self.a))
        for point, sign in ((self.b, 1.0), (self.a, -1.0)):
            column = at.point_column[point]
            entries.add(rows, np.where(column < 0, -1, column + self.axis), np.array(sign))
        x = scene.points
        found: Array = x[at.point[self.b], self.axis] - x[at.point[self.a], self.axis]
        return found
