"""Ways to choose pairs, on simulated photos that look at known parts of a line or a ring of points."""

import numpy as np
import pytest

from graphos_core.data import Exif, Features, Photo, PhotoSet
from graphos_core.errors import UserError
from graphos_core.features.pair_selection import AllPairsParams, all_pairs
from graphos_core.features.pairs.multiscale import MultiscaleParams, multiscale
from graphos_core.features.pairs.positions import PositionsParams, geocentric, positions
from graphos_core.features.pairs.sequential import SequentialParams, sequential
from graphos_core.features.pairs.similarity import (
    SimilarityParams,
    learn_vocabulary,
    similarities,
    similarity,
)
from graphos_core.run import Run

RUN = Run(threads=2)


def photo_set(places: list[tuple[float, float, float] | None]) -> PhotoSet:
    made = []
    for index, place in enumerate(places):
        exif = (
            Exif()
            if place is None
            else Exif(latitude_deg=place[0], longitude_deg=place[1], altitude_m=place[2])
        )
        made.append(Photo(name=f"{index}.jpg", path="", width=100, height=100, bits=8, channels=3, camera=0, digest="", exif=exif))  # fmt: skip
    return PhotoSet(photos=tuple(made), cameras=())


def strip(count: int, seen: int = 400, step: int = 120, seed: int = 0) -> list[Features]:
    """Photos along a wall of points; neighbours share `seen − step` of them, those `seen / step` apart none."""
    rng = np.random.default_rng(seed)
    wall = np.abs(rng.normal(size=(step * count + seen, 128))) ** 2
    wall = 512 * wall / np.linalg.norm(wall, axis=1, keepdims=True)
    size = rng.uniform(2, 40, len(wall))
    found = []
    for index in range(count):
        mine = np.arange(index * step, index * step + seen)
        noisy = np.clip(wall[mine] + rng.normal(0, 4, (seen, 128)), 0, 255)
        zero = np.zeros(seen, np.float32)
        found.append(Features(
            xy=np.column_stack([mine, mine % 7]).astype(np.float32), scale=(size[mine] * rng.uniform(0.95, 1.05, seen)).astype(np.float32),
            angle=zero, response=zero, descriptors=np.rint(noisy).astype(np.uint8), colour=np.zeros((seen, 3), np.uint8),
            width=100, height=100,
        ))  # fmt: skip
    return found


def as_set(pairs: np.ndarray) -> set[tuple[int, int]]:
    return {(int(a), int(b)) for a, b in pairs}


def overlapping(count: int, reach: int) -> set[tuple[int, int]]:
    return {(a, b) for a in range(count) for b in range(a + 1, min(count, a + reach + 1))}


PHOTOS = photo_set([None] * 9)
WALL = strip(9)


def test_all_pairs_are_all() -> None:
    found = all_pairs(PHOTOS, WALL, AllPairsParams(), run=RUN)
    assert as_set(found.pairs) == overlapping(9, 9) and found.possible == 36


def test_a_sequence_is_open_or_closed() -> None:
    line = sequential(PHOTOS, WALL, SequentialParams(reach=2), run=RUN)
    assert as_set(line.pairs) == overlapping(9, 2)
    ring = sequential(PHOTOS, WALL, SequentialParams(reach=2, ring=True), run=RUN)
    assert as_set(ring.pairs) == overlapping(9, 2) | {(0, 8), (0, 7), (1, 8)}
    assert ring.score[ring.pairs.tolist().index([0, 8])] == 1


@pytest.mark.parametrize(("count", "reach"), [(2, 1000), (1, 3)])
def test_short_sequences_do_not_ask_for_photos_that_are_not_there(count: int, reach: int) -> None:
    for ring in (False, True):
        found = sequential(PHOTOS, WALL[:count], SequentialParams(reach=reach, ring=ring), run=RUN)
        assert len(found.pairs) == count * (count - 1) // 2


