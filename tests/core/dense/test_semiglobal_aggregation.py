"""Semi-global aggregation against a plain twin, and cost and aggregation on rectified pairs with known disparity."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.data import Array
from graphos_core.dense.coarse_to_fine import Matching, match_once
from graphos_core.dense.cost import Sweep
from graphos_core.dense.sgm import aggregate
from graphos_core.dense.undistort import View
from graphos_core.run import Run


def plain_aggregation(cost: Array, starts: Array, grey: Array, p1: float, p2: float, edge: float) -> Array:
    """Hirschmüller's recursion written down once more, path by path."""
    h, w, d = cost.shape
    total = np.zeros(cost.shape)
    for dy, dx in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (-1, -1), (1, -1), (-1, 1)):
        paths = np.zeros(cost.shape)
        for y in range(h)[:: -1 if dy < 0 else 1]:
            for x in range(w)[:: -1 if dx < 0 or (dx == 0 and dy < 0) else 1]:
                yy, xx = y - dy, x - dx
                if not (0 <= yy < h and 0 <= xx < w):
                    paths[y, x] = cost[y, x]
                    continue
                before = paths[yy, xx]
                jump = np.rint(max(p2 / (1 + abs(float(grey[y, x]) - float(grey[yy, xx])) / edge), 1.5 * p1))
                apart = float(starts[y, x] - starts[yy, xx])
                shift = 0 if abs(apart) <= 1.5 else round(apart)
                for k in range(d):
                    q = k + shift
                    least = before.min()
                    choices = [least + jump]
                    choices += [before[q]] if 0 <= q < d else []
                    choices += [before[n] + p1 for n in (q - 1, q + 1) if 0 <= n < d]
                    paths[y, x, k] = cost[y, x, k] + min(choices) - least
        total += paths
    return total


@pytest.mark.parametrize("jumps", [False, True])
def test_aggregation_equals_its_plain_twin(jumps: bool) -> None:
    rng = np.random.default_rng(3)
    cost = rng.integers(0, 1001, (13, 17, 9)).astype(np.uint16)
    grey = rng.integers(1, 255, (13, 17)).astype(np.uint8)
    starts = np.zeros((13, 17), np.float32)
    if jumps:
        starts += rng.choice([0.0, 0.7, 3.0, -5.0, 40.0], (13, 17)).astype(np.float32)
    found = aggregate(cost, starts, grey, p1=60, p2=600, edge_grey=12.0, run=Run())
    np.testing.assert_array_equal(found, plain_aggregation(cost, starts, grey, 60, 600, 12.0))


def rectified(left: Array, right: Array) -> tuple[View, View]:
    """Two views whose disparity in px equals the inverse depth: base 1, principal distance 1 px."""
    eye = np.eye(3)
    return (
        View(0, np.maximum(left, 1), 1.0, 0.0, 0.0, eye, np.zeros(3)),
        View(1, np.maximum(right, 1), 1.0, 0.0, 0.0, eye, np.array([1.0, 0.0, 0.0])),
    )


HOW = Matching(
    window=5, census=False, noise=2.0, p1=60, p2=600, edge_grey=12.0, levels=1, step_px=1.0, most_depths=64,
    local_depths=16,
)  # fmt: skip


@pytest.mark.parametrize("census", [False, True])
def test_a_slanted_disparity_is_found_to_a_tenth_of_a_pixel(census: bool) -> None:
    rng = np.random.default_rng(5)
    texture = cv2.GaussianBlur(rng.normal(128, 60, (80, 220)).astype(np.float32), (0, 0), 1.2)
    texture = np.clip((texture - 128) * 3 + 128, 1, 254)
    x, y = np.meshgrid(np.arange(120.0), np.arange(80.0))
    disparity = 6.0 + 0.03 * x
    left = cv2.remap(texture, (x + 40).astype(np.float32), y.astype(np.float32), cv2.INTER_CUBIC)
    at_right = (x + 6.0) / (1 - 0.03)  # pixel x of the right picture shows pixel x + d of the left one
    right = cv2.remap(texture, (at_right + 40).astype(np.float32), y.astype(np.float32), cv2.INTER_CUBIC)
    views = rectified(np.rint(left).astype(np.uint8), np.rint(right).astype(np.uint8))
    how = Matching(**{**HOW.__dict__, "census": census})
    sweep = Sweep(np.full((80, 120), 2.0, np.float32), 0, 24, 0.5)
    found = match_once(views[0], [views[1]], sweep, how, Run())
    inner = (slice(5, -5), slice(20, -5))
    error = np.abs(found.inverse_depth - disparity)[inner]
    assert np.median(error) < (0.15 if census else 0.1)


@pytest.mark.data
@pytest.mark.parametrize(("name", "depths", "most_bad"), [("tsukuba", 18, 0.12), ("venus", 24, 0.06)])
def test_middlebury_pairs_have_few_wrong_pixels(
    data_dir: Path, name: str, depths: int, most_bad: float
) -> None:
    folder = data_dir / "middlebury" / name
    left, right = (cv2.imread(str(folder / f"im{side}.png"), cv2.IMREAD_GRAYSCALE) for side in "LR")
    scale = float((folder / "info.txt").read_text().split()[0])
    truth = cv2.imread(str(folder / "groundtruth.png"), cv2.IMREAD_GRAYSCALE) / scale
    counted = cv2.imread(str(folder / "nonocc.png"), cv2.IMREAD_GRAYSCALE) == 255
    views = rectified(left, right)
    sweep = Sweep(np.full(left.shape, 0.5, np.float32), 0, 2 * depths, 0.5)
    found = match_once(views[0], [views[1]], sweep, HOW, Run())
    bad = np.abs(found.inverse_depth - truth)[counted] > 1.0
    assert bad.mean() < most_bad
