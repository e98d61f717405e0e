"""Does the bundle adjustment converge wherever Ceres does? Bad starts, gross outliers, points behind cameras.

Run: ``python benchmarks/bundle_robustness.py [--seeds N]``

Small aerial blocks with 5 % gross outliers (up to a quarter of the format), a share of the points put behind cameras,
and starts disturbed more and more; the same Cauchy loss of 2 px, the same unknowns and start for both programs. A run
succeeds when the projection centres, after a similarity, are within 3 standard errors of those of a clean start.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
import pyceres
import pycolmap
from bundle_adjustment import aerial_block, reconstruction_of

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.data import Array, Block
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.geometry.similarity import estimate_similarity

PHOTOS, POINTS, OUTLIERS, BEHIND = 12, 900, 0.05, 0.02
FREE = Freedom(interior=(("focal_px", "k1", "k2"),))
LEVELS = (1.0, 4.0, 16.0, 32.0, 64.0)
"""Disturbance: this many metres of centres and points, and this many times 0.01 rad of attitudes (flying height 100 m)."""


def spoiled(level: float, seed: int) -> tuple[Block, Block]:
    """Return a good start of the block with outliers, and the bad one."""
    rng = np.random.default_rng(seed)
    block = aerial_block(PHOTOS, POINTS, seed)
    xy = np.array(block.obs_xy)
    wrong = rng.random(len(xy)) < OUTLIERS
    xy[wrong] += rng.uniform(-1500.0, 1500.0, (int(wrong.sum()), 2))
    good = replace(block, obs_xy=xy)
    points = block.points + rng.normal(0.0, level, block.points.shape)
    behind = rng.random(len(points)) < BEHIND
    points[behind, 2] += 2.5 * (block.centres[:, 2].mean() - points[behind, 2])
    rotations = [matrix_from_vector(rng.normal(0.0, 0.01 * level, 3)) @ r for r in block.rotations]
    centres = block.centres + rng.normal(0.0, level, block.centres.shape)
    return good, replace(good, points=points, rotations=np.stack(rotations), centres=centres)


def ours(block: Block) -> Array:
    """Centres by our adjustment."""
    options = Options(robust="cauchy", scale_px=2.0, max_iterations=200, tolerance=1e-10, statistics=False)
    return adjust_block(block, FREE, options).block.centres


def theirs(block: Block) -> Array:
    """Centres by pyceres."""
    made = reconstruction_of(block)
    options = pycolmap.BundleAdjustmentOptions()
    options.ceres.loss_function_type = pycolmap.LossFunctionType.CAUCHY
    options.ceres.loss_function_scale = 2.0
    config = pycolmap.BundleAdjustmentConfig()
    for i in range(len(block.names)):
        config.add_image(i + 1)
    settings = pyceres.SolverOptions()
    settings.linear_solver_type = pyceres.LinearSolverType.DENSE_SCHUR
    settings.max_num_iterations = 200
    settings.function_tolerance = 1e-10
    settings.gradient_tolerance = settings.parameter_tolerance = 1e-14
    settings.logging_type = pyceres.LoggingType.SILENT
    problem = pycolmap.create_default_ceres_bundle_adjuster(options, config, made).problem
    pyceres.solve(settings, problem, pyceres.SolverSummary())
    return np.array([made.image(i + 1).projection_center() for i in range(len(block.names))])


def miss(found: Array, truth: Array) -> float:
    """RMS of the centres after a similarity, m."""
    rest = estimate_similarity(found, truth).apply(found) - truth
    return float(np.sqrt((rest**2).mean()))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20)
    seeds = parser.parse_args().seeds
    print(f"{'disturbance m':>14} {'ours':>10} {'pyceres':>10} {'only pyceres':>14}")
    for level in LEVELS:
        good = [0, 0, 0]
        for seed in range(seeds):
            start, bad = spoiled(level, seed)
            best = ours(start)
            limit = (
                0.02  # about three standard errors of a centre: 0.5 px at 100 m and f = 5000 px, strong ties
            )
            mine, other = miss(ours(bad), best) < limit, miss(theirs(bad), best) < limit
            good = [good[0] + mine, good[1] + other, good[2] + (other and not mine)]
        print(f"{level:14.0f} {good[0]:6d}/{seeds} {good[1]:7d}/{seeds} {good[2]:14d}", flush=True)


if __name__ == "__main__":
    main()
