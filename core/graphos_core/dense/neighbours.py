"""Which photos are matched with which, and in which range of depths to look.

A good neighbour shares many object points, sees them under an intersection angle of about 10 to 20 degrees (wider
is more precise but looks less alike) and in a similar scale (Furukawa and Ponce 2010, section 3.1; Yao et al. 2018,
section 4.1, use the same idea).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array, Block

GOOD_ANGLES = (np.radians(10.0), np.radians(20.0))
"""Intersection angles with full weight."""

ANGLE_FALL = np.radians(12.0)
"""Standard deviation of the weight's fall beyond the wider good angle."""

LEAST_COMMON = 8
"""Fewest common object points of a usable pair."""


@dataclass(frozen=True)
class Neighbourhood:
    """One photo with the photos it is matched with.

    Attributes
    ----------
    photo : int
        Index in the block.
    neighbours : tuple of int
        Best first.
    near, far : float
        Range of depths z in the camera frame, in the block's unit.
    """

    photo: int
    neighbours: tuple[int, ...]
    near: float
    far: float


def angle_weight(angle: Array) -> Array:
    """Return the weight 0 to 1 of intersection angles (radians): full between 10 and 20 degrees."""
    low, high = GOOD_ANGLES
    rise = np.clip(np.asarray(angle) / low, 0.0, 1.0) ** 2
    fall = np.exp(-0.5 * (np.maximum(np.asarray(angle) - high, 0.0) / ANGLE_FALL) ** 2)
    return rise * fall


def choose_neighbours(block: Block, count: int) -> list[Neighbourhood]:
    """Return the neighbourhood of every oriented photo that has neighbours and a depth range.

    Neighbours are chosen one after the other; a point that chosen neighbours see already counts less, so that
    together they cover the photo and not only its best seen part.

    Parameters
    ----------
    block : Block
    count : int
        Largest number of neighbours of a photo.

    Returns
    -------
    list of Neighbourhood
        In the order of the photos; a photo without any is missing.
    """
    photos = np.flatnonzero(block.oriented)
    seen = np.zeros((len(block.oriented), len(block.points)), dtype=bool)
    seen[block.obs_photo, block.obs_point] = True
    found = []
    for photo in photos:
        ranged = depth_range(block, int(photo), seen[photo])
        chosen = _greedy(block, int(photo), seen, [int(p) for p in photos if p != photo], count)
        if ranged is not None and chosen:
            found.append(Neighbourhood(int(photo), chosen, *ranged))
    return found


def _greedy(block: Block, photo: int, seen: Array, others: list[int], count: int) -> tuple[int, ...]:
    own = np.flatnonzero(seen[photo])
    rays = block.points[own] - block.centres[photo]
    distance = np.linalg.norm(rays, axis=1)
    weights = {}
    for other in others:
        common = seen[other, own]
        if int(common.sum()) < LEAST_COMMON:
            continue
        theirs = block.points[own] - block.centres[other]
        length = np.linalg.norm(theirs, axis=1)
        cosine = np.einsum("ij,ij->i", rays, theirs) / np.maximum(distance * length, 1e-300)
        zoom = (focal(block, other) / length) / (focal(block, photo) / distance)
        scale = np.minimum(zoom, 1.0 / zoom) ** 2
        weights[other] = common * angle_weight(np.arccos(np.clip(cosine, -1.0, 1.0))) * scale
    chosen: list[int] = []
    times = np.zeros(len(own))
    while weights and len(chosen) < count:
        gain = {other: float((weight / (1.0 + times)).sum()) for other, weight in weights.items()}
        best = max(gain, key=lambda other: (gain[other], -other))
        if gain[best] <= 0.0:
            break
        times += weights.pop(best)
        chosen.append(best)
    return tuple(chosen)


def focal(block: Block, photo: int) -> float:
    """Return the principal distance of a photo's camera, px of the full photo."""
    return block.cameras[int(block.camera_of_photo[photo])].focal_px


def depth_range(
    block: Block, photo: int, seen: Array, *, share: float = 0.005, margin: float = 0.15
) -> tuple[float, float] | None:
    """Return the range of depths (near, far) of a photo from its object points, or None with fewer than 8.

    Parameters
    ----------
    block : Block
    photo : int
    seen : bool (p,)
        Which object points the photo observes.
    share : float
        Part of the points that may lie outside at either end.
    margin : float
        Widening of the range in inverse depth at either end, as a share of it.
    """
    z = (block.points[seen] - block.centres[photo]) @ block.rotations[photo][2]
    z = z[z > 0.0]
    if len(z) < LEAST_COMMON:
        return None
    low, high = np.quantile(1.0 / z, [share, 1.0 - share])
    widen = margin * (high - low) + 0.02 * high
    return float(1.0 / (high + widen)), float(1.0 / max(low - widen, 0.2 * low))
