"""The first pair: which two photos the block starts from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.adjustment.orientation.growing import GrowingBlock
from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.geometry.rays import in_turn
from graphos_core.geometry.relative_orientation import relative_orientation
from graphos_core.geometry.triangulation import intersect_rays
from graphos_core.run import Run
from graphos_core.text import Text

CANDIDATES = 12
"""Pairs with the most common points that are tried."""

FULL_ANGLE = np.radians(10.0)
"""Intersection angle from which a point counts fully in the choice of the first pair."""


@dataclass(frozen=True)
class FirstPair:
    """Two photos with their relative orientation; the object frame is the camera frame of `a`, the base has length 1.

    Attributes
    ----------
    a, b : int
        Photos.
    rotation : float64 (3, 3)
        ``cam_from_world`` of photo b.
    centre : float64 (3,)
        Projection centre of photo b.
    points : int
        Points that agree.
    angle : float
        Median intersection angle, radians.
    score : float
        Sum over the points of the intersection angle relative to 10°, at most 1 each.
    """

    a: int
    b: int
    rotation: Array
    centre: Array
    points: int
    angle: float
    score: float


def orient_pair(block: GrowingBlock, a: int, b: int, *, seed: int) -> FirstPair | str:
    """Orient photo b relative to photo a, or say why it is not possible."""
    in_a, in_b = block.common(a, b)
    rays_a, rays_b = block.rays[in_a], block.rays[in_b]
    found = relative_orientation(rays_a, rays_b, block.reprojection_px, seed=seed)
    if not found:
        return found.reason
    inliers = np.flatnonzero(found.inliers)
    centre = -found.rotation.T @ found.translation
    points = intersect_rays(
        2 * np.arange(len(inliers) + 1), np.tile([0, 1], len(inliers)),
        in_turn([rays_a[inliers], rays_b[inliers]]), np.stack([np.eye(3), found.rotation]),
        np.stack([np.zeros(3), centre]), threshold_px=block.reprojection_px,
    )  # fmt: skip
    angles = points.angles[points.ok]
    if not len(angles):
        return "no rays intersect in front of both photos"
    score = float(np.minimum(angles / FULL_ANGLE, 1.0).sum())
    return FirstPair(a, b, found.rotation, centre, len(angles), float(np.median(angles)), score)


def candidate_pairs(block: GrowingBlock, group: tuple[int, ...], min_points: int) -> list[tuple[int, int]]:
    """Return the pairs of a group with enough common tracks, most common tracks first."""
    tracks = block.tracks
    place = np.full(len(block.names), -1)
    place[list(group)] = np.arange(len(group))
    mine = np.flatnonzero((place[tracks.photo] >= 0) & block.valid)
    seen = np.zeros((len(group), len(group)), dtype=np.int64)
    _, start, size = np.unique(tracks.track[mine], return_index=True, return_counts=True)
    for length in np.unique(size[size > 1]):  # tracks of equal length together: few lengths, many tracks
        members = place[tracks.photo[mine[start[size == length][:, None] + np.arange(length)]]]
        for i in range(length):
            for j in range(i + 1, length):
                np.add.at(seen, (members[:, i], members[:, j]), 1)
    first, second = np.nonzero(seen >= min_points)
    order = np.lexsort([second, first, -seen[first, second]])
    return [(group[first[k]], group[second[k]]) for k in order]


def partners(
    block: GrowingBlock, group: tuple[int, ...], min_points: int, chosen: tuple[int, ...]
) -> list[tuple[int, int]]:
    """Return the candidate pairs of a group; with a chosen photo only those it is part of."""
    return [
        pair for pair in candidate_pairs(block, group, min_points) if all(photo in pair for photo in chosen)
    ]


def choose_first_pairs(
    block: GrowingBlock, pairs: list[tuple[int, int]], *, min_points: int, min_angle: float, run: Run
) -> list[FirstPair]:
    """Return the pairs that can start the block, best first.

    Tries the first pairs, those with the most common points; the score rewards many points with good intersection
    angles.

    Raises
    ------
    UserError
        When there is no pair with enough common points, or none has a base.
    """
    if not pairs:
        raise UserError(
            "No two photos can be oriented relative to each other.",
            Text("No pair has {count} verified points in common.", count=min_points),
            "Take photos with more overlap, find more features, or require fewer common points.",
            learn="adjustment/overlap",
        )
    found, widest, reason = [], 0.0, ""
    for a, b in pairs[:CANDIDATES]:
        run.check()
        pair = orient_pair(block, a, b, seed=run.seed)
        if isinstance(pair, str):
            reason = pair
            continue
        widest = max(widest, pair.angle)
        if pair.points >= min_points and pair.angle >= min_angle:
            found.append(pair)
    if not found:
        raise no_base(widest, min_angle, reason)
    return sorted(found, key=lambda pair: (-pair.score, pair.a, pair.b))


def no_base(widest: float, min_angle: float, reason: str) -> UserError:
    """Say that no pair has a usable base; `widest` is the best median angle seen, radians, 0 where none."""
    if widest:
        why = Text(
            "The rays of the best pair meet at {widest:.2f}°, {least:g}° are needed: the photos were taken from one "
            "place, or show the same.",
            widest=float(np.degrees(widest)),
            least=float(np.degrees(min_angle)),
        )
    else:
        why = Text("In every pair: {reason}.", reason=reason or "the rays do not agree")
    return UserError(
        "No pair of photos can start the block.",
        why,
        "Take photos from different places, with a base of at least a tenth of the distance to the object.",
        learn="adjustment/base-and-angle",
    )


def chosen_first_pair(block: GrowingBlock, a: int, b: int, *, min_angle: float, seed: int) -> FirstPair:
    """Orient the pair that a person chose.

    Raises
    ------
    UserError
        When it cannot be oriented, or has no base.
    """
    pair = orient_pair(block, a, b, seed=seed)
    if isinstance(pair, str):
        raise no_base(0.0, min_angle, pair)
    if pair.angle < min_angle:
        raise no_base(pair.angle, min_angle, "")
    return pair
