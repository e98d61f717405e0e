r"""ORB: FAST corners on several sizes of the photo, with a direction and a binary descriptor."""

from __future__ import annotations

from typing import Annotated, Literal

import cv2

from graphos_core.data import Array, Features
from graphos_core.features.detectors.assembling import assemble, working_image
from graphos_core.features.detectors.opencv_names import binary_points, create, most_levels
from graphos_core.features.detectors.point_params import PointParams
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/orb"

WITHOUT_LIMIT = 1_000_000
"""Number of points asked of OpenCV: all of them, so that the selection chooses among all."""


class OrbParams(PointParams):
    """Parameters of ORB."""

    threshold: Annotated[
        int,
        About(
            label="FAST threshold",
            symbol="t",
            unit="grey level",
            low=1,
            high=100,
            step=1,
            help="So much must the pixels of an arc around a corner be brighter or darker than its middle.",
            effect="Higher: fewer corners, of strong contrast. Lower: more corners, also in noise.",
            learn=LESSON,
            level="student",
        ),
    ] = 20
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
            effect="Higher: corners survive a change of distance, slower. 1: the photo only.",
            learn=LESSON,
            level="student",
        ),
    ] = 8
    scale_factor: Annotated[
        float,
        About(
            label="Factor between levels",
            symbol="f",
            low=1.05,
            high=2.0,
            step=0.05,
            help="Each level is smaller than the one before by this factor.",
            effect="Higher: a larger range with few levels, gaps between them. Lower: sizes are sampled finer.",
            learn=LESSON,
            level="expert",
        ),
    ] = 1.2
    patch: Annotated[
        int,
        About(
            label="Patch",
            symbol="p",
            unit="px",
            low=9,
            high=99,
            step=2,
            help="Side of the square whose pixels are compared, and diameter of the disc that gives the direction.",
            effect="Higher: more distinctive, suffers more from tilt. Lower: more local.",
            learn=LESSON,
            level="expert",
        ),
    ] = 31
    rank: Annotated[
        Literal["harris", "fast"],
        About(
            label="Strength",
            help="What counts as the strength of a corner, by which points can be chosen.",
            effect="Harris: corners before edges. FAST: faster, slightly less stable points.",
            choices={"harris": "Harris response", "fast": "FAST score"},
            learn=LESSON,
            level="expert",
        ),
    ] = "harris"


@algorithm(
    stage="features",
    role="detector",
    name="orb",
    label="ORB",
    source="Rublee, Rabaud, Konolige and Bradski 2011, ORB: an efficient alternative to SIFT or SURF",
    learn=LESSON,
)
def orb(grey: Array, colour: Array, params: OrbParams, *, run: Run, mask: Array | None = None) -> Features:
    """Find FAST corners on a pyramid and describe each by 256 comparisons of pixels in its turned patch.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : OrbParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Binary descriptors of 256 bits, uint8 (n, 32).
    """
    working = working_image(grey, params.reduction)
    rank = cv2.ORB_HARRIS_SCORE if params.rank == "harris" else cv2.ORB_FAST_SCORE
    levels = most_levels(working.shape, params.scale_factor, params.levels)
    detector = create(
        "ORB", WITHOUT_LIMIT, params.scale_factor, levels, params.patch, 0, 2, rank, params.patch,
        params.threshold,
    )  # fmt: skip
    return assemble(binary_points(detector, working), working.shape, colour, params, mask)
