r"""Seven pairs of pixels determine the fundamental matrix: all solutions of many samples at once.

The two-dimensional null space of seven conditions ``x_bᵀ F x_a = 0``, ``F = z F₁ + F₂``, and the real roots of the
cubic ``det(z F₁ + F₂) = 0`` (Hartley and Zisserman 2004, section 11.1.2). One or three matrices per sample.
"""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array


def seven_point(a: Array, b: Array) -> tuple[Array, Array]:
    """Return the fundamental matrices of samples of seven pairs of points.

    Parameters
    ----------
    a, b : float64 (s, 7, 3)
        Corresponding homogeneous points, well conditioned (`graphos_core.geometry.normalisation.normalise`).

    Returns
    -------
    float64 (k, 3, 3)
        All real solutions, of norm 1.
    int (k,)
        Sample from which each came.
    """
    rows = (b[:, :, :, None] * a[:, :, None, :]).reshape(len(a), 7, 9)
    null = np.linalg.svd(rows, full_matrices=True)[2][:, 7:].reshape(-1, 2, 3, 3)
    cubic = _determinant(null[:, 0], null[:, 1])
    usable = np.abs(cubic[:, 3]) > 1e-12 * np.abs(cubic).max(axis=1)
    samples = np.flatnonzero(usable)
    companion = np.zeros((len(samples), 3, 3))
    companion[:, 1, 0] = companion[:, 2, 1] = 1.0
    companion[:, :, 2] = -cubic[samples, :3] / cubic[samples, 3:]
    roots = np.linalg.eigvals(companion)
    which, solution = np.nonzero(np.abs(roots.imag) < 1e-8 * (1.0 + np.abs(roots.real)))
    z = roots.real[which, solution][:, None, None]
    found = z * null[samples[which], 0] + null[samples[which], 1]
    return found / np.linalg.norm(found, axis=(1, 2), keepdims=True), samples[which]


def _determinant(first: Array, second: Array) -> Array:
    """Return the coefficients (s, 4) of ``det(z F₁ + F₂)``, from z⁰ to z³, from its values at four places."""
    places = np.array([-1.0, 0.0, 1.0, 2.0])
    values = np.linalg.det(places[None, :, None, None] * first[:, None] + second[:, None])
    return np.asarray(np.linalg.solve(np.vander(places, increasing=True), values.T).T)
