"""Lines, mapped points and distances of a pair as the match view needs them, whichever matrix was estimated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.cameras import camera_model, pixel_from_ray, ray_from_pixel
from graphos_core.cameras.lens import within_field
from graphos_core.data import Array, Camera, PairMatches
from graphos_core.geometry.epipolar import (
    epipolar_circle,
    epipolar_lines,
    fundamental_from_essential,
    interior_matrix,
    line_distances,
)
from graphos_core.geometry.homography import transfer, transfer_squares
from graphos_core.geometry.rays import rays_of
from graphos_core.geometry.relative_orientation import RayPairs

SAMPLES = 64


@dataclass(frozen=True)
class PairGeometry:
    """Epipolar geometry of two photos.

    Attributes
    ----------
    fundamental : float64 (3, 3)
        For measured px, or for distortion-free px where there are cameras; the essential matrix where one of them is
        wide; the homography where the points are mapped.
    sizes : ((width, height), (width, height))
        Of the photos, px.
    cameras : (Camera, Camera) or None
        Where the matrix is an essential one.
    wide : bool
        Whether one of the cameras sees rays that no image plane holds: fish-eye or panorama.
    mapped : bool
        Whether every point has its place in the other photo, by a homography, in place of a line.
    """

    fundamental: Array
    sizes: tuple[tuple[int, int], tuple[int, int]]
    cameras: tuple[Camera, Camera] | None = None
    wide: bool = False
    mapped: bool = False

    @classmethod
    def of_pair(
        cls,
        pair: PairMatches | None,
        sizes: tuple[tuple[int, int], tuple[int, int]],
        cameras: tuple[Camera, Camera] | None,
    ) -> PairGeometry | None:
        """Return the geometry of a pair; None where it has none, or is essential and the cameras are missing."""
        if pair is None or not np.any(pair.matrix):
            return None
        if pair.kind == "homography":
            return cls(np.asarray(pair.matrix), sizes, mapped=True)
        if pair.kind == "fundamental":
            return cls(np.asarray(pair.matrix), sizes)
        if pair.kind == "essential" and cameras is not None:
            if any(camera_model(camera.model).wide for camera in cameras):
                return cls(np.asarray(pair.matrix), sizes, cameras, wide=True)
            return cls(fundamental_from_essential(pair.matrix, *cameras), sizes, cameras)
        return None

    def distances(self, xy_a: Array, xy_b: Array) -> Array:
        """Return the larger distance (n,) of each match from its two epipolar lines, or mapped points, px."""
        if self.mapped:
            return np.asarray(np.sqrt(np.maximum(*transfer_squares(self.fundamental, xy_a, xy_b))))
        if self.wide and self.cameras is not None:
            rays = (rays_of(camera, xy) for camera, xy in zip(self.cameras, (xy_a, xy_b), strict=True))
            return RayPairs(*rays).line_distances(self.fundamental)
        a, b = self._ideal(0, xy_a), self._ideal(1, xy_b)
        return np.asarray(np.maximum(*line_distances(self.fundamental, a, b)))

    def curve(self, side: int, x: float, y: float) -> Array:
        """Return points (n, 2) of the epipolar curve, in the other photo, of pixel (x, y) of photo `side`.

        A straight line, bent by the distortion of the other camera where it is known; in a fish-eye photo the image of
        the whole epipolar plane, NaN outside the image circle. Of a homography one point.
        """
        if self.mapped:
            matrix = self.fundamental if side == 0 else np.linalg.inv(self.fundamental)
            return transfer(matrix, np.array([[x, y]]))
        if self.wide and self.cameras is not None:
            ray = ray_from_pixel(self.cameras[side], np.array([[x, y]]))[0]
            circle = epipolar_circle(self.fundamental, ray, 8 * SAMPLES, into_a=side == 1)
            pixels = pixel_from_ray(self.cameras[1 - side], circle)
            pixels[~within_field(self.cameras[1 - side], circle)] = np.nan
            return pixels
        a, b, c = epipolar_lines(self.fundamental, self._ideal(side, np.array([[x, y]])), into_a=side == 1)[0]
        width, height = self.sizes[1 - side]
        share = np.linspace(-0.25, 1.25, SAMPLES if self.cameras else 2)
        if abs(b) > abs(a):
            along = share * width
            line = np.column_stack([along, -(c + a * along) / b])
        else:
            along = share * height
            line = np.column_stack([-(c + b * along) / (a or np.nan), along])
        if self.cameras is None:
            return line
        camera = self.cameras[1 - side]
        rays = np.column_stack([line, np.ones(len(line))]) @ np.linalg.inv(interior_matrix(camera)).T
        return pixel_from_ray(camera, rays)

    def _ideal(self, side: int, xy: Array) -> Array:
        """Return distortion-free px (n, 2) of measured px."""
        xy = np.asarray(xy, np.float64).reshape(-1, 2)
        if self.cameras is None:
            return xy
        camera = self.cameras[side]
        return np.asarray((ray_from_pixel(camera, xy) @ interior_matrix(camera).T)[:, :2])
