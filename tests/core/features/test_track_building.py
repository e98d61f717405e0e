import numpy as np

from graphos_core.data import Features, PairMatches
from graphos_core.features.graph import components, match_counts
from graphos_core.features.tracks import TrackParams, tracks
from graphos_core.run import Run

RUN = Run()


def photo(count: int, seed: int) -> Features:
    rng = np.random.default_rng(seed)
    zero = np.zeros(count, np.float32)
    return Features(
        xy=rng.uniform(0, 1000, (count, 2)).astype(np.float32), scale=zero, angle=zero, response=zero,
        descriptors=np.zeros((count, 128), np.uint8), colour=rng.integers(0, 256, (count, 3), dtype=np.uint8),
        width=1000, height=1000,
    )  # fmt: skip


def pair(
    a: int, b: int, matches: list[tuple[int, int]], reason: str = "", candidates: int = 50
) -> PairMatches:
    return PairMatches(
        a=a, b=b, matches=np.array(matches, np.int32).reshape(-1, 2), candidates=candidates, kind="fundamental",
        matrix=np.eye(3), reason=reason,
    )  # fmt: skip


PHOTOS = [photo(10, seed) for seed in range(4)]


def as_sets(found) -> list[set[tuple[int, int]]]:
    groups: dict[int, set[tuple[int, int]]] = {}
    for p, f, t in zip(found.photo.tolist(), found.feature.tolist(), found.track.tolist(), strict=True):
        groups.setdefault(t, set()).add((p, f))
    return [groups[t] for t in range(found.count)]


def test_matches_are_followed_over_all_photos() -> None:
    pairs = [pair(0, 1, [(0, 5), (1, 6)]), pair(1, 2, [(5, 2)]), pair(2, 3, [(2, 9), (4, 4)])]
    found = tracks(PHOTOS, pairs, TrackParams(), run=RUN)
    assert as_sets(found) == [{(0, 0), (1, 5), (2, 2), (3, 9)}, {(0, 1), (1, 6)}, {(2, 4), (3, 4)}]
    assert found.components == ((0, 1, 2, 3),) and found.conflicts == 0
    for i in range(len(found.track)):
        assert np.array_equal(found.xy[i], PHOTOS[found.photo[i]].xy[found.feature[i]])
    members = [PHOTOS[p].colour[f].astype(float) for p, f in sorted(as_sets(found)[0])]
    assert np.abs(found.colour[0] - np.mean(members, axis=0)).max() <= 0.5


def test_the_order_is_track_then_photo_and_short_tracks_fall_away() -> None:
    pairs = [pair(1, 2, [(5, 2), (1, 1)]), pair(0, 1, [(0, 5), (3, 7)])]
    found = tracks(PHOTOS, pairs, TrackParams(minimum=3), run=RUN)
    assert as_sets(found) == [{(0, 0), (1, 5), (2, 2)}]
    everything = tracks(PHOTOS, pairs, TrackParams(), run=RUN)
    key = everything.track.astype(np.int64) * 10 + everything.photo
    assert (np.diff(key) > 0).all()


def test_a_contradiction_is_cut_at_the_weaker_pair_or_dropped() -> None:
    strong = pair(0, 1, [(0, 0), (1, 1), (2, 2)])
    other = pair(0, 2, [(0, 0), (5, 5)])
    wrong = pair(1, 2, [(0, 7)])  # would put features 0 and 7 of photo 2 into one track
    cut = tracks(PHOTOS, [wrong, other, strong], TrackParams(), run=RUN)
    assert {(0, 0), (1, 0), (2, 0)} in as_sets(cut)
    assert cut.conflicts == 1
    assert all(len({p for p, _ in members}) == len(members) for members in as_sets(cut))
    dropped = tracks(PHOTOS, [wrong, other, strong], TrackParams(conflicts="drop"), run=RUN)
    assert as_sets(dropped) == [{(0, 1), (1, 1)}, {(0, 2), (1, 2)}, {(0, 5), (2, 5)}]
    assert dropped.conflicts == 1


def test_the_order_of_the_pairs_does_not_matter() -> None:
    rng = np.random.default_rng(0)
    pairs = [
        pair(a, b, list(zip(rng.permutation(10)[:n].tolist(), rng.permutation(10)[:n].tolist(), strict=True)))
        for a, b, n in ((0, 1, 6), (0, 2, 5), (1, 2, 7), (1, 3, 5), (2, 3, 6))
    ]
    one, two = (tracks(PHOTOS, order, TrackParams(), run=RUN) for order in (pairs, pairs[::-1]))
    for name in ("photo", "feature", "track", "xy", "colour"):
        assert np.array_equal(getattr(one, name), getattr(two, name))
    assert one.conflicts > 0


def test_many_random_matches_never_give_two_features_of_one_photo() -> None:
    rng = np.random.default_rng(1)
    photos = [photo(300, seed) for seed in range(6)]
    pairs = [
        pair(a, b, list(zip(range(300), rng.permutation(300).tolist(), strict=True))[: 100 + a + b])
        for a in range(6)
        for b in range(a + 1, 6)
    ]
    found = tracks(photos, pairs, TrackParams(), run=RUN)
    keys = found.track.astype(np.int64) * 6 + found.photo
    assert len(np.unique(keys)) == len(keys)
    assert np.bincount(found.track).min() >= 2


def test_no_matches_give_no_tracks() -> None:
    found = tracks(PHOTOS, [pair(0, 1, [], "only 3 candidate matches, 15 needed")], TrackParams(), run=RUN)
    assert found.count == 0 and found.xy.shape == (0, 2) and found.colour.shape == (0, 3)
    assert found.components == ((0,), (1,), (2,), (3,))


def test_groups_come_largest_first_and_verified_matches_are_counted() -> None:
    pairs = [pair(1, 2, [(0, 0)]), pair(2, 3, [(0, 0)]), pair(4, 5, [(0, 0)]),
             pair(0, 1, [], "only 9 verified matches of 40, 15 needed", 40), pair(0, 2, [], "x", 3)]  # fmt: skip
    assert components(6, pairs) == ((1, 2, 3), (4, 5), (0,))
    table = match_counts(6, pairs)
    assert table[2, 1] == table[1, 2] == 1 and table.sum() == 6
