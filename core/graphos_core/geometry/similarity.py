"""Similarity transforms between two sets of points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data.record import Array
from graphos_core.errors import UserError


@dataclass(frozen=True)
class Similarity:
    """``x_b = scale · rotation · x_a + translation``.

    Attributes
    ----------
    scale : float
    rotation : float64 (3, 3)
    translation : float64 (3,)
    """

    scale: float
    rotation: Array
    translation: Array

    def apply(self, points: Array) -> Array:
        """Move points (n, 3)."""
        return self.scale * np.asarray(points) @ self.rotation.T + self.translation

    def inverse(self) -> Similarity:
        """Return the transform back."""
        rotation = self.rotation.T
        return Similarity(1.0 / self.scale, rotation, -(rotation @ self.translation) / self.scale)

    def rotate_camera(self, cam_from_a: Array) -> Array:
        """Return ``cam_from_b`` of cameras (…, 3, 3)."""
        return np.asarray(cam_from_a) @ self.rotation.T


def estimate_similarity(a: Array, b: Array, *, with_scale: bool = True) -> Similarity:
    """Return the least-squares similarity ``b_from_a`` (Umeyama 1991, equations 38 to 43).

    Parameters
    ----------
    a, b : float64 (n, 3)
        Corresponding points, n ≥ 3, not on one line.
    with_scale : bool
        False for a rigid motion.

    Raises
    ------
    UserError
        With fewer than three points, or all on one line.
    """
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    if len(a) < 3:
        raise UserError(
            f"A similarity needs at least 3 common points, there are {len(a)}.",
            todo="Measure more control points in at least two photos each.",
        )
    mean_a, mean_b = a.mean(axis=0), b.mean(axis=0)
    da, db = a - mean_a, b - mean_b
    u, d, vt = np.linalg.svd(db.T @ da / len(a))
    spread = np.linalg.svd(da, compute_uv=False)
    if spread[1] < 1e-9 * max(spread[0], 1e-300):
        raise UserError(
            "A similarity cannot be computed from points on one line.",
            "The rotation about that line is free.",
            "Add a control point away from the line.",
        )
    sign = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    rotation = (u * sign) @ vt
    scale = float((d * sign).sum() / (da**2).sum() * len(a)) if with_scale else 1.0
    return Similarity(scale, rotation, mean_b - scale * rotation @ mean_a)
