"""Relative orientation of two photos from corresponding rays: five points, consensus, refinement."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.eight_point import decompose_essential
from graphos_core.geometry.five_point import five_point
from graphos_core.geometry.rays import Rays, as_rays
from graphos_core.geometry.rotation import matrix_from_vector, skew
from graphos_core.text import Text

BATCH, BATCHES = 50, 40
"""Samples of five tried at a time, and how many times at most."""

SCORED = 500
"""Correspondences that a sample is scored with."""

CONFIDENCE = 0.9999


@dataclass(frozen=True)
class RelativeOrientation:
    """Where photo b stands, seen from photo a; false in a condition when it was not found.

    Attributes
    ----------
    rotation : float64 (3, 3)
        ``b_from_a`` of the camera frames.
    translation : float64 (3,)
        Unit vector: ``p_b = rotation · p_a + scale · translation``.
    inliers : bool (n,)
        Correspondences that agree and lie in front of both cameras.
    reason : str
        Why there is none; empty where there is.
    """

    rotation: Array
    translation: Array
    inliers: Array
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason


@dataclass(frozen=True)
class RayPairs:
    """Corresponding rays of two photos."""

    a: Rays
    b: Rays

    def __getitem__(self, index: Array) -> RayPairs:
        return RayPairs(self.a[index], self.b[index])

    @cached_property
    def tips(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """`Rays.tips` of both."""
        return self.a.tips(), self.b.tips()

    def line_gradients(self, essential: Array) -> tuple[Array, Array, Array]:
        """Return ``y_bᵀ E y_a`` (n,) and its derivatives by the position in a and in b, (n, 2), per px."""
        (ya, spread_a), (yb, spread_b) = self.tips
        in_b, in_a = ya @ essential.T, yb @ essential
        return (
            (yb * in_b).sum(axis=1),
            np.einsum("nk,nkj->nj", in_a, spread_a),
            np.einsum("nk,nkj->nj", in_b, spread_b),
        )

    def line_distances(self, essential: Array) -> Array:
        """Return the larger distance (n,) of each ray from the epipolar plane of its partner, px of its photo."""
        misfit, in_a, in_b = self.line_gradients(essential)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(
                np.abs(misfit) / np.minimum(np.linalg.norm(in_a, axis=1), np.linalg.norm(in_b, axis=1))
            )

    def sampson(self, essential: Array) -> Array:
        """Return signed Sampson distances (n,), px."""
        misfit, in_a, in_b = self.line_gradients(essential)
        return np.asarray(misfit / np.sqrt(np.maximum((in_a**2).sum(axis=1) + (in_b**2).sum(axis=1), 1e-300)))


def relative_orientation(
    a: Rays | Array, b: Rays | Array, threshold: float, *, seed: int
) -> RelativeOrientation:
    """Orient photo b relative to photo a.

    Five-point solutions (Nistér 2004; by OpenCV for central cameras, by `five_point` for all others) in a seeded
    consensus search, for flat objects also the decomposition of a homography (Malis and Vargas 2007, by OpenCV);
    then Gauss–Newton on the Sampson distances of the agreeing correspondences.

    Parameters
    ----------
    a, b : Rays, or float64 (n, 2) or (n, 3)
        Corresponding rays; ideal image coordinates x/z, y/z or directions also do.
    threshold : float
        Largest Sampson distance: px with `Rays`, else in the unit of the coordinates, or radians.
    seed : int
        Seed of the consensus search.

    Returns
    -------
    RelativeOrientation
    """
    pairs = RayPairs(as_rays(a), as_rays(b))
    count = len(pairs.a)
    nothing = np.zeros(count, dtype=bool)
    if count < 6:
        return RelativeOrientation(
            np.eye(3), np.zeros(3), nothing, Text("only {count} corresponding points", count=count)
        )
    best = RelativeOrientation(
        np.eye(3), np.zeros(3), nothing, Text("the rays do not agree on an orientation")
    )
    lowest = np.inf
    for rotation, translation in _candidates(pairs, threshold, seed):
        for _ in range(3):
            inliers = _agreeing(rotation, translation, pairs, threshold)
            if inliers.sum() < 6:
                break
            rotation, translation = refined(rotation, translation, pairs[inliers])
        inliers = _agreeing(rotation, translation, pairs, threshold)
        agreeing, most = int(inliers.sum()), int(best.inliers.sum())
        cost = float((pairs.sampson(skew(translation) @ rotation)[inliers] ** 2).sum())
        if agreeing >= 6 and (agreeing > most or (agreeing == most and cost < lowest)):
            best, lowest = RelativeOrientation(rotation, translation, inliers), cost
    return best


def _candidates(pairs: RayPairs, threshold: float, seed: int) -> list[tuple[Array, Array]]:
    """Return rotations and directions of the base that may be right.

    One from the essential matrix; where rays also agree on a homography, those of its decomposition: on a plane
    the five points fit two orientations equally, and only the points behind a camera tell them apart.
    """
    found: list[tuple[Array, Array]] = []
    central = pairs.a.central and pairs.b.central
    essential = (
        central_essential(pairs, threshold, seed) if central else ray_essential(pairs, threshold, seed)
    )
    if essential is not None:
        found.append(in_front(decompose_essential(essential), pairs, threshold))
    plane = (
        _central_homography(pairs, threshold, seed) if central else _ray_homography(pairs, threshold, seed)
    )
    if plane is None:
        return found
    _, rotations, translations, _ = cv2.decomposeHomographyMat(plane, np.eye(3))
    for rotation, translation in zip(rotations, translations, strict=True):
        length = float(np.linalg.norm(translation))
        if length > 1e-9 and np.isfinite(rotation).all():
            found.append((rotation, translation.ravel() / length))
    votes = [int(_agreeing(r, t, pairs, threshold).sum()) for r, t in found]
    return [found[k] for k in np.argsort([-v for v in votes], kind="stable")[:3]]


def _usac(threshold: float, seed: int, confidence: float, samples: int) -> cv2.UsacParams:
    settings = cv2.UsacParams()
    settings.threshold, settings.confidence, settings.maxIterations = threshold, confidence, samples
    settings.isParallel, settings.randomGeneratorState = False, seed % (2**31 - 1) + 1
    settings.score, settings.loMethod = cv2.SCORE_METHOD_MAGSAC, cv2.LOCAL_OPTIM_INNER_LO
    return settings


def _in_plane(pairs: RayPairs, threshold: float) -> tuple[Array, Array, float]:
    """Return both sides in the ideal image plane and the threshold in its unit."""
    focal = float(np.sqrt(pairs.a.frames[0, 0, 0] * pairs.b.frames[0, 0, 0]))
    a, b = (np.ascontiguousarray(side.plane) for side in (pairs.a, pairs.b))
    return a, b, threshold / focal


def central_essential(pairs: RayPairs, threshold: float, seed: int) -> Array | None:
    """Return the essential matrix (3, 3) that most rays of central cameras agree with, by OpenCV; None for none."""
    a, b, limit = _in_plane(pairs, threshold)
    try:
        essential, _ = cv2.findEssentialMat(
            a, b, np.eye(3), np.eye(3), None, None, _usac(limit, seed, CONFIDENCE, 5000)
        )
    except cv2.error:  # no five points in general position
        return None
    if essential is None or essential.shape != (3, 3) or not np.isfinite(essential).all():
        return None
    return np.asarray(essential)


def _central_homography(pairs: RayPairs, threshold: float, seed: int) -> Array | None:
    a, b, limit = _in_plane(pairs, threshold)
    try:  # a plane is found soon or is not there
        homography, plane = cv2.findHomography(a, b, _usac(limit, seed, 0.99, 300))
    except cv2.error:
        return None
    if homography is None or plane.sum() < max(6, 0.3 * len(a)):
        return None
    return np.asarray(homography)


def ray_essential(pairs: RayPairs, threshold: float, seed: int) -> Array | None:
    """Return the essential matrix (3, 3) of norm 1 that most rays of any field angle agree with; None for none.

    Samples of five in batches, scored by ``Σ min(e², threshold²)`` (Torr and Zisserman 2000), until a sample without
    a wrong correspondence is as good as certain.
    """
    rng = np.random.default_rng([seed, 5])
    scored = pairs[np.sort(rng.permutation(len(pairs.a))[:SCORED])]
    terms = _linear_terms(scored)
    best, lowest, needed = None, np.inf, BATCHES * BATCH
    for batch in range(BATCHES):
        pick = np.argsort(rng.random((BATCH, len(pairs.a))), axis=1)[:, :5]
        found, _ = five_point(pairs.a.directions[pick], pairs.b.directions[pick])
        misfit, *slopes = found.reshape(-1, 9) @ terms
        squares = misfit**2 / np.maximum(sum(slope**2 for slope in slopes), 1e-300)
        cost = np.minimum(squares, threshold**2).sum(axis=1)
        if len(cost) and cost.min() < lowest:
            winner = int(np.argmin(cost))
            best, lowest = found[winner], float(cost[winner])
            good = float(np.clip((squares[winner] <= threshold**2).mean() ** 5, 1e-12, 1 - 1e-12))
            needed = int(np.ceil(np.log(1.0 - CONFIDENCE) / np.log(1.0 - good)))
        if (batch + 1) * BATCH >= needed:
            break
    return best


def _linear_terms(pairs: RayPairs) -> Array:
    """Return what turns a matrix of nine elements into ``y_bᵀ E y_a`` and its four derivatives per px, (5, 9, n)."""
    (ya, spread_a), (yb, spread_b) = pairs.tips
    sides = [(yb, ya), *((yb, spread_a[:, :, p]) for p in (0, 1)), *((spread_b[:, :, p], ya) for p in (0, 1))]
    return np.stack([(b[:, :, None] * a[:, None, :]).reshape(-1, 9).T for b, a in sides])


def _ray_homography(pairs: RayPairs, threshold: float, seed: int) -> Array | None:
    """Return the homography of rays, ``b ~ H a`` with a positive factor, where enough of them agree on one."""
    rng = np.random.default_rng([seed, 4])
    a, b = pairs.a.directions, pairs.b.directions
    pick = np.argsort(rng.random((3 * BATCH, len(a))), axis=1)[:, :4]
    cross = np.zeros((3 * BATCH, 4, 3, 3))
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        cross[:, :, i, j], cross[:, :, i, k] = -b[pick, k], b[pick, j]
    conditions = np.einsum("skij,skl->skijl", cross, a[pick]).reshape(3 * BATCH, 12, 9)
    found = np.linalg.svd(conditions)[2][:, 8].reshape(-1, 3, 3)
    towards = np.einsum(
        "sni,sij,snj->s", b[pick], found, a[pick]
    )  # a ray goes to a ray, not to the opposite one
    found *= np.where(towards < 0.0, -1.0, 1.0)[:, None, None]
    rows = np.einsum("nri,nj->rijn", pairs.b.frames, a).reshape(3, 9, -1)
    x, y, z = found.reshape(-1, 9) @ rows
    agreeing = (z > 0.0) & (x**2 + y**2 <= (threshold * z) ** 2)
    winner = int(np.argmax(agreeing.sum(axis=1)))
    if agreeing[winner].sum() < max(6, 0.3 * len(a)):
        return None
    return np.asarray(found[winner])


def depths(rotation: Array, translation: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """Return the lengths (n,) along both rays of the nearest points, in units of the translation.

    Least squares of ``z_b y_b − z_a R y_a = t``; negative behind the camera, infinite for parallel rays.

    Parameters
    ----------
    rotation, translation : float64 (3, 3), (3,)
        ``b_from_a``.
    a, b : float64 (n, 3), or (n, 2) for ideal image coordinates
        Rays; lengths count in multiples of theirs, so with (x/z, y/z) they are depths z.
    """
    p, q = _three(a) @ rotation.T, _three(b)
    pp, qq, pq = (p * p).sum(axis=1), (q * q).sum(axis=1), (p * q).sum(axis=1)
    tp, tq = p @ translation, q @ translation
    det = pp * qq - pq * pq
    with np.errstate(divide="ignore", invalid="ignore"):
        return (pq * tq - qq * tp) / det, (pp * tq - pq * tp) / det


def _three(rays: Array) -> Array:
    return rays if rays.shape[1] == 3 else np.column_stack([rays, np.ones(len(rays))])


def _agreeing(rotation: Array, translation: Array, pairs: RayPairs, threshold: float) -> Array:
    za, zb = depths(rotation, translation, pairs.a.directions, pairs.b.directions)
    return (np.abs(pairs.sampson(skew(translation) @ rotation)) <= threshold) & (za > 0) & (zb > 0)


def in_front(choices: list[tuple[Array, Array]], pairs: RayPairs, threshold: float) -> tuple[Array, Array]:
    """Choose the decomposition (rotation, translation) that puts most agreeing points before both cameras."""
    votes = [int(_agreeing(r, t, pairs, threshold).sum()) for r, t in choices]
    return choices[int(np.argmax(votes))]


def refined(
    rotation: Array, translation: Array, pairs: RayPairs, steps: int = 10, weights: Array | None = None
) -> tuple[Array, Array]:
    """Minimise the (weighted) sum of squared Sampson distances over rotation (3) and direction (2).

    Gauss–Newton from a start ``b_from_a``, with the translation of length 1; weights are of the squares, (n,).
    """
    (ya, _), (yb, _) = pairs.tips
    share = np.ones(len(ya)) if weights is None else np.asarray(weights, dtype=np.float64)
    cost = float((share * pairs.sampson(skew(translation) @ rotation) ** 2).sum())
    for _ in range(steps):
        _, in_a, in_b = pairs.line_gradients(skew(translation) @ rotation)
        weight = np.sqrt(share) / np.sqrt((in_a**2).sum(axis=1) + (in_b**2).sum(axis=1))
        p = ya @ rotation.T
        normal = np.cross(p, yb)  # e = t · (R y_a × y_b)
        tangent = np.linalg.svd(translation[None])[2][1:]
        jacobian = np.hstack([np.cross(p, np.cross(yb, translation)), normal @ tangent.T]) * weight[:, None]
        step, *_ = np.linalg.lstsq(jacobian, -(normal @ translation) * weight, rcond=None)
        new_rotation = matrix_from_vector(step[:3]) @ rotation
        new_translation = translation + step[3:] @ tangent
        new_translation /= np.linalg.norm(new_translation)
        new_cost = float((share * pairs.sampson(skew(new_translation) @ new_rotation) ** 2).sum())
        if not new_cost < cost:
            break
        rotation, translation, gain, cost = new_rotation, new_translation, cost - new_cost, new_cost
        if gain < 1e-10 * cost:
            break
    return rotation, translation
