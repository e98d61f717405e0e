"""Adjust a block: the one function behind the bundle adjustment, refinement of poses, and every test of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from graphos_core.adjustment.bundle import datum, kernels, result_kernels
from graphos_core.adjustment.bundle.covariance import Cofactors, cofactors
from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.levenberg_marquardt import Solution, minimise
from graphos_core.adjustment.bundle.problem import Freedom, Problem, make_problem, select, usable
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.data import Adjustment, Array, Block, Camera
from graphos_core.run import Run
from graphos_core.text import Text

Robust = Literal["none", "huber", "cauchy"]
CODES: dict[str, int] = {"none": kernels.NONE, "huber": kernels.HUBER, "cauchy": kernels.CAUCHY}


@dataclass(frozen=True, kw_only=True)
class Options:
    """How a block is adjusted.

    Attributes
    ----------
    robust : {"none", "huber", "cauchy"}
        Robust function of the length of a residual vector.
    scale_px : float
        Length from which it takes effect, px.
    max_iterations : int
    tolerance : float
        Converged when the cost can fall by less than this share of itself.
    statistics : bool
        False leaves out all standard deviations (they are NaN then, `Camera.sigmas` None): for repeated calls.
    guard : bool
        True drops observations that lie behind their camera in the end; False projects them through the projection
        centre, for comparison with programs that do so.
    """

    robust: Robust = "none"
    scale_px: float = 1.0
    max_iterations: int = 50
    tolerance: float = 1e-8
    statistics: bool = True
    guard: bool = True


def adjust_block(
    block: Block, freedom: Freedom | None = None, options: Options | None = None, *, run: Run | None = None
) -> Adjustment:
    """Adjust exterior orientations, object points and free camera parameters by least squares.

    Observations of photos that are not oriented, second observations of a point in one photo, and points with a
    single ray (unless held fixed) are left out; the adjusted block is without them and without the points that lose
    all observations (`Block.point_track` tells which remain). With all points held fixed this refines poses only.

    Parameters
    ----------
    block : Block
        With approximate values.
    freedom : Freedom, optional
        What is free; without it all exterior orientations and points are, and all cameras are fixed.
    options : Options, optional
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
    problem = make_problem(block, freedom)
    rules = Rules(CODES[options.robust], float(options.scale_px), options.guard)
    system = ReducedSystem(problem, rules, run.threads)
    with system.working():
        solution = minimise(system, options.max_iterations, options.tolerance, run=run)
    misfit = residuals_of(problem, solution, rules)
    if np.isnan(misfit[0]).any():
        problem, solution = _without_hidden(problem, freedom, solution, misfit[0])
        system = ReducedSystem(problem, rules, run.threads)
        misfit = residuals_of(problem, solution, rules)
    found = None
    if options.statistics:
        with system.working():
            found = cofactors(system, solution.scene)
    return _result(problem, solution, misfit, found, run)


def residuals_of(problem: Problem, solution: Solution, rules: Rules) -> tuple[Array, Array]:
    """Return residuals (m, 2), projected − measured in px, and robust weights (m,), in the order of the block."""
    m = len(problem.observation)
    sorted_residuals, sorted_weights = np.empty((m, 2)), np.empty(m)
    result_kernels.residuals(solution.scene, problem.layout, rules, sorted_residuals, sorted_weights)
    residuals, weights = np.empty((m, 2)), np.empty(m)
    residuals[problem.observation] = sorted_residuals
    weights[problem.observation] = sorted_weights
    return residuals, weights


def _without_hidden(
    problem: Problem, freedom: Freedom, solution: Solution, residuals: Array
) -> tuple[Problem, Solution]:
    """Drop the observations that ended behind their cameras; they had no weight, so the solution stays."""
    block, fixed = problem.to_block(solution.scene), problem.fixed_points
    keep: Array = np.asarray(np.isfinite(residuals).all(axis=1))
    keep[keep] = usable(replace(block, obs_photo=block.obs_photo[keep], obs_point=block.obs_point[keep],
                                obs_xy=block.obs_xy[keep]), fixed)  # fmt: skip
    smaller, points = select(block, keep)
    left = make_problem(smaller, replace(freedom, fixed_points=fixed[points]))
    return left, replace(solution, scene=left.scene)


