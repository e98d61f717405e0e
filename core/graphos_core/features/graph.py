"""The image graph: photos are its nodes, verified pairs its edges; where it is weak, and what that means."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array, PairMatches
from graphos_core.text import Text

WEAK = 60
"""Verified matches: a group that hangs on fewer is called weakly connected; some twenty survive as good points."""


@dataclass(frozen=True)
class ImageGraph:
    """Photos and verified pairs, and where they hang together weakly. Nothing is deleted because of it.

    Attributes
    ----------
    weights : int32 (n, n)
        Verified matches between photos.
    components : tuple of tuple of int
        Photos that hang together, largest group first.
    bridges : tuple of (int, int)
        Pairs whose loss would divide a group (Tarjan 1974).
    articulations : tuple of int
        Photos whose loss would divide a group (Tarjan 1972).
    cut : int
        Smallest number of verified matches whose loss would divide the largest group (Stoer and Wagner 1997).
    cut_photos : tuple of int
        The smaller side of that cut; empty where the group has one photo.
    sentences : tuple of str
        What it means, in the order of importance.
    """

    weights: Array
    components: tuple[tuple[int, ...], ...]
    bridges: tuple[tuple[int, int], ...]
    articulations: tuple[int, ...]
    cut: int
    cut_photos: tuple[int, ...]
    sentences: tuple[str, ...]


def image_graph(names: Sequence[str], pairs: Sequence[PairMatches]) -> ImageGraph:
    """Return the image graph with its weak places.

    Parameters
    ----------
    names : sequence of str
        Of the photos, for the sentences.
    pairs : sequence of PairMatches
    """
    weights = match_counts(len(names), pairs)
    groups = components(len(names), pairs)
    bridges, articulations = weak_places(weights > 0)
    largest = groups[0] if groups else ()
    cut, side = minimum_cut(weights[np.ix_(largest, largest)]) if len(largest) > 1 else (0, ())
    photos = tuple(largest[i] for i in side)
    sentences = _sentences(names, groups, bridges, articulations, cut, photos)
    return ImageGraph(weights, groups, bridges, articulations, cut, photos, sentences)


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


def weak_places(linked: Array) -> tuple[tuple[tuple[int, int], ...], tuple[int, ...]]:
    """Return bridges and articulation nodes of an undirected graph by one depth-first search (Tarjan 1972, 1974).

    ``low`` of a node is the earliest node that it or its descendants reach by one edge back. An edge to a child is a
    bridge if the child reaches nothing before itself; a node is an articulation if a child reaches nothing before it.

    Parameters
    ----------
    linked : bool (n, n)
        Symmetric; the diagonal does not count.
    """
    count = len(linked)
    neighbours = [[int(j) for j in np.flatnonzero(linked[i]) if j != i] for i in range(count)]
    order, low, parent = [-1] * count, [0] * count, [-1] * count
    bridges: list[tuple[int, int]] = []
    cuts: set[int] = set()
    time = 0
    for root in range(count):
        if order[root] >= 0:
            continue
        children, stack = 0, [(root, iter(neighbours[root]))]
        order[root] = low[root] = time
        time += 1
        while stack:
            node, rest = stack[-1]
            other = next(rest, None)
            if other is None:
                stack.pop()
                above = parent[node]
                if above < 0:
                    continue
                low[above] = min(low[above], low[node])
                if low[node] > order[above]:
                    bridges.append((min(above, node), max(above, node)))
                if above == root:
                    children += 1
                elif low[node] >= order[above]:
                    cuts.add(above)
            elif order[other] < 0:
                parent[other] = node
                order[other] = low[other] = time
                time += 1
                stack.append((other, iter(neighbours[other])))
            elif other != parent[node]:
                low[node] = min(low[node], order[other])
        if children > 1:
            cuts.add(root)
    return tuple(sorted(bridges)), tuple(sorted(cuts))


def minimum_cut(weights: Array) -> tuple[int, tuple[int, ...]]:
    """Return the smallest total weight that divides a connected graph, and the smaller side (Stoer and Wagner 1997).

    Parameters
    ----------
    weights : int (n, n)
        Symmetric, n ≥ 2.
    """
    table = np.array(weights, dtype=np.int64)
    np.fill_diagonal(table, 0)
    count = len(table)
    merged = [[node] for node in range(count)]
    alive = list(range(count))
    lowest, side = np.iinfo(np.int64).max, [0]
    while len(alive) > 1:
        joined = [alive[0]]
        rest = alive[1:]
        pull = table[alive[0]].copy()
        while rest:
            last = max(rest, key=lambda node: pull[node])
            rest.remove(last)
            if not rest and pull[last] < lowest:
                lowest, side = int(pull[last]), list(merged[last])
            pull += table[last]
            joined.append(last)
        before, last = joined[-2], joined[-1]
        merged[before] += merged[last]
        table[before] += table[last]
        table[:, before] = table[before]
        table[before, before] = 0
        alive.remove(last)
    if len(side) * 2 > count:
        side = [node for node in range(count) if node not in set(side)]
    return int(lowest), tuple(sorted(side))


def _sentences(
    names: Sequence[str],
    groups: Sequence[Sequence[int]],
    bridges: Sequence[tuple[int, int]],
    articulations: Sequence[int],
    cut: int,
    cut_photos: Sequence[int],
) -> tuple[str, ...]:
    said: list[str] = []
    alone = [names[group[0]] for group in groups if len(group) == 1]
    several = [group for group in groups if len(group) > 1]
    if len(several) > 1:
        said.append(Text(
            "The photos fall into {count} groups of {sizes}: no verified pair joins them, so each would be a model of its "
            "own. Take photos in between.", count=len(several), sizes=", ".join(str(len(g)) for g in several),
        ))  # fmt: skip
    if alone:
        said.append(Text("Without any verified pair: {names}.", names=", ".join(alone)))
    for a, b in bridges:
        said.append(Text("Only the pair {a} and {b} joins two parts of the block.", a=names[a], b=names[b]))
    for photo in articulations:
        said.append(Text(
            "Without {name} the block would fall apart: take a second photo that overlaps both of its sides.",
            name=names[photo],
        ))  # fmt: skip
    if cut_photos and cut < WEAK:
        said.append(Text(
            "Only {cut} verified matches hold {names} to the rest.", cut=cut,
            names=", ".join(names[p] for p in cut_photos),
        ))  # fmt: skip
    return tuple(said)