def test_geocentric_positions_are_those_of_proj() -> None:
    from pyproj import Transformer

    places = [(51.5, -0.1, 35.0), (-33.9, 151.2, 10.0), (0.0, 179.999, 0.0)]
    expected = Transformer.from_crs("EPSG:4979", "EPSG:4978").transform(*np.array(places).T)
    assert np.abs(geocentric(photo_set(list(places))) - np.column_stack(expected)).max() < 1e-6


def test_neighbours_by_position_cross_the_date_line_and_name_photos_without_one() -> None:
    degree = 1 / 111_320  # of longitude at the equator, per metre
    east = [0, 10, 20, 200, 210]
    places = [(0.0, 180.0 - 15 * degree + m * degree, 50.0) for m in east]
    places = [(a, b - 360 if b > 180 else b, h) for a, b, h in places]
    found = positions(photo_set([*places, None]), strip(6), PositionsParams(nearest=1), run=RUN)
    assert as_set(found.pairs) == {(0, 1), (1, 2), (3, 4), *((i, 5) for i in range(5))}
    assert "5.jpg" in found.said
    assert found.score[found.pairs.tolist().index([3, 4])] == pytest.approx(10.0, abs=0.02)
    near = positions(photo_set(places), strip(5), PositionsParams(nearest=4, distance=25.0), run=RUN)
    assert as_set(near.pairs) == {(0, 1), (0, 2), (1, 2), (3, 4)}


def test_without_positions_there_is_an_explanation() -> None:
    with pytest.raises(UserError, match="1 of 2 photos carry"):
        positions(photo_set([(1.0, 2.0, 3.0), None]), strip(2), PositionsParams(), run=RUN)


def test_multiscale_keeps_what_overlaps_and_counts_what_is_left_out() -> None:
    found = multiscale(PHOTOS, WALL, MultiscaleParams(points=120), run=RUN)
    assert as_set(found.pairs) == overlapping(9, 3)  # 40 of 400 points are shared by photos three apart
    assert found.said == f"{len(found.pairs)} of 36 pairs share at least 3 of their 120 largest points; {36 - len(found.pairs)} pairs are left out."  # fmt: skip
    shared = dict(zip(map(tuple, found.pairs.tolist()), found.score, strict=True))
    assert shared[0, 1] > shared[0, 2] > shared[0, 3]


def test_similarity_finds_the_neighbours_without_trying_all_pairs() -> None:
    found = similarity(PHOTOS, WALL, SimilarityParams(nearest=2), run=RUN)
    assert overlapping(9, 1) <= as_set(found.pairs) <= overlapping(9, 2)
    again = similarity(PHOTOS, WALL, SimilarityParams(nearest=2), run=Run(threads=1))
    assert np.array_equal(found.pairs, again.pairs) and np.array_equal(found.score, again.score)


def test_similarity_of_the_same_and_of_nothing_in_common() -> None:
    counts = np.array([[4, 2, 0, 0], [2, 1, 0, 0], [0, 0, 3, 3]], dtype=float)
    table = similarities(counts)
    assert table[0, 1] == pytest.approx(1.0) and table[0, 2] == 0.0
    assert similarities(np.ones((3, 5)))[0, 1] == pytest.approx(1.0)


def test_every_descriptor_has_a_word_and_near_ones_the_same() -> None:
    rng = np.random.default_rng(3)
    centres = rng.uniform(0, 200, (16, 32))
    photos = [
        (centres[rng.integers(0, 16, 300)] + rng.normal(0, 0.5, (300, 32))).astype(np.float32)
        for _ in range(3)
    ]
    tree = learn_vocabulary(photos, 4, 3, RUN)
    words = tree.words_of(photos[0])
    assert words.min() >= 0 and words.max() < tree.words == 64
    kind = ((photos[0][:, None] - centres[None]) ** 2).sum(axis=2).argmin(axis=1)
    homes = [set(kind[words == word]) for word in np.unique(words)]
    assert np.mean([len(home) == 1 for home in homes]) > 0.9  # a word is one kind of descriptor
