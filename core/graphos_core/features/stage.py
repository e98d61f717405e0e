"""The features room as a whole: all photos through a detector, all pairs through matcher and verification."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import Any

import cv2
from threadpoolctl import threadpool_limits

from graphos_core.data import Array, Block, Camera, Features, PairMatches
from graphos_core.features.given_pair import given_pair
from graphos_core.params import Params
from graphos_core.registry import Algorithm
from graphos_core.run import Run, each, map_items

Choice = tuple[Algorithm, Params]
"""An algorithm and its parameters."""

PhotoReader = Callable[[int], tuple[Array, Array]]
"""Reads photo i: the grey photo uint8 (h, w), preprocessed, and the colour one uint8 (h, w, 3)."""

MaskReader = Callable[[int], Array | None]
"""Reads the mask of photo i: bool (h, w), True where points may be; None: everywhere."""


def detect_all(
    count: int,
    read: PhotoReader,
    detector: Algorithm,
    params: Params,
    run: Run,
    mask: MaskReader = lambda index: None,
    names: Sequence[str] = (),
) -> list[Features]:
    """Find the features of all photos.

    Photos are taken one after the other and the detector uses all threads, which is as fast as threads over
    photos and needs the memory of one photo. Each result is offered as ``("features", (index, Features))``.

    Parameters
    ----------
    count : int
        Number of photos.
    read : callable
        Reads photo i, grey and colour.
    detector : Algorithm
        Of the role ``detector``.
    params : Params
        Of the detector.
    run : Run
    mask : callable, optional
        Reads the mask of photo i.
    names : sequence of str, optional
        Of the photos; handed to a detector that has the keyword ``name``.

    Raises
    ------
    Stopped
        When the person asked to stop.
    """
    before = cv2.getNumThreads()
    cv2.setNumThreads(run.threads)
    try:
        found = []
        for index in each(run, range(count), "photos"):
            grey, colour = read(index)
            run.check()
            more = {"name": names[index]} if takes(detector, "name") else {}
            found.append(detector.function(grey, colour, params, run=run, mask=mask(index), **more))
            run.show("features", (index, found[-1]))
        return found
    finally:
        cv2.setNumThreads(before)


def match_all(
    features: Sequence[Features],
    cameras: Sequence[Camera],
    matcher: Choice,
    verification: Choice,
    run: Run,
    pairs: Sequence[Sequence[int]] | None = None,
    thinning: Choice | None = None,
    given: Block | None = None,
    names: Sequence[str] = (),
) -> list[PairMatches]:
    """Match and verify pairs of photos.

    Pairs run side by side, each with a single-threaded matrix product: faster than one pair at a time with a
    threaded product. Each result is offered as ``("pair", PairMatches)`` as soon as it is there, in any order and
    from the thread that made it.

    Parameters
    ----------
    features : sequence of Features
        Of all photos.
    cameras : sequence of Camera
        Camera of each photo.
    matcher, verification : (Algorithm, Params)
    run : Run
    pairs : sequence of (int, int), optional
        All pairs by default.
    thinning : (Algorithm, Params), optional
        Every verified match is kept by default.
    given : Block, optional
        Orientation of an earlier result, for a matcher that has the keyword ``given``.
    names : sequence of str, optional
        Of the photos: they find the photos in `given`, and are handed to a matcher that has the keyword ``names``.

    Returns
    -------
    list of PairMatches
        In the order of the pairs, rejected ones with their reason.

    Raises
    ------
    Stopped
        When the person asked to stop.
    """
    todo = list(combinations(range(len(features)), 2)) if pairs is None else [(a, b) for a, b in pairs]
    task = partial(
        _match_pair, features=features, cameras=cameras, matcher=matcher, verification=verification,
        thinning=thinning, run=run, given=given, names=names,
    )  # fmt: skip
    with threadpool_limits(1, "blas"):
        return map_items(run, task, todo, "pairs")


def _match_pair(
    index: tuple[int, int],
    features: Sequence[Features],
    cameras: Sequence[Camera],
    matcher: Choice,
    verification: Choice,
    thinning: Choice | None,
    run: Run,
    given: Block | None,
    names: Sequence[str],
) -> PairMatches:
    a, b = features[index[0]], features[index[1]]
    both = (cameras[index[0]], cameras[index[1]])
    run.check()
    more: dict[str, Any] = {}
    if takes(matcher[0], "given"):
        more["given"] = given_pair(given, names, index)
    if takes(matcher[0], "names"):
        more["names"] = (names[index[0]], names[index[1]])
    candidates = matcher[0].function(a, b, matcher[1], run=run, **more)
    run.check()
    verified: PairMatches = verification[0].function(index, a, b, candidates, both, verification[1], run=run)
    steps = (*candidates.steps, ("verified", len(verified.matches)))
    if thinning is not None and not verified.reason:
        more = {"cameras": both} if takes(thinning[0], "cameras") else {}
        verified = thinning[0].function(verified, a, b, thinning[1], run=run, **more)
        steps = (*steps, ("kept", len(verified.matches)))
    verified = replace(verified, steps=steps)
    run.show("pair", verified)
    return verified


def takes(algorithm: Algorithm, keyword: str) -> bool:
    """Say whether an algorithm's function has a keyword."""
    return keyword in inspect.signature(algorithm.function).parameters
