"""Fewer matches of better quality: the n best of a pair, or the best of each cell of both photos."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from graphos_core.data import Array, Camera, Features, PairMatches
from graphos_core.features.residuals import match_residuals
from graphos_core.features.thinning import LESSON
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run


class RankedParams(Params):
    """Parameters of every thinning by quality."""

    quality: Annotated[
        Literal["ratio", "residual"],
        About(
            label="Quality",
            help="What makes a match good: its descriptor is distinctive, or it fits the geometry of the pair.",
            effect="Ratio: the nearest descriptor was much nearer than the second. Residual: the point lies near its "
            "epipolar line.",
            choices={"ratio": "ratio of distances", "residual": "distance from the line"},
            learn=LESSON,
            level="student",
        ),
    ] = "ratio"


class BestParams(RankedParams):
    """Parameters of keeping the n best."""

    number: Annotated[
        int,
        About(
            label="Matches kept",
            symbol="n",
            unit="matches",
            low=15,
            high=100_000,
            step=100,
            help="At most so many verified matches of each pair are kept.",
            effect="Higher: more object points. Lower: faster adjustment, fewer and safer points.",
            learn=LESSON,
            level="novice",
        ),
    ] = 1000


class CellsParams(RankedParams):
    """Parameters of keeping the best of each cell."""

    cells: Annotated[
        int,
        About(
            label="Cells",
            symbol="m",
            unit="cells",
            low=2,
            high=200,
            step=1,
            help="Square cells along the longer side of each photo.",
            effect="Higher: more matches are kept, finer spread. Lower: fewer.",
            learn=LESSON,
            level="student",
        ),
    ] = 24
    each: Annotated[
        int,
        About(
            label="In each cell",
            symbol="k",
            unit="matches",
            low=1,
            high=1000,
            step=1,
            help="So many matches are kept in each cell of either photo.",
            effect="Higher: more matches. Lower: fewer, evenly spread.",
            learn=LESSON,
            level="novice",
        ),
    ] = 4


@algorithm(
    stage="features",
    role="thinning",
    name="best",
    label="The n best matches",
    source="González-Aguilera et al. 2018 (GRAPHOS), n-best filter; Lowe 2004, section 7.1 (ratio as quality)",
    learn=LESSON,
)
def best(
    pair: PairMatches,
    a: Features,
    b: Features,
    params: BestParams,
    *,
    run: Run,
    cameras: tuple[Camera, Camera] | None = None,
) -> PairMatches:
    """Keep the best matches of a pair.

    Parameters
    ----------
    pair : PairMatches
    a, b : Features
    params : BestParams
    run : Run
    cameras : (Camera, Camera), optional
        Needed for the residual as quality.
    """
    order = np.argsort(match_quality(pair, a, b, params.quality, cameras), kind="stable")
    return only(pair, np.sort(order[: params.number]))


@algorithm(
    stage="features",
    role="thinning",
    name="cells",
    label="The best of each cell of both photos",
    source="González-Aguilera et al. 2018 (GRAPHOS), tie point reduction; Förstner and Gülch 1987 (even distribution)",
    learn=LESSON,
)
def cells(
    pair: PairMatches,
    a: Features,
    b: Features,
    params: CellsParams,
    *,
    run: Run,
    cameras: tuple[Camera, Camera] | None = None,
) -> PairMatches:
    """Keep the best matches of each cell of either photo, so that the covered part of both stays covered.

    Best first, a match is kept while its cell in one of the photos still has room.

    Parameters
    ----------
    pair : PairMatches
    a, b : Features
    params : CellsParams
    run : Run
    cameras : (Camera, Camera), optional
        Needed for the residual as quality.
    """
    quality = match_quality(pair, a, b, params.quality, cameras)
    cell_a, cell_b = (
        cell_of(own.xy[pair.matches[:, side]], own.width, own.height, params.cells)
        for side, own in enumerate((a, b))
    )
    return only(pair, best_of_cells(quality, cell_a, cell_b, params.each))


def match_quality(
    pair: PairMatches, a: Features, b: Features, quality: str, cameras: tuple[Camera, Camera] | None
) -> Array:
    """Return a number for each match, float64 (n,), smaller is better: its ratio, or its residual in px.

    Without ratios (imported matches) the residual is taken, and without cameras the ratio; where neither is known all
    are alike.
    """
    has_ratio = len(pair.ratio) == len(pair.matches)
    if cameras is not None and (quality == "residual" or not has_ratio):
        return np.nan_to_num(match_residuals(pair, a, b, cameras), nan=np.inf)
    return np.asarray(pair.ratio, np.float64) if has_ratio else np.zeros(len(pair.matches))


def cell_of(xy: Array, width: int, height: int, number: int) -> Array:
    """Return the square cell of each position, int64 (n,), with `number` cells along the longer side."""
    side = max(width, height) / number
    column, row = ((np.asarray(xy, np.float64) + 0.5) // side).astype(np.int64).T
    return np.clip(row, 0, number) * (number + 1) + np.clip(column, 0, number)


def best_of_cells(quality: Array, cell_a: Array, cell_b: Array, each: int) -> Array:
    """Return the sorted indices of matches that are kept, best first, while either of their cells has room.

    Parameters
    ----------
    quality : float64 (n,)
        Smaller is better.
    cell_a, cell_b : int64 (n,)
        Cell in each photo.
    each : int
    """
    room_a, room_b = (np.full(int(c.max(initial=0)) + 1, each) for c in (cell_a, cell_b))
    kept = []
    for match in np.argsort(quality, kind="stable"):
        if room_a[cell_a[match]] > 0 or room_b[cell_b[match]] > 0:
            room_a[cell_a[match]] -= 1
            room_b[cell_b[match]] -= 1
            kept.append(match)
    return np.sort(np.array(kept, np.int64))


def only(pair: PairMatches, kept: Array) -> PairMatches:
    """Return the pair with only the matches of the given indices."""
    ratio = pair.ratio[kept] if len(pair.ratio) == len(pair.matches) else pair.ratio
    return replace(pair, matches=np.ascontiguousarray(pair.matches[kept]), ratio=ratio)
