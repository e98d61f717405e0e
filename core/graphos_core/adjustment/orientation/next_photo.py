"""The next photo: which one to add to the block, and how it is oriented."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.adjustment.orientation.growing import GrowingBlock
from graphos_core.data import Array
from graphos_core.geometry.relative_orientation import depths, relative_orientation
from graphos_core.geometry.resection import judge_resection, refine_resection, space_resection
from graphos_core.text import Text

MIN_SCALING = 6
"""Known points that must agree where a relative orientation carries a photo and they only scale its base."""

CONVINCING = 0.75
"""Share of the known points that must agree with a resection so that nothing else is tried."""


@dataclass(frozen=True)
class Placement:
    """An oriented photo that is to join the block; false in a condition when it cannot.

    Attributes
    ----------
    rotation, centre : float64 (3, 3), (3,)
        ``cam_from_world`` and projection centre.
    method : str
        ``"space resection"`` or ``"relative orientation to <photo>"``.
    inliers, common : int
        Known points that agree, of those it sees.
    rms_px : float
        Root mean square distance (2-D) of the agreeing points, px.
    reason : str
        Why it cannot join; empty where it can.
    on : tuple of int
        The neighbour of a relative orientation; empty for a resection.
    """

    rotation: Array
    centre: Array
    method: str
    inliers: int
    common: int
    rms_px: float
    reason: str = ""
    on: tuple[int, ...] = ()

    def __bool__(self) -> bool:
        return not self.reason


def inertia(xy: Array, width: int, height: int) -> float:
    """Return how well points hold a photo: the smallest eigenvalue of their inertia matrix.

    ``Σ (x − x̄)(x − x̄)ᵀ`` over the tie points with the oriented photos, in units of half the longer side: it grows
    with the number of points and with their spread in the narrowest direction (Pierrot-Deseilligny and Cléry 2011,
    APERO, choice of the next image).

    Parameters
    ----------
    xy : float64 (n, 2)
        Image points, px.
    width, height : int
        Format, px.
    """
    if len(xy) < 2:
        return 0.0
    centred = (xy - xy.mean(axis=0)) / (0.5 * max(width, height))
    return float(np.linalg.eigvalsh(centred.T @ centred)[0])


def rank_photos(block: GrowingBlock, waiting: list[int]) -> list[tuple[int, int]]:
    """Return (photo, number of known points it sees), best hold first, by `inertia`."""
    ranked = []
    for photo in waiting:
        seen = block.seen_by(photo)
        camera = block.cameras[block.camera_of_photo[photo]]
        ranked.append((inertia(block.tracks.xy[seen], camera.width, camera.height), photo, len(seen)))
    ranked.sort(key=lambda item: (-item[0], item[1]))
    return [(photo, count) for _, photo, count in ranked]


def place_photo(
    block: GrowingBlock, photo: int, *, min_points: int, threshold_px: float, seed: int
) -> Placement:
    """Orient a photo by space resection and, where that convinces less, by relative orientation to its best neighbour.

    A resection with which `CONVINCING` of the known points agree is taken; else the better one is kept. Better is the one with which more known points agree, and at equal number the smaller residual. Where fewer
    known points agree than are needed, a relative orientation still holds if enough rays of the pair agree and
    some known points give the length of its base (`MIN_SCALING`).
    """
    seen = block.seen_by(photo)
    points, rays = block.points[block.tracks.track[seen]], block.rays[seen]
    best, method = space_resection(points, rays, threshold_px, seed=seed), Text("space resection")
    on: tuple[int, ...] = ()
    neighbour, pair = -1, None
    if best.inliers.sum() < max(2 * min_points, CONVINCING * len(seen)):
        neighbour = best_neighbour(block, photo)
        pair = relative_to(block, photo, neighbour, seed=seed)
    if pair is not None:
        name = Text("relative orientation to {photo}", photo=block.names[neighbour])
        relative = refine_resection(pair.rotation, pair.translation, points, rays, threshold_px)
        if (relative.inliers.sum(), -relative.rms) > (best.inliers.sum(), -best.rms):
            best, method, on = relative, name, (neighbour,)
        if best.inliers.sum() < min_points <= pair.rays:
            scaled = judge_resection(pair.rotation, pair.translation, points, rays, 2.0 * threshold_px)
            agreeing = int(scaled.inliers.sum())
            if agreeing >= max(MIN_SCALING, 0.6 * len(seen)):
                best, method, on, min_points = scaled, name, (neighbour,), agreeing
    count = int(best.inliers.sum())
    reason = ""
    if not best or count < min_points:
        reason = Text(
            "only {count} of its {seen} points in common with the oriented photos agree within {limit:g} px, "
            "{needed} needed",
            count=count,
            seen=len(seen),
            limit=threshold_px,
            needed=min_points,
        )
    return Placement(best.rotation, best.centre, method, count, len(seen), best.rms, reason, on)


def best_neighbour(block: GrowingBlock, photo: int) -> int:
    """Return the oriented photo that has most tracks in common with `photo`."""
    tracks = block.tracks
    mine = np.zeros(tracks.count, dtype=bool)
    mine[tracks.track[block.observations_of(photo)]] = True
    counts = np.bincount(tracks.photo[block.valid & mine[tracks.track]], minlength=len(block.names))
    counts[~block.oriented] = 0
    return int(np.argmax(counts))


@dataclass(frozen=True)
class ScaledPair:
    """A photo oriented relative to a neighbour: ``p_cam = rotation · X + translation``, from so many rays."""

    rotation: Array
    translation: Array
    rays: int


def relative_to(block: GrowingBlock, photo: int, neighbour: int, *, seed: int) -> ScaledPair | None:
    """Orient `photo` by five points relative to `neighbour`; the known points common to both scale the base."""
    here, there = block.common(photo, neighbour)
    found = relative_orientation(block.rays[there], block.rays[here], block.reprojection_px, seed=seed)
    scaling = found.inliers & block.known[block.tracks.track[here]]
    if not found or scaling.sum() < 3:
        return None
    # the known distance from the neighbour against the one intersected with a base of length 1
    object_points = block.points[block.tracks.track[here[scaling]]]
    known = np.linalg.norm(object_points - block.centres[neighbour], axis=1)
    unit, _ = depths(
        found.rotation,
        found.translation,
        block.rays.directions[there[scaling]],
        block.rays.directions[here[scaling]],
    )
    base = float(np.median(known / unit))
    if not (np.isfinite(base) and base > 0):
        return None
    rotation = found.rotation @ block.rotations[neighbour]
    translation = base * found.translation - rotation @ block.centres[neighbour]
    return ScaledPair(rotation, translation, int(found.inliers.sum()))
