"""Photos and object points of two blocks, found again in each other and compared in one frame."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.data import Adjustment, Array, Block
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import angle_between
from graphos_core.geometry.similarity import Similarity, estimate_similarity
from graphos_core.run_comparison.loading import ComparedRun
from graphos_core.run_comparison.records import FrameDifference, PhotoDifference, PointsDifference
from graphos_core.text import Text


def photo_pairs(a: Block, b: Block) -> list[tuple[int, int]]:
    """Return the indices in A and in B of the photos that are oriented in both, found by name."""
    where = {name: i for i, name in enumerate(b.names) if b.oriented[i]}
    return [(int(i), where[a.names[i]]) for i in np.flatnonzero(a.oriented) if a.names[i] in where]


def point_pairs(a: Block, b: Block) -> Array:
    """Return int (k, 2): the points of A and B that have image measurements in common, each at most once.

    Two points may share a measurement (a detector can give one place two orientations), so pairs are taken in the
    order of how many measurements they share.
    """
    names = {name: i for i, name in enumerate(a.names)}
    photo_b = np.array([names.get(name, -1) for name in b.names])[b.obs_photo]
    stack = np.vstack([
        np.column_stack([a.obs_photo, np.round(a.obs_xy, 4)]),
        np.column_stack([photo_b, np.round(b.obs_xy, 4)]),
    ])  # fmt: skip
    _, place = np.unique(stack, axis=0, return_inverse=True)
    place_a, place_b = np.split(place.ravel(), [len(a.obs_photo)])
    order = np.argsort(place_a, kind="stable")
    first, last = (np.searchsorted(place_a[order], place_b, side) for side in ("left", "right"))
    count = np.where(photo_b >= 0, last - first, 0)
    within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    both = np.column_stack([
        a.obs_point[order[np.repeat(first, count) + within]], np.repeat(b.obs_point, count)
    ])  # fmt: skip
    pairs, votes = np.unique(both, axis=0, return_counts=True)
    taken_a, taken_b = np.zeros(len(a.points), dtype=bool), np.zeros(len(b.points), dtype=bool)
    kept = []
    for i in np.argsort(-votes, kind="stable"):
        one, two = pairs[i]
        if not (taken_a[one] or taken_b[two]):
            taken_a[one] = taken_b[two] = True
            kept.append(i)
    return np.asarray(pairs[np.sort(np.array(kept, dtype=int))])


def common_frame(
    a: ComparedRun, b: ComparedRun, photos: list[tuple[int, int]], points: Array
) -> tuple[FrameDifference, Similarity]:
    """Return the similarity ``a_from_b`` and what is said about it; the identity where both are placed by control."""
    one, two = a.adjustment.block, b.adjustment.block
    still = Similarity(1.0, np.eye(3), np.zeros(3))
    if one.unit == two.unit == "m" and _by_control(a) and _by_control(b):
        how = Text("Both are in the frame of their control points: nothing was moved.")
        shift = np.asarray(b.georeference.origin) - np.asarray(a.georeference.origin)
        still = Similarity(1.0, np.eye(3), shift)
        return FrameDifference(False, 1.0, 0.0, float(np.linalg.norm(shift)), "m", how), still
    good = _well_determined(a.adjustment, b.adjustment, points)
    from_a = np.vstack([*(one.centres[i] for i, _ in photos), one.points[good[:, 0]]])
    from_b = np.vstack([*(two.centres[j] for _, j in photos), two.points[good[:, 1]]])
    try:
        a_from_b = estimate_similarity(from_b, from_a)
    except UserError:
        how = Text("The two have too little in common for a similarity: their frames are taken as the same.")
        return FrameDifference(False, 1.0, 0.0, 0.0, one.unit, how), still
    how = Text(
        "B was moved onto A by a similarity over {photos} projection centres and {points} object points, those with "
        "the smaller half of the standard deviations.", photos=len(photos), points=len(good),
    )  # fmt: skip
    turn = math.degrees(angle_between(np.eye(3), a_from_b.rotation))
    return FrameDifference(
        True, a_from_b.scale, turn, float(np.linalg.norm(a_from_b.translation)), one.unit, how
    ), a_from_b


def _by_control(run: ComparedRun) -> bool:
    kinds = {group.kind for group in run.adjustment.groups}
    return run.georeference.method == "control points" or "control coordinates" in kinds


def _well_determined(a: Adjustment, b: Adjustment, points: Array) -> Array:
    """Return the pairs of points whose largest standard deviation is below the median in both."""
    keep = np.ones(len(points), dtype=bool)
    for adjustment, column in ((a, 0), (b, 1)):
        sigma = adjustment.sigma_points[points[:, column]].max(axis=1, initial=0.0)
        if len(sigma) and np.isfinite(sigma).any():
            keep &= sigma <= np.nanmedian(sigma[np.isfinite(sigma)])
    return points[keep] if keep.sum() >= 3 else points


def photo_differences(
    a: Adjustment, b: Adjustment, pairs: list[tuple[int, int]], a_from_b: Similarity
) -> tuple[PhotoDifference, ...]:
    """Return the differences of the exterior orientations in the frame of A."""
    rows = []
    for i, j in pairs:
        centre = a_from_b.apply(b.block.centres[j : j + 1])[0] - a.block.centres[i]
        turned = a_from_b.rotate_camera(b.block.rotations[j])
        sigma = np.sqrt(
            a.sigma_centres[i] ** 2 + a_from_b.scale**2 * (a_from_b.rotation**2 @ b.sigma_centres[j] ** 2)
        )
        mine_a, mine_b = a.block.obs_photo == i, b.block.obs_photo == j
        rows.append(
            PhotoDifference(
                a.block.names[i], triple(centre), triple(sigma),
                math.degrees(angle_between(a.block.rotations[i], turned)),
                _rms(a.residuals[mine_a]), _rms(b.residuals[mine_b]), int(mine_a.sum()), int(mine_b.sum()),
            )
        )  # fmt: skip
    return tuple(rows)


def point_differences(a: Adjustment, b: Adjustment, pairs: Array, a_from_b: Similarity) -> PointsDifference:
    """Return statistics of the differences of the object points in the frame of A."""
    only = len(a.block.points) - len(pairs), len(b.block.points) - len(pairs)
    if not len(pairs):
        nothing = (math.nan, math.nan, math.nan)
        return PointsDifference(0, *only, nothing, math.nan, math.nan, math.nan, math.nan, math.nan)
    d = a_from_b.apply(b.block.points[pairs[:, 1]]) - a.block.points[pairs[:, 0]]
    length = np.linalg.norm(d, axis=1)
    return PointsDifference(
        len(pairs), *only, triple(np.sqrt((d**2).mean(axis=0))), float(np.median(length)),
        float(np.quantile(length, 0.95)), float(length.max()),
        _median(a.sigma_points[pairs[:, 0]]), a_from_b.scale * _median(b.sigma_points[pairs[:, 1]]),
    )  # fmt: skip


def triple(values: Array) -> tuple[float, float, float]:
    """Return three numbers as a tuple."""
    x, y, z = (float(v) for v in values)
    return x, y, z


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if np.size(values) else math.nan


def _median(values: Array) -> float:
    good = np.asarray(values)[np.isfinite(values)]
    return float(np.median(good)) if good.size else math.nan
