"""How far each verified match of a pair lies from the pair's geometry."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Camera, Features, PairMatches
from graphos_core.features.pair_verdict import ideal_pixels
from graphos_core.geometry.epipolar import fundamental_from_essential, line_distances
from graphos_core.geometry.homography import transfer_squares
from graphos_core.geometry.rays import rays_of
from graphos_core.geometry.relative_orientation import RayPairs


def match_residuals(pair: PairMatches, a: Features, b: Features, cameras: tuple[Camera, Camera]) -> Array:
    """Return the distance of each match from its epipolar line (homography: from the mapped point), px, float64 (n,).

    The larger one of both photos, as the verification measures it; NaN where the pair has no geometry.

    Parameters
    ----------
    pair : PairMatches
    a, b : Features
    cameras : (Camera, Camera)
    """
    xy_a = a.xy[pair.matches[:, 0]].astype(np.float64)
    xy_b = b.xy[pair.matches[:, 1]].astype(np.float64)
    if not np.any(pair.matrix):
        return np.full(len(xy_a), np.nan)
    if pair.kind == "homography":
        return np.asarray(np.sqrt(np.maximum(*transfer_squares(pair.matrix, xy_a, xy_b))))
    matrix = np.asarray(pair.matrix)
    if pair.kind == "essential":
        if any(camera_model(camera.model).wide for camera in cameras):
            rays = RayPairs(rays_of(cameras[0], xy_a), rays_of(cameras[1], xy_b))
            return rays.line_distances(matrix)
        xy_a, xy_b = ideal_pixels(cameras[0], xy_a), ideal_pixels(cameras[1], xy_b)
        matrix = fundamental_from_essential(matrix, *cameras)
    return np.asarray(np.maximum(*line_distances(matrix, xy_a, xy_b)))
