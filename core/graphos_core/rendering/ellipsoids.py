"""Error ellipsoids as lines: the three principal ellipses of every covariance matrix."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array

SEGMENTS = 20


def ellipsoid_lines(centres: Array, covariances: Array, factor: float) -> tuple[Array, Array]:
    """Return starts and ends (3 · `SEGMENTS` · n, 3) of the lines of n ellipsoids.

    Half axes are `factor` times the square roots of the eigenvalues, so ``factor = 1`` is the ellipsoid of one standard
    deviation, inside which a point lies with a probability of 20 %. Ellipsoids that are not finite are left out.

    Parameters
    ----------
    centres : float64 (n, 3)
    covariances : float64 (n, 3, 3)
        In the square of the unit of the centres.
    factor : float
    """
    good = np.isfinite(covariances).all(axis=(1, 2)) & (np.einsum("nii->n", covariances) > 0)
    values, vectors = np.linalg.eigh(np.where(good[:, None, None], covariances, 0.0))
    axes = factor * np.sqrt(np.maximum(values, 0.0))[good, None, :] * vectors[good]  # columns are half axes
    angle = np.linspace(0.0, 2.0 * np.pi, SEGMENTS + 1)
    circles = np.zeros((3, SEGMENTS + 1, 3))
    for plane, (a, b) in enumerate(((0, 1), (0, 2), (1, 2))):
        circles[plane, :, a], circles[plane, :, b] = np.cos(angle), np.sin(angle)
    points = np.einsum("nij,psj->npsi", axes, circles) + np.asarray(centres)[good, None, None, :]
    return points[:, :, :-1].reshape(-1, 3), points[:, :, 1:].reshape(-1, 3)
