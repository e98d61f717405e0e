"""Where the nodes of a graph are drawn so that strongly linked ones lie together."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array

ROUNDS = 120
"""Most iterations of the stress majorisation."""
FAR = 0.8
"""Distance between parts that do not hang together, in units of the largest distance within one."""
SPREAD = 0.25
"""Power of the weights in the lengths of edges: more would draw weak links too long to see anything else."""


def force_layout(weights: Array) -> Array:
    r"""Return places (n, 2) of the nodes of an undirected graph, centred, the same for the same graph.

    An edge of weight w has the length ``(w_max / w)^¼``, so that strongly linked nodes lie together; the wanted distance
    of two nodes is the length of the shortest way between them. The stress
    ``Σ d_ij⁻² (‖x_i − x_j‖ − d_ij)²`` is lowered by majorisation from the classical scaling of the distances, which
    needs no random start.

    Source: Gansner, Koren and North 2004, Graph drawing by stress majorization; Torgerson 1952 (classical scaling).

    Parameters
    ----------
    weights : float (n, n)
        Symmetric, ≥ 0; 0 where there is no edge.
    """
    n = len(weights)
    if n < 3:
        return np.column_stack([np.arange(n) - (n - 1) / 2, np.zeros(n)])
    wanted = way_lengths(weights)
    places = _classical_scaling(wanted)
    inverse = 1.0 / np.where(wanted > 0, wanted, 1.0) ** 2
    np.fill_diagonal(inverse, 0.0)
    laplacian = np.diag(inverse.sum(axis=1)) - inverse
    solver = np.linalg.pinv(laplacian)
    before = np.inf
    for _ in range(ROUNDS):
        apart = np.linalg.norm(places[:, None] - places[None], axis=2)
        stress = float((inverse * (apart - wanted) ** 2).sum() / 2)
        if stress > before * (1 - 1e-4):
            break
        before = stress
        pull = -inverse * wanted / np.maximum(apart, 1e-9)
        np.fill_diagonal(pull, 0.0)
        np.fill_diagonal(pull, -pull.sum(axis=1))
        places = solver @ (pull @ places)
    return np.asarray(places - places.mean(axis=0))


def way_lengths(weights: Array) -> Array:
    """Return the lengths (n, n) of the shortest ways between nodes (Floyd and Warshall), see `force_layout`."""
    heaviest = float(np.max(weights, initial=0.0)) or 1.0
    with np.errstate(divide="ignore"):
        length = (heaviest / np.asarray(weights, np.float64)) ** SPREAD
    np.fill_diagonal(length, 0.0)
    for k in range(len(length)):
        np.minimum(length, length[:, k : k + 1] + length[k : k + 1], out=length)
    linked = np.isfinite(length)
    longest = float(length[linked].max()) or 1.0
    return np.where(linked, length, FAR * longest)


def flat_layout(places: Array) -> Array:
    """Return places (n, 2) of points in space seen along the direction in which they extend least.

    Parameters
    ----------
    places : float (n, 3)
        Not finite where a point has no place; those get NaN.
    """
    places = np.asarray(places, np.float64)
    known = np.isfinite(places).all(axis=1)
    flat = np.full((len(places), 2), np.nan)
    if known.any():
        centred = places[known] - places[known].mean(axis=0)
        _, _, axes = np.linalg.svd(centred, full_matrices=False)
        axes = np.vstack([axes, np.zeros((3, 3))])[:2]
        axes *= np.where(axes[np.arange(2), np.abs(axes).argmax(axis=1)] < 0, -1.0, 1.0)[:, None]
        flat[known] = centred @ axes.T
    return flat


def _classical_scaling(distances: Array) -> Array:
    """Return the plane places (n, 2) whose distances come closest to the given ones in Torgerson's sense."""
    square = distances**2
    centred = -0.5 * (square - square.mean(axis=0) - square.mean(axis=1)[:, None] + square.mean())
    values, vectors = np.linalg.eigh(centred)
    axes = vectors[:, ::-1][:, :2]
    axes = axes * np.where(axes[np.abs(axes).argmax(axis=0), [0, 1]] < 0, -1.0, 1.0)
    return np.asarray(axes * np.sqrt(np.maximum(values[::-1][:2], 1e-12)))
