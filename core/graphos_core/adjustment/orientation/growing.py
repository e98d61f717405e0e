"""The block while it grows: the one mutable thing of the orientation, never seen outside it."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from graphos_core.data import Array, Block, Camera, OrientationTree, PhotoSet, Tracks
from graphos_core.errors import ItemFailure
from graphos_core.geometry.rays import Rays, joined, rays_of
from graphos_core.geometry.triangulation import distances_px, intersect_rays, intersection_angles

SHOWN = 3
"""Photos named in the tree as those a resection stands on."""


@dataclass(frozen=True)
class Oriented:
    """How one photo was oriented: see `graphos_core.data.OrientationTree`."""

    photo: int
    on: tuple[int, ...]
    method: str
    points: int
    rms_px: float


class GrowingBlock:
    """Orientations, points and accepted observations so far.

    Parameters
    ----------
    photos : PhotoSet
    tracks : Tracks
    reprojection_px : float
        Largest distance of an accepted observation from its point in the plane of its ray, px.
    min_angle : float
        Smallest largest intersection angle of an accepted point, radians.

    Attributes
    ----------
    cameras : tuple of Camera
    oriented : bool (n,)
    rotations, centres : float64 (n, 3, 3), (n, 3)
        ``cam_from_world`` and projection centres, model units.
    points : float64 (t, 3)
        A point per track; valid where `known`.
    known : bool (t,)
    used : bool (m,)
        Accepted observations, in the order of the tracks' observations.
    rays : Rays (m)
        Of all observations under the present calibration.
    """

    def __init__(self, photos: PhotoSet, tracks: Tracks, reprojection_px: float, min_angle: float) -> None:
        count = len(photos.photos)
        self.names = tuple(photo.name for photo in photos.photos)
        self.tracks = tracks
        self.reprojection_px = reprojection_px
        self.min_angle = min_angle
        self.camera_of_photo = np.array([photo.camera for photo in photos.photos], dtype=np.int32)
        self.oriented = np.zeros(count, dtype=bool)
        self.rotations = np.tile(np.eye(3), (count, 1, 1))
        self.centres = np.zeros((count, 3))
        self.points = np.zeros((tracks.count, 3))
        self.known = np.zeros(tracks.count, dtype=bool)
        self.used = np.zeros(len(tracks.track), dtype=bool)
        order = np.argsort(tracks.photo, kind="stable")
        bounds = np.searchsorted(tracks.photo[order], np.arange(count + 1))
        self.tree: list[Oriented] = []
        self._start = np.searchsorted(tracks.track, np.arange(tracks.count + 1))
        self._of_photo = [order[bounds[i] : bounds[i + 1]] for i in range(count)]
        self.rays: Rays = joined([], len(tracks.track))
        self.cameras: tuple[Camera, ...] = ()
        self.set_cameras(photos.cameras)

    def set_cameras(self, cameras: tuple[Camera, ...]) -> None:
        """Take a calibration and compute the rays of all observations with it."""
        if self.cameras and all(
            np.array_equal(new.values, old.values) for new, old in zip(cameras, self.cameras, strict=True)
        ):
            self.cameras = tuple(cameras)
            return
        camera = self.camera_of_photo[self.tracks.photo]
        parts = []
        for index, new in enumerate(cameras):
            mine = np.flatnonzero(camera == index)
            known = bool(self.cameras) and np.array_equal(new.values, self.cameras[index].values)
            parts.append((mine, self.rays[mine] if known else rays_of(new, self.tracks.xy[mine])))
        self.cameras = tuple(cameras)
        self.rays = joined(parts, len(camera)) if len(parts) > 1 else parts[0][1]
        self.valid: Array = self.rays.valid

    def fresh(self) -> GrowingBlock:
        """Return an empty block of the same photos, tracks and calibration, which shares their rays."""
        new = copy(self)
        new.oriented = np.zeros_like(self.oriented)
        new.rotations, new.centres = np.tile(np.eye(3), (len(self.names), 1, 1)), np.zeros_like(self.centres)
        new.points, new.known = np.zeros_like(self.points), np.zeros_like(self.known)
        new.used, new.tree = np.zeros_like(self.used), []
        return new

    def observations_of(self, photo: int) -> Array:
        """Return the indices of the valid observations of a photo, sorted by track."""
        of_photo = self._of_photo[photo]
        return of_photo[self.valid[of_photo]]

    def seen_by(self, photo: int) -> Array:
        """Return the indices of the observations of a photo whose points are known."""
        observations = self.observations_of(photo)
        return observations[self.known[self.tracks.track[observations]]]

    def common(self, a: int, b: int) -> tuple[Array, Array]:
        """Return the indices of the observations of the tracks common to two photos, in the same order."""
        in_a, in_b = self.observations_of(a), self.observations_of(b)
        _, at_a, at_b = np.intersect1d(
            self.tracks.track[in_a], self.tracks.track[in_b], assume_unique=True, return_indices=True
        )
        return in_a[at_a], in_b[at_b]

    def place(self, photo: int, rotation: Array, centre: Array, how: Oriented) -> None:
        """Add an oriented photo, with its observations of known points that fit."""
        self.oriented[photo] = True
        self.rotations[photo], self.centres[photo] = rotation, centre
        seen = self.seen_by(photo)
        self.used[seen] = self.distances_px(seen) <= self.reprojection_px
        self.tree.append(how)

    def explain_last(self) -> None:
        """Say in the tree on which photos the resection of the last photo stands."""
        how = self.tree[-1]
        if not how.on:
            self.tree[-1] = replace(how, on=self.neighbours(how.photo, SHOWN))

    def release(self, photo: int) -> None:
        """Take a photo out again, with the points that lose too many rays."""
        self.oriented[photo] = False
        self.tree = [how for how in self.tree if how.photo != photo]
        self.rotations[photo], self.centres[photo] = np.eye(3), np.zeros(3)
        self.reject()

    def distances_px(self, observations: Array) -> Array:
        """Return the distance of each observation from its known point in the plane of its ray, px."""
        return distances_px(
            self.tracks.track[observations], self.tracks.photo[observations], self.rays[observations],
            self.rotations, self.centres, self.points,
        )  # fmt: skip

    def intersect(self) -> int:
        """Compute the points of all tracks not known yet from their oriented photos; return how many are new."""
        tracks = self.tracks
        free = np.flatnonzero(self.oriented[tracks.photo] & self.valid & ~self.known[tracks.track])
        ids, start = np.unique(tracks.track[free], return_index=True)
        start = np.append(start, len(free))
        found = intersect_rays(
            start, tracks.photo[free], self.rays[free], self.rotations, self.centres,
            threshold_px=self.reprojection_px, min_angle=self.min_angle,
        )  # fmt: skip
        new = ids[found.ok]
        self.points[new] = found.points[found.ok]
        self.known[new] = True
        self.used[free] = found.used
        return len(new)

    def neighbours(self, photo: int, most: int) -> tuple[int, ...]:
        """Return the oriented photos that share most accepted points with an oriented one, at most so many."""
        tracks = self.tracks
        mine = np.zeros(tracks.count, dtype=bool)
        observations = self._of_photo[photo]
        mine[tracks.track[observations[self.used[observations]]]] = True
        shared = np.bincount(tracks.photo[self.used & mine[tracks.track]], minlength=len(self.names))
        shared[photo] = 0
        order = np.argsort(-shared, kind="stable")[:most]
        return tuple(int(i) for i in order if shared[i] > 0)

    def reject(self, of: Array | None = None) -> int:
        """Accept or refuse observations anew, drop points left with too little; return the observations lost.

        Parameters
        ----------
        of : bool (t,), optional
            Only those of some tracks; by default of all.
        """
        tracks = self.tracks
        before = int(self.used.sum())
        there = self.oriented[tracks.photo] & self.valid & self.known[tracks.track]
        live = np.flatnonzero(there if of is None else there & of[tracks.track])
        self.used[live] = False
        if of is None:
            self.used[:] = False
        self.used[live] = self.distances_px(live) <= self.reprojection_px
        angles = intersection_angles(self._start, tracks.photo, self.used, self.centres, self.points)
        rays = np.bincount(tracks.track[live], minlength=tracks.count)
        agreeing = np.bincount(tracks.track[self.used], minlength=tracks.count)
        good = (angles >= self.min_angle) & (2 * agreeing > rays)  # a minority may have made the point
        self.known &= good if of is None else good | ~of
        self.used &= self.known[tracks.track]
        return before - int(self.used.sum())

    def tracks_of(self, photos: Array) -> Array:
        """Say which tracks have an accepted observation in some photos bool (n,); bool (t,)."""
        found = np.zeros(self.tracks.count, dtype=bool)
        found[self.tracks.track[self.used & photos[self.tracks.photo]]] = True
        return found

    def block(self, failures: tuple[ItemFailure, ...] = (), of: Array | None = None) -> Block:
        """Return the block so far as a record, with all its points or those of some tracks bool (t,)."""
        tracks = self.tracks
        observations = np.flatnonzero(self.used if of is None else self.used & of[tracks.track])
        ids, point = np.unique(tracks.track[observations], return_inverse=True)
        return Block(
            cameras=self.cameras,
            names=self.names,
            camera_of_photo=self.camera_of_photo,
            oriented=self.oriented.copy(),
            rotations=self.rotations.copy(),
            centres=self.centres.copy(),
            points=self.points[ids],
            colours=tracks.colour[ids],
            point_track=ids.astype(np.int32),
            obs_photo=tracks.photo[observations].astype(np.int32),
            obs_point=point.astype(np.int32),
            obs_xy=tracks.xy[observations],
            failures=failures,
            tree=self._tree(),
        )

    def _tree(self) -> OrientationTree:
        return OrientationTree(
            photo=np.array([how.photo for how in self.tree], np.int32),
            on=tuple(how.on for how in self.tree),
            method=tuple(how.method for how in self.tree),
            points=np.array([how.points for how in self.tree], np.int32),
            rms_px=np.array([how.rms_px for how in self.tree]),
        )

    def adopt(self, block: Block) -> None:
        """Take orientations, points and calibration from an adjusted block made by `block`."""
        self.rotations, self.centres = block.rotations.copy(), block.centres.copy()
        self.points[block.point_track] = block.points
        self.set_cameras(block.cameras)
