"""Coverage in words: which parts of a format are empty, why, and what to change."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphos_core.data import Array
from graphos_core.text import Text

BARE = 1.0 / 3.0
"""A ninth of the format is called empty when less than this share of its cells holds a point."""

ROWS = (Text("the upper third"), Text("the middle from left to right"), Text("the lower third"))
COLUMNS = (Text("the left third"), Text("the middle from top to bottom"), Text("the right third"))
NINTHS = (
    (Text("the upper left corner"), Text("the upper middle"), Text("the upper right corner")),
    (Text("the left middle"), Text("the centre"), Text("the right middle")),
    (Text("the lower left corner"), Text("the lower middle"), Text("the lower right corner")),
)


def advise(
    counts: Array,
    key_counts: Array | None,
    occupied: float,
    hull_share: float,
    possible: float,
    alert: bool,
    photos: int,
) -> tuple[tuple[str, ...], str, str]:
    """Return the empty parts, the verdict and the advice; see `graphos_core.features.coverage.coverage`."""
    bare = bare_ninths(counts)
    parts = part_names(bare)
    verdict = Text(
        "Matched points cover {occupied:.0%} of the cells, their hull {hull:.0%} of the format.",
        occupied=occupied, hull=hull_share,
    )  # fmt: skip
    if not alert:
        return parts, verdict, ""
    if possible < min(occupied * 1.25, 0.9) or not counts.any():
        return parts, verdict, Text(
            "Only {n} matched points: even spread over the whole format they would fill {possible:.0%} of the cells. "
            "More keypoints or a looser ratio come first.", n=int(counts.sum()), possible=possible,
        )  # fmt: skip
    if not parts:
        return parts, verdict, Text(
            "The gaps are scattered: choose the keypoints evenly instead of by scale, or lower the contrast threshold."
        )  # fmt: skip
    names = listed(parts)
    if photos > 1:
        return parts, verdict, Text(
            "Empty in all {photos} photos: {parts}. Distortion is extrapolated there: let the object fill the format, "
            "and take some photos turned by 90° or with the object in that part.", photos=photos, parts=names,
        )  # fmt: skip
    return parts, verdict, _cause(bare, key_counts, names)


def bare_ninths(counts: Array) -> Array:
    """Return which ninths of the format are empty, bool (3, 3): few of their cells hold a point."""
    rows, columns = (np.minimum(np.arange(n) * 3 // n, 2) for n in counts.shape)
    filled = np.zeros((3, 3))
    cells = np.zeros((3, 3))
    np.add.at(filled, (rows[:, None], columns[None, :]), counts > 0)
    np.add.at(cells, (rows[:, None], columns[None, :]), 1.0)
    return (filled < BARE * cells) & (cells > 0)


def part_names(bare: Array) -> tuple[str, ...]:
    """Name empty ninths: whole rows and columns by one name, the rest one by one."""
    if bare.all():
        return (Text("the whole format"),)
    ring = bare.copy()
    ring[1, 1] = True
    if ring.all():
        return (Text("the whole border"),)
    names: list[str] = []
    named = np.zeros((3, 3), bool)
    for index in range(3):
        if bare[index].all():
            names.append(ROWS[index])
            named[index] = True
        if bare[:, index].all():
            names.append(COLUMNS[index])
            named[:, index] = True
    return (*names, *(NINTHS[r][c] for r, c in np.argwhere(bare & ~named)))


def listed(parts: Sequence[str]) -> str:
    """Join names with commas."""
    return ", ".join(parts)


def _cause(bare: Array, key_counts: Array | None, names: str) -> str:
    """Say what one photo lacks in its empty parts: structure or partners."""
    if key_counts is None:
        return Text(
            "Empty: {parts}. Either nothing can be recognised there or no other photo shows it.", parts=names
        )
    without = bare_ninths(key_counts) & bare
    share = float(without.sum() / bare.sum())
    found = int(key_counts[_cells_of(bare, key_counts.shape)].sum())
    if share > 0.5:
        return Text(
            "Empty: {parts}. Hardly any keypoints there ({found}): sky, water, a plain or dark surface. Let the object "
            "fill the format, or bring out weak structure with the Wallis filter or a lower contrast threshold.",
            parts=names, found=found,
        )  # fmt: skip
    return Text(
        "Empty: {parts}. There are {found} keypoints, but no other photo confirms them: it does not show that part, or "
        "shows it too differently. Take photos that overlap more on that side.", parts=names, found=found,
    )  # fmt: skip


def _cells_of(ninths: Array, shape: tuple[int, ...]) -> Array:
    rows, columns = (np.minimum(np.arange(n) * 3 // n, 2) for n in shape)
    return ninths[rows[:, None], columns[None, :]]
