"""Which pairs of photos are matched."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from graphos_core.data import Features, PairSelection, PhotoSet
from graphos_core.params import Params
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

LESSON = "features/pairs"


class AllPairsParams(Params):
    """All pairs need no parameters."""


@algorithm(
    stage="features",
    role="pairs",
    name="all",
    label="All pairs",
    source="exhaustive",
    learn=LESSON,
)
def all_pairs(
    photos: PhotoSet, features: Sequence[Features], params: AllPairsParams, *, run: Run
) -> PairSelection:
    """Match every photo with every other; the time grows with the square of their number.

    Parameters
    ----------
    photos : PhotoSet
    features : sequence of Features
    params : AllPairsParams
    run : Run
    """
    pairs = np.array(list(combinations(range(len(features)), 2)), np.int32).reshape(-1, 2)
    return PairSelection(
        pairs=pairs,
        score=np.full(len(pairs), np.nan, np.float32),
        possible=len(pairs),
        said=Text("Every photo with every other."),
    )
