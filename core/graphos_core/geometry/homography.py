r"""Homographies: ``x_b ∝ H x_a`` for points of one plane, or for photos taken from one place.

Each pair of points gives two conditions ``x_b × H x_a = 0``; four pairs determine the eight unknowns (Hartley and
Zisserman 2004, section 4.1).
"""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.normalisation import homogeneous, normalise, null_vector


def four_point(a: Array, b: Array) -> tuple[Array, Array]:
    """Return the homographies of samples of four pairs of points; samples that turn over are left out.

    A homography of what a camera sees keeps the sense of every triple of points; a sample of which some triples turn
    over and others do not is wrong (Marquez-Neila et al. 2015).

    Parameters
    ----------
    a, b : float64 (s, 4, 3)
        Corresponding homogeneous points with third coordinate 1, well conditioned.

    Returns
    -------
    float64 (k, 3, 3)
        Of norm 1.
    int (k,)
        Sample from which each came.
    """
    usable = _same_sense(a, b)
    samples = np.flatnonzero(usable)
    rows = _conditions(a[samples], b[samples])
    found = np.linalg.svd(rows, full_matrices=True)[2][:, 8].reshape(-1, 3, 3)
    return found, samples


def homography(xy_a: Array, xy_b: Array, weights: Array | None = None) -> Array:
    """Return the homography (3, 3) of norm 1 that fits four or more pairs of pixels best (normalised, algebraic).

    The rows are divided by the projective denominators of the solution before, twice, so that the residuals of the
    transfer into b are minimised instead of algebraic ones.

    Parameters
    ----------
    xy_a, xy_b : float64 (n, 2)
    weights : float64 (n,), optional
        Of the squared residuals.
    """
    a, from_a = normalise(xy_a)
    b, from_b = normalise(xy_b)
    rows = _conditions(a[None], b[None])[0].reshape(len(a), 2, 9)
    scale = np.ones(len(a)) if weights is None else np.sqrt(np.asarray(weights, dtype=np.float64))
    found = np.eye(3)
    for _ in range(3):
        depth = np.maximum(np.abs(a @ found[2]), 1e-9)
        found = null_vector((rows * (scale / depth)[:, None, None]).reshape(-1, 9))[0].reshape(3, 3)
    pixels = np.linalg.inv(from_b) @ found @ from_a
    return np.asarray(pixels / np.linalg.norm(pixels))


def transfer(matrix: Array, xy: Array) -> Array:
    """Return where points (n, 2) go under homographies (…, 3, 3): (…, n, 2); infinite on the vanishing line."""
    points = homogeneous(np.asarray(xy, dtype=np.float64)) @ np.swapaxes(matrix, -1, -2)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(points[..., :2] / points[..., 2:])


def transfer_squares(matrix: Array, xy_a: Array, xy_b: Array) -> tuple[Array, Array]:
    """Return the squared distances, px², of points of b from those of a mapped forth, and of a mapped back.

    Parameters
    ----------
    matrix : float64 (…, 3, 3)
    xy_a, xy_b : float64 (n, 2)

    Returns
    -------
    two float64 (…, n)
        Infinite where a point is not mapped.
    """
    matrix = np.asarray(matrix, dtype=np.float64)
    forth = ((transfer(matrix, xy_a) - xy_b) ** 2).sum(axis=-1)
    back = ((transfer(_inverse(matrix), xy_b) - xy_a) ** 2).sum(axis=-1)
    return np.nan_to_num(forth, nan=np.inf), np.nan_to_num(back, nan=np.inf)


def _inverse(matrix: Array) -> Array:
    """Return the adjugates: the inverses up to scale, also defined for singular matrices."""
    first, second, third = matrix[..., 0, :], matrix[..., 1, :], matrix[..., 2, :]
    return np.stack(
        [np.cross(second, third), np.cross(third, first), np.cross(first, second)], axis=-1
    )  # columns


def _conditions(a: Array, b: Array) -> Array:
    """Return two conditions for each pair of points, (s, 2 n, 9); third coordinates are 1."""
    zero = np.zeros_like(a)
    x, y = b[:, :, :1], b[:, :, 1:2]
    rows = np.stack(
        [np.concatenate([a, zero, -x * a], axis=2), np.concatenate([zero, a, -y * a], axis=2)], axis=2
    )
    return rows.reshape(len(a), 2 * a.shape[1], 9)


def _same_sense(a: Array, b: Array) -> Array:
    triples = [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]
    sides = [np.sign(np.linalg.det(side[:, triples])) for side in (a, b)]
    product = sides[0] * sides[1]
    return np.asarray(np.abs(product.sum(axis=1)) == len(triples))
