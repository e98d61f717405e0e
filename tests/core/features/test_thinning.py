import dataclasses

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera, Features, PairMatches
from graphos_core.features.residuals import match_residuals
from graphos_core.features.thinning_by_quality import (
    BestParams,
    CellsParams,
    best,
    best_of_cells,
    cell_of,
    cells,
)
from graphos_core.geometry.epipolar import (
    essential_from_relative,
    fundamental_from_essential,
    relative_orientation,
)
from graphos_core.geometry.rotation import look_at
from graphos_core.run import Run

RUN = Run()
CAMERA = Camera(model="basic", width=900, height=600, values=np.array([800.0, 449.5, 299.5, 0.0, 0.0]))
COUNT = 600


def features(xy: np.ndarray) -> Features:
    n = len(xy)
    zero = np.zeros(n, np.float32)
    return Features(
        xy=xy.astype(np.float32), scale=zero, angle=zero, response=zero, descriptors=np.zeros((n, 128), np.uint8),
        colour=np.zeros((n, 3), np.uint8), width=900, height=600,
    )  # fmt: skip


def scene() -> tuple[PairMatches, Features, Features, np.ndarray]:
    """Matches whose point in b is moved across its epipolar line by a known distance."""
    rng = np.random.default_rng(0)
    points = rng.uniform((-3, -2, -1.5), (3, 2, 1.5), (COUNT, 3))
    centres = np.array([[0.0, -9.0, 0.0], [1.5, -9.0, 0.0]])
    turns = [look_at(c, np.zeros(3)) for c in centres]
    xy = [pixel_from_ray(CAMERA, (points - c) @ r.T) for c, r in zip(centres, turns, strict=True)]
    essential = essential_from_relative(*relative_orientation(turns[0], centres[0], turns[1], centres[1]))
    fundamental = fundamental_from_essential(essential, CAMERA, CAMERA)
    lines = np.column_stack([xy[0], np.ones(COUNT)]) @ fundamental.T
    normal = lines[:, :2] / np.linalg.norm(lines[:, :2], axis=1, keepdims=True)
    off = rng.uniform(-3, 3, COUNT)
    xy[1] = xy[1] + off[:, None] * normal
    index = np.arange(COUNT, dtype=np.int32)
    pair = PairMatches(
        a=0, b=1, matches=np.stack([index, index], axis=1), candidates=COUNT, kind="essential", matrix=essential,
        ratio=rng.uniform(0.2, 0.8, COUNT).astype(np.float32),
    )  # fmt: skip
    return pair, features(xy[0]), features(xy[1]), np.abs(off)


def test_residuals_are_the_distances_from_the_lines() -> None:
    pair, a, b, off = scene()
    found = match_residuals(pair, a, b, (CAMERA, CAMERA))
    assert (found >= off - 1e-3).all()  # the distance in a may be the larger one
    assert np.median(found / off) == pytest.approx(1.0, abs=0.1)
    none = dataclasses.replace(pair, matrix=np.zeros((3, 3)), kind="none")
    assert np.isnan(match_residuals(none, a, b, (CAMERA, CAMERA))).all()


@pytest.mark.parametrize("quality", ["ratio", "residual"])
def test_the_best_are_kept_in_their_order(quality: str) -> None:
    pair, a, b, _ = scene()
    found = best(pair, a, b, BestParams(number=100, quality=quality), run=RUN, cameras=(CAMERA, CAMERA))
    value = pair.ratio if quality == "ratio" else match_residuals(pair, a, b, (CAMERA, CAMERA))
    kept = found.matches[:, 0]
    assert len(kept) == 100 and (np.diff(kept) > 0).all()
    assert value[kept].max() <= np.delete(value, kept).min()
    assert np.array_equal(found.ratio, pair.ratio[kept])
    everything = best(pair, a, b, BestParams(number=5000), run=RUN)
    assert len(everything.matches) == COUNT


def test_every_cell_that_had_a_match_still_has_one_and_hardly_more_than_wanted() -> None:
    pair, a, b, _ = scene()
    found = cells(pair, a, b, CellsParams(cells=12, each=1), run=RUN)
    assert len(found.matches) < 0.4 * COUNT
    for side, own in enumerate((a, b)):
        before = set(cell_of(own.xy[pair.matches[:, side]], 900, 600, 12).tolist())
        after = cell_of(own.xy[found.matches[:, side]], 900, 600, 12).tolist()
        assert set(after) == before
    assert len(found.matches) <= len(before) + len(set(cell_of(a.xy, 900, 600, 12).tolist()))


def test_the_best_match_of_a_cell_wins() -> None:
    kept = best_of_cells(np.array([0.9, 0.1, 0.5, 0.2]), np.array([0, 0, 0, 1]), np.array([5, 5, 5, 6]), 1)
    assert kept.tolist() == [1, 3]
    free = best_of_cells(np.array([0.9, 0.1]), np.array([0, 0]), np.array([5, 6]), 1)
    assert free.tolist() == [0, 1]  # the second cell of b would be empty otherwise


def test_matches_without_ratios_are_ranked_by_what_is_known() -> None:
    pair, a, b, _ = scene()
    bare = dataclasses.replace(pair, ratio=np.zeros(0, np.float32))
    found = best(bare, a, b, BestParams(number=50), run=RUN, cameras=(CAMERA, CAMERA))
    residual = match_residuals(pair, a, b, (CAMERA, CAMERA))
    assert residual[found.matches[:, 0]].max() <= np.sort(residual)[50]
    assert len(best(bare, a, b, BestParams(number=50), run=RUN).matches) == 50
