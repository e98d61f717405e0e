r"""Coverage: which part of the format matched points hold, and what to change where it is too little.

An orientation and a calibration hold only where there are points: outside, distortion is extrapolated. Three shares
are computed, since each has a blind spot. The convex hull (Sklansky 1982, by OpenCV) overlooks holes; the share of
occupied cells of a grid depends on the size of the cells and the number of points; the radial zones, which matter to
radial distortion, overlook directions. GRAPHOS (González-Aguilera et al. 2018) warns below two thirds of the format.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import cv2
import numpy as np

from graphos_core.data import Array, Features, PairMatches
from graphos_core.features.coverage_words import advise
from graphos_core.params import About, Params

LESSON = "features/coverage"

FINE = 240
"""Samples along each side of the format with which the areas of the radial zones are measured."""


class CoverageParams(Params):
    """Parameters of the coverage assistant."""

    cells: Annotated[
        int,
        About(
            label="Cells",
            symbol="m",
            unit="cells",
            low=3,
            high=60,
            step=1,
            help="Square cells along the longer side of the format.",
            effect="Higher: smaller holes are seen, more points are needed to fill the format. Lower: coarser.",
            learn=LESSON,
            level="student",
        ),
    ] = 12
    zones: Annotated[
        int,
        About(
            label="Radial zones",
            symbol="z",
            unit="zones",
            low=2,
            high=12,
            step=1,
            help="Rings of equal width between the centre of the format and its corners.",
            effect="Higher: finer histogram of radii. Lower: coarser.",
            learn=LESSON,
            level="student",
        ),
    ] = 5
    enough: Annotated[
        float,
        About(
            label="Enough",
            symbol="c",
            low=0.1,
            high=1.0,
            step=0.05,
            help="Share of the format that must be covered; the assistant warns below it.",
            effect="Higher: warns sooner. Lower: warns later.",
            learn=LESSON,
            level="student",
        ),
    ] = 0.667


@dataclass(frozen=True)
class Coverage:
    """How points cover a format.

    Attributes
    ----------
    counts : int64 (rows, columns)
        Points in each cell: the heat map.
    hull : float64 (k, 2)
        Corners of the convex hull, px, in order round it.
    hull_share, occupied_share : float
        Area of the hull, and cells with at least one point, as shares of the format, 0 to 1.
    possible_share : float
        Share of cells that as many points would occupy if they were spread at random over the whole format,
        ``1 − (1 − 1/m)ⁿ``.
    radii : float64 (z + 1,)
        Limits of the radial zones, px from the centre of the format; the last is its corner.
    radial_share, radial_area : float64 (z,)
        Share of the points, and of the format's area, in each zone.
    reach : float
        Largest radius of a point, as a share of the half diagonal.
    points : int
    width, height : int
        Format, px.
    empty : tuple of str
        Parts of the format that are empty, in words.
    alert : bool
        Whether less than `CoverageParams.enough` is covered, by the hull or by the cells.
    verdict, advice : str
        What was found and what to change, in one sentence each; no advice where nothing needs to change.
    """

    counts: Array
    hull: Array
    hull_share: float
    occupied_share: float
    possible_share: float
    radii: Array
    radial_share: Array
    radial_area: Array
    reach: float
    points: int
    width: int
    height: int
    empty: tuple[str, ...]
    alert: bool
    verdict: str
    advice: str


def coverage(
    xy: Array,
    width: int,
    height: int,
    params: CoverageParams | None = None,
    *,
    keypoints: Array | None = None,
    photos: int = 1,
) -> Coverage:
    """Measure how points cover a format.

    Parameters
    ----------
    xy : float (n, 2)
        Matched points, px of the format; those of many photos one upon the other for the coverage of a camera.
    width, height : int
        Format, px.
    params : CoverageParams, optional
    keypoints : float (k, 2), optional
        All keypoints, px: they tell whether an empty part lacks structure or partners.
    photos : int
        How many photos the points come from, for the words of the advice.
    """
    params = params or CoverageParams()
    xy = np.asarray(xy, dtype=np.float64).reshape(-1, 2)
    xy = xy[np.isfinite(xy).all(axis=1)]
    counts = occupancy(xy, width, height, params.cells)
    occupied = float((counts > 0).mean())
    hull = convex_hull(xy)
    hull_share = min(1.0, polygon_area(hull) / (width * height))
    radii, share, area, reach = radial_zones(xy, width, height, params.zones)
    possible = float(1.0 - (1.0 - 1.0 / counts.size) ** len(xy))
    alert = min(occupied, hull_share) < params.enough
    key_counts = None if keypoints is None else occupancy(keypoints, width, height, params.cells)
    empty, verdict, advice = advise(counts, key_counts, occupied, hull_share, possible, alert, photos)
    return Coverage(
        counts=counts, hull=hull, hull_share=hull_share, occupied_share=occupied, possible_share=possible,
        radii=radii, radial_share=share, radial_area=area, reach=reach, points=len(xy), width=width, height=height,
        empty=empty, alert=alert, verdict=verdict, advice=advice,
    )  # fmt: skip


def matched_features(features: Sequence[Features], pairs: Sequence[PairMatches], photo: int) -> Array:
    """Return the indices of a photo's features that have a verified match in any other photo, sorted."""
    used = [
        pair.matches[:, 0 if pair.a == photo else 1]
        for pair in pairs
        if not pair.reason and photo in (pair.a, pair.b)
    ]
    return np.unique(np.concatenate([np.zeros(0, np.int32), *used]))


