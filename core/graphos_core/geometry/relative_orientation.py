"""Relative orientation of two photos from corresponding rays: five points, consensus, refinement."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.rotation import matrix_from_vector, skew
from graphos_core.text import Text


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


def relative_orientation(a: Array, b: Array, threshold: float, *, seed: int) -> RelativeOrientation:
    """Orient photo b relative to photo a.

    Five-point solutions (Nistér 2004, by OpenCV) in a seeded consensus search, for flat objects also the
    decomposition of a homography (Malis and Vargas 2007, by OpenCV); then Gauss–Newton on the Sampson distances of
    the agreeing correspondences.

    Parameters
    ----------
    a, b : float64 (n, 2)
        Corresponding ideal image coordinates x/z, y/z.
    threshold : float
        Largest distance from the epipolar line, in the unit of `a` (px divided by the principal distance).
    seed : int
        Seed of the consensus search.

    Returns
    -------
    RelativeOrientation
    """
    a, b = (np.ascontiguousarray(side, dtype=np.float64) for side in (a, b))
    count = len(a)
    nothing = np.zeros(count, dtype=bool)
    if count < 6:
        return RelativeOrientation(
            np.eye(3), np.zeros(3), nothing, Text("only {count} corresponding points", count=count)
        )
    best = RelativeOrientation(np.eye(3), np.zeros(3), nothing, "the rays do not agree on an orientation")
    lowest = np.inf
    for rotation, translation in _candidates(a, b, threshold, seed):
        for _ in range(3):
            inliers = _agreeing(rotation, translation, a, b, threshold)
            if inliers.sum() < 6:
                break
            rotation, translation = _refine(rotation, translation, a[inliers], b[inliers])
        inliers = _agreeing(rotation, translation, a, b, threshold)
        agreeing, most = int(inliers.sum()), int(best.inliers.sum())
        cost = float((sampson_distances(rotation, translation, a, b)[inliers] ** 2).sum())
        if agreeing >= 6 and (agreeing > most or (agreeing == most and cost < lowest)):
            best, lowest = RelativeOrientation(rotation, translation, inliers), cost
    return best


def _candidates(a: Array, b: Array, threshold: float, seed: int) -> list[tuple[Array, Array]]:
    """Return rotations and directions of the base that may be right.

    One from the essential matrix; where rays also agree on a homography, those of its decomposition: on a plane
    the five points fit two orientations equally, and only the points behind a camera tell them apart.
    """
    settings = cv2.UsacParams()
    settings.threshold, settings.confidence, settings.maxIterations = threshold, 0.9999, 5000
    settings.isParallel, settings.randomGeneratorState = False, seed % (2**31 - 1) + 1
    settings.score, settings.loMethod = cv2.SCORE_METHOD_MAGSAC, cv2.LOCAL_OPTIM_INNER_LO
    found: list[tuple[Array, Array]] = []
    try:
        essential, _ = cv2.findEssentialMat(a, b, np.eye(3), np.eye(3), None, None, settings)
        if essential is not None and essential.shape == (3, 3) and np.isfinite(essential).all():
            found.append(_decompose(essential, a, b, threshold))
    except cv2.error:
        pass  # no five points in general position
    settings.confidence, settings.maxIterations = 0.99, 300  # a plane is found soon or is not there
    try:
        homography, plane = cv2.findHomography(a, b, settings)
    except cv2.error:
        return found
    if homography is None or plane.sum() < max(6, 0.3 * len(a)):
        return found
    _, rotations, translations, _ = cv2.decomposeHomographyMat(homography, np.eye(3))
    for rotation, translation in zip(rotations, translations, strict=True):
        length = float(np.linalg.norm(translation))
        if length > 1e-9 and np.isfinite(rotation).all():
            found.append((rotation, translation.ravel() / length))
    votes = [int(_agreeing(r, t, a, b, threshold).sum()) for r, t in found]
    return [found[k] for k in np.argsort([-v for v in votes], kind="stable")[:3]]


def sampson_distances(rotation: Array, translation: Array, a: Array, b: Array) -> Array:
    """Return signed Sampson distances (n,) of corresponding ideal coordinates, first order, in their unit.

    ``e = y_bᵀ E y_a / √(|E y_a|²₁₂ + |Eᵀ y_b|²₁₂)`` with ``E = [t]× R`` (Hartley and Zisserman 2004, equation
    11.9).
    """
    essential = skew(translation) @ rotation
    ya, yb = _homogeneous(a), _homogeneous(b)
    la, lb = ya @ essential.T, yb @ essential
    size = (la[:, :2] ** 2).sum(axis=1) + (lb[:, :2] ** 2).sum(axis=1)
    return (yb * la).sum(axis=1) / np.sqrt(np.maximum(size, 1e-300))


def depths(rotation: Array, translation: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """Return the distances z (n,) along both rays of the nearest points, in units of the translation.

    Least squares of ``z_b y_b − z_a R y_a = t``; negative behind the camera, infinite for parallel rays.
    """
    p, q = _homogeneous(a) @ rotation.T, _homogeneous(b)
    pp, qq, pq = (p * p).sum(axis=1), (q * q).sum(axis=1), (p * q).sum(axis=1)
    tp, tq = p @ translation, q @ translation
    det = pp * qq - pq * pq
    with np.errstate(divide="ignore", invalid="ignore"):
        return (pq * tq - qq * tp) / det, (pp * tq - pq * tp) / det


def _agreeing(rotation: Array, translation: Array, a: Array, b: Array, threshold: float) -> Array:
    za, zb = depths(rotation, translation, a, b)
    return (np.abs(sampson_distances(rotation, translation, a, b)) <= threshold) & (za > 0) & (zb > 0)


def _decompose(essential: Array, a: Array, b: Array, threshold: float) -> tuple[Array, Array]:
    """Choose the one of four decompositions that puts most agreeing points before both cameras."""
    u, _, vt = np.linalg.svd(essential)
    w = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    sign = np.sign(np.linalg.det(u) * np.linalg.det(vt))
    choices = [(sign * u @ m @ vt, s * u[:, 2]) for m in (w, w.T) for s in (1.0, -1.0)]
    votes = [int(_agreeing(r, t, a, b, threshold).sum()) for r, t in choices]
    return choices[int(np.argmax(votes))]


def _refine(rotation: Array, translation: Array, a: Array, b: Array, steps: int = 10) -> tuple[Array, Array]:
    """Minimise the sum of squared Sampson distances over rotation (3) and direction (2)."""
    ya, yb = _homogeneous(a), _homogeneous(b)
    cost = float((sampson_distances(rotation, translation, a, b) ** 2).sum())
    for _ in range(steps):
        essential = skew(translation) @ rotation
        la, lb = ya @ essential.T, yb @ essential
        weight = 1.0 / np.sqrt((la[:, :2] ** 2).sum(axis=1) + (lb[:, :2] ** 2).sum(axis=1))
        p = ya @ rotation.T
        normal = np.cross(p, yb)  # e = t · (R y_a × y_b)
        tangent = np.linalg.svd(translation[None])[2][1:]
        jacobian = np.hstack([np.cross(p, np.cross(yb, translation)), normal @ tangent.T]) * weight[:, None]
        step, *_ = np.linalg.lstsq(jacobian, -(normal @ translation) * weight, rcond=None)
        new_rotation = matrix_from_vector(step[:3]) @ rotation
        new_translation = translation + step[3:] @ tangent
        new_translation /= np.linalg.norm(new_translation)
        new_cost = float((sampson_distances(new_rotation, new_translation, a, b) ** 2).sum())
        if not new_cost < cost:
            break
        rotation, translation, gain, cost = new_rotation, new_translation, cost - new_cost, new_cost
        if gain < 1e-10 * cost:
            break
    return rotation, translation


def _homogeneous(xy: Array) -> Array:
    return np.column_stack([xy, np.ones(len(xy))])
