"""Rival minimisers: the same minimum, comparable traces."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.powell import blended, quadratic_model
from graphos_core.adjustment.bundle.problem import Freedom, make_problem
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem

FREE = Freedom(interior=(("focal_px", "x0", "y0", "k1", "k2"),))


@pytest.mark.parametrize("method", ["gauss-newton", "powell"])
@pytest.mark.parametrize("fixed", [False, True])
def test_every_method_reaches_the_same_minimum(make_block, method: str, fixed: bool) -> None:
    made = make_block(points=120)
    freedom = FREE
    if fixed:
        points = np.zeros(len(made.truth.points), dtype=bool)
        points[:6] = True
        freedom = Freedom(interior=FREE.interior, fixed_points=points)
    reference = adjust_block(made.start, freedom, Options(tolerance=1e-13))
    other = adjust_block(made.start, freedom, Options(method=method, tolerance=1e-13))
    assert reference.converged and other.converged, (reference.stop_reason, other.stop_reason)
    assert other.iterations[-1].cost == pytest.approx(reference.iterations[-1].cost, rel=1e-8)
    assert len(other.iterations) < 15
    costs = [record.cost for record in other.iterations]
    assert all(b <= a for a, b in pairwise(costs))
    np.testing.assert_allclose(other.block.cameras[0].values, reference.block.cameras[0].values, rtol=1e-4)


@pytest.mark.parametrize("method", ["levenberg-marquardt", "gauss-newton", "powell"])
def test_a_far_start_is_left_downhill(make_block, method: str) -> None:
    made = make_block(points=120, shake=0.06)
    found = adjust_block(made.start, FREE, Options(method=method, max_iterations=100))
    costs = [record.cost for record in found.iterations]
    assert costs[-1] < 1e-2 * costs[0]
    assert all(b <= a * (1 + 1e-12) for a, b in pairwise(costs))


@pytest.mark.parametrize("shares", [(0.0, 1.0), (0.5, 0.0), (0.5, 0.8)])
def test_the_dogleg_model_predicts_what_a_blend_gains(make_block, shares: tuple[float, float]) -> None:
    """Close to the minimum the cost is quadratic; the second share is in units of the Cauchy step."""
    problem = make_problem(make_block(points=120, shake=1e-5).start, FREE)
    system = ReducedSystem(problem, Rules(0, 1.0, True), 1)
    with system.working():
        equations = system.build(problem.scene, 0.0)
        model = quadratic_model(system, equations)
        blend = shares[0], shares[1] * model.gd / model.curvature
        moved = blended(system, equations, model, blend)
    assert equations.cost - moved.cost == pytest.approx(model.predicted(*blend), rel=0.02)


@pytest.mark.parametrize("method", ["gauss-newton", "powell"])
def test_a_step_that_overshoots_is_shortened_and_the_minimum_still_reached(make_block, method: str) -> None:
    made = make_block(points=120, shake=0.25, seed=2)
    found = adjust_block(made.start, FREE, Options(method=method, max_iterations=60))
    shares = [record.damping for record in found.iterations[1:] if record.accepted]
    assert 0.0 < min(shares) < 1.0
    reference = adjust_block(made.truth, FREE, Options())
    noisy = adjust_block(replace(reference.block, obs_xy=made.start.obs_xy), FREE, Options())
    assert found.iterations[-1].cost == pytest.approx(noisy.iterations[-1].cost, rel=1e-6)


@pytest.mark.parametrize("method", ["levenberg-marquardt", "gauss-newton", "powell"])
def test_the_trace_tells_how_the_camera_moved(make_block, method: str) -> None:
    made = make_block(points=120)
    found = adjust_block(made.start, FREE, Options(method=method))
    assert np.array_equal(found.iterations[0].interior[0], made.start.cameras[0].values)
    assert np.array_equal(found.iterations[-1].interior[0], found.block.cameras[0].values)