def photo_coverage(
    features: Sequence[Features],
    pairs: Sequence[PairMatches],
    photo: int,
    params: CoverageParams | None = None,
) -> Coverage:
    """Measure how verified matches cover one photo."""
    own = features[photo]
    xy = own.xy[matched_features(features, pairs, photo)]
    return coverage(xy, own.width, own.height, params, keypoints=own.xy)


def camera_coverage(
    features: Sequence[Features],
    pairs: Sequence[PairMatches],
    photos: Sequence[int],
    params: CoverageParams | None = None,
) -> Coverage:
    """Measure how the verified matches of all photos of one camera, laid upon each other, cover its format.

    Parameters
    ----------
    features, pairs
        Of the block.
    photos : sequence of int
        Photos of the camera; those of another format than the first are left out.
    """
    first = features[photos[0]]
    alike = [i for i in photos if (features[i].width, features[i].height) == (first.width, first.height)]
    xy = np.concatenate([features[i].xy[matched_features(features, pairs, i)] for i in alike])
    return coverage(xy, first.width, first.height, params, photos=len(alike))


def occupancy(xy: Array, width: int, height: int, cells: int) -> Array:
    """Return the points in each cell, int64 (rows, columns), of a grid with `cells` along the longer side.

    Points outside the format are not counted.
    """
    side = max(width, height) / cells
    columns, rows = max(1, round(width / side)), max(1, round(height / side))
    xy = np.asarray(xy, dtype=np.float64).reshape(-1, 2)
    column = np.floor((xy[:, 0] + 0.5) / width * columns).astype(np.int64)
    row = np.floor((xy[:, 1] + 0.5) / height * rows).astype(np.int64)
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    flat = np.bincount(row[inside] * columns + column[inside], minlength=rows * columns)
    return flat.reshape(rows, columns)


def convex_hull(xy: Array) -> Array:
    """Return the corners (k, 2) of the convex hull in order round it, to float32; fewer than three span no area."""
    points = np.asarray(xy, dtype=np.float32).reshape(-1, 2)
    if len(points) < 3:
        return points.astype(np.float64)
    return cv2.convexHull(points)[:, 0].astype(np.float64)


def polygon_area(corners: Array) -> float:
    """Return the area of a simple polygon (k, 2) by Gauss's formula."""
    if len(corners) < 3:
        return 0.0
    x, y = corners[:, 0], corners[:, 1]
    return float(abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2.0)


def radial_zones(xy: Array, width: int, height: int, zones: int) -> tuple[Array, Array, Array, float]:
    """Return the limits of rings of equal width, the share of points and of the format in each, and the reach."""
    middle = np.array([(width - 1) / 2.0, (height - 1) / 2.0])
    corner = float(np.hypot(width, height) / 2.0)
    radii = np.linspace(0.0, corner, zones + 1)
    xs, ys = ((np.arange(FINE) + 0.5) / FINE * side - side / 2.0 for side in (width, height))
    area = np.histogram(np.hypot(*np.meshgrid(xs, ys)), radii)[0] / FINE**2
    radius = np.hypot(*(np.asarray(xy, dtype=np.float64).reshape(-1, 2) - middle).T)
    share = np.histogram(radius, radii)[0] / max(len(radius), 1)
    return radii, share, area, float(min(1.0, radius.max(initial=0.0) / corner))
