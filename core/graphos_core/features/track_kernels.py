"""Union–find over matches, compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data import Array


@njit(cache=True, nogil=True)
def find_root(parent: Array, node: int) -> int:
    """Return the root of a node, halving the path on the way."""
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@njit(cache=True, nogil=True)
def join_all(first: Array, second: Array, count: int) -> Array:
    """Join nodes ``first[i]`` and ``second[i]``; return the smallest node of every node's set, int32 (count,)."""
    parent = np.arange(count).astype(np.int32)
    for i in range(first.shape[0]):
        a = find_root(parent, first[i])
        b = find_root(parent, second[i])
        if a < b:
            parent[b] = a
        elif b < a:
            parent[a] = b
    for node in range(count):
        parent[node] = find_root(parent, node)
    return parent


@njit(cache=True, nogil=True)
def join_without_conflict(first: Array, second: Array, photo: Array, photos: int) -> Array:
    """Join like `join_all`, in the order given, but never two sets that have a photo in common.

    Every set is a linked list; the photos of one list are stamped before the other is looked through.

    Parameters
    ----------
    first, second : int32 (n,)
        Nodes to join.
    photo : int32 (count,)
        Photo of each node.
    photos : int
        Number of photos.

    Returns
    -------
    int32 (count,)
        Smallest node of every node's set.
    """
    count = photo.shape[0]
    parent = np.arange(count).astype(np.int32)
    following = np.full(count, -1, np.int32)
    last = np.arange(count).astype(np.int32)
    stamp = np.full(photos, -1, np.int64)
    for i in range(first.shape[0]):
        a = find_root(parent, first[i])
        b = find_root(parent, second[i])
        if a == b:
            continue
        if b < a:
            a, b = b, a
        node = a
        while node >= 0:
            stamp[photo[node]] = i
            node = following[node]
        node = b
        free = True
        while node >= 0 and free:
            free = stamp[photo[node]] != i
            node = following[node]
        if free:
            parent[b] = a
            following[last[a]] = b
            last[a] = last[b]
    for node in range(count):
        parent[node] = find_root(parent, node)
    return parent
