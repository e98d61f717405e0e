"""Which points stay when a detector finds too many."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.data import Array
from graphos_core.features.detectors.selection_kernels import cover

POINTS_PER_CELL = 8
"""Points wanted in each cell of the even selection."""

RADIUS_STEP = 1e-3
"""The bisection of the suppression radius ends when it is known to this share."""


def choose(how: str, xy: Array, scale: Array, response: Array, maximum: int, size: tuple[int, int]) -> Array:
    """Return the indices of at most `maximum` points.

    Parameters
    ----------
    how : {"scale", "strength", "grid", "anms"}
        Value of `PointParams.selection`.
    xy : float64 (n, 2)
        Positions, px.
    scale : float64 (n,)
        Diameters, px.
    response : float64 (n,)
    maximum : int
    size : (int, int)
        Width and height of the photo, px.
    """
    if how == "strength":
        return by_rank(xy, response)[:maximum]
    if how == "anms":
        return spread_by_suppression(by_rank(xy, response), xy, maximum, size)
    order = by_rank(xy, scale)
    return spread_over_cells(order, xy, maximum, size) if how == "grid" else order[:maximum]


def by_rank(xy: Array, value: Array) -> Array:
    """Return all indices, largest value first, ties in the order of y, then x."""
    return np.lexsort((xy[:, 0], xy[:, 1], -value))


def spread_over_cells(order: Array, xy: Array, maximum: int, size: tuple[int, int]) -> Array:
    """Return at most `maximum` of the ranked points, spread over the photo.

    The photo is divided into square cells of which each would get `POINTS_PER_CELL` points. Every cell offers its
    first point first; all first offers are taken before any second one, until `maximum` are taken.

    Parameters
    ----------
    order : int (n,)
        Indices of the points, best first.
    xy, maximum, size
        As in `choose`.
    """
    if len(order) <= maximum:
        return order
    side = math.sqrt(size[0] * size[1] * POINTS_PER_CELL / maximum)
    columns = math.ceil(size[0] / side) + 1
    cell = ((xy[order, 1] + 0.5) // side).astype(np.int64) * columns + ((xy[order, 0] + 0.5) // side).astype(
        np.int64
    )
    by_cell = np.argsort(cell, kind="stable")
    starts = np.flatnonzero(np.r_[True, np.diff(cell[by_cell]) != 0])
    offer = np.empty(len(order), np.int64)
    offer[by_cell] = np.arange(len(order)) - np.repeat(starts, np.diff(np.r_[starts, len(order)]))
    taken = np.argsort(offer, kind="stable")[:maximum]
    return order[np.sort(taken)]


def spread_by_suppression(order: Array, xy: Array, maximum: int, size: tuple[int, int]) -> Array:
    """Return at most `maximum` of the ranked points, such that no point has a better one near.

    Adaptive non-maximal suppression: every point suppresses worse ones nearer than a radius, and the radius is the
    largest that leaves enough points (Brown, Szeliski and Winder 2005, section 3). The fast form of Bailo et al. 2018
    is used (suppression via square covering): points are taken by rank, each covers the cells of a square around it,
    covered points fall away, and the side of the square is found by bisection.

    Parameters
    ----------
    order : int (n,)
        Indices of the points, best first.
    xy, maximum, size
        As in `choose`.
    """
    if len(order) <= maximum:
        return order
    ranked = np.ascontiguousarray(xy[order], dtype=np.float64)
    low, high = 1e-3, float(max(size))
    best = np.arange(maximum)
    while high - low > RADIUS_STEP * high:
        radius = math.sqrt(low * high) if high > 2.0 * low else 0.5 * (low + high)
        kept = cover(ranked, radius, size[0], size[1], maximum)
        if len(kept) >= maximum:
            low, best = radius, kept
        else:
            high = radius
    return order[best[:maximum]]
