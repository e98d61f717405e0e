r"""Simulated views: what a photo would look like from the side, for detectors that see no tilt themselves.

Every affine map with positive determinant is ``A = λ R(ψ) T_t R(φ)`` with ``T_t = diag(t, 1)`` (Morel and Yu 2009,
theorem 1; González-Aguilera et al. 2018, equation 1). A detector that is invariant to scale and rotation undoes λ and
ψ; tilt t and longitude φ are simulated here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.data import Array

ANTI_ALIASING = 0.8
"""Blur before the compression by t, ``0.8·√(t² − 1)`` px: Morel and Yu 2009, section 4.3."""

BLUR_RADIUS = 4.0
"""Half width of the Gaussian window, in standard deviations."""


@dataclass(frozen=True)
class Simulation:
    """One simulated view of a photo.

    Attributes
    ----------
    tilt : float
        t = 1 / cos θ of the angle θ between the simulated viewing direction and the photo's.
    longitude : float
        φ, radians: the direction of the tilt.
    image : uint8 (h, w)
    simulated_from_photo : float64 (2, 3)
        Affine map of pixel coordinates, centre of the top-left pixel (0, 0) in both.
    size : (int, int)
        Width and height of the photo, px.
    """

    tilt: float
    longitude: float
    image: Array
    simulated_from_photo: Array
    size: tuple[int, int]

    @property
    def photo_from_simulated(self) -> Array:
        """The way back, float64 (2, 3)."""
        return np.asarray(cv2.invertAffineTransform(self.simulated_from_photo))


def views(tilts: int, longitude_step: float) -> tuple[tuple[float, float], ...]:
    """Return the (tilt, longitude) of all simulated views, the photo itself first.

    Tilts are ``t = √2ᵏ`` with k = 0 … `tilts`; longitudes go from 0 to less than 180° in steps of b / t, because a
    strongly tilted view changes faster with its direction (Yu and Morel 2011, section 3).

    Parameters
    ----------
    tilts : int
        Number of tilts beside the photo itself.
    longitude_step : float
        b, radians; 72° in the publication.
    """
    found = [(1.0, 0.0)]
    for k in range(1, tilts + 1):
        tilt = math.sqrt(2.0) ** k
        count = math.ceil(math.pi * tilt / longitude_step - 1e-9)
        found += [(tilt, j * longitude_step / tilt) for j in range(count)]
    return tuple(found)


def rotation_of_view(longitude: float, size: tuple[int, int]) -> tuple[Array, tuple[int, int]]:
    """Return the map from the photo to the photo rotated by φ, and the size that holds all of it.

    Parameters
    ----------
    longitude : float
        Radians, from x towards y.
    size : (int, int)
        Width and height of the photo, px.

    Returns
    -------
    float64 (2, 3), (int, int)
        Pixel coordinates; the outline of the rotated photo begins at −½ px.
    """
    width, height = size
    cosine, sine = math.cos(longitude), math.sin(longitude)
    rotation = np.array([[cosine, -sine], [sine, cosine]])
    outline = np.array([(0, 0), (width, 0), (width, height), (0, height)]) - 0.5
    rotated = outline @ rotation.T
    low = rotated.min(axis=0)
    extent = np.ceil(rotated.max(axis=0) - low - 1e-6).astype(int)
    return np.column_stack([rotation, -0.5 - low]), (int(extent[0]), int(extent[1]))


def compression(tilt: float) -> Array:
    """Return the map of pixel coordinates that divides x by t: ``x' = (x + ½) / t − ½``; float64 (2, 3)."""
    return np.array([[1.0 / tilt, 0.0, 0.5 / tilt - 0.5], [0.0, 1.0, 0.0]])


def simulate(grey: Array, tilt: float, longitude: float) -> Simulation:
    """Make the view of a photo from tilt t and longitude φ: rotate, blur in x, compress x by t.

    Outside the photo its border is continued; `fully_inside` tells which points do not depend on it.

    Parameters
    ----------
    grey : uint8 (h, w)
    tilt : float
        At least 1; 1 with longitude 0 is the photo itself.
    longitude : float
        Radians.
    """
    size = (grey.shape[1], grey.shape[0])
    rotate, extent = rotation_of_view(longitude, size)
    image = grey
    if longitude != 0.0:
        image = cv2.warpAffine(grey, rotate, extent, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    if tilt == 1.0:
        return Simulation(tilt, longitude, image, rotate, size)
    blur = ANTI_ALIASING * math.sqrt(tilt * tilt - 1.0)
    image = cv2.GaussianBlur(
        image, (2 * math.ceil(BLUR_RADIUS * blur) + 1, 1), blur, borderType=cv2.BORDER_REPLICATE
    )
    compress = compression(tilt)
    image = cv2.warpAffine(
        image,
        compress,
        (math.ceil(extent[0] / tilt), extent[1]),
        flags=cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return Simulation(tilt, longitude, image, _composed(compress, rotate), size)


def mapped(affine: Array, xy: Array) -> Array:
    """Return the points float64 (n, 2) mapped by an affine map (2, 3)."""
    return np.asarray(xy @ affine[:, :2].T + affine[:, 2])


def keypoints_in_photo(view: Simulation, xy: Array, scale: Array, angle: Array) -> tuple[Array, Array, Array]:
    """Map keypoints of a simulated view back to the photo.

    The scale is multiplied by √t, so that the area of the circle becomes that of the ellipse it really is in the
    photo; the orientation is that of the mapped direction vector.

    Parameters
    ----------
    view : Simulation
    xy : float64 (n, 2)
        Positions in the simulated view, px.
    scale, angle : float64 (n,)
        Diameters in px, orientations in radians from x towards y.

    Returns
    -------
    float64 (n, 2), float64 (n,), float64 (n,)
        Position, diameter and orientation (−π to π) in the photo.
    """
    back = view.photo_from_simulated
    direction = np.column_stack([np.cos(angle), np.sin(angle)]) @ back[:, :2].T
    area = abs(float(np.linalg.det(back[:, :2])))
    return mapped(back, xy), scale * math.sqrt(area), np.arctan2(direction[:, 1], direction[:, 0])


def fully_inside(view: Simulation, xy: Array, radius: Array) -> Array:
    """Tell which circles of a simulated view show nothing but the photo.

    Parameters
    ----------
    view : Simulation
    xy : float64 (n, 2)
        Centres in the simulated view, px.
    radius : float64 (n,)
        Radii in the simulated view, px.

    Returns
    -------
    bool (n,)
    """
    width, height = view.size
    outline = np.array([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]) - 0.5
    corners = mapped(view.simulated_from_photo, outline)
    inside = np.ones(len(xy), bool)
    for corner, following in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        edge = (following - corner) / np.linalg.norm(following - corner)
        offset = xy - corner
        inside &= edge[0] * offset[:, 1] - edge[1] * offset[:, 0] >= radius
    return inside


def _composed(c_from_b: Array, b_from_a: Array) -> Array:
    linear = c_from_b[:, :2] @ b_from_a[:, :2]
    return np.column_stack([linear, c_from_b[:, :2] @ b_from_a[:, 2] + c_from_b[:, 2]])
