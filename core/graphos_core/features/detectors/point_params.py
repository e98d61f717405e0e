"""The parameters that all detectors share: how many points, which ones, and at which size the photo is worked on."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

LESSON = "features/selection"

POINTS_PER_MILLION, FEWEST, MOST = 2750, 8448, 16_384
"""Points kept with the automatic number: measured so that a pair of 6 Mpx has as many verified matches as others find."""


def points_kept(maximum: int | None, width: int, height: int) -> int:
    """Return how many points of a photo are kept at most; None stands for the automatic number."""
    if maximum is not None:
        return maximum
    return min(MOST, max(FEWEST, round(POINTS_PER_MILLION * width * height / 1e6)))


class PointParams(Params):
    """Parameters of every detector."""

    maximum: Annotated[
        int | None,
        About(
            label="Points kept",
            symbol="N",
            unit="points",
            low=50,
            high=100_000,
            step=500,
            help="At most so many points of each photo are kept; automatic: as large as the photo is, "
            f"{POINTS_PER_MILLION} per million pixels, but {FEWEST} at least and {MOST} at most.",
            effect="Higher: more object points, matching time grows with the square. Lower: faster.",
            learn=LESSON,
            level="novice",
        ),
    ] = None
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
