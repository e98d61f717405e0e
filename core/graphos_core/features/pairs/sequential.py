"""Pairs of photos taken one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from graphos_core.data import Features, PairSelection, PhotoSet
from graphos_core.features.pairs.choosing import LESSON, selection
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text


class SequentialParams(Params):
    """Parameters of pairs in sequence."""

    reach: Annotated[
        int,
        About(
            label="Reach",
            symbol="n",
            unit="photos",
            low=1,
            high=1000,
            step=1,
            help="Each photo is matched with so many that follow it by name.",
            effect="Higher: more pairs, gaps are bridged. Lower: faster, one bad photo can break the line.",
            learn=LESSON,
            level="novice",
        ),
    ] = 3
    ring: Annotated[
        bool,
        About(
            label="Closed ring",
            help="The line of photos ends where it began: round a statue, round a room.",
            effect="On: the last photos are also matched with the first. Off: an open line.",
            learn=LESSON,
            level="novice",
        ),
    ] = False


@algorithm(
    stage="features",
    role="pairs",
    name="sequential",
    label="Neighbours in the sequence",
    source="Line of photos in the order of their names; see Luhmann 2018, section 7.3 (photo arrangement)",
    learn=LESSON,
)
def sequential(
    photos: PhotoSet, features: Sequence[Features], params: SequentialParams, *, run: Run
) -> PairSelection:
    """Match each photo with the next few in the order of names; the score is how many photos lie between, plus one.

    Parameters
    ----------
    photos : PhotoSet
    features : sequence of Features
        Only their number matters.
    params : SequentialParams
    run : Run
    """
    place = np.arange(len(features))
    apart = np.abs(place[:, None] - place[None, :])
    if params.ring:
        apart = np.minimum(apart, len(place) - apart)
    template = (
        "Each photo with the next {n}, the last also with the first."
        if params.ring
        else "Each photo with the next {n}."
    )
    return selection((apart <= params.reach) & (apart > 0), apart, Text(template, n=params.reach))
