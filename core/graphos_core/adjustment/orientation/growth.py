"""Growing one block from one first pair."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.orientation.first_pair import FirstPair
from graphos_core.adjustment.orientation.growing import GrowingBlock, Oriented
from graphos_core.adjustment.orientation.intermediate import adjusted, adjusted_around
from graphos_core.adjustment.orientation.next_photo import MIN_SCALING, place_photo, rank_photos
from graphos_core.adjustment.orientation.parameters import GrowthParams
from graphos_core.run import Run
from graphos_core.text import Text

ALWAYS_ADJUST = 8
"""Blocks up to this number of photos are adjusted after every photo."""

LOCAL = 3
"""Neighbours that move with a new photo in a local adjustment."""

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
    params : GrowthParams
    run : Run
    """

    def __init__(
        self,
        block: GrowingBlock,
        group: tuple[int, ...],
        params: GrowthParams,
        run: Run,
    ) -> None:
        self.block, self.group, self.params, self.run = block, group, params, run
        self.reasons: dict[int, str] = {}
        self._tried: dict[int, int] = {}
        self._adjusted_at = 0

    @property
    def count(self) -> int:
        """Number of oriented photos."""
        return int(self.block.oriented.sum())

    def start(self, pair: FirstPair) -> None:
        """Place the first pair, intersect its points and adjust."""
        self.place_pair(pair)
        self.adjust()

    def place_pair(self, pair: FirstPair) -> None:
        """Place the first pair and intersect its points."""
        block = self.block
        block.place(pair.a, np.eye(3), np.zeros(3), Oriented(pair.a, (), Text("first photo"), 0, np.nan))
        how = Oriented(pair.b, (pair.a,), Text("relative orientation of the first pair"), pair.points, np.nan)
        block.place(pair.b, pair.rotation, pair.centre, how)
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

    def take_over(self) -> None:
        """Go on from photos that are placed and points that are intersected already."""
        self.run.say(
            Text(
                "{count} photos with a given orientation: {points} points.",
                count=self.count,
                points=int(self.block.known.sum()),
            )
        )
        self.block.reject()
        self.adjust()

    def grow(self) -> None:
        """Add photos until none can be added."""
        while True:
            self.run.check()
            self.run.progress(self.count, len(self.group), "photos oriented")
            if not self._add_one():
                if self._adjusted_at == self.count:
                    return
                self.adjust()  # what waits gets one more chance with better points
                self._tried.clear()

    def finish(self) -> None:
        """Adjust, reject and intersect anew until little changes."""
        for _ in range(FINAL_ROUNDS):
            before = self.block.used.copy()
            self.adjust()
            if not self._release_weak() and (before != self.block.used).sum() < 1e-3 * before.sum():
                break

    def _release_weak(self) -> bool:
        """Take out the photo that is held by the fewest points, if they are too few; say whether there was one."""
        block = self.block
        held = np.bincount(block.tracks.photo[block.used], minlength=len(block.names))
        held[~block.oriented] = np.iinfo(held.dtype).max
        weakest = int(np.argmin(held))
        if held[weakest] >= self.params.min_points or self.count <= 2:
            return False
        block.release(weakest)
        self.reasons[weakest] = Text(
            "only {held} of its points fit after the adjustment, {needed} needed",
            held=int(held[weakest]),
            needed=self.params.min_points,
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
                        needed=self.params.min_points,
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
                min_points=self.params.min_points,
                threshold_px=self.params.resection_px,
                seed=self.run.seed + photo,
            )
            if not placed:
                self._tried[photo] = seen
                self.reasons[photo] = placed.reason
                continue
            how = Oriented(photo, placed.on, placed.method, placed.inliers, placed.rms_px)
            block.place(photo, placed.rotation, placed.centre, how)
            block.explain_last()
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
            grown = self.count >= self._adjusted_at * (1 + self.params.adjust_growth / 100)
            if self.count <= ALWAYS_ADJUST or grown:
                self.adjust()
            else:
                self._adjust_around(photo)
            return True
        return False

    def _adjust_around(self, photo: int) -> None:
        """Adjust a new photo with its neighbours and their points, the rest of the block held fixed."""
        block = self.block
        free = np.zeros(len(block.names), dtype=bool)
        free[[photo, *block.neighbours(photo, LOCAL)]] = True
        concerned = block.tracks_of(free)
        block.adopt(adjusted_around(block.block(of=concerned), free, self.run))
        block.reject(concerned)

    def adjust(self) -> None:
        """Adjust the block, reject outliers, intersect what can be intersected now."""
        block = self.block
        block.adopt(adjusted(block.block(), self_calibration=self.params.self_calibration, run=self.run))
        block.reject()
        block.intersect()
        self._adjusted_at = self.count
        self.run.show("block", block.block())
