"""Photos as a distortion-free camera would have taken them, reduced to the size of the depth maps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Array, Block, Camera

OUTSIDE = 0
"""Grey level of pixels that the photo does not show; true greys are 1 to 255."""


@dataclass(frozen=True)
class View:
    """A distortion-free, reduced grey photo with its exterior orientation.

    Attributes
    ----------
    photo : int
        Index in the block.
    grey : uint8 (h, w)
        1 to 255; 0 where the photo shows nothing.
    focal_px, cx, cy : float
        Distortion-free camera, px of this picture.
    rotation : float64 (3, 3)
        ``cam_from_world``.
    centre : float64 (3,)
        Projection centre in the object frame.
    """

    photo: int
    grey: Array
    focal_px: float
    cx: float
    cy: float
    rotation: Array
    centre: Array

    @property
    def matrix(self) -> Array:
        """Calibration matrix K (3, 3)."""
        return calibration_matrix(self.focal_px, self.cx, self.cy)

    def halved(self) -> View:
        """Return the next level of the pyramid: both sides halved, pixels averaged two by two."""
        h, w = self.grey.shape[0] // 2, self.grey.shape[1] // 2
        whole = self.grey[: 2 * h, : 2 * w]
        small = cv2.resize(whole, (w, h), interpolation=cv2.INTER_AREA)
        hidden = (whole == OUTSIDE).reshape(h, 2, w, 2).any(axis=(1, 3))
        small = np.where(hidden, OUTSIDE, np.maximum(small, 1)).astype(np.uint8)
        return replace(
            self,
            grey=small,
            focal_px=self.focal_px / 2.0,
            cx=(self.cx + 0.5) / 2.0 - 0.5,
            cy=(self.cy + 0.5) / 2.0 - 0.5,
        )


def calibration_matrix(focal_px: float, cx: float, cy: float) -> Array:
    """Return K (3, 3) of a distortion-free camera, px."""
    return np.array([[focal_px, 0.0, cx], [0.0, focal_px, cy], [0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class Undistortion:
    """How the pixels of a distortion-free, reduced picture are found in the photo.

    Attributes
    ----------
    focal_px, cx, cy : float
        Distortion-free camera, px of the picture.
    scale : float
        Size of the picture relative to the photo.
    source_xy : float32 (h, w, 2)
        Position in the photo, px of the full photo; −1e6 where it shows nothing.
    """

    focal_px: float
    cx: float
    cy: float
    scale: float
    source_xy: Array


def undistortion(camera: Camera, longest_side: int) -> Undistortion:
    """Return the way from a picture whose longer side has at most `longest_side` px to the photo.

    The ideal camera keeps the principal distance and principal point of the photo, both reduced by the scale;
    ``x_picture = (x_photo + 0.5)·s − 0.5``.
    """
    scale = min(1.0, longest_side / max(camera.width, camera.height))
    w, h = max(1, round(camera.width * scale)), max(1, round(camera.height * scale))
    f = camera.focal_px * scale
    cx, cy = (float(camera.values[1]) + 0.5) * scale - 0.5, (float(camera.values[2]) + 0.5) * scale - 0.5
    x, y = np.meshgrid(np.arange(w, dtype=np.float64), np.arange(h, dtype=np.float64))
    rays = np.stack([(x - cx) / f, (y - cy) / f, np.ones_like(x)], axis=-1)
    source = pixel_from_ray(camera, rays.reshape(-1, 3)).reshape(h, w, 2)
    inside = (
        (source[..., 0] >= 0)
        & (source[..., 1] >= 0)
        & (source[..., 0] <= camera.width - 1)
        & (source[..., 1] <= camera.height - 1)
    )
    inside &= _one_to_one(camera, rays, source)
    source[~inside] = -1e6
    return Undistortion(f, cx, cy, scale, source.astype(np.float32))


def _one_to_one(camera: Camera, rays: Array, source: Array, *, every: int = 8) -> Array:
    """Return where the distortion can be inverted, checked on a coarse grid; bool (h, w)."""
    h, w = source.shape[:2]
    pixels = source[::every, ::every]
    back = ray_from_pixel(camera, pixels.reshape(-1, 2)).reshape(*pixels.shape[:2], 3)
    off = np.abs(back - rays[::every, ::every]).max(axis=-1)
    good = np.nan_to_num(off, nan=1.0) < 1e-6
    coarse = good.astype(np.uint8)
    return cv2.resize(coarse, (w, h), interpolation=cv2.INTER_NEAREST).astype(bool)


def undistort(image: Array, way: Undistortion) -> Array:
    """Return the distortion-free, reduced picture of a photo.

    Parameters
    ----------
    image : uint8 (H, W) or (H, W, 3)
    way : Undistortion

    Returns
    -------
    uint8 (h, w) or (h, w, 3)
        0 where the photo shows nothing.
    """
    if way.scale < 0.99:  # low-pass to the pixel size of the picture before sampling
        sigma = 0.45 * np.sqrt(1.0 / way.scale**2 - 1.0)
        image = cv2.GaussianBlur(image, (0, 0), sigma)
    x, y = np.ascontiguousarray(way.source_xy[..., 0]), np.ascontiguousarray(way.source_xy[..., 1])
    return cv2.remap(image, x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=(OUTSIDE,) * 3)


def undistorted_mask(mask: Array, way: Undistortion) -> Array:
    """Return where all pixels behind a pixel of the distortion-free, reduced picture are free; bool (h, w).

    Parameters
    ----------
    mask : bool (H, W)
        Of the full photo, True where something may be measured.
    way : Undistortion
    """
    reach = int(np.ceil(0.5 / way.scale))
    sure = cv2.erode(mask.astype(np.uint8), np.ones((2 * reach + 1, 2 * reach + 1), np.uint8), borderValue=1)
    x, y = (
        np.clip(np.rint(way.source_xy[..., i]), 0, mask.shape[1 - i] - 1).astype(np.intp) for i in range(2)
    )
    return sure[y, x] > 0


def grey_view(block: Block, photo: int, image: Array, way: Undistortion, mask: Array | None = None) -> View:
    """Return the grey `View` of an oriented photo.

    Parameters
    ----------
    block : Block
    photo : int
    image : uint8 (H, W) or (H, W, 3) RGB
        The full photo.
    way : Undistortion
        Of the photo's camera.
    mask : bool (H, W), optional
        True where something may be measured; the rest counts as not shown.
    """
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) if image.ndim == 3 else image
    grey = np.maximum(undistort(grey, way), 1)
    grey[way.source_xy[..., 0] < -1e5] = OUTSIDE
    if mask is not None:
        grey[~undistorted_mask(mask, way)] = OUTSIDE
    return View(photo, grey, way.focal_px, way.cx, way.cy, block.rotations[photo], block.centres[photo])
