"""Joining two oriented clusters of photos: a similarity from the points that both know."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.adjustment.orientation.growing import GrowingBlock, Oriented
from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.geometry.similarity import Similarity, estimate_similarity
from graphos_core.text import Text

SAMPLES = 200
"""Samples of three common points."""

NEAR = 0.03
"""Common points agree when they differ by less than this share of their distance from the nearest photo."""

FITTING = 0.5
"""Share of the observations of common points that must fit after joining."""


@dataclass(frozen=True)
class Joint:
    """``a_from_b`` of two clusters; false in a condition when it was not found.

    Attributes
    ----------
    similarity : Similarity
    points : int
        Common points that agree.
    rms_px : float
        Root mean square distance (2-D) of the observations in b of a's points, px.
    reason : str
    """

    similarity: Similarity
    points: int
    rms_px: float
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason


def find_joint(a: GrowingBlock, b: GrowingBlock, *, min_points: int, threshold_px: float, seed: int) -> Joint:
    """Find the similarity from cluster b to cluster a: samples of three common points, then all that agree."""
    nothing = Similarity(1.0, np.eye(3), np.zeros(3))
    common = np.flatnonzero(a.known & b.known)
    if len(common) < min_points:
        return Joint(nothing, len(common), np.nan, Text("only {n} points in common", n=len(common)))
    in_a, in_b = a.points[common], b.points[common]
    centres = a.centres[a.oriented]
    distance = np.min([np.linalg.norm(in_a - centre, axis=1) for centre in centres], axis=0)
    rng = np.random.default_rng([seed, len(common)])
    best, agreeing = nothing, np.zeros(len(common), dtype=bool)
    for _ in range(SAMPLES):
        pick = rng.choice(len(common), 3, replace=False)
        found, inliers = _fitted(in_a, in_b, pick, distance)
        if inliers.sum() > agreeing.sum():
            best, agreeing = found, inliers
    for _ in range(3):
        found, inliers = _fitted(in_a, in_b, np.flatnonzero(agreeing), distance)
        if inliers.sum() < agreeing.sum():
            break
        best, agreeing = found, inliers
    if agreeing.sum() < min_points:
        return Joint(nothing, int(agreeing.sum()), np.nan, Text("the common points do not agree"))
    fits, rms = _judged(a, b, best, common[agreeing], threshold_px)
    reason = "" if fits >= FITTING else Text("only {share:.0%} of the common observations fit", share=fits)
    return Joint(best, int(agreeing.sum()), rms, reason)


def _fitted(in_a: Array, in_b: Array, pick: Array, distance: Array) -> tuple[Similarity, Array]:
    try:
        found = estimate_similarity(in_b[pick], in_a[pick])
    except UserError:
        return Similarity(1.0, np.eye(3), np.zeros(3)), np.zeros(len(in_a), dtype=bool)
    return found, np.asarray(np.linalg.norm(found.apply(in_b) - in_a, axis=1) <= NEAR * distance)


def _judged(
    a: GrowingBlock, b: GrowingBlock, similarity: Similarity, common: Array, threshold_px: float
) -> tuple[float, float]:
    """Return the share of b's observations of a's points that fit, and their RMS, px."""
    moved = _moved(b, similarity)
    moved.points = a.points
    asked = np.zeros(b.tracks.count, dtype=bool)
    asked[common] = True
    misses = moved.distances_px(np.flatnonzero(b.used & asked[b.tracks.track]))
    good = misses[misses <= threshold_px]
    return len(good) / max(len(misses), 1), float(np.sqrt((good**2).mean())) if len(good) else np.nan


def _moved(block: GrowingBlock, similarity: Similarity) -> GrowingBlock:
    """Return the cluster in the frame of the other one; its observations and tree are shared."""
    moved = block.fresh()
    there = block.oriented
    moved.oriented, moved.known, moved.used, moved.tree = there, block.known, block.used, block.tree
    moved.rotations[there] = similarity.rotate_camera(block.rotations[there])
    moved.centres[there] = similarity.apply(block.centres[there])
    moved.points = similarity.apply(block.points)
    return moved


def join(a: GrowingBlock, b: GrowingBlock, joint: Joint) -> None:
    """Take cluster b into cluster a."""
    moved = _moved(b, joint.similarity)
    first, *others = b.tree
    method = Text(
        "similarity of blocks of {a} and {b} photos", a=int(a.oriented.sum()), b=int(b.oriented.sum())
    )
    a.rotations[b.oriented], a.centres[b.oriented] = moved.rotations[b.oriented], moved.centres[b.oriented]
    new = b.known & ~a.known
    a.points[new] = moved.points[new]
    a.known |= b.known
    a.used |= b.used
    shared = _sharing_most(a, b)
    a.oriented |= b.oriented
    a.tree += [Oriented(first.photo, shared, method, joint.points, joint.rms_px), *others]


def _sharing_most(a: GrowingBlock, b: GrowingBlock) -> tuple[int, ...]:
    """Return the photo of a that sees most points of b."""
    tracks = a.tracks
    seen = np.zeros(tracks.count, dtype=bool)
    seen[tracks.track[b.used]] = True
    counts = np.bincount(tracks.photo[a.used & seen[tracks.track]], minlength=len(a.names))
    counts[~a.oriented] = 0
    return (int(np.argmax(counts)),)
