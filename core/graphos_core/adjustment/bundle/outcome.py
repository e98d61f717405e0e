"""From the solution of a problem to the record of the adjustment: figures, standard deviations, groups, reliability."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.adjustment.bundle import datum
from graphos_core.adjustment.bundle.covariance import Cofactors
from graphos_core.adjustment.bundle.known import assembly
from graphos_core.adjustment.bundle.known.build import is_measured
from graphos_core.adjustment.bundle.levenberg_marquardt import Solution
from graphos_core.adjustment.bundle.problem import Problem
from graphos_core.adjustment.bundle.robust import consistency
from graphos_core.adjustment.statistics.groups import image_group, other_groups
from graphos_core.adjustment.statistics.reliability import global_test, non_centrality, reliability
from graphos_core.data import (
    Adjustment,
    Array,
    Camera,
    Covariance,
    ExtraUnknown,
    ObservationGroup,
    Reliability,
)
from graphos_core.run import Run
from graphos_core.text import Text


def outcome(
    problem: Problem,
    solution: Solution,
    misfit: tuple[Array, Array],
    found: Cofactors | None,
    levels: tuple[float, float],
    robust: tuple[str, float],
    run: Run,
) -> Adjustment:
    """Return the record of an adjustment.

    Parameters
    ----------
    problem : Problem
    solution : Solution
    misfit : tuple of float64 (m, 2), float64 (m,)
        Residuals in px and robust weights, in the order of the block.
    found : Cofactors or None
    levels : tuple of float
        Error probability and power of the tests.
    robust : tuple of str, float
        Name and scale of the robust function.
    run : Run
        Is warned when there is no redundancy, or more than the datum is undetermined.
    """
    residuals, weights = misfit
    block, scene = problem.to_block(solution.scene), solution.scene
    sigma = np.ones(len(residuals)) if block.obs_sigma_px is None else np.asarray(block.obs_sigma_px)
    others = assembly.linearise(problem, scene)
    defect = datum.defect(problem, scene) if found is None else found.defect
    observations = 2 * len(residuals) + (0 if others is None else len(others.residuals))
    unknowns = problem.unknowns + 3 * problem.free_points
    redundancy = observations - unknowns + defect
    images = float((weights * (residuals**2).sum(axis=1) / sigma**2).sum())
    rest = 0.0 if others is None else 2.0 * others.cost
    kept, loss = consistency(*robust, (images + rest) / max(redundancy, 1))
    squares = images / kept + rest
    sigma0 = _sigma0(squares, redundancy, observations, unknowns, run)
    if found is not None and found.singular:
        run.warn(Text("The normal equations are singular beyond the datum: some unknowns cannot be determined, "
                      "and their standard deviations cannot be trusted."))  # fmt: skip
    spread = sigma0 * float(np.sqrt(loss))
    covariance = None if found is None else _covariance(problem, found, spread)
    cameras = tuple(
        _calibrated(camera, None if covariance is None else _root(covariance.cameras[c]), problem, c)
        for c, camera in enumerate(block.cameras)
    )
    sigma_rotations, sigma_centres, sigma_points = _sigmas(problem, covariance)
    prior = float(sigma.min()) if len(sigma) else 1.0
    checked = None
    if found is not None and found.redundancy is not None and found.effect is not None:
        checked = reliability(
            residuals,
            sigma,
            _in_block_order(problem, found.redundancy),
            _in_block_order(problem, found.effect),
            sigma0,
            *levels,
        )
    return Adjustment(
        block=replace(block, cameras=cameras), sigma0=sigma0, sigma0_px=sigma0 * prior, prior_px=prior,
        redundancy=redundancy, observations=observations, unknowns=unknowns,
        datum=datum.describe(problem, defect) if found is None else found.datum,
        rms_px=float(np.sqrt((residuals**2).mean())), residuals=residuals, weights=weights,
        sigma_rotations=sigma_rotations, sigma_centres=sigma_centres, sigma_points=sigma_points,
        iterations=solution.iterations, converged=solution.converged, stop_reason=solution.reason,
        groups=_groups(problem, (residuals, weights / kept), sigma, others, found, checked, levels), covariance=covariance,
        reliability=checked,
        global_test=None if found is None else global_test(squares, redundancy, 0.05),
        extras=_extras(problem, scene.extra, found, spread), findings=() if found is None else found.findings,
    )  # fmt: skip


def _sigma0(squares: float, redundancy: int, observations: int, unknowns: int, run: Run) -> float:
    if redundancy > 0:
        return float(np.sqrt(squares / redundancy))
    run.warn(Text(
        "The block has no redundancy ({observations} observations, {unknowns} unknowns): sigma0 cannot be "
        "computed and is taken as 1.", observations=observations, unknowns=unknowns,
    ))  # fmt: skip
    return 1.0


def _in_block_order(problem: Problem, values: Array) -> Array:
    out = np.empty_like(values)
    out[problem.observation] = values
    return out


def _groups(
    problem: Problem, misfit: tuple[Array, Array], sigma: Array, others: assembly.Linear | None,
    found: Cofactors | None, checked: Reliability | None, levels: tuple[float, float],
) -> tuple[ObservationGroup, ...]:  # fmt: skip
    residuals, weights = misfit
    named = np.zeros(len(problem.order), dtype=bool)
    named[problem.order] = (problem.layout.point_column >= 0) | problem.fixed
    mine = (named | is_measured(problem.block))[np.asarray(problem.block.obs_point)]
    out = []
    for kind, part in (("tie points", ~mine), ("control image points", mine)):
        if part.any():
            numbers = None if checked is None else checked.redundancy[part]
            out.append(image_group(kind, residuals[part], weights[part], sigma[part], numbers))
    if others is not None:
        reduced = None if found is None or checked is None else found.reduced
        out += other_groups(problem.groups, others, reduced, non_centrality(*levels))
    return tuple(out)


def _calibrated(camera: Camera, sigmas: Array | None, problem: Problem, index: int) -> Camera:
    layout = problem.layout
    known = replace(camera, sigmas=sigmas)
    if 0 not in layout.free_index[index, : layout.free_count[index]]:
        return known
    return replace(known, focal_estimated=False, focal_source="bundle adjustment")


def _root(covariance: Array) -> Array:
    return np.sqrt(np.maximum(covariance.diagonal(), 0.0))


def _covariance(problem: Problem, found: Cofactors, sigma0: float) -> Covariance:
    layout, n = problem.layout, len(problem.layout.pose)
    scale = max(sigma0**2, float(np.finfo(float).tiny))  # 0 · ∞ of undetermined points is not a number
    cameras = [np.zeros((len(camera.values), len(camera.values))) for camera in problem.block.cameras]
    photos = np.zeros((n, 6, 6))
    for i in np.flatnonzero(layout.width > 0):
        column, pose, c = layout.photo_column[i], layout.pose[i], layout.camera[i]
        if pose:
            photos[i] = scale * found.reduced[column : column + 6, column : column + 6]
        own = layout.width[i] - pose
        if own:
            _put(cameras[c], layout.free_index[c, :own], scale * _block(found.reduced, column + pose, own))
    for c in np.flatnonzero(layout.camera_column >= 0):
        free = layout.free_count[c]
        part = scale * _block(found.reduced, layout.camera_column[c], free)
        _put(cameras[c], layout.free_index[c, :free], part)
    points = np.empty((len(problem.order), 3, 3))
    points[problem.order] = scale * found.points
    return Covariance(cameras=tuple(cameras), photos=photos, points=points)


def _block(matrix: Array, first: int, size: int) -> Array:
    return np.asarray(matrix[first : first + size, first : first + size])


def _put(target: Array, index: Array, block: Array) -> None:
    target[np.ix_(index, index)] = block


def _sigmas(problem: Problem, covariance: Covariance | None) -> tuple[Array, Array, Array]:
    """Return standard deviations of rotations (n, 3), centres (n, 3) and points (p, 3); NaN where not computed."""
    n, p = len(problem.layout.pose), len(problem.order)
    if covariance is None:
        return np.full((n, 3), np.nan), np.full((n, 3), np.nan), np.full((p, 3), np.nan)
    photos = np.sqrt(np.maximum(np.einsum("nii->ni", covariance.photos), 0.0))
    points = np.sqrt(np.maximum(np.einsum("pii->pi", covariance.points), 0.0))
    return photos[:, :3], photos[:, 3:], points


def _extras(
    problem: Problem, values: Array, found: Cofactors | None, sigma0: float
) -> tuple[ExtraUnknown, ...]:
    declared = [extra for group in problem.groups for extra in group.extras]
    first = problem.unknowns - len(values)
    out = []
    for i, (extra, value) in enumerate(zip(declared, values, strict=True)):
        variance = np.nan if found is None else found.reduced[first + i, first + i]
        out.append(ExtraUnknown(
            name=extra.name, value=float(value), sigma=float(sigma0 * np.sqrt(max(variance, 0.0))), unit=extra.unit,
        ))  # fmt: skip
    return tuple(out)
