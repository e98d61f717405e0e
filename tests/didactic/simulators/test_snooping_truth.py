"""What the simulator of data snooping shows is true."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from graphos_didactic.simulator import find_simulator
from graphos_didactic.simulators.adjustment.snooping_model import Snooping
from graphos_didactic.simulators.adjustment.snooping_params import SnoopingParams

DRAWS = 100
CLEAN = SnoopingParams(a_x=0.0, a_y=0.0, alpha=0.05)


def own(params: SnoopingParams) -> tuple[Snooping, int]:
    block = Snooping(params)
    i = block.result.find(params.a_photo, params.a_point)
    assert i is not None
    return block, i


def test_good_observations_are_accused_as_often_as_alpha_says() -> None:
    hits = [own(CLEAN.replace(seed=seed)) for seed in range(DRAWS)]
    accused = sum(abs(block.result.values[i, 0]) > block.result.limit for block, i in hits)
    assert stats.binom.ppf(0.0005, DRAWS, 0.05) <= accused <= stats.binom.ppf(0.9995, DRAWS, 0.05)


def test_a_minimal_detectable_blunder_is_found_with_the_power() -> None:
    block, i = own(CLEAN)
    size = float(block.result.reliability.mdb_px[i, 0])
    found = [own(CLEAN.replace(seed=seed, a_x=size)) for seed in range(DRAWS)]
    share = sum(abs(b.result.values[k, 0]) > b.result.limit for b, k in found)
    assert stats.binom.ppf(0.0005, DRAWS, 0.8) <= share <= stats.binom.ppf(0.9995, DRAWS, 0.8)


def test_the_residual_shows_the_share_r_of_a_blunder() -> None:
    before, i = own(CLEAN)
    after, _ = own(CLEAN.replace(a_x=1.0))
    shown = before.result.adjustment.residuals[i, 0] - after.result.adjustment.residuals[i, 0]
    assert shown == pytest.approx(before.result.reliability.redundancy[i, 0], rel=0.02)


def test_redundancy_numbers_add_up() -> None:
    for photos in (2, 3, 4):
        found = Snooping(CLEAN.replace(photos=photos)).result
        assert found.reliability.redundancy.sum() == pytest.approx(found.adjustment.redundancy)


def test_a_single_blunder_is_removed_and_the_point_comes_back() -> None:
    block = Snooping(SnoopingParams(photos=4, a_x=12.0, removed=3))
    assert block.dropped == [(2, 5)]
    assert not block.result.accused.any()
    assert (
        np.abs(block.errors).max() < 0.5 * np.abs(Snooping(SnoopingParams(photos=4, a_x=12.0)).errors).max()
    )


def test_two_blunders_hide_each_other_though_the_point_is_far_off() -> None:
    simulator = find_simulator("adjustment/snooping")
    params = simulator.preset("masked")
    assert isinstance(params, SnoopingParams)
    block = Snooping(params)
    assert not block.result.accused.any()
    assert min(block.size("a"), block.size("b")) > 10 * params.sigma_px
    clean = Snooping(params.replace(a_x=0.0, a_y=0.0, b_x=0.0, b_y=0.0))
    assert np.abs(block.errors).max() > 3 * np.abs(clean.errors).max()


def test_two_blunders_accuse_an_innocent_observation() -> None:
    simulator = find_simulator("adjustment/snooping")
    assert "wrongly" in simulator.scene(simulator.preset("swamped")).says


def test_two_photos_do_not_control_the_epipolar_line() -> None:
    block, i = own(SnoopingParams(photos=2, a_x=12.0, a_y=0.0))
    assert block.result.reliability.redundancy[i, 0] < 0.01
    assert not block.result.accused.any()
