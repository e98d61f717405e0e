r"""BRISK: corners of a pyramid, compared along rings of sampling points."""

from __future__ import annotations

from typing import Annotated

from graphos_core.data import Array, Features
from graphos_core.features.detectors.assembling import assemble, working_image
from graphos_core.features.detectors.opencv_names import binary_points, create, most_levels
from graphos_core.features.detectors.point_params import PointParams
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/brisk"


class BriskParams(PointParams):
    """Parameters of BRISK."""

    threshold: Annotated[
        int,
        About(
            label="Corner threshold",
            symbol="t",
            unit="grey level",
            low=1,
            high=128,
            step=5,
            help="So much must the pixels of an arc around a corner be brighter or darker than its middle.",
            effect="Higher: fewer corners, of strong contrast. Lower: more corners, also in noise.",
            learn=LESSON,
            level="student",
        ),
    ] = 30
    octaves: Annotated[
        int,
        About(
            label="Octaves",
            symbol="O",
            unit="octaves",
            low=0,
            high=8,
            step=1,
            help="How many times the photo is halved; 0: corners are sought in the photo only.",
            effect="Higher: corners survive a change of distance. Lower: faster, small corners only.",
            learn=LESSON,
            level="student",
        ),
    ] = 3
    pattern: Annotated[
        float,
        About(
            label="Size of the pattern",
            symbol="s_p",
            low=0.3,
            high=4.0,
            step=0.1,
            help="Factor on the radii of the rings of 60 sampling points around a corner.",
            effect="Higher: more distinctive, suffers more from tilt. Lower: more local.",
            learn=LESSON,
            level="expert",
        ),
    ] = 1.0


@algorithm(
    stage="features",
    role="detector",
    name="brisk",
    label="BRISK",
    source="Leutenegger, Chli and Siegwart 2011, BRISK: binary robust invariant scalable keypoints",
    learn=LESSON,
)
def brisk(
    grey: Array, colour: Array, params: BriskParams, *, run: Run, mask: Array | None = None
) -> Features:
    """Find corners in place and scale and describe each by comparing smoothed samples on rings around it.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : BriskParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Binary descriptors of 512 bits, uint8 (n, 64).
    """
    working = working_image(grey, params.reduction)
    octaves = most_levels(working.shape, 2.0, params.octaves + 1) - 1
    detector = create("BRISK", params.threshold, octaves, params.pattern)
    return assemble(binary_points(detector, working), working.shape, colour, params, mask)
