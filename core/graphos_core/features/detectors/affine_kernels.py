"""Points found in several simulated views: which are the same, and which of their descriptors differ most."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data import Array


@njit(cache=True, nogil=True)
def leaders(pairs: Array, count: int) -> Array:
    """Return the leader of every point: the first one near enough that has no leader before it.

    Parameters
    ----------
    pairs : int64 (k, 2)
        Points i < j that are near enough, sorted by i, then j.
    count : int

    Returns
    -------
    int64 (count,)
        Its own index for a leader.
    """
    leader = np.arange(count)
    for k in range(len(pairs)):
        i, j = pairs[k]
        if leader[i] == i and leader[j] == j:
            leader[j] = i
    return leader


@njit(cache=True, nogil=True)
def most_different(descriptors: Array, order: Array, begins: Array, most: int) -> Array:
    """Tell which descriptors of every point stay: its first one, then always the one farthest from those that stay.

    Parameters
    ----------
    descriptors : uint8 (n, d)
    order : int64 (n,)
        Features, point after point, the first of each point first.
    begins : int64 (p + 1,)
        Where each point begins in `order`.
    most : int
        Descriptors that stay of each point.

    Returns
    -------
    bool (n,)
    """
    stays = np.zeros(len(order), np.bool_)
    for point in range(len(begins) - 1):
        members = order[begins[point] : begins[point + 1]]
        if len(members) <= most:
            stays[members] = True
            continue
        away = np.full(len(members), np.int64(2**62))
        chosen = 0
        for _ in range(most):
            stays[members[chosen]] = True
            own = descriptors[members[chosen]]
            for m in range(len(members)):
                other = descriptors[members[m]]
                total = np.int64(0)
                for c in range(len(own)):
                    step = np.int64(own[c]) - np.int64(other[c])
                    total += step * step
                away[m] = min(away[m], total)
            chosen = int(np.argmax(away))
    return stays
