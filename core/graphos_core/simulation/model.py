"""Theoretical models: exact poses, points and observations, with noise, outliers and visibility limits by a seed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from graphos_core.data.block import Block
from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array, record
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.params import About, Params
from graphos_core.simulation.objects import ObjectPoints
from graphos_core.simulation.templates import Stations
from graphos_core.simulation.visibility import incidence, project_inside


class NoiseParams(Params):
    """What is added to exact observations, and which observations there are at all."""

    sigma_px: Annotated[
        float, About(label="Noise", symbol=r"\sigma", unit="px", low=0, high=100, step=0.05,
                     help="Standard deviation of the Gaussian noise of each image coordinate.")
    ] = 0.3  # fmt: skip
    outlier_share: Annotated[
        float, About(label="Outliers", unit="", low=0, high=0.9, step=0.01,
                     help="Share of the observations that are blunders.")
    ] = 0.0  # fmt: skip
    outlier_px: Annotated[
        float, About(label="Size of outliers", unit="px", low=0, high=10000, step=1,
                     help="Blunders lie up to this far, and at least a fifth as far, from the true position.")
    ] = 50.0  # fmt: skip
    max_distance: Annotated[
        float | None, About(label="Largest distance", unit="m", low=0, low_open=True, high=1e7,
                            help="Points farther from the projection centre are not seen; none for no limit.")
    ] = None  # fmt: skip
    max_incidence: Annotated[
        float, About(label="Largest incidence", unit="°", low=0, high=90, step=5,
                     help="Points seen under a larger angle from their surface normal are not seen, "
                          "where normals are known.")
    ] = 80.0  # fmt: skip
    drop_share: Annotated[
        float, About(label="Missed", unit="", low=0, high=0.99, step=0.05,
                     help="Share of the visible images of points that nobody measured.")
    ] = 0.0  # fmt: skip
    min_rays: Annotated[
        int, About(label="Fewest rays", low=1, high=100, step=1,
                   help="Points seen in fewer photos are left out.")
    ] = 2  # fmt: skip


@record
class TheoreticalModel:
    """A block whose truth is known.

    Attributes
    ----------
    cameras : tuple of Camera
        Exact.
    camera_of_photo : int32 (n,)
    stations : Stations
        Exact exterior orientations, m.
    points : float64 (p, 3)
        Exact object points, m; each seen in at least ``min_rays`` photos.
    point_index : int32 (p,)
        Index of each point among the object's points.
    obs_photo, obs_point : int32 (m,)
        Sorted by point, then photo.
    obs_xy_true, obs_xy : float64 (m, 2)
        Exact projection, and with noise and outliers, px.
    outlier : bool (m,)
    noise : NoiseParams
    """

    cameras: tuple[Camera, ...]
    camera_of_photo: Array
    stations: Stations
    points: Array
    point_index: Array
    obs_photo: Array
    obs_point: Array
    obs_xy_true: Array
    obs_xy: Array
    outlier: Array
    noise: NoiseParams

    def as_block(
        self,
        *,
        perturb_rotation: float = 0.0,
        perturb_centre: float = 0.0,
        perturb_points: float = 0.0,
        exact_observations: bool = False,
        seed: int = 0,
    ) -> Block:
        """Return a block for the adjustment.

        Parameters
        ----------
        perturb_rotation : float
            Standard deviation of small rotations about the camera's axes, radians.
        perturb_centre, perturb_points : float
            Standard deviation of each coordinate, m.
        exact_observations : bool
            The exact observations instead of the noisy ones.
        seed : int
        """
        rng = np.random.default_rng([seed, 7])
        turns = rng.standard_normal((len(self.stations.names), 3)) * perturb_rotation
        shifts = rng.standard_normal(self.stations.centres.shape) * perturb_centre
        moves = rng.standard_normal(self.points.shape) * perturb_points
        rotations = [matrix_from_vector(t) @ r for t, r in zip(turns, self.stations.rotations, strict=True)]
        return Block(
            cameras=self.cameras,
            names=self.stations.names,
            camera_of_photo=self.camera_of_photo,
            oriented=np.ones(len(self.stations.names), dtype=bool),
            rotations=np.array(rotations),
            centres=self.stations.centres + shifts,
            points=self.points + moves,
            colours=np.full((len(self.points), 3), 128, np.uint8),
            point_track=np.full(len(self.points), -1, np.int32),
            obs_photo=self.obs_photo,
            obs_point=self.obs_point,
            obs_xy=self.obs_xy_true if exact_observations else self.obs_xy,
            unit="m",
        )


def theoretical_model(
    stations: Stations,
    cameras: Camera | Sequence[Camera],
    points: ObjectPoints,
    noise: NoiseParams | None = None,
    *,
    seed: int = 0,
    camera_of_photo: Array | None = None,
) -> TheoreticalModel:
    """Return the theoretical model of an object seen from stations (ARPENTEUR 2013).

    Parameters
    ----------
    stations : Stations
    cameras : Camera or sequence of Camera
        Of any model.
    points : ObjectPoints
    noise : NoiseParams, optional
    seed : int
        Of what is measured, its noise and its outliers.
    camera_of_photo : int32 (n,), optional
        Index into `cameras`; needed when there are several.

    Raises
    ------
    UserError
        When nothing is seen by enough photos.
    """
    noise = noise or NoiseParams()
    rng = np.random.default_rng([seed, 5])
    all_cameras = (cameras,) if isinstance(cameras, Camera) else tuple(cameras)
    owner = (
        np.zeros(len(stations.names), np.int32) if camera_of_photo is None else np.asarray(camera_of_photo)
    )
    photo, point, xy = _observations(stations, all_cameras, owner, points, noise)
    measured = rng.random(len(photo)) >= noise.drop_share
    rays = np.bincount(point[measured], minlength=len(points.xyz))
    keep = measured & (rays[point] >= noise.min_rays)
    photo, point, xy = photo[keep], point[keep], xy[keep]
    if not len(photo):
        raise UserError(
            "No point is seen by enough photos.",
            "The stations do not look at the object together.",
            "Move the object, widen the visibility limits or add photos.",
        )
    order = np.lexsort((photo, point))
    photo, point, xy = photo[order], point[order], xy[order]
    index, point = np.unique(point, return_inverse=True)
    outlier = rng.random(len(photo)) < noise.outlier_share
    return TheoreticalModel(
        cameras=all_cameras, camera_of_photo=owner.astype(np.int32), stations=stations, points=points.xyz[index],
        point_index=index.astype(np.int32), obs_photo=photo.astype(np.int32), obs_point=point.astype(np.int32),
        obs_xy_true=xy, obs_xy=_disturbed(xy, outlier, noise, rng), outlier=outlier, noise=noise,
    )  # fmt: skip


def _observations(
    stations: Stations, cameras: tuple[Camera, ...], owner: Array, points: ObjectPoints, noise: NoiseParams
) -> tuple[Array, Array, Array]:
    photos, seen, pixels = [], [], []
    for i, (rotation, centre) in enumerate(zip(stations.rotations, stations.centres, strict=True)):
        xy, visible = project_inside(cameras[owner[i]], rotation, centre, points.xyz)
        known = np.abs(points.normals).max(axis=1) > 0.0
        steep = incidence(points.normals, points.xyz, centre) >= np.cos(np.radians(noise.max_incidence))
        visible &= steep | ~known
        if noise.max_distance is not None:
            visible &= np.linalg.norm(points.xyz - centre, axis=1) <= noise.max_distance
        which = np.flatnonzero(visible)
        photos.append(np.full(len(which), i))
        seen.append(which)
        pixels.append(xy[which])
    return np.concatenate(photos), np.concatenate(seen), np.concatenate(pixels)


def _disturbed(xy: Array, outlier: Array, noise: NoiseParams, rng: np.random.Generator) -> Array:
    out = xy + noise.sigma_px * rng.standard_normal(xy.shape)
    angle = rng.uniform(0.0, 2 * np.pi, len(xy))
    radius = noise.outlier_px * rng.uniform(0.2, 1.0, len(xy))
    blunder = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    result: Array = np.where(outlier[:, None], xy + blunder, out)
    return result
