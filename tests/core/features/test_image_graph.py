"""Weak places of the image graph, against what happens when photos and pairs are really taken away."""

import itertools

import numpy as np
import pytest

from graphos_core.data import Features, PairMatches, Tracks
from graphos_core.features.funnel import funnel
from graphos_core.features.graph import components, image_graph, minimum_cut, weak_places
from graphos_core.results import FeaturesResult


def pair(a: int, b: int, count: int, reason: str = "", **more: object) -> PairMatches:
    matches = np.stack([np.arange(count)] * 2, axis=1).astype(np.int32)
    return PairMatches(a=a, b=b, matches=matches, candidates=count, kind="none", matrix=np.zeros((3, 3)), reason=reason, **more)  # fmt: skip


def pairs_of(linked: np.ndarray) -> list[PairMatches]:
    return [pair(int(a), int(b), int(linked[a, b])) for a, b in np.argwhere(np.triu(linked, 1))]


def random_graph(count: int, share: float, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    table = np.triu(rng.integers(1, 200, (count, count)) * (rng.random((count, count)) < share), 1)
    return table + table.T


@pytest.mark.parametrize("seed", range(12))
def test_weak_places_are_those_whose_loss_divides_a_group(seed: int) -> None:
    table = random_graph(9, 0.28, seed)
    whole = len(components(9, pairs_of(table)))
    bridges, articulations = weak_places(table > 0)
    for a, b in itertools.combinations(range(9), 2):
        without = table.copy()
        without[a, b] = without[b, a] = 0
        assert ((a, b) in bridges) == (len(components(9, pairs_of(without))) > whole)
    for photo in range(9):
        left = np.delete(np.delete(table, photo, 0), photo, 1)
        alone = not table[photo].any()
        assert (photo in articulations) == (len(components(8, pairs_of(left))) > whole - alone)


@pytest.mark.parametrize("seed", range(8))
def test_the_minimum_cut_is_the_least_of_all_cuts(seed: int) -> None:
    table = random_graph(7, 0.8, seed)
    least = min(
        table[np.ix_(side, [n for n in range(7) if n not in side])].sum()
        for size in (1, 2, 3)
        for side in map(list, itertools.combinations(range(7), size))
    )
    cut, side = minimum_cut(table)
    rest = [n for n in range(7) if n not in side]
    assert cut == least == table[np.ix_(list(side), rest)].sum()
    assert 0 < len(side) <= len(rest)


def test_weak_places_are_named_and_nothing_is_deleted() -> None:
    names = ["a.jpg", "b.jpg", "c.jpg", "d.jpg", "e.jpg", "lost.jpg"]
    given = [
        pair(0, 1, 300),
        pair(1, 2, 280),
        pair(0, 2, 310),
        pair(2, 3, 25),
        pair(3, 4, 500),
        pair(0, 5, 9, "too few"),
    ]
    graph = image_graph(names, given)
    assert graph.components == ((0, 1, 2, 3, 4), (5,))
    assert graph.bridges == ((2, 3), (3, 4)) and graph.articulations == (2, 3)
    assert graph.cut == 25 and graph.cut_photos == (3, 4)
    text = " ".join(graph.sentences)
    assert "Without any verified pair: lost.jpg." in text
    assert "Only the pair c.jpg and d.jpg joins two parts of the block." in text
    assert "Only 25 verified matches hold d.jpg, e.jpg to the rest." in text


@pytest.mark.parametrize("count", [0, 1, 2])
def test_hardly_any_photos_have_a_graph_too(count: int) -> None:
    graph = image_graph([f"{i}.jpg" for i in range(count)], [])
    assert len(graph.components) == count and graph.cut == 0


def test_a_well_connected_block_has_nothing_to_say() -> None:
    names = [f"{i}.jpg" for i in range(5)]
    assert (
        image_graph(names, [pair(a, b, 400) for a, b in itertools.combinations(range(5), 2)]).sentences == ()
    )


def test_the_funnel_counts_every_step_and_the_tracks() -> None:
    zero = np.zeros(10, np.float32)
    photo = Features(
        xy=np.zeros((10, 2), np.float32), scale=zero, angle=zero, response=zero, descriptors=np.zeros((10, 4), np.uint8),
        colour=np.zeros((10, 3), np.uint8), width=9, height=9, found=25,
    )  # fmt: skip
    tracks = Tracks(
        photo=np.array([0, 1, 0, 1], np.int32), feature=np.array([0, 0, 1, 1], np.int32),
        track=np.array([0, 0, 1, 1], np.int32), xy=np.zeros((4, 2)), colour=np.zeros((2, 3), np.uint8), count=2, conflicts=3,
    )  # fmt: skip
    steps = (("nearest", 10), ("ratio", 6), ("verified", 4))
    given = (
        pair(0, 1, 4, steps=steps),
        pair(0, 2, 0, "too few", steps=(("nearest", 10), ("ratio", 1), ("verified", 0))),
    )
    found = funnel(FeaturesResult(features=(photo, photo, photo), pairs=given, tracks=tracks))
    assert found.pairs[0].steps == (("keypoints", 10), *steps, ("in tracks", 2))
    assert dict(found.total) == {
        "found": 75, "keypoints": 30, "nearest": 20, "ratio": 7, "verified": 4, "in tracks": 2, "observations": 4, "tracks": 2,
    }  # fmt: skip
    assert (found.tried, found.used, found.conflicts) == (2, 1, 3)
