r"""SIFT: blobs of the difference-of-Gaussians pyramid, with a histogram of gradients as descriptor."""

from __future__ import annotations

from typing import Annotated, Any

import cv2
import numpy as np

from graphos_core.data import Array, Features
from graphos_core.features.detectors.assembling import FoundPoints, assemble, working_image
from graphos_core.features.detectors.point_params import PointParams
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/sift"

DESCRIPTOR_NORM = 512.0
"""Length of OpenCV's descriptors, and of the Hellinger form made here, before they are rounded to bytes."""

MANY = 100
"""More octaves than any photo has."""


class SiftParams(PointParams):
    """Parameters of SIFT."""

    contrast: Annotated[
        float,
        About(
            label="Contrast threshold",
            symbol="C",
            low=0.0,
            high=0.5,
            step=0.005,
            help="A blob weaker than C divided by the layers per octave (grey range 0 to 1) is dropped.",
            effect="Higher: fewer points, in structured parts only. Lower: more points, also in noise.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.02
    edge: Annotated[
        float,
        About(
            label="Edge threshold",
            symbol="r",
            low=1.0,
            low_open=True,
            high=100.0,
            step=1.0,
            help="A blob whose principal curvatures have a larger ratio lies on an edge and is dropped.",
            effect="Higher: more points along edges, which slide. Lower: only round blobs stay.",
            learn=LESSON,
            level="student",
        ),
    ] = 10.0
    layers: Annotated[
        int,
        About(
            label="Layers per octave",
            symbol="n",
            unit="layers",
            low=1,
            high=8,
            step=1,
            help="Scales examined between one size and its double.",
            effect="Higher: scale is sampled finer, slower. Lower: faster, fewer repeated points.",
            learn=LESSON,
            level="expert",
        ),
    ] = 3
    sigma: Annotated[
        float,
        About(
            label="First blur",
            symbol=r"\sigma_0",
            unit="px",
            low=0.6,
            high=5.0,
            step=0.1,
            help="Gaussian blur of the first layer, in pixels of the working image enlarged twice.",
            effect="Higher: the smallest blobs vanish. Lower: smaller blobs, more noise.",
            learn=LESSON,
            level="expert",
        ),
    ] = 1.6
    first_octave: Annotated[
        int,
        About(
            label="First octave",
            symbol="o_1",
            low=-1,
            high=6,
            step=1,
            help="Smallest octave whose blobs are kept; −1: that of the working image enlarged twice, 0: its own.",
            effect="Higher: blobs of less than about 4, 7, 14 px (0, 1, 2) are left out. Lower: small blobs too.",
            learn=LESSON,
            level="expert",
        ),
    ] = -1
    octaves: Annotated[
        int | None,
        About(
            label="Octaves",
            symbol="O",
            unit="octaves",
            low=1,
            high=16,
            step=1,
            help="So many octaves are used, each with blobs twice as large as the one before; automatic: all there are.",
            effect="Higher: large blobs too, which bridge large changes of distance. Lower: small blobs only.",
            learn=LESSON,
            level="expert",
        ),
    ] = None
    hellinger: Annotated[
        bool,
        About(
            label="RootSIFT",
            help="Compare square roots of the normalised descriptors (Hellinger distance).",
            effect="On: large bins weigh less, usually more correct matches. Off: descriptors as Lowe made them.",
            learn=LESSON,
            level="student",
        ),
    ] = True


@algorithm(
    stage="features",
    role="detector",
    name="sift",
    label="SIFT",
    source="Lowe 2004, Distinctive image features from scale-invariant keypoints; "
    "RootSIFT: Arandjelović and Zisserman 2012, section 2",
    learn=LESSON,
)
def sift(grey: Array, colour: Array, params: SiftParams, *, run: Run, mask: Array | None = None) -> Features:
    """Find blobs at all scales and describe each by a histogram of gradients.

    The photo may be reduced first (`graphos_core.features.detectors.assembling`). Points are best limited by scale
    or evenly: the strongest responses are the smallest blobs, and choosing them loses half the matches.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : SiftParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Descriptors uint8 (n, 128) of length about 512.
    """
    working = working_image(grey, params.reduction)
    return assemble(find_sift(working, params), working.shape, colour, params, mask)


def find_sift(image: Array, params: SiftParams) -> FoundPoints:
    """Return the described points of one image, in its pixels.

    Parameters
    ----------
    image : uint8 (h, w)
    params : SiftParams
    """
    detector = cv2.SIFT_create(  # type: ignore[attr-defined]
        0, params.layers, params.contrast, params.edge, params.sigma, cv2.CV_8U, True
    )
    points, descriptors = detector.detectAndCompute(image, None)
    if descriptors is None:
        descriptors = np.zeros((0, 128), np.uint8)
    octave = np.array([octave_of(point) for point in points], dtype=np.int64)
    last = params.first_octave + (params.octaves or MANY)
    kept = np.flatnonzero((octave >= params.first_octave) & (octave < last))
    points, descriptors = [points[i] for i in kept], descriptors[kept]
    return FoundPoints.of_cv2(points, hellinger(descriptors) if params.hellinger else descriptors)


def octave_of(point: Any) -> int:
    """Return the octave of OpenCV's keypoint: −1 for the enlarged image. It is the lowest byte, with its sign."""
    low = point.octave & 255
    return low - 256 if low > 127 else low


def hellinger(descriptors: Array) -> Array:
    """Return the square root of descriptors divided by their sum: length 1, stored as bytes of length 512.

    Parameters
    ----------
    descriptors : uint8 or float32 (n, d), not negative
    """
    values = descriptors.astype(np.float32)
    total = np.maximum(values.sum(axis=1, keepdims=True), 1.0)
    return np.minimum(np.rint(DESCRIPTOR_NORM * np.sqrt(values / total)), 255.0).astype(np.uint8)
