"""Space resection: the exterior orientation of one photo from object points and their rays."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.text import Text


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
        Root mean square distance (2-D) of the agreeing points, in the unit of the rays.
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


def space_resection(points: Array, rays: Array, threshold: float, *, seed: int) -> Resection:
    """Find where a photo was taken.

    Three-point solutions in a seeded consensus search (OpenCV: P3P; Grunert's problem), then Levenberg–Marquardt on the
    distances of the agreeing points.

    Parameters
    ----------
    points : float64 (n, 3)
        Object points.
    rays : float64 (n, 2)
        Their ideal image coordinates x/z, y/z.
    threshold : float
        Largest distance of an agreeing point, in the unit of the rays (px divided by the principal distance).
    seed : int
        Seed of the consensus search.

    Returns
    -------
    Resection
    """
    count = len(points)
    if count < 4:
        return _failed(count, Text("only {count} points", count=count))
    order = np.random.default_rng(seed).permutation(
        count
    )  # OpenCV's own draws are fixed: shuffle what it draws
    try:
        found, vector, translation, _ = cv2.solvePnPRansac(
            np.ascontiguousarray(points[order], dtype=np.float64),
            np.ascontiguousarray(rays[order], dtype=np.float64),
            np.eye(3),
            None,
            iterationsCount=3000,
            reprojectionError=threshold,
            confidence=0.9999,
            flags=cv2.SOLVEPNP_P3P,
        )
    except cv2.error:
        found = False
    if not found:
        return _failed(count, "the points do not agree on an orientation")
    return refine_resection(cv2.Rodrigues(vector)[0], translation.ravel(), points, rays, threshold)


def refine_resection(
    rotation: Array, translation: Array, points: Array, rays: Array, threshold: float
) -> Resection:
    """Refine an approximate exterior orientation ``p_cam = rotation · X + translation`` with its agreeing points.

    Parameters and result as in `space_resection`; agreement and refinement alternate three times.
    """
    points = np.ascontiguousarray(points, dtype=np.float64)
    rays = np.ascontiguousarray(rays, dtype=np.float64)
    for _ in range(3):
        inliers = _distances(rotation, translation, points, rays) <= threshold
        if inliers.sum() < 4:
            return _failed(len(points), "the points do not agree on an orientation")
        vector, moved = cv2.solvePnPRefineLM(
            points[inliers], rays[inliers], np.eye(3), None,
            cv2.Rodrigues(rotation)[0], np.array(translation, dtype=np.float64).reshape(3, 1),
            (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 30, 1e-14),
        )  # fmt: skip
        if not (np.isfinite(vector).all() and np.isfinite(moved).all()):
            return _failed(len(points), "the points do not agree on an orientation")
        rotation, translation = cv2.Rodrigues(vector)[0], moved.ravel()
    return judge_resection(rotation, translation, points, rays, threshold)


def judge_resection(
    rotation: Array, translation: Array, points: Array, rays: Array, threshold: float
) -> Resection:
    """Say which points agree with an exterior orientation ``p_cam = rotation · X + translation``, unchanged.

    Parameters and result as in `space_resection`.
    """
    distances = _distances(rotation, translation, points, rays)
    inliers = distances <= threshold
    if inliers.sum() < 4:
        return _failed(len(points), "the points do not agree on an orientation")
    rms = float(np.sqrt((distances[inliers] ** 2).mean()))
    return Resection(rotation, -rotation.T @ translation, inliers, rms)


def _distances(rotation: Array, translation: Array, points: Array, rays: Array) -> Array:
    """Distance of each projected point from its ray in the ideal image; infinite behind the camera."""
    p = points @ rotation.T + translation
    front = p[:, 2] > 0
    z = np.where(front, p[:, 2], 1.0)
    distance: Array = np.hypot(p[:, 0] / z - rays[:, 0], p[:, 1] / z - rays[:, 1])
    return np.where(front, distance, np.inf)


def _failed(count: int, reason: str) -> Resection:
    return Resection(np.eye(3), np.zeros(3), np.zeros(count, dtype=bool), np.inf, reason)