def _result(
    problem: Problem, solution: Solution, misfit: tuple[Array, Array], found: Cofactors | None, run: Run
) -> Adjustment:
    residuals, weights = misfit
    defect = datum.free_motions(problem, solution.scene).shape[1]
    observations = 2 * len(residuals)
    unknowns = problem.unknowns + 3 * problem.free_points
    redundancy = observations - unknowns + defect
    squares = float((weights * (residuals**2).sum(axis=1)).sum())
    if redundancy > 0:
        sigma0 = float(np.sqrt(squares / redundancy))
    else:
        sigma0 = 1.0
        run.warn(Text(
            "The block has no redundancy ({observations} observations, {unknowns} unknowns): sigma0 cannot be "
            "computed and is taken as 1 px.", observations=observations, unknowns=unknowns,
        ))  # fmt: skip
    block = problem.to_block(solution.scene)
    sigma_rotations, sigma_centres, sigma_points, interior = _sigmas(problem, found, sigma0)
    if found is not None and found.singular:
        run.warn(Text("The normal equations are singular beyond the datum: some unknowns cannot be determined, "
                      "and their standard deviations cannot be trusted."))  # fmt: skip
    cameras = tuple(
        _calibrated(camera, None if interior is None else interior[c], problem, c)
        for c, camera in enumerate(block.cameras)
    )
    return Adjustment(
        block=replace(block, cameras=cameras), sigma0_px=sigma0, redundancy=redundancy, observations=observations,
        unknowns=unknowns, datum=datum.describe(problem, defect), rms_px=float(np.sqrt((residuals**2).mean())),
        residuals=residuals, weights=weights, sigma_rotations=sigma_rotations, sigma_centres=sigma_centres,
        sigma_points=sigma_points, iterations=solution.iterations, converged=solution.converged,
        stop_reason=solution.reason,
    )  # fmt: skip


def _calibrated(camera: Camera, sigmas: Array | None, problem: Problem, index: int) -> Camera:
    layout = problem.layout
    known = replace(camera, sigmas=None if sigmas is None else sigmas[: len(camera.values)])
    if 0 not in layout.free_index[index, : layout.free_count[index]]:
        return known
    return replace(known, focal_estimated=False, focal_source="bundle adjustment")


def _sigmas(
    problem: Problem, found: Cofactors | None, sigma0: float
) -> tuple[Array, Array, Array, Array | None]:
    """Return standard deviations of rotations (n, 3), centres (n, 3), points (p, 3) and cameras (c, k)."""
    layout, n = problem.layout, len(problem.layout.pose)
    if found is None:
        return (
            np.full((n, 3), np.nan),
            np.full((n, 3), np.nan),
            np.full((len(problem.order), 3), np.nan),
            None,
        )
    sigma = sigma0 * np.sqrt(np.maximum(found.reduced.diagonal(), 0.0))
    rotations, centres, interior = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(layout.free_index.shape)
    for i in np.flatnonzero(layout.width > 0):
        column, pose = layout.photo_column[i], layout.pose[i]
        if pose:
            rotations[i], centres[i] = sigma[column : column + 3], sigma[column + 3 : column + 6]
        c, own = layout.camera[i], layout.width[i] - pose
        interior[c, layout.free_index[c, :own]] = sigma[column + pose : column + pose + own]
    for c in np.flatnonzero(layout.camera_column >= 0):
        column, free = layout.camera_column[c], layout.free_count[c]
        interior[c, layout.free_index[c, :free]] = sigma[column : column + free]
    points = np.empty((len(problem.order), 3))
    points[problem.order] = sigma0 * np.sqrt(np.maximum(np.einsum("pii->pi", found.points), 0.0))
    return rotations, centres, points, interior
