"""Three calibrated photos of the same points: two relative orientations brought to one scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.rays import Rays, as_rays, in_turn
from graphos_core.geometry.relative_orientation import depths, relative_orientation
from graphos_core.geometry.resection import refine_resection
from graphos_core.geometry.triangulation import intersect_rays
from graphos_core.text import Text

FEWEST = 6
"""Points that must agree in all three photos."""


@dataclass(frozen=True)
class Triplet:
    """Exterior orientations of three photos in the frame of the first, base a–b of length 1; false when not found.

    Attributes
    ----------
    rotations : float64 (3, 3, 3)
        ``cam_from_world``; identity for the first.
    centres : float64 (3, 3)
        Projection centres; zero for the first.
    inliers : bool (n,)
        Points whose three rays meet within the threshold.
    reason : str
        Why there is none; empty where there is.
    """

    rotations: Array
    centres: Array
    inliers: Array
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason


def orient_triplet(
    a: Rays | Array, b: Rays | Array, c: Rays | Array, threshold: float, *, seed: int
) -> Triplet:
    """Orient three photos relative to each other: a synchronised triple.

    b and c are oriented relative to a; the points that both pairs know have one depth in a, which gives the ratio of
    the bases. Then c is refined on the points that a and b intersect, and a point counts when its three rays meet.
    A third photo so tests a pair: a wrong match that lies on its epipolar line hardly survives it.

    Parameters
    ----------
    a, b, c : Rays, or float64 (n, 2) or (n, 3)
        Corresponding rays, as in `relative_orientation`.
    threshold : float
        As in `relative_orientation`.
    seed : int
        Of the consensus searches.
    """
    a, b, c = as_rays(a), as_rays(b), as_rays(c)
    to_b = relative_orientation(a, b, threshold, seed=seed)
    to_c = relative_orientation(a, c, threshold, seed=seed + 1)
    for found, name in ((to_b, "second"), (to_c, "third")):
        if not found:
            return _failed(len(a), Text("the {name} photo: {why}", name=name, why=found.reason))
    both = np.flatnonzero(to_b.inliers & to_c.inliers)
    if len(both) < FEWEST:
        return _failed(len(a), Text("only {count} points agree in both pairs", count=len(both)))
    in_b, _ = depths(to_b.rotation, to_b.translation, a.directions[both], b.directions[both])
    in_c, _ = depths(to_c.rotation, to_c.translation, a.directions[both], c.directions[both])
    ratio = float(np.median(in_b / in_c))
    rotations = np.stack([np.eye(3), to_b.rotation, to_c.rotation])
    centres = np.stack([
        np.zeros(3), -to_b.rotation.T @ to_b.translation, -ratio * to_c.rotation.T @ to_c.translation
    ])  # fmt: skip
    pair = intersect_rays(
        2 * np.arange(len(both) + 1), np.tile([0, 1], len(both)), in_turn([a[both], b[both]]), rotations, centres,
        threshold_px=threshold,
    )  # fmt: skip
    refined = refine_resection(
        to_c.rotation, ratio * to_c.translation, pair.points[pair.ok], c[both[pair.ok]], 3.0 * threshold
    )
    if not refined:
        return _failed(len(a), Text("the two pairs do not agree on the points"))
    rotations[2], centres[2] = refined.rotation, refined.centre
    return _judged(a, b, c, rotations, centres, threshold)


def _judged(a: Rays, b: Rays, c: Rays, rotations: Array, centres: Array, threshold: float) -> Triplet:
    count = len(a)
    found = intersect_rays(
        3 * np.arange(count + 1), np.tile([0, 1, 2], count), in_turn([a, b, c]), rotations, centres,
        threshold_px=threshold,
    )  # fmt: skip
    inliers = found.ok & found.used.reshape(count, 3).all(axis=1)
    if inliers.sum() < FEWEST:
        return _failed(count, Text("only {count} points agree in all three photos", count=int(inliers.sum())))
    return Triplet(rotations, centres, inliers)


def _failed(count: int, reason: str) -> Triplet:
    return Triplet(np.tile(np.eye(3), (3, 1, 1)), np.zeros((3, 3)), np.zeros(count, dtype=bool), reason)
