"""The parameters of the simulator of the datum."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

ROLES = {"none": "nothing", "height": "height", "position": "position", "full": "all three"}
CORNERS = (1, 3, 7, 9)
"""Numbers of the points that can be control points."""
LESSON = "adjustment/datum"


def _role(number: int) -> About:
    return About(
        label=f"Point {number}", group="Control", level="novice", choices=ROLES,
        help=f"Which coordinates of point {number} are known.",
        effect="More coordinates: fewer free motions; beyond seven numbers the shape can be pulled.", learn=LESSON,
    )  # fmt: skip


Role4 = Literal["none", "height", "position", "full"]


class DatumParams(Params):
    """A block of nine points; up to four of them can be control points, a distance can be known."""

    p1: Annotated[Role4, _role(1)] = "full"
    p3: Annotated[Role4, _role(3)] = "none"
    p7: Annotated[Role4, _role(7)] = "none"
    p9: Annotated[Role4, _role(9)] = "full"
    distance: Annotated[
        bool,
        About(
            label="Distance 1–3",
            group="Control",
            level="novice",
            help="Whether the distance between the points 1 and 3 is known.",
            effect="On: the scale is known.",
            learn="adjustment/scale-bars",
        ),
    ] = False
    motion: Annotated[
        int,
        About(
            label="Which motion",
            unit="number",
            low=0,
            high=8,
            low_open=True,
            high_open=True,
            step=1,
            group="Free motions",
            level="novice",
            help="Which of the free motions is shown; beyond the last one, the last.",
            effect="Another number: another motion that no photo notices.",
            learn="adjustment/rank-defects",
        ),
    ] = 1
    amount: Annotated[
        float,
        About(
            label="How far",
            unit="of the block",
            low=-1,
            high=1,
            step=0.05,
            group="Free motions",
            level="novice",
            help="How far the block is moved along the free motion.",
            effect="Away from 0: farther; the photos stay the same.",
            learn="adjustment/rank-defects",
        ),
    ] = 0.5
    kind: Annotated[
        Literal["inner", "minimal"],
        About(
            label="Free motions are fixed by",
            group="Free motions",
            level="novice",
            choices={"inner": "inner constraints", "minimal": "minimal constraints"},
            help="Free network, or just as many coordinates held as there are free motions.",
            effect="Minimal: the ellipses grow away from what is held; the shape stays.",
            learn=LESSON,
        ),
    ] = "inner"
    wrong_x: Annotated[
        float,
        About(
            label="Error of point 1, X",
            unit="mm",
            low=-600,
            high=600,
            step=10,
            group="Error of control",
            help="How wrong the given X of point 1 is.",
            effect="Away from 0: the block follows, or is bent where more than seven numbers are given.",
            learn="adjustment/control-points",
        ),
    ] = 0.0
    wrong_y: Annotated[
        float,
        About(
            label="Error of point 1, Y",
            unit="mm",
            low=-600,
            high=600,
            step=10,
            group="Error of control",
            help="How wrong the given Y of point 1 is.",
            effect="Away from 0: the block follows, or is bent where more than seven numbers are given.",
            learn="adjustment/control-points",
        ),
    ] = 0.0
    control_mm: Annotated[
        float,
        About(
            label="Precision of control",
            symbol=r"\sigma",
            unit="mm",
            low=0.5,
            high=50,
            step=0.5,
            group="Error of control",
            help="Standard deviation of known coordinates and of the distance.",
            effect="Smaller: control pulls harder.",
            learn="adjustment/control-points",
        ),
    ] = 5.0
    sigma_px: Annotated[
        float,
        About(
            label="Image precision",
            symbol=r"\sigma",
            unit="px",
            low=0.1,
            high=3,
            step=0.1,
            group="Measurement",
            help="Standard deviation of a measured image coordinate.",
            effect="Larger: larger ellipses; the free motions stay free.",
            learn="adjustment/covariance",
        ),
    ] = 0.5
    seed: Annotated[
        int,
        About(
            label="Noise",
            symbol="seed",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Measurement",
            help="Seed of the measuring errors.",
            effect="Another number: other errors, same size.",
        ),
    ] = 1
    exaggeration: Annotated[
        int,
        About(
            label="Ellipses drawn",
            unit="times",
            low=1,
            high=200,
            step=1,
            group="Drawing",
            help="How much larger than true the error ellipses are drawn.",
            effect="Larger: bigger ellipses; the numbers stay.",
        ),
    ] = 30
    photo: Annotated[
        bool,
        About(
            label="Show the photos",
            group="Drawing",
            help="Lay a photo on the ground below the points.",
            effect="On: the photos show it.",
        ),
    ] = False
