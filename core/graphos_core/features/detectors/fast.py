r"""FAST corners: a circle of sixteen pixels tells a corner, described by ORB, BRIEF or SIFT."""

from __future__ import annotations

from typing import Annotated, Literal

import cv2
import numpy as np

from graphos_core.data import Array, Features
from graphos_core.features.detectors.assembling import assemble, working_image
from graphos_core.features.detectors.corners import Described, joined, reduced_levels
from graphos_core.features.detectors.description_kernels import centroid_directions
from graphos_core.features.detectors.opencv_names import create
from graphos_core.features.detectors.point_params import PointParams
from graphos_core.features.detectors.sift import hellinger
from graphos_core.features.detectors.sift_description import CELLS_ACROSS, sift_descriptors, sift_directions
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/fast"

PATCH = 31
"""Side of the described square, px of the level, as in Rublee et al. 2011."""

BYTES = 32
"""Length of the binary descriptors."""


class FastParams(PointParams):
    """Parameters of FAST corners."""

    threshold: Annotated[
        int,
        About(
            label="Threshold",
            symbol="t",
            unit="grey level",
            low=1,
            high=100,
            step=1,
            help="So much must 9 neighbouring ones of 16 pixels on a circle be brighter, or darker, than its middle.",
            effect="Higher: fewer corners, of strong contrast. Lower: more corners, also in noise.",
            learn=LESSON,
            level="novice",
        ),
    ] = 25
    suppression: Annotated[
        bool,
        About(
            label="Strongest only",
            help="Of neighbouring corners only the one with the highest score stays.",
            effect="On: one point per corner. Off: a cluster of points at each.",
            learn=LESSON,
            level="student",
        ),
    ] = True
    levels: Annotated[
        int,
        About(
            label="Levels",
            symbol="L",
            unit="levels",
            low=1,
            high=16,
            step=1,
            help="Corners are sought in the photo and in so many sizes of it, each smaller than the one before.",
            effect="Higher: corners survive a change of distance, slower. 1: the photo only, as published.",
            learn=LESSON,
            level="student",
        ),
    ] = 6
    scale_factor: Annotated[
        float,
        About(
            label="Factor between levels",
            symbol="f",
            low=1.1,
            high=3.0,
            step=0.1,
            help="Each level is smaller than the one before by this factor.",
            effect="Higher: a larger range with few levels, gaps between them. Lower: sizes are sampled finer.",
            learn=LESSON,
            level="expert",
        ),
    ] = 1.4
    descriptor: Annotated[
        Literal["orb", "brief", "sift"],
        About(
            label="Descriptor",
            help="FAST only finds corners. ORB: comparisons in a turned patch. BRIEF: the same, upright. SIFT: "
            "histograms of gradients.",
            effect="SIFT: most matches, slowest. BRIEF: for photos that are not turned about their axis.",
            choices={"orb": "ORB (binary)", "brief": "BRIEF (binary, upright)", "sift": "SIFT (Hellinger)"},
            learn=LESSON,
            level="novice",
        ),
    ] = "orb"


@algorithm(
    stage="features",
    role="detector",
    name="fast",
    label="FAST corners",
    source="Rosten and Drummond 2006, Machine learning for high-speed corner detection; descriptors: Rublee et al. "
    "2011 (ORB), Calonder et al. 2010 (BRIEF), Lowe 2004 (SIFT)",
    learn=LESSON,
)
def fast(grey: Array, colour: Array, params: FastParams, *, run: Run, mask: Array | None = None) -> Features:
    """Find FAST corners on several sizes of the photo and describe each.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : FastParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Binary descriptors of 256 bits, uint8 (n, 32), or those of SIFT, uint8 (n, 128).
    """
    working = working_image(grey, params.reduction)
    parts = []
    for level in reduced_levels(working, params.levels, params.scale_factor):
        run.check()
        parts.append(_on_level(level, working.shape, params))
    metric = "l2" if params.descriptor == "sift" else "hamming"
    return assemble(joined(parts, metric), working.shape, colour, params, mask)


def fast_corners(image: Array, threshold: int, suppression: bool) -> tuple[Array, Array]:
    """Return the FAST corners of one image, float64 (n, 2), px, and their scores, float64 (n,).

    Nine neighbouring ones of the sixteen pixels at radius 3 px must be brighter, or darker. (The smaller circles of
    OpenCV are not offered: its quick rejection test is that of sixteen pixels and loses corners of the others.)

    Parameters
    ----------
    image : uint8 (h, w)
    threshold, suppression
        As in `FastParams`.
    """
    points = create("FastFeatureDetector", threshold, suppression).detect(image)
    table = np.array([(*p.pt, p.response) for p in points], dtype=np.float64).reshape(-1, 3)
    return table[:, :2], table[:, 2]


def _on_level(level: Array, working: tuple[int, ...], params: FastParams) -> Described:
    """Return position, diameter, angle, strength and descriptor of a level's corners, px of the working image."""
    xy, strength = fast_corners(level, params.threshold, params.suppression)
    factors = np.array([working[1] / level.shape[1], working[0] / level.shape[0]])
    if params.descriptor == "sift":
        sigma = PATCH / CELLS_ACROSS
        index, angle = sift_directions(level, xy, sigma)
        descriptors, diameter = hellinger(sift_descriptors(level, xy[index], angle, sigma)), 2.0 * sigma
    else:
        angle = (
            centroid_directions(level, xy, PATCH // 2) if params.descriptor == "orb" else np.zeros(len(xy))
        )
        index, descriptors = _compared(level, xy, angle, params.descriptor)
        angle, diameter = angle[index], float(PATCH)
    scale = np.full(len(index), diameter * np.sqrt(factors.prod()))
    return (xy[index] + 0.5) * factors - 0.5, scale, angle, strength[index], descriptors


def _compared(level: Array, xy: Array, angle: Array, kind: str) -> tuple[Array, Array]:
    """Return which points have a binary descriptor, those not too near to the border, and the descriptors."""
    points = [
        cv2.KeyPoint(float(x), float(y), float(PATCH), float(turn), 0.0, 0, i)
        for i, ((x, y), turn) in enumerate(zip(xy, np.degrees(angle) % 360.0, strict=True))
    ]
    if kind == "orb":
        extractor = create("ORB", nlevels=1, edgeThreshold=PATCH // 2 + 1, patchSize=PATCH)
    else:
        extractor = create("BriefDescriptorExtractor", BYTES)
    kept, descriptors = extractor.compute(level, points) if points else ([], None)
    index = np.array([point.class_id for point in kept], dtype=np.int64)
    return index, np.zeros((0, BYTES), np.uint8) if descriptors is None else descriptors
