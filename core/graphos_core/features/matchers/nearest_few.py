"""The few descriptors of a photo that are nearest to one descriptor, for looking at."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array


def nearest_few(descriptor: Array, others: Array, count: int, metric: str = "l2") -> tuple[Array, Array]:
    """Return the nearest of many descriptors and their distances, nearest first.

    Parameters
    ----------
    descriptor : uint8 or float32 (d,)
    others : uint8 or float32 (m, d)
    count : int
        Wanted at most.
    metric : {"l2", "hamming"}
        Hamming for binary descriptors, whose bytes hold eight bits each.

    Returns
    -------
    int32 (k,), float64 (k,)
        Indices and distances; equal distances by index.

    Raises
    ------
    ValueError
        When the lengths differ or the metric is unknown.
    """
    if others.ndim != 2 or (len(others) and others.shape[1] != len(descriptor)):
        raise ValueError(f"descriptors of length {len(descriptor)} and of shape {others.shape}")
    if metric == "hamming":
        distance = np.bitwise_count(np.bitwise_xor(others, descriptor)).sum(axis=1).astype(np.float64)
    elif metric == "l2":
        distance = np.linalg.norm(others.astype(np.float64) - descriptor.astype(np.float64), axis=1)
    else:
        raise ValueError(f"metric {metric!r}: there are l2 and hamming")
    order = np.argsort(distance, kind="stable")[:count]
    return order.astype(np.int32), distance[order]
