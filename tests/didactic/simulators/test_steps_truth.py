"""What the simulator of the adjustment step by step shows is true."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from graphos_core.adjustment.bundle.adjust import METHODS, Method, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.cameras import pixel_from_ray
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_didactic.simulators.adjustment.four_photos import CAMERA
from graphos_didactic.simulators.adjustment.steps_model import KNOWN, Iteration
from graphos_didactic.simulators.adjustment.steps_params import StepsParams


def misfit(run: Iteration, step: np.ndarray) -> np.ndarray:
    """Residuals over σ after a step of all unknowns, computed apart from the engine's adjustment."""
    layout, scene, u = run.problem.layout, run.scene, run.problem.unknowns
    points = scene.points.copy()
    points[layout.free_point] += step[u:].reshape(-1, 3)
    point = np.repeat(np.arange(len(points)), np.diff(layout.start))
    out = np.empty((len(layout.photo), 2))
    for o, (n, i) in enumerate(zip(layout.photo, point, strict=True)):
        turn, shift = step[6 * n : 6 * n + 3], step[6 * n + 3 : 6 * n + 6]
        ray = matrix_from_vector(turn) @ scene.rotations[n] @ (points[i] - scene.centres[n] - shift)
        out[o] = (pixel_from_ray(CAMERA, ray[None])[0] - layout.xy[o]) / run.params.sigma_px
    return out.ravel()


@pytest.mark.parametrize("iteration", [0, 2])
def test_the_jacobian_is_the_numerical_one(iteration: int) -> None:
    run = Iteration(StepsParams(iteration=iteration))
    zero = np.zeros(run.jacobian.shape[1])
    for column in (0, 1, 2, 3, 5, 8, 11, 23, 24, 30, 41):
        d = zero.copy()
        d[column] = 1e-6
        numeric = (misfit(run, d) - misfit(run, -d)) / 2e-6
        np.testing.assert_allclose(run.jacobian[:, column], numeric, rtol=1e-5, atol=1e-3)


def test_the_engines_reduced_matrix_is_the_schur_complement_of_the_normal_matrix() -> None:
    run = Iteration(StepsParams(iteration=1))
    u, n = run.problem.unknowns, run.normal
    schur = n[:u, :u] - n[:u, u:] @ np.linalg.solve(n[u:, u:], n[u:, :u])
    np.testing.assert_allclose(run.reduced, schur, atol=1e-10 * np.abs(schur).max())


def test_the_undamped_step_solves_the_whole_normal_equations() -> None:
    run = Iteration(StepsParams(iteration=1, damping=-6.0))
    assert run.mine is not None
    zero = np.zeros(run.jacobian.shape[1])
    full = np.linalg.solve(run.normal, -run.jacobian.T @ misfit(run, zero))
    np.testing.assert_allclose(run.mine.scene.centres[0] - run.scene.centres[0], full[3:6], atol=1e-3)


def test_the_iteration_ends_where_scipy_ends() -> None:
    run = Iteration(StepsParams(iteration=25, rough=0.2, turn=5.0))
    zero = np.zeros(run.jacobian.shape[1])
    found = least_squares(lambda step: misfit(run, step), zero)
    assert 0.5 * float(found.fun @ found.fun) == pytest.approx(run.cost, rel=1e-6)
    assert np.abs(found.x).max() < 1e-3


def test_it_is_the_adjustment_that_the_engine_would_make() -> None:
    run = Iteration(StepsParams(iteration=25))
    fixed = np.isin(np.arange(9), KNOWN)
    found = adjust_block(run.start, Freedom(fixed_points=fixed))
    np.testing.assert_allclose(run.problem.to_block(run.scene).points, found.block.points, atol=1e-6)
    assert len(found.iterations) == len(run.solution.iterations)


def test_a_refused_step_leaves_everything_where_it_is() -> None:
    run = Iteration(StepsParams(turn=90.0))
    refused = [r.iteration for r in run.solution.iterations if not r.accepted]
    assert refused
    for k in refused:
        assert run.scenes[k] is run.scenes[k - 1]


def test_upside_down_it_does_not_arrive() -> None:
    run = Iteration(StepsParams(turn=180.0, start_x=0.0, start_y=0.0, iteration=25))
    assert not run.solution.converged
    assert run.cost > 1e4


@pytest.mark.parametrize("method", ["levenberg-marquardt", "gauss-newton", "powell"])
def test_every_scene_has_the_cost_of_its_iteration(method: Method) -> None:
    for turn in (20.0, 90.0):
        run = Iteration(StepsParams(method=method, turn=turn))
        for k, record in enumerate(run.solution.iterations):
            shown = Iteration(run.params.replace(iteration=k))
            assert shown.cost == pytest.approx(record.cost, rel=1e-9), (turn, k)


def test_all_methods_end_in_the_same_minimum_from_a_good_start() -> None:
    ends = [Iteration(StepsParams(method=m, iteration=25, turn=5.0)).cost for m in METHODS]  # type: ignore[arg-type]
    assert ends == pytest.approx([ends[0]] * 3, rel=1e-6)
