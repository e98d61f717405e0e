"""From the points a detector found in a working image to `Features` of the full photo."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from graphos_core.data import Array, Features
from graphos_core.features.detectors.point_params import PointParams, points_kept
from graphos_core.features.detectors.selection import choose

WORKING_PIXELS = 1_250_000
"""With automatic reduction photos are worked on at this size, where SIFT finds more points than are kept."""

LEAST_SIDE = 16


@dataclass(frozen=True)
class FoundPoints:
    """Points in a working image.

    Attributes
    ----------
    xy : float64 (n, 2)
        Px of the working image, centre of the top-left pixel is (0, 0).
    scale : float64 (n,)
        Diameters, px of the working image.
    angle : float64 (n,)
        Radians, from x towards y.
    response : float64 (n,)
    descriptors : uint8 or float32 (n, d)
    metric : {"l2", "hamming"}
        As in `Features`.
    """

    xy: Array
    scale: Array
    angle: Array
    response: Array
    descriptors: Array
    metric: str = "l2"

    @classmethod
    def of_cv2(cls, points: Sequence[Any], descriptors: Array, metric: str = "l2") -> FoundPoints:
        """Take over OpenCV's keypoints; an orientation of −1 (none) becomes 0."""
        table = np.array(
            [(*p.pt, p.size, p.angle if p.angle >= 0 else 0.0, p.response) for p in points], dtype=np.float64
        ).reshape(-1, 5)  # fmt: skip
        angle = np.radians((table[:, 3] + 180.0) % 360.0 - 180.0)
        return cls(table[:, :2], table[:, 2], angle, table[:, 4], descriptors, metric)

    @classmethod
    def joined(cls, parts: Sequence[FoundPoints]) -> FoundPoints:
        """Return the points of at least one set as one, in their order."""
        return cls(
            xy=np.concatenate([part.xy for part in parts]),
            scale=np.concatenate([part.scale for part in parts]),
            angle=np.concatenate([part.angle for part in parts]),
            response=np.concatenate([part.response for part in parts]),
            descriptors=np.concatenate([part.descriptors for part in parts]),
            metric=parts[0].metric,
        )

    def take(self, index: Array) -> FoundPoints:
        """Return some of the points, by their indices."""
        return FoundPoints(
            self.xy[index], self.scale[index], self.angle[index], self.response[index],
            self.descriptors[index], self.metric,
        )  # fmt: skip


def working_image(grey: Array, reduction: float | None, pixels: int = WORKING_PIXELS) -> Array:
    """Return the photo reduced by a factor, or to about so many pixels without one; never enlarged.

    Parameters
    ----------
    grey : uint8 (h, w)
    reduction : float or None
    pixels : int
    """
    height, width = grey.shape
    factor = max(1.0, np.sqrt(grey.size / pixels)) if reduction is None else reduction
    least = (min(LEAST_SIDE, width), min(LEAST_SIDE, height))
    size = (max(least[0], round(width / factor)), max(least[1], round(height / factor)))
    return grey if size == (width, height) else cv2.resize(grey, size, interpolation=cv2.INTER_AREA)


def assemble(
    points: FoundPoints,
    working: tuple[int, ...],
    colour: Array,
    params: PointParams,
    mask: Array | None = None,
) -> Features:
    """Map points back to the full photo, drop masked ones, limit their number and read their colours.

    A point (x_s, y_s) of the working image maps back by ``x = (x_s + 0.5)·s − 0.5`` with the factors s of both axes
    taken from the rounded working size.

    Parameters
    ----------
    points : FoundPoints
    working : (int, int)
        Height and width of the working image.
    colour : uint8 (h, w, 3) or (h, w)
    params : PointParams
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        In the order of the selection; ``found`` counts the points outside the mask before it.
    """
    height, width = colour.shape[:2]
    factors = np.array([width / working[1], height / working[0]])
    xy = (points.xy + 0.5) * factors - 0.5
    scale = points.scale * np.sqrt(factors.prod())
    most = points_kept(params.maximum, width, height)
    allowed = np.arange(len(xy)) if mask is None else np.flatnonzero(_at(mask, xy))
    kept = allowed[
        choose(
            params.selection, xy[allowed], scale[allowed], points.response[allowed], most, (width, height)
        )
    ]  # fmt: skip
    return Features(
        xy=xy[kept].astype(np.float32),
        scale=scale[kept].astype(np.float32),
        angle=points.angle[kept].astype(np.float32),
        response=points.response[kept].astype(np.float32),
        descriptors=points.descriptors[kept],
        colour=_colour_at(colour, xy[kept]),
        width=width,
        height=height,
        found=len(allowed),
        metric=points.metric,
    )


def _at(image: Array, xy: Array) -> Array:
    """Return the pixels of an image nearest to the points."""
    rows = np.clip(np.rint(xy[:, 1]).astype(np.intp), 0, image.shape[0] - 1)
    columns = np.clip(np.rint(xy[:, 0]).astype(np.intp), 0, image.shape[1] - 1)
    return np.asarray(image[rows, columns])


def _colour_at(colour: Array, xy: Array) -> Array:
    values = _at(colour, xy)
    if values.dtype == np.uint16:
        values = (values >> 8).astype(np.uint8)
    return np.repeat(values[:, None], 3, axis=1) if values.ndim == 1 else values
