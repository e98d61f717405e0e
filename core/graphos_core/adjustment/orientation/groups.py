"""Which photos hang together, and why a photo stayed outside."""

from __future__ import annotations

from collections.abc import Sequence

from graphos_core.data import PairMatches
from graphos_core.errors import ItemFailure
from graphos_core.features.graph import components
from graphos_core.text import Text

LISTED = 4
"""Names listed in a sentence before "and n more"."""


def photo_groups(count: int, pairs: Sequence[PairMatches]) -> list[tuple[int, ...]]:
    """Return the groups of two photos or more that hang together by verified pairs, largest first."""
    return [group for group in components(count, pairs) if len(group) > 1]


def listed(names: Sequence[str]) -> str:
    """Return the names in a sentence, the first few and how many more."""
    shown = ", ".join(names[:LISTED])
    return shown if len(names) <= LISTED else f"{shown} and {len(names) - LISTED} more"


def explain_failures(
    names: Sequence[str],
    oriented: Sequence[bool],
    groups: Sequence[tuple[int, ...]],
    reasons: dict[int, str],
) -> tuple[ItemFailure, ...]:
    """Return each photo that is not oriented with its reason.

    Parameters
    ----------
    names : sequence of str
        All photos.
    oriented : sequence of bool
    groups : sequence of tuple of int
        From `photo_groups`.
    reasons : dict of int to str
        Why photos of the oriented group could not be added.
    """
    group_of = {photo: group for group in groups for photo in group}
    home = next((group for group in groups if any(oriented[photo] for photo in group)), ())
    failures = []
    for photo, name in enumerate(names):
        if oriented[photo]:
            continue
        group = group_of.get(photo)
        reason: str
        if group is None:
            reason = Text("no verified matches with any other photo")
        elif group is not home:
            reason = Text(
                "belongs to another group of {count} photos: {names}",
                count=len(group),
                names=listed([names[i] for i in group]),
            )
        else:
            reason = reasons.get(photo, Text("no verified matches with the oriented photos"))
        failures.append(ItemFailure(name, reason))
    return tuple(failures)
