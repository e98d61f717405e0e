"""The parameters of the simulator of the coverage of the format."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

WIDTH, HEIGHT, FOCAL_PX = 3000, 2000, 2600.0
"""Format and principal distance of the camera, px."""
GROUPS = "abcd"
"""Names of the groups of points."""
LESSON = "features/coverage"


def _place(group: str, axis: str) -> About:
    way = "to the right" if axis == "across" else "down"
    return About(label=f"Group {group}, {axis}", unit="%", low=0, high=100, step=1, group="Places", level="expert",
                 help=f"Where the middle of group {group} is, in parts of the format.",
                 effect=f"Higher: farther {way}.", learn=LESSON)  # fmt: skip


class CoverageSimulatorParams(Params):
    """Where on the format four groups of matched points lie; each of four photos has such points."""

    a_x: Annotated[float, _place("A", "across")] = 33.0
    a_y: Annotated[float, _place("A", "down")] = 31.0
    b_x: Annotated[float, _place("B", "across")] = 66.0
    b_y: Annotated[float, _place("B", "down")] = 34.0
    c_x: Annotated[float, _place("C", "across")] = 35.0
    c_y: Annotated[float, _place("C", "down")] = 67.0
    d_x: Annotated[float, _place("D", "across")] = 68.0
    d_y: Annotated[float, _place("D", "down")] = 68.0
    spread: Annotated[
        float,
        About(
            label="Size of a group",
            unit="%",
            low=0,
            high=60,
            step=1,
            group="Points",
            level="novice",
            help="Radius of each group, in parts of the half diagonal of the format.",
            effect="Larger: more of the format is covered.",
            learn=LESSON,
        ),
    ] = 18.0
    points: Annotated[
        int,
        About(
            label="Points of a photo",
            symbol="n",
            unit="points",
            low=12,
            high=200,
            step=4,
            group="Points",
            level="novice",
            help="Matched points of each photo, a quarter of them in each group.",
            effect="More: all standard deviations fall by the root of the number, wherever the points are.",
            learn=LESSON,
        ),
    ] = 60
    sigma_px: Annotated[
        float,
        About(
            label="Image precision",
            symbol=r"\sigma",
            unit="px",
            low=0.05,
            high=2,
            step=0.05,
            group="Measurement",
            help="Standard deviation of a measured image coordinate.",
            effect="Larger: all standard deviations grow with it.",
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
            help="Seed of the places within the groups and of the measuring errors.",
            effect="Another number: other places and errors of the same kind.",
        ),
    ] = 2
    source: Annotated[
        Literal["simulated", "photo"],
        About(
            label="Points",
            group="Points",
            choices={"simulated": "at random", "photo": "of a photo"},
            help="At random within the groups, or the SIFT features of a photo that lie within them.",
            effect="Photo: where there is no structure, there are no points.",
            learn="features/sift",
        ),
    ] = "simulated"
