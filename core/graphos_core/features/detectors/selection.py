"""Which points stay when a detector finds too many."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.data import Array

POINTS_PER_CELL = 8
"""Points wanted in each cell of the even selection."""


def choose_largest(xy: Array, scale: Array, maximum: int, size: tuple[int, int]) -> Array:
    """Return the indices of the `maximum` largest points, in the order of scale, then y, then x.

    Parameters
    ----------
    xy : float64 (n, 2)
        Positions, px.
    scale : float64 (n,)
        Diameters, px.
    maximum : int
    size : (int, int)
        Width and height of the photo, px; not used.
    """
    return np.lexsort((xy[:, 0], xy[:, 1], -scale))[:maximum]


def choose_evenly(xy: Array, scale: Array, maximum: int, size: tuple[int, int]) -> Array:
    """Return the indices of at most `maximum` points spread over the photo, largest first.

    The photo is divided into square cells of which each would get `POINTS_PER_CELL` points. Every cell offers its
    largest point first; all first offers are taken before any second one, until `maximum` are taken.

    Parameters
    ----------
    xy, scale, maximum, size
        As in `choose_largest`.
    """
    order = choose_largest(xy, scale, len(xy), size)
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
