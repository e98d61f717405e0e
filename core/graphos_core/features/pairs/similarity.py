r"""Pairs of photos that look alike: words of a vocabulary tree, learnt from the photos' own descriptors.

Descriptors are sorted into the leaves of a tree of cluster centres; a leaf is a *word*. A photo is then a list of how
often each word occurs in it, weighted by how rare the word is among the photos, ``w = ln(N / N_w)``. Two photos are as
similar as their normalised lists overlap (Nistér and Stewénius 2006).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from graphos_core.data import Array, Features, PairSelection, PhotoSet
from graphos_core.features.pairs.choosing import LESSON, best_partners, largest, selection
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run, each
from graphos_core.text import Text

LEARNT = 60_000
"""Descriptors at most from which the vocabulary is learnt."""

ROUNDS = 8
"""Rounds of k-means at each node."""


class SimilarityParams(Params):
    """Parameters of pairs by similarity."""

    nearest: Annotated[
        int,
        About(
            label="Most similar photos",
            symbol="k",
            unit="photos",
            low=1,
            high=1000,
            step=1,
            help="Each photo is matched with so many of the most similar.",
            effect="Higher: more pairs, safer. Lower: faster; loops may stay open.",
            learn=LESSON,
            level="novice",
        ),
    ] = 20
    points: Annotated[
        int,
        About(
            label="Points",
            symbol="h",
            unit="points",
            low=100,
            high=20_000,
            step=100,
            help="So many of the largest points stand for each photo.",
            effect="Higher: more reliable, slower. Lower: faster.",
            learn=LESSON,
            level="student",
        ),
    ] = 1500
    branches: Annotated[
        int,
        About(
            label="Branches",
            symbol="b",
            unit="branches",
            low=2,
            high=32,
            step=1,
            help="Into so many clusters each node of the tree divides its descriptors.",
            effect="Higher: more words, more specific. Lower: fewer, vaguer words.",
            learn=LESSON,
            level="expert",
        ),
    ] = 8
    levels: Annotated[
        int,
        About(
            label="Levels",
            symbol="l",
            unit="levels",
            low=1,
            high=6,
            step=1,
            help="Depth of the tree; it has at most as many words as branches to this power.",
            effect="Higher: more words, more specific. Lower: fewer, vaguer words.",
            learn=LESSON,
            level="expert",
        ),
    ] = 4


@dataclass(frozen=True)
class VocabularyTree:
    """Cluster centres in levels.

    Attributes
    ----------
    centres : tuple of float32 (nodes, b, d)
        Of each level: the centres below each node; NaN where a node has fewer.
    """

    centres: tuple[Array, ...]

    @property
    def words(self) -> int:
        """Number of leaves."""
        return len(self.centres[-1]) * self.centres[-1].shape[1]

    def words_of(self, descriptors: Array) -> Array:
        """Return the leaf of each descriptor float32 (n, d), int64 (n,)."""
        node = np.zeros(len(descriptors), np.int64)
        for centres in self.centres:
            node = _descend(descriptors, node, centres)
        return node


@algorithm(
    stage="features",
    role="pairs",
    name="similarity",
    label="Most similar photos (vocabulary tree)",
    source="Nistér and Stewénius 2006, Scalable recognition with a vocabulary tree; Sivic and Zisserman 2003 (weights)",
    learn=LESSON,
)
def similarity(
    photos: PhotoSet, features: Sequence[Features], params: SimilarityParams, *, run: Run
) -> PairSelection:
    """Match each photo with the most similar ones; the score is the similarity, 0 to 1.

    The time grows with the number of photos, not with its square: made for hundreds of photos and more.

    Parameters
    ----------
    photos : PhotoSet
    features : sequence of Features
    params : SimilarityParams
    run : Run
        Its seed chooses the descriptors that are learnt from, and the first centres.
    """
    own = [as_vectors(f, largest(f, params.points)) for f in features]
    tree = learn_vocabulary(own, params.branches, params.levels, run)
    counts = np.zeros((len(own), tree.words))
    for index in each(run, range(len(own)), "photos"):
        counts[index] = np.bincount(tree.words_of(own[index]), minlength=tree.words)
    table = similarities(counts)
    chosen = best_partners(np.where(table > 0.0, table, -np.inf), params.nearest)
    used = int((counts.sum(axis=0) > 0).sum())
    said = Text("Each photo with the {k} most similar, by a vocabulary of {words} words learnt from these photos.",
                k=params.nearest, words=used)  # fmt: skip
    return selection(chosen, table, said)


def as_vectors(features: Features, kept: Array) -> Array:
    """Return descriptors as float32 vectors whose Euclidean distance orders them; bits of binary ones are numbers."""
    descriptors = features.descriptors[kept]
    if features.metric == "hamming":
        return np.unpackbits(descriptors, axis=1).astype(np.float32)
    return descriptors.astype(np.float32)


def learn_vocabulary(photos: Sequence[Array], branches: int, levels: int, run: Run) -> VocabularyTree:
    """Learn a vocabulary tree by k-means at every node (hierarchical k-means).

    Parameters
    ----------
    photos : sequence of float32 (n, d)
        Descriptors of each photo.
    branches, levels : int
    run : Run
    """
    rng = np.random.default_rng([run.seed, 41])
    everything = np.concatenate(photos)
    if len(everything) > LEARNT:
        everything = everything[np.sort(rng.permutation(len(everything))[:LEARNT])]
    node = np.zeros(len(everything), np.int64)
    centres: list[Array] = []
    for level in range(levels):
        run.check()
        found = np.full((branches**level, branches, everything.shape[1]), np.nan, np.float32)
        order = np.argsort(node, kind="stable")
        starts = np.searchsorted(node[order], np.arange(branches**level + 1))
        for parent in np.flatnonzero(np.diff(starts)):
            members = everything[order[starts[parent] : starts[parent + 1]]]
            own = _k_means(members, branches, rng)
            found[parent, : len(own)] = own
        centres.append(found)
        node = _descend(everything, node, found)
    return VocabularyTree(tuple(centres))


def similarities(counts: Array) -> Array:
    """Return how similar photos are, float64 (n, n), 0 to 1, from how often each word occurs in each (n, words).

    ``Σ min(q, d)`` of the weighted lists of sum 1, that is ``1 − ½ |q − d|₁`` (Nistér and Stewénius 2006, equation 5).
    Words that occur in every photo tell nothing; where all do, every word counts alike.
    """
    photos = len(counts)
    weight = np.log(photos / np.maximum((counts > 0).sum(axis=0), 1))
    weighted = counts * weight
    if not weighted.any():
        weighted = counts.astype(np.float64)
    weighted = weighted / np.maximum(weighted.sum(axis=1, keepdims=True), 1e-300)
    table = np.zeros((photos, photos))
    for index, own in enumerate(weighted):
        there = np.flatnonzero(own)
        table[index] = np.minimum(weighted[:, there], own[there]).sum(axis=1)
    return table


def _descend(descriptors: Array, node: Array, centres: Array) -> Array:
    """Return the child of each descriptor's node with the nearest centre, as number of the next level."""
    branches = centres.shape[1]
    child = np.zeros(len(descriptors), np.int64)
    order = np.argsort(node, kind="stable")
    starts = np.searchsorted(node[order], np.arange(len(centres) + 1))
    for parent in np.flatnonzero(np.diff(starts)):
        members = order[starts[parent] : starts[parent + 1]]
        distance = _squared(descriptors[members], centres[parent])
        child[members] = np.argmin(np.where(np.isnan(distance), np.inf, distance), axis=1)
    return node * branches + child


def _k_means(members: Array, k: int, rng: np.random.Generator) -> Array:
    """Return at most k centres by Lloyd's iteration from members drawn at random; empty clusters are dropped."""
    if len(members) <= k:
        return members
    centres = members[np.sort(rng.permutation(len(members))[:k])].astype(np.float32)
    for _ in range(ROUNDS):
        near = np.argmin(_squared(members, centres), axis=1)
        number = np.bincount(near, minlength=len(centres))
        sums = (near == np.arange(len(centres))[:, None]).astype(np.float32) @ members
        centres = sums[number > 0] / number[number > 0, None]
    return centres


def _squared(members: Array, centres: Array) -> Array:
    """Squared distances (n, k), without the squares of the members, which do not matter to the nearest."""
    return np.asarray((centres**2).sum(axis=1) - 2.0 * members @ centres.T)
