"""Pairs that share points already on small images: the largest points of each photo are matched first."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import combinations
from typing import Annotated

import numpy as np
from threadpoolctl import threadpool_limits

from graphos_core.data import Features, PairSelection, PhotoSet
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.features.pairs.choosing import LESSON, largest, selection
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run, map_items
from graphos_core.text import Text

RATIO = 0.8
"""Ratio test of the small matching, as in the full one."""


class MultiscaleParams(Params):
    """Parameters of multi-scale pair selection."""

    points: Annotated[
        int,
        About(
            label="Points first",
            symbol="h",
            unit="points",
            low=50,
            high=5000,
            step=50,
            help="So many of the largest points of each photo are matched first.",
            effect="Higher: weakly overlapping pairs are found, slower. Lower: faster.",
            learn=LESSON,
            level="student",
        ),
    ] = 1000
    shared: Annotated[
        int,
        About(
            label="Shared points",
            symbol="t",
            unit="points",
            low=1,
            high=200,
            step=1,
            help="A pair is matched in full when so many of its largest points match.",
            effect="Higher: fewer pairs, faster, weak overlaps are lost. Lower: more pairs are tried in vain.",
            learn=LESSON,
            level="student",
        ),
    ] = 3


@algorithm(
    stage="features",
    role="pairs",
    name="multiscale",
    label="Multi-scale (largest points first)",
    source="Wu 2013, Towards linear-time incremental structure from motion, section 3 (preemptive feature matching)",
    learn=LESSON,
)
def multiscale(
    photos: PhotoSet, features: Sequence[Features], params: MultiscaleParams, *, run: Run
) -> PairSelection:
    """Match the largest points of all pairs; only pairs that share enough of them are matched in full.

    The largest points are those that a reduced image would show, so this is matching on small images without making
    them. The score is how many points a pair shares.

    Parameters
    ----------
    photos : PhotoSet
    features : sequence of Features
    params : MultiscaleParams
    run : Run
    """
    small = [first_points(own, params.points) for own in features]
    todo = list(combinations(range(len(features)), 2))
    with threadpool_limits(1, "blas"):
        counts = map_items(run, partial(_shared, small=small, run=run), todo, "pairs on small images")
    table = np.zeros((len(features), len(features)), np.int64)
    for (a, b), count in zip(todo, counts, strict=True):
        table[a, b] = table[b, a] = count
    chosen = table >= params.shared
    kept = int(np.triu(chosen, 1).sum())
    said = Text(
        "{kept} of {all} pairs share at least {t} of their {h} largest points; {left} pairs are left out.",
        kept=kept, all=len(todo), t=params.shared, h=params.points, left=len(todo) - kept,
    )  # fmt: skip
    return selection(chosen, table, said)


def first_points(features: Features, number: int) -> Features:
    """Return the `number` largest points of a photo."""
    kept = largest(features, number)
    return Features(
        xy=features.xy[kept], scale=features.scale[kept], angle=features.angle[kept],
        response=features.response[kept], descriptors=features.descriptors[kept], colour=features.colour[kept],
        width=features.width, height=features.height, found=features.found, metric=features.metric,
    )  # fmt: skip


def _shared(pair: tuple[int, int], small: Sequence[Features], run: Run) -> int:
    run.check()
    return len(mutual(small[pair[0]], small[pair[1]], MutualParams(ratio=RATIO), run=run))
