r"""Undistortion: photos as a camera without distortion would have taken them, by a calibration that is known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import cv2
import numpy as np

from graphos_core.cameras.undistortion import ideal_camera, positions_in_photo
from graphos_core.data import Array, Camera
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/undistortion"


@dataclass(frozen=True)
class Resampling:
    """How undistorted photos are made of those of one camera.

    Attributes
    ----------
    camera : Camera
        Calibrated, of the photos as taken.
    ideal : Camera
        Of the undistorted photos.
    lanczos : bool
        Lanczos' kernel over 8 × 8 pixels instead of the bicubic one over 4 × 4.
    """

    camera: Camera
    ideal: Camera
    lanczos: bool = False

    def positions(self) -> Array:
        """Return where the pixels of the undistorted photo lie in the one as taken; see `positions_in_photo`."""
        return positions_in_photo(self.camera, self.ideal)

    def apply(self, image: Array, positions: Array) -> Array:
        """Return the undistorted image: uint8 or uint16 (h, w) or (h, w, n) as `image`; 0 where it shows nothing."""
        bands = [image] if image.ndim == 2 else cv2.split(image)
        made = [self._band(np.ascontiguousarray(band), positions) for band in bands]
        return made[0] if image.ndim == 2 else np.dstack(made)

    def _band(self, band: Array, positions: Array) -> Array:
        how = cv2.INTER_LANCZOS4 if self.lanczos else cv2.INTER_CUBIC
        lost = np.isnan(positions[:, :, 0])
        x, y = np.ascontiguousarray(positions[:, :, 0]), np.ascontiguousarray(positions[:, :, 1])
        made = cv2.remap(
            band, np.where(lost, 0, x), np.where(lost, 0, y), how, borderMode=cv2.BORDER_REFLECT_101
        )
        made[lost] = 0
        return made

    def shown(self, mask: Array | None, positions: Array) -> Array:
        """Return where the undistorted photo shows pixels that `mask` allows, as far as the kernel reaches.

        Parameters
        ----------
        mask : bool (H, W) or None
            Of the photo as taken; None: everywhere.
        positions : float32 (h, w, 2)

        Returns
        -------
        bool (h, w)
        """
        lost = np.isnan(positions[:, :, 0])
        if mask is None:
            return ~lost
        reach = 9 if self.lanczos else 5
        sure = cv2.erode(mask.astype(np.uint8), np.ones((reach, reach), np.uint8), borderValue=1)
        return self.nearest(sure > 0, positions) & ~lost

    @staticmethod
    def nearest(mask: Array, positions: Array) -> Array:
        """Return a mask (H, W) of the photo as taken in the undistorted photo: the nearest pixel; False outside."""
        lost = np.isnan(positions[:, :, 0])
        x, y = (np.rint(np.where(lost, 0, positions[:, :, i])).astype(np.intp) for i in range(2))
        return mask[y, x] & ~lost


class AsTakenParams(Params):
    """Photos as they are have no parameters."""


class CalibratedParams(Params):
    """Which calibration undistorts, and how pixels are interpolated."""

    calibration: Annotated[
        str,
        About(
            label="Calibration",
            help="File with calibrated cameras, relative to the project folder: of “graphos calibrate”, or the "
            "cameras.toml of an earlier run (runs/0001/cameras.toml). Empty: the calibration given with the project.",
            effect="Its distortion is taken out of the photos; what is wrong in it stays in them.",
            learn=LESSON,
            level="novice",
            files="Calibration (*.toml)",
        ),
    ] = ""
    interpolation: Annotated[
        Literal["cubic", "lanczos"],
        About(
            label="Interpolation",
            help="How grey values between the pixels of the photo are found.",
            effect="Bicubic: fast, slightly softer. Lanczos: keeps fine detail, faint rings at sharp edges.",
            choices={"cubic": "bicubic (4 × 4 px)", "lanczos": "Lanczos (8 × 8 px)"},
            learn=LESSON,
            level="student",
        ),
    ] = "cubic"


@algorithm(
    stage="preprocessing",
    role="undistortion",
    name="as_taken",
    label="Photos as taken",
    source="Brown 1971, Close-range camera calibration: distortion belongs into the camera, not into the pixels",
    learn=LESSON,
)
def as_taken(camera: Camera, params: AsTakenParams, *, run: Run) -> Resampling | None:
    """Leave the photos as they are: distortion is part of the camera and is estimated with it."""
    return None


@algorithm(
    stage="preprocessing",
    role="undistortion",
    name="calibrated",
    label="Undistorted by a calibration",
    source="Keys 1981, Cubic convolution interpolation for digital image processing; "
    "Luhmann et al. 2020, section 3.3, correction of distortion",
    learn=LESSON,
)
def calibrated(camera: Camera, params: CalibratedParams, *, run: Run) -> Resampling | None:
    """Resample the photos as the ideal camera of the same principal distance would have taken them.

    Each pixel of the new photo is followed along its ray into the photo as taken, where the grey value is
    interpolated. Later steps see the new photos together with the ideal camera.

    Parameters
    ----------
    camera : Camera
        Calibrated.
    params : CalibratedParams
    run : Run
    """
    return Resampling(camera, ideal_camera(camera), params.interpolation == "lanczos")
