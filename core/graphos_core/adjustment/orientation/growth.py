"""Growing one block from one first pair."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.orientation.first_pair import FirstPair
from graphos_core.adjustment.orientation.growing import GrowingBlock
from graphos_core.adjustment.orientation.intermediate import adjusted
from graphos_core.adjustment.orientation.next_photo import MIN_SCALING, place_photo, rank_photos
from graphos_core.run import Run
from graphos_core.text import Text

ALWAYS_ADJUST = 12
"""Blocks up to this number of photos are adjusted after every photo."""

FINAL_ROUNDS = 5
"""Adjustments at the end, between which observations are rejected and points intersected anew."""


class Growth:
    """One attempt: a block, the photos that wait for it, and the reasons of those that could not be added.

    Parameters
    ----------
    block : GrowingBlock
        Empty.
    group : tuple of int
        Photos that may be added.
    min_points, resection_px : int, float
        See `IncrementalParams`.
    adjust_growth : float
        Share of new photos after which the block is adjusted, percent.
    self_calibration : bool
    run : Run
    """

    def __init__(
        self,
        block: GrowingBlock,
        group: tuple[int, ...],
        *,
        min_points: int,
        resection_px: float,
        adjust_growth: float,
        self_calibration: bool,
        run: Run,
    ) -> None:
        self.block, self.group, self.run = block, group, run
        self.min_points, self.resection_px = min_points, resection_px
        self.adjust_growth, self.self_calibration = adjust_growth, self_calibration
        self.reasons: dict[int, str] = {}
        self._tried: dict[int, int] = {}
        self._adjusted_at = 0

    @property
    def count(self) -> int:
        """Number of oriented photos."""
        return int(self.block.oriented.sum())

    def start(self, pair: FirstPair) -> None:
        """Place the first pair, intersect its points and adjust."""
        block = self.block
        block.place(pair.a, np.eye(3), np.zeros(3))
        block.place(pair.b, pair.rotation, pair.centre)
        block.intersect()
        self.run.say(
            Text(
                "First pair {a} and {b}: {points} points, median intersection angle {angle:.1f}°.",
                a=block.names[pair.a],
                b=block.names[pair.b],
                points=pair.points,
                angle=np.degrees(pair.angle),
            )
        )
        self._adjust()

    def grow(self) -> None:
        """Add photos until none can be added."""
        while True:
            self.run.check()
            self.run.progress(self.count, len(self.group), "photos oriented")
            if not self._add_one():
                if self._adjusted_at == self.count:
                    return
                self._adjust()  # what waits gets one more chance with better points
                self._tried.clear()

    def finish(self) -> None:
        """Adjust, reject and intersect anew until little changes."""
        for _ in range(FINAL_ROUNDS):
            before = self.block.used.copy()
            self._adjust()
            if not self._release_weak() and (before != self.block.used).sum() < 1e-3 * before.sum():
                break

    def _release_weak(self) -> bool:
        """Take out the photo that is held by the fewest points, if they are too few; say whether there was one."""
        block = self.block
        held = np.bincount(block.tracks.photo[block.used], minlength=len(block.names))
        held[~block.oriented] = np.iinfo(held.dtype).max
        weakest = int(np.argmin(held))
        if held[weakest] >= self.min_points or self.count <= 2:
            return False
        block.release(weakest)
        self.reasons[weakest] = Text(
            "only {held} of its points fit after the adjustment, {needed} needed",
            held=int(held[weakest]),
            needed=self.min_points,
        )
        return True

    def _add_one(self) -> bool:
        """Add the best photo that can be added; say whether there was one."""
        block = self.block
        waiting = [photo for photo in self.group if not block.oriented[photo]]
        for photo, seen in rank_photos(block, waiting):
            if seen < MIN_SCALING:
                self.reasons[photo] = (
                    Text(
                        "only {seen} points in common with the oriented photos, {needed} needed",
                        seen=seen,
                        needed=self.min_points,
                    )
                    if seen
                    else Text("no points in common with the oriented photos")
                )
                continue
            if seen <= 1.1 * self._tried.get(photo, 0):  # failed before with nearly the same points
                continue
            self.run.check()
            placed = place_photo(
                block,
                photo,
                min_points=self.min_points,
                threshold_px=self.resection_px,
                seed=self.run.seed + photo,
            )
            if not placed:
                self._tried[photo] = seen
                self.reasons[photo] = placed.reason
                continue
            block.place(photo, placed.rotation, placed.centre)
            new = block.intersect()
            self.run.say(
                Text(
                    "{photo} by {method}: {inliers} of {common} points agree, {rms:.2f} px; {new} new points.",
                    photo=block.names[photo],
                    method=placed.method,
                    inliers=placed.inliers,
                    common=placed.common,
                    rms=placed.rms_px,
                    new=new,
                )
            )
            if self.count <= ALWAYS_ADJUST or self.count >= self._adjusted_at * (
                1 + self.adjust_growth / 100
            ):
                self._adjust()
            return True
        return False

    def _adjust(self) -> None:
        """Adjust the block, reject outliers, intersect what can be intersected now."""
        block = self.block
        block.adopt(adjusted(block.block(), self_calibration=self.self_calibration, run=self.run))
        block.reject()
        block.intersect()
        self._adjusted_at = self.count
        self.run.show("block", block.block())
