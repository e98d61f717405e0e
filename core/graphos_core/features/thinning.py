"""Which verified matches of a pair are kept."""

from __future__ import annotations

from graphos_core.data import Features, PairMatches
from graphos_core.params import Params
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/thinning"


class EveryParams(Params):
    """Keeping everything needs no parameters."""


@algorithm(
    stage="features",
    role="thinning",
    name="every",
    label="Keep every match",
    source="no selection",
    learn=LESSON,
)
def every(pair: PairMatches, a: Features, b: Features, params: EveryParams, *, run: Run) -> PairMatches:
    """Keep every verified match.

    Parameters
    ----------
    pair : PairMatches
    a, b : Features
    params : EveryParams
    run : Run
    """
    return pair
