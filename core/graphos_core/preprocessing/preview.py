"""Filters live: the visible part of a photo, filtered in the size in which it is seen."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.params import Params
from graphos_core.preprocessing.grey import eight_bit, stretch_range
from graphos_core.preprocessing.parts import Parts, Place, parts_of
from graphos_core.registry import Algorithm
from graphos_core.run import Run
from graphos_core.text import Text

Chain = Sequence[tuple[Algorithm, Params]]

LEARNING_PIXELS = 250_000
"""Until the whole photo has been looked at, what a filter must know of it is taken from a copy of at most this size."""

PATIENCE_S = 0.08
"""A piece that would take longer is shown coarser first."""


COARSEST = 32
"""No piece is reduced further than this."""

TRIAL = 128
"""A chain that was never timed is tried on so many pixels square first."""


@dataclass(frozen=True)
class Region:
    """Whole pixels of the photo, ends excluded."""

    left: int
    top: int
    right: int
    bottom: int


@dataclass(frozen=True)
class Piece:
    """A filtered piece of a photo.

    Attributes
    ----------
    before, after : uint8 (h, w) or (h, w, 3)
        The piece without and with the filters, reduced by `factor`.
    region : Region
        What it covers.
    factor : int
        1: every pixel of the photo.
    exact : bool
        Whether it equals the same piece of the result of a run.
    why : str
        Why it does, or what is approximate.
    """

    before: Array
    after: Array
    region: Region
    factor: int
    exact: bool
    why: str


class Preview:
    """A photo in several sizes, and what filters learned of it.

    Not for use by two threads at once.

    Parameters
    ----------
    pixels : uint8 or uint16 (h, w) or (h, w, n)
        The whole photo; not changed.
    """

    def __init__(self, pixels: Array) -> None:
        self.pixels = pixels
        self._sizes: dict[int, Array] = {1: pixels}
        self._learned: dict[str, list[Any]] = {}
        self._exact: tuple[str, list[Any]] | None = None
        self._pace: dict[tuple[str, int], float] = {}
        levels = stretch_range(pixels) if pixels.dtype == np.uint16 else None
        self.levels = levels

    def reduced(self, factor: int) -> Array:
        """Return the photo `factor` (a power of 2) times smaller, by means of areas."""
        if factor not in self._sizes:
            half = self.reduced(factor // 2)
            size = (max(1, half.shape[1] // 2), max(1, half.shape[0] // 2))
            self._sizes[factor] = _resized(half, size)
        return self._sizes[factor]

    @staticmethod
    def can(chain: Chain) -> bool:
        """Say whether every filter of a chain says how it works on a piece."""
        return all(parts_of(algorithm.function) is not None for algorithm, _ in chain)

    def needs_whole(self, chain: Chain) -> bool:
        """Say whether pieces at full size become exact only after `learn_whole`."""
        deep = self.pixels.dtype != np.uint8
        return any(not parts.local or (deep and i == 0) for i, parts in enumerate(_parts(chain))) and (
            self._exact is None or self._exact[0] != _key(chain)
        )

    def learn_whole(self, chain: Chain, run: Run) -> None:
        """Let the filters learn from the whole photo at full size; takes as long as filtering it.

        Raises
        ------
        Stopped
            When the person asked to stop.
        """
        self._exact = (_key(chain), self._learn(self.pixels, chain, 1, run))

    def piece(self, chain: Chain, region: Region, factor: int, run: Run) -> Piece:
        """Filter a region, reduced by `factor` (a power of 2).

        At full size the region is filtered with a margin, so that nothing comes from the cut edge. Reduced, the
        filters' lengths are reduced as well, which is an approximation.

        Raises
        ------
        Stopped
            When the person asked to stop.
        """
        exact_known = self._exact is not None and self._exact[0] == _key(chain)
        known = self._exact[1] if exact_known and self._exact is not None else self._small(chain, run)
        whole = self.reduced(factor)
        height, width = whole.shape[:2]
        cut = _divided(region, factor, width, height)
        scaled = [(p, p.reduced(params, factor) if factor > 1 else params) for p, (_, params) in
                  zip(_parts(chain), chain, strict=True)]  # fmt: skip
        margin = sum(p.margin(params) for p, params in scaled)
        left, top = max(0, cut.left - margin), max(0, cut.top - margin)
        image = whole[top : min(height, cut.bottom + margin), left : min(width, cut.right + margin)]
        begun = time.perf_counter()
        after = np.ascontiguousarray(image)
        for (parts, params), learned in zip(scaled, known, strict=True):
            run.check()
            after = parts.apply(after, params, learned, Place(left, top, width, height))
        self._pace[_names(chain), factor] = (time.perf_counter() - begun) / max(
            1, image.shape[0] * image.shape[1]
        )
        inner = (slice(cut.top - top, cut.bottom - top), slice(cut.left - left, cut.right - left))
        exact = factor == 1 and (exact_known or not self.needs_whole(chain))
        shown = Region(
            cut.left * factor,
            cut.top * factor,
            _end(cut.right, factor, width, self.pixels.shape[1]),
            _end(cut.bottom, factor, height, self.pixels.shape[0]),
        )
        before = displayed(image[inner], self.levels)
        return Piece(before, displayed(after[inner], self.levels), shown, factor, exact, _why(factor, exact))

    def first_factor(self, chain: Chain, region: Region, factor: int, run: Run) -> int:
        """Return the factor at which a region is shown within `PATIENCE_S`, from how long the chain took last."""
        area = (region.right - region.left) * (region.bottom - region.top)
        while factor < COARSEST:
            if (_names(chain), factor) not in self._pace:
                self.piece(chain, _middle(region, TRIAL * factor), factor, run)
            if self._pace[_names(chain), factor] * area / factor**2 <= PATIENCE_S:
                break
            factor *= 2
        return factor

    def _small(self, chain: Chain, run: Run) -> list[Any]:
        key = _key(chain)
        if key not in self._learned:
            if len(self._learned) > 50:
                self._learned.clear()
            area = self.pixels.shape[0] * self.pixels.shape[1]
            factor = 2 ** max(0, math.ceil(0.5 * math.log2(max(area / LEARNING_PIXELS, 1.0))))
            self._learned[key] = self._learn(self.reduced(factor), chain, factor, run)
        return self._learned[key]

    def _learn(self, image: Array, chain: Chain, factor: int, run: Run) -> list[Any]:
        found = []
        parts = _parts(chain)
        for i, ((_, params), part) in enumerate(zip(chain, parts, strict=True)):
            run.check()
            found.append(part.learn(image, params, run))
            if i + 1 < len(parts) and any(not later.local for later in parts[i + 1 :]):
                scaled = part.reduced(params, factor) if factor > 1 else params
                image = part.apply(image, scaled, found[-1], Place.whole(image))
            elif image.dtype != np.uint8:
                image = np.zeros((1, 1), np.uint8)  # what follows is local and learns nothing from it
        return found


def _resized(image: Array, size: tuple[int, int]) -> Array:
    if image.ndim == 2 or image.shape[2] <= 4:
        return cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    bands = [np.ascontiguousarray(image[:, :, i]) for i in range(image.shape[2])]
    return np.stack([cv2.resize(b, size, interpolation=cv2.INTER_AREA) for b in bands], axis=2)


def displayed(image: Array, levels: tuple[int, int] | None) -> Array:
    """Return an image as views can show it: 8 bit, grey or RGB; of more bands the mean."""
    image = eight_bit(image, levels)
    if image.ndim == 3 and image.shape[2] != 3:
        image = np.rint(image.mean(axis=2)).astype(np.uint8)
    return np.ascontiguousarray(image)


def _parts(chain: Chain) -> list[Parts]:
    found = [parts_of(algorithm.function) for algorithm, _ in chain]
    if any(part is None for part in found):
        raise ValueError("a filter of the chain does not say how it works on a piece")
    return [part for part in found if part is not None]


def _key(chain: Chain) -> str:
    return repr([(algorithm.name, params) for algorithm, params in chain])


def _names(chain: Chain) -> str:
    return " ".join(algorithm.name for algorithm, _ in chain)


def _middle(region: Region, side: int) -> Region:
    x, y = (region.left + region.right) // 2, (region.top + region.bottom) // 2
    return Region(
        max(region.left, x - side // 2),
        max(region.top, y - side // 2),
        min(region.right, x + side // 2 + 1),
        min(region.bottom, y + side // 2 + 1),
    )


def _divided(region: Region, factor: int, width: int, height: int) -> Region:
    left, top = min(region.left // factor, width - 1), min(region.top // factor, height - 1)
    right, bottom = -(-region.right // factor), -(-region.bottom // factor)
    return Region(
        max(0, left), max(0, top), min(max(right, left + 1), width), min(max(bottom, top + 1), height)
    )


def _end(end: int, factor: int, reduced: int, full: int) -> int:
    return full if end >= reduced else min(end * factor, full)


def _why(factor: int, exact: bool) -> str:
    if exact:
        return Text("1:1 · equals the result of a run")
    if factor > 1:
        return Text(
            "approximate: filtered at 1:{factor}, as it is seen · zoom to 1:1 for the result", factor=factor
        )
    return Text("1:1 · approximate until the whole photo has been looked at")
