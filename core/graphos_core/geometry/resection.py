"""Space resection: the exterior orientation of one photo from object points and their rays."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.rays import Rays, as_rays
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.geometry.three_point import three_point
from graphos_core.text import Text

BATCH, BATCHES = 50, 40
"""Samples of three tried at a time, and how many times at most."""

SCORED = 500
"""Points that a sample is scored with."""

CONFIDENCE = 0.9999

DISAGREE = Text("the points do not agree on an orientation")


@dataclass(frozen=True)
class Resection:
    """Exterior orientation of one photo; false in a condition when it was not found.

    Attributes
    ----------
    rotation : float64 (3, 3)
        ``cam_from_world``.
    centre : float64 (3,)
        Projection centre in the object frame.
    inliers : bool (n,)
        Points that agree within the threshold and lie in front of the camera.
    rms : float
        Root mean square distance (2-D) of the agreeing points, px with `Rays`.
    reason : str
        Why there is none; empty where there is.
    """

    rotation: Array
    centre: Array
    inliers: Array
    rms: float
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason


def space_resection(points: Array, rays: Rays | Array, threshold: float, *, seed: int) -> Resection:
    """Find where a photo was taken.

    Three-point solutions in a seeded consensus search (Grunert's problem; by OpenCV for central cameras, by
    `three_point` for all others), then Gauss–Newton on the distances of the agreeing points.

    Parameters
    ----------
    points : float64 (n, 3)
        Object points.
    rays : Rays, or float64 (n, 2) or (n, 3)
        Their rays; ideal image coordinates x/z, y/z or directions also do.
    threshold : float
        Largest distance of an agreeing point: px with `Rays`, else in the unit of the coordinates, or radians.
    seed : int
        Seed of the consensus search.

    Returns
    -------
    Resection
    """
    rays, count = as_rays(rays), len(points)
    points = np.ascontiguousarray(points, dtype=np.float64)
    if count < 4:
        return _failed(count, Text("only {count} points", count=count))
    search = _central_search if rays.central else _ray_search
    found = search(points, rays, threshold, seed)
    if found is None:
        return _failed(count, DISAGREE)
    return refine_resection(*found, points, rays, threshold)


def _central_search(points: Array, rays: Rays, threshold: float, seed: int) -> tuple[Array, Array] | None:
    order = np.random.default_rng(seed).permutation(len(points))  # OpenCV's own draws are fixed
    try:
        found, vector, translation, _ = cv2.solvePnPRansac(
            points[order],
            np.ascontiguousarray(rays.plane[order]),
            np.eye(3),
            None,
            iterationsCount=3000,
            reprojectionError=threshold / rays.frames[0, 0, 0],
            confidence=CONFIDENCE,
            flags=cv2.SOLVEPNP_P3P,
        )
    except cv2.error:
        return None
    return (cv2.Rodrigues(vector)[0], translation.ravel()) if found else None


def _ray_search(points: Array, rays: Rays, threshold: float, seed: int) -> tuple[Array, Array] | None:
    """Try samples of three in batches, scored by ``Σ min(e², threshold²)``, until a good one is as good as certain."""
    rng, count = np.random.default_rng([seed, 3]), len(points)
    scored = np.sort(rng.permutation(count)[:SCORED])
    frames, targets = rays.frames[scored], np.column_stack([points[scored], np.ones(len(scored))])
    terms = np.einsum("nri,nj->rijn", frames, targets).reshape(3, 12, -1)
    best, lowest, needed = None, np.inf, BATCH * BATCHES
    for batch in range(BATCHES):
        pick = np.argsort(rng.random((BATCH, count)), axis=1)[:, :3]
        rotations, translations, _ = three_point(points[pick], rays.directions[pick])
        poses = np.concatenate([rotations, translations[:, :, None]], axis=2).reshape(-1, 12)
        x, y, z = poses @ terms
        with np.errstate(divide="ignore", invalid="ignore"):
            squares = np.where(z > 0.0, (x**2 + y**2) / z**2, np.inf)
        cost = np.minimum(squares, threshold**2).sum(axis=1)
        if len(cost) and cost.min() < lowest:
            winner = int(np.argmin(cost))
            best, lowest = (rotations[winner], translations[winner]), float(cost[winner])
            good = float(np.clip((squares[winner] <= threshold**2).mean() ** 3, 1e-12, 1 - 1e-12))
            needed = int(np.ceil(np.log(1.0 - CONFIDENCE) / np.log(1.0 - good)))
        if (batch + 1) * BATCH >= needed:
            break
    return best


def refine_resection(
    rotation: Array, translation: Array, points: Array, rays: Rays | Array, threshold: float
) -> Resection:
    """Refine an approximate exterior orientation ``p_cam = rotation · X + translation`` with its agreeing points.

    Parameters and result as in `space_resection`; agreement and refinement alternate three times.
    """
    points, rays = np.ascontiguousarray(points, dtype=np.float64), as_rays(rays)
    for _ in range(3):
        inliers = _distances(rotation, translation, points, rays) <= threshold
        if inliers.sum() < 4:
            return _failed(len(points), DISAGREE)
        rotation, translation = _least_squares(rotation, translation, points[inliers], rays[inliers])
        if not (np.isfinite(rotation).all() and np.isfinite(translation).all()):
            return _failed(len(points), DISAGREE)
    return judge_resection(rotation, translation, points, rays, threshold)


def _least_squares(
    rotation: Array, translation: Array, points: Array, rays: Rays, steps: int = 10
) -> tuple[Array, Array]:
    """Minimise the sum of squared distances over rotation (3) and translation (3) by damped Gauss–Newton."""
    cost, misfit, jacobian = _linearised(rotation, translation, points, rays)
    damping = 0.0
    for _ in range(steps):
        normal = jacobian.T @ jacobian
        step = np.linalg.lstsq(normal + damping * np.diag(np.diag(normal)), -jacobian.T @ misfit, rcond=None)[
            0
        ]
        turn = matrix_from_vector(step[:3])
        new_rotation, new_translation = turn @ rotation, turn @ translation + step[3:]
        new_cost, new_misfit, new_jacobian = _linearised(new_rotation, new_translation, points, rays)
        if not new_cost < cost:
            if damping > 1e3 or new_cost < cost * (1 + 1e-12):
                break
            damping = max(1e-4, 10.0 * damping)
            continue
        gain, cost = cost - new_cost, new_cost
        rotation, translation, misfit, jacobian = new_rotation, new_translation, new_misfit, new_jacobian
        damping *= 0.1
        if gain < 1e-12 * cost:
            break
    return rotation, translation


def _linearised(rotation: Array, translation: Array, points: Array, rays: Rays) -> tuple[float, Array, Array]:
    """Return the sum of squares (infinite behind the camera), misfits (2n,) and derivatives by turn and shift (2n, 6)."""
    p = points @ rotation.T + translation
    q = np.einsum("nij,nj->ni", rays.frames, p)
    if not (q[:, 2] > 0.0).all():
        return np.inf, np.zeros(2 * len(q)), np.zeros((2 * len(q), 6))
    misfit = q[:, :2] / q[:, 2:]
    by_point = (rays.frames[:, :2] - misfit[:, :, None] * rays.frames[:, 2:]) / q[:, 2, None, None]
    by_turn = np.cross(p[:, None], by_point)  # ∂(ω × p) by ω: by_point · (ω × p) = ω · (p × by_point)
    jacobian = np.concatenate([by_turn, by_point], axis=2).reshape(-1, 6)
    return float((misfit**2).sum()), misfit.ravel(), jacobian


def judge_resection(
    rotation: Array, translation: Array, points: Array, rays: Rays | Array, threshold: float
) -> Resection:
    """Say which points agree with an exterior orientation ``p_cam = rotation · X + translation``, unchanged.

    Parameters and result as in `space_resection`.
    """
    distances = _distances(rotation, translation, points, as_rays(rays))
    inliers = distances <= threshold
    if inliers.sum() < 4:
        return _failed(len(points), DISAGREE)
    rms = float(np.sqrt((distances[inliers] ** 2).mean()))
    return Resection(rotation, -rotation.T @ translation, inliers, rms)


def _distances(rotation: Array, translation: Array, points: Array, rays: Rays) -> Array:
    """Distance of each projected point from its ray in the plane of the ray; infinite behind it."""
    q = np.einsum("nij,nj->ni", rays.frames, points @ rotation.T + translation)
    front = q[:, 2] > 0
    return np.where(front, np.hypot(q[:, 0], q[:, 1]) / np.where(front, q[:, 2], 1.0), np.inf)


def _failed(count: int, reason: str) -> Resection:
    return Resection(np.eye(3), np.zeros(3), np.zeros(count, dtype=bool), np.inf, reason)
