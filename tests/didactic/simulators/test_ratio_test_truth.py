"""What the simulator of the ratio test shows is true."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.run import Run
from graphos_didactic.simulator import Setting, find_simulator
from graphos_didactic.simulators.features.ratio_test_model import Judged
from graphos_didactic.simulators.features.ratio_test_params import RatioTestParams
from graphos_didactic.simulators.pictured_pair import PicturedPair, View, wall_picture


def judged(**changes: object) -> Judged:
    return Judged(RatioTestParams().replace(**changes), Setting())


def preset(name: str) -> Judged:
    params = find_simulator("features/ratio_test").preset(name)
    assert isinstance(params, RatioTestParams)
    return Judged(params, Setting())


def test_photo_b_shows_the_wall_where_the_truth_says() -> None:
    pair = PicturedPair(wall_picture("texture", Setting())[0], View(tilt=35, swing=30, roll=20, aside=25))
    corners = np.array([[60.0, 50], [290, 60], [280, 210], [70, 200]])
    back = cv2.getPerspectiveTransform(
        pair.true_partner(corners).astype(np.float32), corners.astype(np.float32)
    )
    rectified = cv2.warpPerspective(pair.photo_b, back, pair.photo_a.shape[1::-1])
    window = (slice(70, 190), slice(90, 260))
    a, b = (photo[window].astype(float).ravel() for photo in (pair.photo_a, rectified))
    assert np.corrcoef(a, b)[0, 1] > 0.98


@pytest.mark.parametrize("both", [False, True])
@pytest.mark.parametrize("ratio", [0.6, 0.8, 0.95])
def test_what_is_accepted_is_what_the_engine_accepts(ratio: float, both: bool) -> None:
    seen = judged(ratio=ratio, mutual=both)
    engine = mutual(seen.pair.a, seen.pair.b, MutualParams(ratio=ratio, mutual=both), run=Run())
    assert {tuple(m) for m in seen.nearest.matches[seen.accepted]} == {tuple(m) for m in engine.matches}
    assert np.array_equal(seen.accepted_by("ratio", ratio), seen.accepted)


def test_distances_are_those_of_an_exhaustive_search() -> None:
    """Of points: features at one place are one of them, as far away as their nearest descriptors."""
    seen = judged()
    a, b = seen.pair.a, seen.pair.b
    every = np.linalg.norm(a.descriptors[:, None].astype(float) - b.descriptors[None].astype(float), axis=2)
    place_a, place_b = (np.unique(f.xy, axis=0, return_inverse=True)[1].ravel() for f in (a, b))
    points = np.full((place_a.max() + 1, place_b.max() + 1), np.inf)
    np.minimum.at(points, (place_a[:, None], place_b[None]), every)
    ordered, order = np.sort(points, axis=1), np.argsort(points, axis=1)
    rows = place_a[seen.nearest.matches[:, 0]]
    assert seen.nearest.distance == pytest.approx(ordered[rows, 0], rel=1e-5)
    assert seen.second_distance == pytest.approx(ordered[rows, 1], rel=1e-5)
    for x, y in ((227.0, 58.0), (60.0, 200.0), (300.0, 120.0)):
        at = judged(look_x=x, look_y=y)
        first, best = at.nearest.matches[at.looked_at]
        found = [place_b[best], place_b[at.second]]
        assert points[place_a[first]][found] == pytest.approx(
            points[place_a[first]][order[place_a[first], :2]]
        )


def test_counts_add_up_and_a_generous_threshold_keeps_everything_true() -> None:
    seen = judged(ratio=1.0)
    counts = seen.counts
    assert counts.true_rejected == 0
    total = counts.accepted + counts.true_rejected + counts.false_rejected
    assert total == len(seen.nearest)
    recalls = seen.curve("ratio")[:, 0]
    assert (np.diff(recalls) >= 0).all()


def test_the_ratio_beats_the_distance_at_equal_number() -> None:
    shares = []
    for seed in range(4):
        by_ratio = judged(seed=seed)
        by_distance = judged(seed=seed, rule="distance", limit=by_ratio.limit_for(by_ratio.counts.accepted))
        assert abs(by_distance.counts.accepted - by_ratio.counts.accepted) <= 2
        shares.append((by_ratio.counts.precision, by_distance.counts.precision))
    assert np.mean([a - b for a, b in shares]) > 1.0


def test_equal_windows_break_the_test_and_a_rich_texture_does_not() -> None:
    assert preset("windows").counts.precision < 40.0
    assert preset("texture").counts.precision > 95.0
