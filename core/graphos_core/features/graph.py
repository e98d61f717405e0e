"""The image graph: photos are its nodes, verified pairs its edges."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphos_core.data import Array, PairMatches


def match_counts(count: int, pairs: Sequence[PairMatches]) -> Array:
    """Return the symmetric matrix int32 (count, count) of verified matches between photos."""
    table = np.zeros((count, count), np.int32)
    for pair in pairs:
        if not pair.reason:
            table[pair.a, pair.b] = table[pair.b, pair.a] = len(pair.matches)
    return table


def components(count: int, pairs: Sequence[PairMatches]) -> tuple[tuple[int, ...], ...]:
    """Return the groups of photos that hang together by verified pairs, largest first.

    Photos without any verified pair are groups of one. Equally large groups are ordered by their first photo.
    """
    linked = match_counts(count, pairs) > 0
    group = np.full(count, -1)
    found: list[tuple[int, ...]] = []
    for start in range(count):
        if group[start] >= 0:
            continue
        group[start] = len(found)
        waiting, members = [start], [start]
        while waiting:
            for other in np.flatnonzero(linked[waiting.pop()] & (group < 0)):
                group[other] = len(found)
                waiting.append(int(other))
                members.append(int(other))
        found.append(tuple(sorted(members)))
    return tuple(sorted(found, key=lambda members: (-len(members), members[0])))
