"""The parameters that all detectors share: how many points, which ones, and at which size the photo is worked on."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

LESSON = "features/selection"


class PointParams(Params):
    """Parameters of every detector."""

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
        Literal["scale", "strength", "grid", "anms"],
        About(
            label="Choose points",
            help="Which points stay when there are more.",
            effect="By scale: the largest, which several photos see best. By strength: the highest response, mostly "
            "small ones. Evenly: weakly structured parts of the photo get points too, the largest of every cell, or "
            "strong ones at a distance from each other.",
            choices={
                "scale": "by scale",
                "strength": "by strength",
                "grid": "evenly, by cells",
                "anms": "evenly, by distance (ANMS)",
            },
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
            high=16.0,
            step=0.5,
            help="The photo is reduced by this factor before detection; automatic: to about 1.25 million pixels.",
            effect="Higher: faster, coarser points. 1: every pixel counts, slow for large photos.",
            learn=LESSON,
            level="student",
        ),
    ] = None
