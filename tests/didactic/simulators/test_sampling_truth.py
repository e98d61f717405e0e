"""What the simulator of random sampling shows is true."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest

from graphos_core.features.robust_scores import COSTS
from graphos_didactic.simulator import Setting, find_simulator
from graphos_didactic.simulators.features.sampling_model import Search
from graphos_didactic.simulators.features.sampling_params import MOST, SamplingParams


def search(**changes: object) -> Search:
    return Search(SamplingParams().replace(**changes), Setting())


def preset(name: str) -> Search:
    params = find_simulator("features/sampling").preset(name)
    assert isinstance(params, SamplingParams)
    return Search(params, Setting())


def test_samples_are_clean_as_often_as_combinatorics_says() -> None:
    clean, expected = 0, 0.0
    for seed in range(8):
        seen = search(seed=seed)
        good, n = int(seen.good.sum()), len(seen.model)
        expected += MOST * comb(good, 4) / comb(n, 4)
        clean += sum(seen.clean(i) for i in range(MOST))
    assert abs(clean - expected) < 4.0 * np.sqrt(expected)


def test_the_needed_number_finds_a_clean_sample_with_the_confidence() -> None:
    found = 0
    for seed in range(60):
        seen = search(seed=seed, confidence=0.9)
        needed = int(seen.needed(seen.share))
        found += any(seen.clean(i) for i in range(needed))
    assert 45 <= found <= 60  # 0.9 of 60, four standard deviations


def test_the_model_of_a_sample_passes_through_its_matches() -> None:
    for model in ("homography", "fundamental"):
        seen = search(model=model, depth=40.0 if model == "fundamental" else 0.0)
        solved = np.flatnonzero(np.isfinite(seen.drawn.costs))
        assert len(solved) > 20
        for i in solved[:20]:
            assert np.sqrt(seen.drawn.squares[i, seen.drawn.picks[i]]).max() < 1e-3


def test_without_noise_a_clean_sample_is_exact_and_all_true_matches_agree() -> None:
    seen = search(noise_px=0.0, draw=MOST, off_x=0.0, off_y=0.0)
    assert seen.clean(seen.leader)
    assert (seen.agreeing(seen.leader) >= seen.good).all()
    assert seen.error(seen.refined) < 1e-4


@pytest.mark.parametrize("cost", ["ransac", "msac", "lmeds", "magsac"])
def test_the_best_is_the_one_of_least_cost_by_the_engine(cost: str) -> None:
    seen = search(cost=cost, draw=120)
    solved = np.isfinite(seen.drawn.costs[:120])
    costs = COSTS[cost](seen.drawn.squares[:120][solved], seen.params.threshold)
    assert seen.drawn.costs[seen.leader] == pytest.approx(costs.min())


def test_the_fit_to_all_that_agree_is_nearer_to_the_truth_than_the_sample() -> None:
    errors = []
    for seed in range(12):
        seen = search(seed=seed, draw=MOST)
        errors.append((seen.error(seen.drawn.matrices[seen.leader]), seen.error(seen.refined)))
    sample, fit = np.median(errors, axis=0)
    assert fit < 0.7 * sample


def test_a_plane_leaves_the_fundamental_matrix_open_though_all_agree() -> None:
    flat, space = preset("flat"), preset("space")
    assert flat.counts[flat.leader] >= flat.good.sum() - 1
    assert flat.error(flat.refined) > 5.0
    full = Search(space.params.replace(draw=MOST), Setting())
    assert full.error(full.refined) < 2.0


def test_the_median_follows_the_false_matches_below_half() -> None:
    errors = []
    for seed in range(4):
        by = [search(good=0.35, cost=c, draw=MOST, seed=seed, count=60) for c in ("lmeds", "msac")]
        errors.append([s.error(s.drawn.matrices[s.leader]) for s in by])
    lmeds, msac = np.median(errors, axis=0)
    assert lmeds > 2.0 * msac


def test_a_dragged_match_stops_agreeing_and_photos_give_real_matches() -> None:
    placed, dragged = search(off_x=0.0, off_y=0.0, draw=MOST), search(draw=MOST)
    assert placed.good[0]
    assert not dragged.good[0]
    assert placed.share > dragged.share
    photo = preset("photo")
    assert 0.2 < photo.share < 0.95
    full = Search(photo.params.replace(draw=MOST), Setting())
    assert full.error(full.refined) < 2.0
