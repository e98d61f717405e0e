"""What the simulator of maximal self-dissimilarity shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_didactic.simulator import Setting, find_simulator
from graphos_didactic.simulators.features.self_dissimilarity_model import MARKS, Compared
from graphos_didactic.simulators.features.self_dissimilarity_params import SelfDissimilarityParams
from graphos_didactic.simulators.features.self_dissimilarity_tasks import PREDICTION


def compared(**values: object) -> Compared:
    return Compared(SelfDissimilarityParams(**values), Setting())  # type: ignore[arg-type]


def test_the_map_at_the_point_is_the_mean_of_the_nearest_patches() -> None:
    for values in (
        {},
        {"x": 25.0, "y": 39.0, "neighbours": 7},
        {"picture": "photo", "level": 0, "search": 3},
    ):
        seen = compared(**values)
        column, row = seen.at
        assert seen.dissimilarity == pytest.approx(float(seen.map[row, column]), rel=1e-5)
        distance = seen.every[1]
        assert len(distance) == (2 * seen.params.search + 1) ** 2 - 1
        assert (np.diff(distance) >= 0).all()


def test_a_distance_is_the_mean_squared_difference_of_two_patches() -> None:
    seen = compared(x=30.0, y=40.0)
    (column, row), patch = seen.at, seen.params.patch
    shifts, distance = seen.every
    image = seen.image.astype(float)

    def cut(u: int, v: int) -> np.ndarray:
        return image[row + v - patch : row + v + patch + 1, column + u - patch : column + u + patch + 1]

    for i in (0, 3, 60):
        assert np.mean((cut(*shifts[i]) - cut(0, 0)) ** 2) == pytest.approx(distance[i])


def test_all_marks_are_found_where_they_are() -> None:
    seen = compared()
    assert seen.marked == len(MARKS) == 3
    assert seen.errors.max() < 0.8


def test_tiles_are_distinctive_only_while_the_search_is_narrower_than_a_tile() -> None:
    narrow, wide = compared(search=5), compared(search=11)
    assert narrow.elsewhere > 20
    assert wide.elsewhere == 0
    assert wide.marked == 3


def test_an_edge_is_not_distinctive_and_a_mark_is() -> None:
    simulator = find_simulator("features/self_dissimilarity")
    edge, mark, stripes = (
        Compared(simulator.preset(name), Setting()) for name in ("edge", "mark", "stripes")  # type: ignore[arg-type]
    )  # fmt: skip
    assert edge.dissimilarity < 0.1 * edge.params.threshold
    assert mark.dissimilarity > 2 * mark.params.threshold
    assert len(stripes.points) == 0


def test_a_wider_search_never_makes_a_point_more_distinctive() -> None:
    for x in (20.0, 40.0, 62.5, 77.0):
        values = [compared(x=x, search=search).dissimilarity for search in (2, 4, 8, 12)]
        assert (np.diff(values) <= 1e-9).all()


def test_the_point_keeps_its_search_area_inside() -> None:
    for x, y in ((0.0, 0.0), (100.0, 100.0)):
        for level in (0, 5):
            seen = compared(x=x, y=y, level=level, search=14, patch=7)
            rows, columns = seen.image.shape
            column, row = seen.at
            assert seen.reach <= column < columns - seen.reach
            assert seen.reach <= row < rows - seen.reach


def test_a_narrow_photo_still_holds_the_search_area() -> None:
    narrow = np.random.default_rng(0).integers(0, 255, (3000, 20, 3)).astype(np.uint8)
    params = SelfDissimilarityParams(picture="photo", level=5, search=14, patch=7)
    assert Compared(params, Setting(narrow, "narrow")).dissimilarity > 0


def test_the_prediction_depends_on_the_picture() -> None:
    answer = PREDICTION.answer
    assert answer(SelfDissimilarityParams(), Setting()) == 2
    assert answer(SelfDissimilarityParams(picture="stripes", threshold=0.0, noise=10.0), Setting()) != 0
    assert answer(SelfDissimilarityParams(search=11), Setting()) == 1
