"""The image graph: photos are its nodes, verified pairs its edges."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphos_core.data import Array, PairMatches
from graphos_core.errors import ItemFailure
from graphos_core.text import Text


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


def separated_photos(names: Sequence[str], pairs: Sequence[PairMatches]) -> tuple[ItemFailure, ...]:
    """Return the photos outside the largest group, each with the reason in one sentence."""
    groups = components(len(names), pairs)
    failures = []
    for members in groups[1:]:
        for photo in members:
            if len(members) == 1:
                reason = _why_alone(photo, names, pairs)
            else:
                others = ", ".join(names[other] for other in members if other != photo)
                reason = Text(
                    "It is connected with {others} only; the largest group has {count} photos.",
                    others=others,
                    count=len(groups[0]),
                )
            failures.append(ItemFailure(names[photo], reason))
    return tuple(failures)


def _why_alone(photo: int, names: Sequence[str], pairs: Sequence[PairMatches]) -> str:
    own = [pair for pair in pairs if photo in (pair.a, pair.b)]
    if not own:
        return Text("It was matched with no other photo.")
    best = max(own, key=lambda pair: pair.candidates)
    other = names[best.b if best.a == photo else best.a]
    return Text(
        "No other photo has enough matches with it; best with {other}: {reason}.",
        other=other,
        reason=best.reason,
    )
