"""Which photos hang together, and why a photo stayed outside."""

from __future__ import annotations

from collections.abc import Sequence

from graphos_core.data import PairMatches, PhotoSet
from graphos_core.errors import ItemFailure, UserError
from graphos_core.features.graph import components
from graphos_core.text import Text

LISTED = 4
"""Names listed in a sentence before "and n more"."""


def photo_groups(count: int, pairs: Sequence[PairMatches]) -> list[tuple[int, ...]]:
    """Return the groups of two photos or more that hang together by verified pairs, largest first."""
    return [group for group in components(count, pairs) if len(group) > 1]


def groups_of(photos: PhotoSet, pairs: Sequence[PairMatches]) -> list[tuple[int, ...]]:
    """Return the groups of photos to orient, largest first.

    Raises
    ------
    UserError
        With a single photo, and when no two photos are connected.
    """
    if len(photos.photos) < 2:
        raise UserError(
            Text("Orientation needs at least two photos; found: {count}.", count=len(photos.photos)),
            "Depth comes from seeing the same point from two places.",
            "Add photos that overlap with this one.",
            learn="adjustment/overlap",
        )
    groups = photo_groups(len(photos.photos), pairs)
    if not groups:
        raise UserError(
            "No photo can be oriented.",
            _why_unconnected(pairs),
            "Take photos with at least 60 % overlap, or find more features and relax the matching.",
            learn="adjustment/overlap",
        )
    return groups


def _why_unconnected(pairs: Sequence[PairMatches]) -> Text:
    """Say that no pair is verified, and what the pair with most candidates lacked."""
    if not pairs:
        return Text("No two photos have verified matches in common; there was no pair with points to verify.")
    best = max(pairs, key=lambda pair: pair.candidates)
    return Text("No two photos have verified matches in common; of {count} pairs the best one has: {reason}.",
                count=len(pairs), reason=best.reason or Text("no verified match"))  # fmt: skip


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
        Photos that hang together, those of other blocks before the groups they came from.
    reasons : dict of int to str
        Why photos of the oriented group could not be added.
    """
    group_of: dict[int, tuple[int, ...]] = {}
    for group in groups:
        for photo in group:
            group_of.setdefault(photo, group)
    home = next((group for group in groups if any(oriented[photo] for photo in group)), ())
    failures = []
    for photo, name in enumerate(names):
        if oriented[photo]:
            continue
        found = group_of.get(photo)
        if found is None:
            reason = Text("no verified matches with any other photo")
        elif found is not home:
            reason = Text(
                "belongs to another group of {count} photos: {names}",
                count=len(found),
                names=listed([names[i] for i in found]),
            )
        else:
            reason = Text("no verified matches with the oriented photos")
            reason = reasons.get(photo, reason)  # type: ignore[assignment]
        failures.append(ItemFailure(name, reason))
    return tuple(failures)
