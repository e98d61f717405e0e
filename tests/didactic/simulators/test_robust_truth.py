"""What the simulator of robust weights shows is true."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares, minimize

from graphos_core.adjustment.bundle.robust import ROBUST
from graphos_didactic.simulator import drag, find_simulator
from graphos_didactic.simulators.adjustment.robust_model import RAYS, Bundle, mm
from graphos_didactic.simulators.adjustment.robust_params import RobustParams
from graphos_didactic.simulators.adjustment.robust_tasks import tolerance_mm


@pytest.mark.parametrize("name", ["huber", "cauchy"])
def test_the_estimate_is_that_of_scipy(name: str) -> None:
    params = RobustParams(function=name, scale=2.5, iterations=60, ray_2=-30.0)
    bundle = Bundle(params)

    def residuals(xz: np.ndarray) -> np.ndarray:
        return bundle.residuals(np.array([xz[0], 0.0, xz[1]])) / params.sigma_px

    found = least_squares(residuals, mm(bundle.least_squares) * 1e-3, loss=name, f_scale=2.5, xtol=1e-15)
    np.testing.assert_allclose(mm(bundle.robust.point), 1e3 * found.x, atol=0.02)


@pytest.mark.parametrize("name", [n for n in ROBUST if n != "l1"])
def test_the_reweighting_ends_in_the_lowest_place_of_its_valley(name: str) -> None:
    bundle = Bundle(RobustParams(function=name, scale=4.0, iterations=60))

    def cost(xz: np.ndarray) -> float:
        return bundle.fit(np.array([xz[0], 0.0, xz[1]]) * 1e-3, bundle.function).cost

    end = mm(bundle.robust.point)
    found = minimize(cost, end, method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-10})
    np.testing.assert_allclose(end, found.x, atol=0.02)
    assert bundle.robust.cost <= bundle.path[0].cost * (1 + 1e-12)


def test_without_blunders_the_errors_are_as_large_as_the_covariance_says() -> None:
    errors = np.array([mm(Bundle(RobustParams(seed=s, ray_7=0.0)).least_squares) for s in range(300)])
    largest = np.sqrt(np.linalg.eigvalsh(np.cov(errors.T)).max())
    assert tolerance_mm(RobustParams(ray_7=0.0)) == pytest.approx(3 * largest, rel=0.12)


def test_a_wrong_majority_breaks_every_function() -> None:
    simulator = find_simulator("adjustment/robust")
    params = simulator.preset("majority")
    for name in ROBUST:
        point = mm(Bundle(params.replace(function=name)).robust.point)  # type: ignore[arg-type]
        assert np.linalg.norm(point) > 30, name


def test_the_wrong_valley_is_left_by_a_start_from_samples() -> None:
    params = find_simulator("adjustment/robust").preset("valley")
    assert isinstance(params, RobustParams)
    assert np.linalg.norm(mm(Bundle(params).robust.point)) > 50
    assert np.linalg.norm(mm(Bundle(params.replace(start="ransac")).robust.point)) < 10


def test_a_ray_that_is_dragged_passes_where_it_was_dragged_to() -> None:
    simulator = find_simulator("adjustment/robust")
    for k in range(1, RAYS + 1):
        handle = next(h for h in simulator.scene(RobustParams()).handles if h.name == f"ray_{k}")
        goal = np.add(handle.at, (25.0, -5.0))
        moved = simulator.scene(drag(RobustParams(), handle, *goal))
        ray = next(m for m in moved.marks if (m.panel, m.thing) == ("zoom", f"ray_{k}") and hasattr(m, "xy"))
        along = np.diff(ray.xy, axis=0)[0]
        off = (goal - ray.xy[0]) @ [-along[1], along[0]] / np.linalg.norm(along)
        assert abs(off) < 0.5


def test_blunders_lose_their_weight_and_good_rays_keep_it() -> None:
    bundle = Bundle(RobustParams(function="danish", scale=4.0, ray_2=-35.0, ray_5=30.0, ray_7=40.0))
    assert (bundle.robust.weights[~bundle.good] < 1e-3).all()
    assert (bundle.robust.weights[bundle.good] == 1.0).all()
