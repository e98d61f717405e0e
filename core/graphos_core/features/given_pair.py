"""The orientation of two photos from an earlier result, for matchers that are guided by it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphos_core.cameras import camera_model, ray_from_pixel
from graphos_core.data import Array, Block, Camera
from graphos_core.features.pair_verdict import ideal_pixels
from graphos_core.geometry.epipolar import (
    essential_from_relative,
    fundamental_from_essential,
    relative_orientation,
)
from graphos_core.geometry.normalisation import homogeneous


@dataclass(frozen=True)
class GivenPair:
    """Cameras and exterior orientations of two photos.

    Attributes
    ----------
    cameras : (Camera, Camera)
    rotations : (float64 (3, 3), float64 (3, 3))
        ``cam_from_world``.
    centres : (float64 (3,), float64 (3,))
    """

    cameras: tuple[Camera, Camera]
    rotations: tuple[Array, Array]
    centres: tuple[Array, Array]

    def epipolar(self, xy_a: Array, xy_b: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Return what tells the distance of any point of a from the line of any point of b.

        ``|q_jᵀ M p_i| / length`` is the distance in px of point j from the line of point i, with the length of line i
        (in b) or of line j (in a). For wide cameras it is the angle from the epipolar plane times the principal
        distance. Points without a ray are NaN.

        Parameters
        ----------
        xy_a, xy_b : float (n, 2), (m, 2)
            Measured pixels.

        Returns
        -------
        M (3, 3), p (n, 3), q (m, 3), lengths (n,) of the lines in b, lengths (m,) of the lines in a
        """
        sides = [np.asarray(xy, dtype=np.float64) for xy in (xy_a, xy_b)]
        essential = essential_from_relative(
            *relative_orientation(self.rotations[0], self.centres[0], self.rotations[1], self.centres[1])
        )
        if any(camera_model(camera.model).wide for camera in self.cameras):
            p, q = (unit_rays(camera, xy) for camera, xy in zip(self.cameras, sides, strict=True))
            along, back = p @ essential.T, q @ essential
            return (
                essential, p, q, np.linalg.norm(along, axis=1) / self.cameras[1].focal_px,
                np.linalg.norm(back, axis=1) / self.cameras[0].focal_px,
            )  # fmt: skip
        p, q = (homogeneous(ideal_pixels(camera, xy)) for camera, xy in zip(self.cameras, sides, strict=True))
        matrix = fundamental_from_essential(essential, *self.cameras)
        along, back = p @ matrix.T, q @ matrix
        return matrix, p, q, np.linalg.norm(along[:, :2], axis=1), np.linalg.norm(back[:, :2], axis=1)


def unit_rays(camera: Camera, xy: Array) -> Array:
    """Return unit rays (n, 3) of pixels; NaN where there is none."""
    rays = ray_from_pixel(camera, xy)
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


def given_pair(block: Block | None, names: Sequence[str], index: tuple[int, int]) -> GivenPair | None:
    """Return the orientation of a pair in a block of an earlier result, photos by name; None where one is missing.

    Parameters
    ----------
    block : Block or None
    names : sequence of str
        Names of the photos that are matched.
    index : (int, int)
        Of the pair in `names`.
    """
    if block is None:
        return None
    place = {name: i for i, name in enumerate(block.names) if block.oriented[i]}
    found = [place.get(names[i]) for i in index]
    if found[0] is None or found[1] is None:
        return None
    a, b = int(found[0]), int(found[1])
    if np.allclose(block.centres[a], block.centres[b]):
        return None
    return GivenPair(
        cameras=(block.cameras[block.camera_of_photo[a]], block.cameras[block.camera_of_photo[b]]),
        rotations=(block.rotations[a], block.rotations[b]),
        centres=(block.centres[a], block.centres[b]),
    )
