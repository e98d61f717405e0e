"""Normalisation of points before linear estimation: centroid at the origin, mean distance √d."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array


def normalise(points: Array) -> tuple[Array, Array]:
    """Shift and scale points so that a linear estimation with them is well conditioned (Hartley 1997).

    Parameters
    ----------
    points : float64 (n, d)

    Returns
    -------
    float64 (n, d + 1)
        Homogeneous normalised points: centroid 0, root mean square distance √d.
    float64 (d + 1, d + 1)
        ``normalised_from_points``: ``normalised = T · (x, 1)``.
    """
    points = np.asarray(points, dtype=np.float64)
    count, d = points.shape
    middle = points.mean(axis=0)
    spread = float(np.sqrt(((points - middle) ** 2).sum() / count))
    scale = np.sqrt(d) / spread if spread > 0.0 else 1.0
    transform = np.diag([scale] * d + [1.0])
    transform[:d, d] = -scale * middle
    return homogeneous(points) @ transform.T, transform


def homogeneous(points: Array) -> Array:
    """Return points (n, d) with a last coordinate 1."""
    return np.column_stack([points, np.ones(len(points))])


def null_vector(matrix: Array) -> tuple[Array, Array]:
    """Return the unit vector x with the smallest ``|matrix · x|``, and all singular values, largest first.

    Missing rows count as zeros, so the singular values are as many as the columns.
    """
    wide = len(matrix) < matrix.shape[1]
    _, singular, vt = np.linalg.svd(matrix, full_matrices=wide)
    return vt[-1], np.pad(singular, (0, matrix.shape[1] - len(singular)))
