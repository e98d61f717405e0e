"""Hierarchical orientation: pairs, triplets and clusters of photos joined in a tree, from the leaves to the root."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from graphos_core.adjustment.orientation.components import grow_blocks, main_block
from graphos_core.adjustment.orientation.first_pair import no_base, orient_pair
from graphos_core.adjustment.orientation.groups import groups_of
from graphos_core.adjustment.orientation.growing import GrowingBlock, Oriented
from graphos_core.adjustment.orientation.growth import Growth
from graphos_core.adjustment.orientation.merging import find_joint, join
from graphos_core.adjustment.orientation.next_photo import place_photo
from graphos_core.adjustment.orientation.parameters import GrowthParams
from graphos_core.data import Array, Block, PairMatches, PhotoSet, Tracks
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text


class HierarchicalParams(GrowthParams):
    """Parameters of the hierarchical orientation."""

    pair_angle_deg: Annotated[
        float,
        About(
            label="Smallest angle of a pair",
            symbol=r"\gamma_0",
            unit="°",
            low=0.1,
            high=90,
            step=0.5,
            level="expert",
            help="Smallest admissible median intersection angle of two photos that make a cluster.",
            effect="Higher: firmer clusters, but more photos join one by one.",
            learn="adjustment/base-and-angle",
        ),
    ] = 2.0


@dataclass(eq=False)
class Cluster:
    """Photos that are joined already; a single photo has no block yet."""

    photos: tuple[int, ...]
    growth: Growth | None = None


@algorithm(
    stage="adjustment",
    role="orientation",
    name="hierarchical",
    label="Hierarchical orientation",
    source="Gherardi, Farenzena and Fusiello 2010, Improving the efficiency of hierarchical structure-and-motion",
    learn="adjustment/orientation",
)
def orient_hierarchically(
    photos: PhotoSet, tracks: Tracks, pairs: Sequence[PairMatches], params: HierarchicalParams, *, run: Run
) -> Block:
    """Orient the photos in a tree: what shares most tracks is joined first.

    Two photos make a cluster by relative orientation, a photo joins a cluster by resection, two clusters join by the
    similarity of their common points; after each step the cluster is adjusted. No first pair decides about the whole
    block, and errors spread over the depth of the tree instead of the number of photos. Photos that are left at the
    end are added one by one.

    Parameters
    ----------
    photos : PhotoSet
    tracks : Tracks
    pairs : sequence of PairMatches
    params : HierarchicalParams
    run : Run

    Returns
    -------
    Block
        As of the incremental orientation.

    Raises
    ------
    UserError
        With a single photo, without verified pairs, and when no pair has a base.
    """
    groups = groups_of(photos, pairs)
    empty = GrowingBlock(photos, tracks, params.reprojection_px, float(np.radians(params.min_angle_deg)))

    def grown(group: tuple[int, ...]) -> Growth:
        growth = Joining(empty, group, params, run).root()
        growth.grow()
        return growth

    return main_block(grow_blocks(groups, pairs, grown, run), groups, params.component, (), run)


class Joining:
    """The clusters of one group while they are joined.

    Parameters
    ----------
    empty : GrowingBlock
        Without oriented photos.
    group : tuple of int
    params : HierarchicalParams
    run : Run
    """

    def __init__(
        self, empty: GrowingBlock, group: tuple[int, ...], params: HierarchicalParams, run: Run
    ) -> None:
        self.empty, self.group, self.params, self.run = empty, group, params, run
        self.clusters = [Cluster((photo,)) for photo in group]
        self.common = common_tracks(empty)
        self.widest, self.reason = 0.0, ""

    def root(self) -> Growth:
        """Join until nothing can be joined any more; return the largest cluster.

        Raises
        ------
        UserError
            When no two photos can be oriented relative to each other.
        """
        refused: set[tuple[Cluster, Cluster]] = set()
        while True:
            self.run.check()
            best = self._closest(refused)
            if best is None:
                break
            joined = self._joined(*best)
            if joined is None:
                refused.add(best)
                continue
            self.clusters = [cluster for cluster in self.clusters if cluster not in best] + [joined]
            done = sum(len(cluster.photos) for cluster in self.clusters if cluster.growth is not None)
            self.run.progress(done, len(self.group), "photos in clusters")
        largest = max(self.clusters, key=lambda cluster: (cluster.growth is not None, len(cluster.photos)))
        if largest.growth is None:
            raise no_base(self.widest, float(np.radians(self.params.pair_angle_deg)), self.reason)
        largest.growth.group = self.group
        return largest.growth

    def _closest(self, refused: set[tuple[Cluster, Cluster]]) -> tuple[Cluster, Cluster] | None:
        """Return the two clusters with the largest mean number of common tracks per pair of photos."""
        best, most = None, 0.0
        for i, a in enumerate(self.clusters):
            for b in self.clusters[i + 1 :]:
                shared = self.common[np.ix_(a.photos, b.photos)]
                linkage = float(shared.mean())
                if linkage > most and shared.sum() >= self.params.min_points and (a, b) not in refused:
                    best, most = (a, b), linkage
        return best

    def _joined(self, a: Cluster, b: Cluster) -> Cluster | None:
        """Return both clusters as one, adjusted, or None when they cannot be joined."""
        if len(a.photos) < len(b.photos):
            a, b = b, a
        if a.growth is None:
            growth = self._pair(a.photos[0], b.photos[0])
        elif b.growth is None:
            growth = self._with_photo(a.growth, b.photos[0])
        else:
            growth = self._both(a.growth, b.growth)
        if growth is None:
            return None
        growth.adjust()
        return Cluster(tuple(sorted(a.photos + b.photos)), growth)

    def _pair(self, a: int, b: int) -> Growth | None:
        pair = orient_pair(self.empty, a, b, seed=self.run.seed)
        if isinstance(pair, str):
            self.reason = pair
            return None
        self.widest = max(self.widest, pair.angle)
        if pair.points < self.params.min_points or pair.angle < np.radians(self.params.pair_angle_deg):
            return None
        growth = Growth(self.empty.fresh(), self.group, self.params, self.run)
        growth.place_pair(pair)
        return growth

    def _with_photo(self, growth: Growth, photo: int) -> Growth | None:
        block = growth.block
        if len(block.seen_by(photo)) < self.params.min_points:
            return None
        placed = place_photo(
            block, photo, min_points=self.params.min_points, threshold_px=self.params.resection_px,
            seed=self.run.seed + photo,
        )  # fmt: skip
        if not placed:
            return None
        how = Oriented(photo, placed.on, placed.method, placed.inliers, placed.rms_px)
        block.place(photo, placed.rotation, placed.centre, how)
        block.explain_last()
        block.intersect()
        return growth

    def _both(self, a: Growth, b: Growth) -> Growth | None:
        joint = find_joint(
            a.block, b.block, min_points=self.params.min_points, threshold_px=self.params.resection_px,
            seed=self.run.seed,
        )  # fmt: skip
        if not joint:
            return None
        self.run.say(Text("Blocks of {a} and {b} photos joined by {points} common points.", a=a.count, b=b.count,
                          points=joint.points))  # fmt: skip
        join(a.block, b.block, joint)
        a.block.intersect()
        return a


def common_tracks(block: GrowingBlock) -> Array:
    """Return the number of tracks that each pair of photos has in common, int64 (n, n), 0 on the diagonal."""
    from scipy.sparse import csr_matrix

    tracks, valid = block.tracks, np.flatnonzero(block.valid)
    seen = csr_matrix(
        (np.ones(len(valid), np.int64), (tracks.photo[valid], tracks.track[valid])),
        shape=(len(block.names), tracks.count),
    )
    common = np.asarray((seen @ seen.T).todense())
    np.fill_diagonal(common, 0)
    return common
