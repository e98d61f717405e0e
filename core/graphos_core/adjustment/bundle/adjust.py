"""Adjust a block: the one function behind the bundle adjustment, refinement of poses, and every test of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from graphos_core.adjustment.bundle import gauss_newton, levenberg_marquardt, powell, result_kernels
from graphos_core.adjustment.bundle.covariance import cofactors
from graphos_core.adjustment.bundle.datum import DatumKind
from graphos_core.adjustment.bundle.hidden import without_hidden
from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.known.group import Group
from graphos_core.adjustment.bundle.levenberg_marquardt import Solution
from graphos_core.adjustment.bundle.outcome import outcome
from graphos_core.adjustment.bundle.problem import Freedom, make_problem
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.adjustment.bundle.robust import ROBUST, Robust
from graphos_core.adjustment.statistics.reliability import non_centrality
from graphos_core.data import Adjustment, Array, Block
from graphos_core.run import Run

Method = Literal["levenberg-marquardt", "gauss-newton", "powell"]

METHODS: dict[str, Callable[..., Solution]] = {
    "levenberg-marquardt": levenberg_marquardt.minimise,
    "gauss-newton": gauss_newton.minimise,
    "powell": powell.minimise,
}
"""The minimisers; all have the signature of `levenberg_marquardt.minimise` and a comparable trace."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """How a block is adjusted.

    Attributes
    ----------
    robust : str
        Name of the robust function of the length of a residual vector, see `graphos_core.adjustment.bundle.robust`.
    scale_px : float
        Length from which it takes effect: px for observations with an a priori standard deviation of 1 px, in general
        multiples of the a priori standard deviation.
    method : {"levenberg-marquardt", "gauss-newton", "powell"}
        How the cost is minimised.
    max_iterations : int
    tolerance : float
        Converged when the cost can fall by less than this share of itself.
    statistics : bool
        False leaves out all standard deviations (they are NaN then, `Camera.sigmas` None): for repeated calls.
    reliability : bool
        Whether redundancy numbers, tests and minimal detectable biases of every observation are computed too.
    alpha, power : float
        Error probability of the tests, and power at which a minimal detectable bias is found.
    datum : {"inner", "minimal"}
        How free motions of the whole block are fixed for the standard deviations.
    guard : bool
        True drops observations that lie behind their camera in the end; False projects them through the projection
        centre, for comparison with programs that do so.
    """

    robust: Robust = "none"
    scale_px: float = 1.0
    method: Method = "levenberg-marquardt"
    max_iterations: int = 50
    tolerance: float = 1e-8
    statistics: bool = True
    reliability: bool = False
    alpha: float = 0.001
    power: float = 0.8
    datum: DatumKind = "inner"
    guard: bool = True


def adjust_block(
    block: Block,
    freedom: Freedom | None = None,
    options: Options | None = None,
    groups: Sequence[Group] = (),
    *,
    run: Run | None = None,
) -> Adjustment:
    """Adjust exterior orientations, object points and free camera parameters by least squares.

    Observations of photos that are not oriented, second observations of a point in one photo, and points with a
    single ray (unless held fixed or concerned by other observations) are left out; the adjusted block is without them
    and without the points that lose all observations (`Block.point_track` tells which remain). With all points held
    fixed this refines poses only.

    Parameters
    ----------
    block : Block
        With approximate values; `Block.obs_sigma_px` weights its observations.
    freedom : Freedom, optional
        What is free; without it all exterior orientations and points are, and all cameras are fixed.
    options : Options, optional
    groups : sequence of Group
        Observations beside image points, see `graphos_core.adjustment.bundle.known`.
    run : Run, optional
        Is shown an `IterationRecord` per iteration under ``"iteration"`` and asked whether to stop.

    Returns
    -------
    Adjustment

    Raises
    ------
    UserError
        When nothing can be adjusted, or a free camera parameter does not exist.
    Stopped
        When the person asked to stop.
    """
    freedom, options, run = freedom or Freedom(), options or Options(), run or Run()
    problem = make_problem(block, freedom, groups)
    rules = Rules(ROBUST[options.robust].code, float(options.scale_px), options.guard)
    system = ReducedSystem(problem, rules, run.threads)
    with system.working():
        solution = METHODS[options.method](system, options.max_iterations, options.tolerance, run=run)
        misfit = residuals_of(system, solution)
    if np.isnan(misfit[0]).any():
        problem, solution, keep = without_hidden(problem, freedom, solution, misfit[0])
        system = ReducedSystem(problem, rules, run.threads)
        misfit = misfit[0][keep], misfit[1][keep]
    found = None
    if options.statistics:
        delta0 = non_centrality(options.alpha, options.power) if options.reliability else -1.0
        with system.working():
            found = cofactors(system, solution.scene, options.datum, delta0)
    levels, robust = (options.alpha, options.power), (options.robust, options.scale_px)
    return outcome(problem, solution, misfit, found, levels, robust, run)


def residuals_of(system: ReducedSystem, solution: Solution) -> tuple[Array, Array]:
    """Return residuals (m, 2), projected − measured in px, and robust weights (m,), in the order of the block."""
    problem = system.problem
    m = len(problem.observation)
    sorted_residuals, sorted_weights = np.empty((m, 2)), np.empty(m)

    def one(chunk: int) -> None:
        span = problem.chunks[chunk]
        result_kernels.residuals(
            solution.scene, problem.layout, system.rules, span, sorted_residuals, sorted_weights
        )

    system.each_chunk(one)
    residuals, weights = np.empty((m, 2)), np.empty(m)
    residuals[problem.observation] = sorted_residuals
    weights[problem.observation] = sorted_weights
    return residuals, weights
