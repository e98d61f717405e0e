import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import chi, norm

from graphos_core.features.robust_scores import (
    COSTS,
    DEGREES,
    QUANTILE,
    lmeds_cost,
    magsac_loss,
    magsac_weight,
    msac_cost,
    ransac_cost,
    robust_sigma,
)

THRESHOLD = 3.0


def test_the_quantile_is_that_of_the_chi_distribution() -> None:
    assert chi(DEGREES).ppf(0.99) == pytest.approx(QUANTILE, abs=0.005)


@pytest.mark.parametrize("residual", [0.2, 1.0, 2.0, 2.9])
def test_magsac_weight_is_the_density_marginalised_over_the_noise(residual: float) -> None:
    def marginal(r: float) -> float:
        # density of a residual of four degrees of freedom, truncated at k sigma, over sigma uniform in (0, t/k)
        return quad(
            lambda s: s**-4 * r**3 * np.exp(-(r**2) / (2 * s**2)), r / QUANTILE, THRESHOLD / QUANTILE
        )[0]

    near = 1e-3
    ratio = marginal(residual) / marginal(near)
    weights = magsac_weight(np.array([residual**2, near**2]), THRESHOLD)
    assert weights[0] / weights[1] == pytest.approx(ratio, rel=1e-4)


@pytest.mark.parametrize("residual", [0.3, 1.2, 2.5])
def test_magsac_loss_is_the_integral_of_weighted_residuals(residual: float) -> None:
    def up_to(end: float) -> float:
        return quad(lambda e: e * float(magsac_weight(np.array(e * e), THRESHOLD)), 0, end)[0]

    assert float(magsac_loss(np.array(residual**2), THRESHOLD)) == pytest.approx(
        up_to(residual) / up_to(THRESHOLD), rel=1e-6
    )


def test_costs_of_plain_numbers() -> None:
    squares = np.array([0.0, 1.0, 4.0, 9.01, 100.0])
    assert ransac_cost(squares, THRESHOLD) == 2
    assert msac_cost(squares, THRESHOLD) == pytest.approx((0 + 1 + 4 + 9 + 9) / 9)
    assert lmeds_cost(squares) == 4.0


@pytest.mark.parametrize("method", sorted(COSTS))
def test_many_models_are_scored_at_once_and_the_better_one_costs_less(method: str) -> None:
    rng = np.random.default_rng(0)
    good, bad = rng.normal(0, 0.5, 200) ** 2, rng.normal(0, 5.0, 200) ** 2
    cost = COSTS[method](np.stack([good, bad]), THRESHOLD)
    assert cost.shape == (2,) and cost[0] < cost[1]


def test_robust_sigma_finds_the_noise_among_forty_per_cent_of_outliers() -> None:
    rng = np.random.default_rng(1)
    clean = rng.normal(0, 0.7, 6000)
    assert robust_sigma(clean**2, 7) == pytest.approx(0.7, rel=0.04)
    mixed = np.r_[clean, rng.uniform(50, 100, 4000)]
    # the median of the mixture is the 5/6 quantile of the good ones: LMedS overestimates, but stays of their size
    assert robust_sigma(mixed**2, 7) == pytest.approx(0.7 * 1.4826 * norm.ppf(0.5 + 5 / 12), rel=0.05)


def test_the_tabulated_cost_is_the_loss() -> None:
    squares = np.random.default_rng(2).uniform(0, 1.3 * THRESHOLD, 500) ** 2
    assert COSTS["magsac"](squares, THRESHOLD) == pytest.approx(
        magsac_loss(squares, THRESHOLD).sum(), abs=1e-4
    )
