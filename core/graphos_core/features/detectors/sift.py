r"""SIFT: blobs of the difference-of-Gaussians pyramid, with a histogram of gradients as descriptor."""

from __future__ import annotations

from typing import Annotated, Literal

import cv2
import numpy as np

from graphos_core.data import Array, Features
from graphos_core.features.detectors.selection import choose_evenly, choose_largest
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/sift"

WORKING_PIXELS = 1_250_000
"""With automatic reduction photos are worked on at this size, where SIFT finds more points than are kept."""

DESCRIPTOR_NORM = 512.0
"""Length of OpenCV's descriptors, and of the Hellinger form made here, before they are rounded to bytes."""


class SiftParams(Params):
    """Parameters of SIFT."""

    maximum: Annotated[
        int,
        About(
            label="Points kept",
            symbol="N",
            unit="points",
            low=50,
            high=100_000,
            step=500,
            help="At most so many points of each photo are kept.",
            effect="Higher: more object points, matching time grows with the square. Lower: faster.",
            learn=LESSON,
            level="novice",
        ),
    ] = 8192
    selection: Annotated[
        Literal["scale", "even"],
        About(
            label="Choose points",
            help="Which points stay when there are more: the largest, or the largest of every image cell.",
            effect="By scale: most matches. Evenly: weakly structured parts of the photo get points too.",
            choices={"scale": "by scale", "even": "evenly"},
            learn=LESSON,
            level="novice",
        ),
    ] = "scale"
    reduction: Annotated[
        float | None,
        About(
            label="Reduction",
            symbol="s",
            low=1.0,
            high=8.0,
            step=0.5,
            help="The photo is reduced by this factor before detection; automatic: to about 1.25 million pixels.",
            effect="Higher: faster, coarser points. 1: every pixel counts, slow for large photos.",
            learn=LESSON,
            level="student",
        ),
    ] = None
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
    ] = 0.03
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
def sift(grey: Array, colour: Array, params: SiftParams, *, run: Run) -> Features:
    """Find blobs at all scales and describe each by a histogram of gradients.

    The photo may be reduced by a factor s first; a point (x_s, y_s) found there maps back by
    ``x = (x_s + 0.5)·s − 0.5``, with the factors of both axes taken from the rounded working size. More points
    than `SiftParams.maximum` are limited by scale or evenly, never by strength: the strongest responses are the
    smallest blobs, and choosing them loses half the matches.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : SiftParams
    run : Run

    Returns
    -------
    Features
        Descriptors uint8 (n, 128) of length about 512.
    """
    height, width = grey.shape
    working = _reduced(grey, params.reduction)
    factors = np.array([width / working.shape[1], height / working.shape[0]])
    detector = cv2.SIFT_create(  # type: ignore[attr-defined]
        0, params.layers, params.contrast, params.edge, params.sigma, cv2.CV_8U, True
    )
    points, descriptors = detector.detectAndCompute(working, None)
    table = np.array(
        [(*p.pt, p.size, p.angle, p.response) for p in points], dtype=np.float64
    ).reshape(-1, 5)  # fmt: skip
    found = len(table)
    table[:, :2] = (table[:, :2] + 0.5) * factors - 0.5
    choose = choose_evenly if params.selection == "even" else choose_largest
    kept = choose(table[:, :2], table[:, 2], params.maximum, (width, height))
    table = table[kept]
    descriptors = np.zeros((0, 128), np.uint8) if found == 0 else descriptors[kept]
    return Features(
        xy=table[:, :2].astype(np.float32),
        scale=(table[:, 2] * np.sqrt(factors.prod())).astype(np.float32),
        angle=(np.radians((table[:, 3] + 180.0) % 360.0 - 180.0)).astype(np.float32),
        response=table[:, 4].astype(np.float32),
        descriptors=_hellinger(descriptors) if params.hellinger else descriptors,
        colour=_colour_at(colour, table[:, :2]),
        width=width,
        height=height,
        found=found,
    )


def _reduced(grey: Array, reduction: float | None) -> Array:
    height, width = grey.shape
    factor = max(1.0, np.sqrt(grey.size / WORKING_PIXELS)) if reduction is None else reduction
    size = (max(16, round(width / factor)), max(16, round(height / factor)))
    return grey if size == (width, height) else cv2.resize(grey, size, interpolation=cv2.INTER_AREA)


def _hellinger(descriptors: Array) -> Array:
    """Square root of the descriptor divided by its sum: length 1, stored as bytes of length 512."""
    values = descriptors.astype(np.float32)
    total = np.maximum(values.sum(axis=1, keepdims=True), 1.0)
    return np.minimum(np.rint(DESCRIPTOR_NORM * np.sqrt(values / total)), 255.0).astype(np.uint8)


def _colour_at(colour: Array, xy: Array) -> Array:
    rows = np.clip(np.rint(xy[:, 1]).astype(np.intp), 0, colour.shape[0] - 1)
    columns = np.clip(np.rint(xy[:, 0]).astype(np.intp), 0, colour.shape[1] - 1)
    values = colour[rows, columns]
    if values.dtype == np.uint16:
        values = (values >> 8).astype(np.uint8)
    return np.repeat(values[:, None], 3, axis=1) if values.ndim == 1 else values
