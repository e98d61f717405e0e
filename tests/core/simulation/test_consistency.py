"""Errors agree with the covariance that predicts them: a few seeds of what the benchmark does with two hundred."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from graphos_core.simulation.consistency import KINDS, Weighted, adjusted, simulate, total, weighted_errors

SEEDS = range(4)


@pytest.mark.parametrize(
    ("model", "kinds"),
    [
        ("basic", ("control",)),
        ("complete", ("control",)),
        ("ebner", ("control",)),
        ("fisheye_equisolid", ("control",)),
        ("basic", ("control", "positions", "attitudes")),
        ("basic", KINDS),
    ],
)
def test_errors_are_as_large_as_the_covariance_says(model: str, kinds: tuple[str, ...]) -> None:
    parts: list[Weighted] = []
    for seed in SEEDS:
        case = simulate(model, kinds, seed)
        found = adjusted(case)
        assert sum(group.redundancy for group in found.groups) == pytest.approx(found.redundancy, abs=1e-4)
        parts += weighted_errors(case, found)
    for name, part in total(parts).items():
        low, high = stats.chi2.ppf([5e-4, 1 - 5e-4], part.freedom)
        assert low < part.statistic < high, (name, part.ratio)


def test_false_alarms_come_at_the_chosen_rate_and_detectable_biases_are_found() -> None:
    alarms = count = found = 0
    for seed in SEEDS:
        case = simulate("basic", ("control",), seed)
        checked = adjusted(case).reliability
        assert checked is not None
        w = np.abs(checked.standardised)
        alarms, count = alarms + int((w > stats.norm.isf(0.025)).sum()), count + w.size
        rng = np.random.default_rng(seed)
        o = int(rng.integers(len(w)))
        twice = 2.0 * float(checked.mdb_px[o, 0])
        spoiled = adjusted(case, bias=(o, 0, twice)).reliability
        assert spoiled is not None
        found += int(np.abs(spoiled.standardised[o, 0]) > spoiled.critical)
    low, high = stats.binom.ppf([1e-3, 1 - 1e-3], count, 0.05)
    assert low < alarms < high
    assert found == len(SEEDS)
