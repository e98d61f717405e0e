r"""AKAZE: blobs of a scale space that keeps edges sharp, with a binary descriptor."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.data import Array, Features
from graphos_core.features.detectors.assembling import assemble, working_image
from graphos_core.features.detectors.opencv_names import binary_points, create
from graphos_core.features.detectors.point_params import PointParams
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/akaze"

DIFFUSIVITIES = ("perona-malik-1", "perona-malik-2", "weickert", "charbonnier")
"""In the order of OpenCV's numbers 0 to 3."""

MLDB_UPRIGHT, MLDB = 4, 5
"""OpenCV's numbers of the descriptors."""


class AkazeParams(PointParams):
    """Parameters of AKAZE."""

    threshold: Annotated[
        float,
        About(
            label="Least response",
            symbol="t",
            low=0.00001,
            high=0.1,
            step=0.0005,
            help="A blob whose determinant of the Hessian (grey range 0 to 1) is less is dropped.",
            effect="Higher: fewer points, in structured parts only. Lower: more points, also in noise.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.0005
    octaves: Annotated[
        int,
        About(
            label="Octaves",
            symbol="O",
            unit="octaves",
            low=1,
            high=8,
            step=1,
            help="How many times the size of blobs is doubled.",
            effect="Higher: large blobs are found too. Lower: faster, small blobs only.",
            learn=LESSON,
            level="student",
        ),
    ] = 4
    layers: Annotated[
        int,
        About(
            label="Layers per octave",
            symbol="S",
            unit="layers",
            low=1,
            high=8,
            step=1,
            help="Scales examined between one size and its double.",
            effect="Higher: scale is sampled finer, slower. Lower: faster, fewer repeated points.",
            learn=LESSON,
            level="expert",
        ),
    ] = 4
    diffusivity: Annotated[
        Literal["perona-malik-1", "perona-malik-2", "weickert", "charbonnier"],
        About(
            label="Diffusivity",
            help="How strongly the blur stops at edges, as a function g of the gradient.",
            effect="Perona–Malik 1 keeps edges of high contrast, 2 wide areas; Weickert smooths within areas fastest.",
            choices={
                "perona-malik-1": "Perona–Malik 1",
                "perona-malik-2": "Perona–Malik 2",
                "weickert": "Weickert",
                "charbonnier": "Charbonnier",
            },
            learn=LESSON,
            level="expert",
        ),
    ] = "perona-malik-2"
    upright: Annotated[
        bool,
        About(
            label="Photos are upright",
            help="Describe every point as it stands, instead of turning its patch by its main direction.",
            effect="On: more correct matches while photos are not turned about their axis. Off: turned photos match.",
            learn=LESSON,
            level="student",
        ),
    ] = False


@algorithm(
    stage="features",
    role="detector",
    name="akaze",
    label="AKAZE",
    source="Alcantarilla, Nuevo and Bartoli 2013, Fast explicit diffusion for accelerated features in nonlinear scale "
    "spaces",
    learn=LESSON,
)
def akaze(
    grey: Array, colour: Array, params: AkazeParams, *, run: Run, mask: Array | None = None
) -> Features:
    """Find blobs in a nonlinear scale space and describe each by comparing areas of its patch.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : AkazeParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Binary descriptors of 486 bits (M-LDB), uint8 (n, 61).
    """
    working = working_image(grey, params.reduction)
    detector = create(
        "AKAZE", MLDB_UPRIGHT if params.upright else MLDB, 0, 3, params.threshold, params.octaves, params.layers,
        DIFFUSIVITIES.index(params.diffusivity),
    )  # fmt: skip
    return assemble(binary_points(detector, working), working.shape, colour, params, mask)
