"""Points of all simulated views as points of the photo: mapped back, merged, and thinned to what differs."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated

import numpy as np
from scipy.spatial import cKDTree

from graphos_core.data import Array
from graphos_core.features.detectors.affine_kernels import leaders, most_different
from graphos_core.features.detectors.affine_simulation import (
    fully_inside,
    keypoints_in_photo,
    simulate,
    views,
)
from graphos_core.features.detectors.assembling import FoundPoints
from graphos_core.features.detectors.point_params import PointParams
from graphos_core.params import About
from graphos_core.run import Run

LESSON = "features/asift"

WORKING_PIXELS = 500_000
"""With automatic reduction; Yu and Morel 2011, section 4, reduce photos to 800 × 600 pixels."""

REACH = 3.0
"""Half the side of a SIFT descriptor in diameters of its point: 2 cells of 3 σ."""


class AffineParams(PointParams):
    """Parameters of detectors that simulate views."""

    maximum: Annotated[int, PointParams.declarations()["maximum"].about] = 20_000
    reduction: Annotated[
        float | None,
        About(
            label="Reduction",
            symbol="s",
            low=1.0,
            high=16.0,
            step=0.5,
            help="The photo is reduced by this factor before detection; automatic: to about half a million pixels.",
            effect="Higher: faster, coarser points. 1: every pixel of every simulated view counts, very slow.",
            learn=LESSON,
            level="student",
        ),
    ] = None
    tilts: Annotated[
        int,
        About(
            label="Tilts",
            symbol="n",
            unit="tilts",
            low=0,
            high=7,
            step=1,
            help="Simulated tilts t = √2, 2, 2√2 … beside the photo itself; tilt t is seen at an angle of arccos 1/t.",
            effect="Higher: photos taken from farther aside match; time and points grow. 0: nothing is simulated.",
            learn=LESSON,
            level="novice",
        ),
    ] = 2
    longitude_step: Annotated[
        float,
        About(
            label="Step of longitude",
            symbol="b",
            unit="°",
            low=20.0,
            high=180.0,
            step=6.0,
            help="At tilt t the directions of the tilt follow each other by b / t.",
            effect="Higher: fewer views, faster. Lower: more views, each viewing direction is met more closely.",
            learn=LESSON,
            level="expert",
        ),
    ] = 72.0
    merge: Annotated[
        float,
        About(
            label="Same point within",
            symbol="r",
            unit="px of the reduced photo",
            low=0.0,
            high=5.0,
            step=0.25,
            help="Points of different views that lie so near to each other become one point with several descriptors.",
            effect="Higher: fewer, less exact points. 0: a point found in many views competes with itself.",
            learn=LESSON,
            level="expert",
        ),
    ] = 1.0
    descriptors: Annotated[
        int,
        About(
            label="Descriptors per point",
            unit="descriptors",
            low=1,
            high=50,
            step=1,
            help="Of a point found in more views the descriptors that differ most are kept.",
            effect="Higher: more matches, matching time grows with the square. 1: that of the least tilted view only.",
            learn=LESSON,
            level="student",
        ),
    ] = 1


def points_of_views(
    image: Array, find: Callable[[Array], FoundPoints], params: AffineParams, *, run: Run
) -> FoundPoints:
    """Find points in the photo and in all its simulated views.

    Points of simulated views whose descriptor would reach over the border of the photo are dropped. The others are
    mapped back; their scale and orientation too (`keypoints_in_photo`), while their descriptors stay those of the
    simulated view. Points nearer than `AffineParams.merge` to one of a less tilted view take the mean position of all
    of them, exactly the same, by which matchers know that they are one point.

    Parameters
    ----------
    image : uint8 (h, w)
    find : callable
        From an image to its described points.
    params : AffineParams
    run : Run

    Returns
    -------
    FoundPoints
        In px of `image`, less tilted views first.
    """
    parts = []
    for tilt, longitude in views(params.tilts, math.radians(params.longitude_step)):
        run.check()
        view = simulate(image, tilt, longitude)
        found = find(view.image)
        if tilt > 1.0:
            found = found.take(np.flatnonzero(fully_inside(view, found.xy, REACH * found.scale)))
        xy, scale, angle = keypoints_in_photo(view, found.xy, found.scale, found.angle)
        parts.append(FoundPoints(xy, scale, angle, found.response, found.descriptors, found.metric))
    return _merged(FoundPoints.joined(parts), params.merge, params.descriptors)


def _merged(points: FoundPoints, radius: float, most: int) -> FoundPoints:
    """Give points within a radius one position, and keep their most different descriptors."""
    n = len(points.xy)
    if n == 0 or radius == 0.0:
        return points
    pairs = cKDTree(points.xy).query_pairs(radius, output_type="ndarray").astype(np.int64)
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    _, group = np.unique(leaders(pairs, n), return_inverse=True)
    size = np.bincount(group)
    mean = np.stack([np.bincount(group, points.xy[:, axis]) / size for axis in (0, 1)], axis=1)
    order = np.argsort(group, kind="stable")
    stays = most_different(points.descriptors, order, np.cumsum(np.r_[0, size]), most)
    return FoundPoints(
        mean[group], points.scale, points.angle, points.response, points.descriptors, points.metric
    ).take(np.flatnonzero(stays))
