"""Statistics recover the parameters of injected errors."""

from __future__ import annotations

import numpy as np

from graphos_core.quality.statistics import DEFINITIONS, distance_statistics


def test_normal_noise_gives_back_its_parameters() -> None:
    d = np.random.default_rng(1).normal(0.3, 2.0, 200_000)
    found = distance_statistics(d)
    tolerance = 4 * 2.0 / np.sqrt(len(d))
    assert abs(found["mean"] - 0.3) < tolerance
    assert abs(found["median"] - 0.3) < 1.3 * tolerance
    assert abs(found["std"] - 2.0) < tolerance
    assert abs(found["nmad"] - 2.0) < 2 * tolerance
    assert abs(found["rmse"] - np.hypot(0.3, 2.0)) < tolerance
    assert found.keys() == DEFINITIONS.keys()


def test_quantiles_of_centred_noise_are_those_of_the_normal_distribution() -> None:
    found = distance_statistics(np.random.default_rng(2).normal(0.0, 1.0, 200_000))
    assert abs(found["q68"] - 1.0006) < 0.02
    assert abs(found["q95"] - 1.95996) < 0.03


def test_nmad_hardly_moves_under_outliers_and_unknown_distances_do_not_count() -> None:
    d = np.random.default_rng(3).normal(0.0, 1.0, 20_000)
    d[:1000] = 500.0
    d[1000:1500] = np.nan
    found = distance_statistics(d)
    assert found["count"] == 19_500
    assert found["std"] > 50.0
    assert abs(found["nmad"] - 1.0) < 0.1


def test_no_distances_give_no_numbers() -> None:
    found = distance_statistics(np.empty(0))
    assert found["count"] == 0
    assert np.isnan(found["rmse"])
