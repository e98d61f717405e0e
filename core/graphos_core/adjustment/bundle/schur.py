"""The bundle adjustment stage: self-calibration, robust weights, rejection of outliers, statistics."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from graphos_core.data import Adjustment, Array, Block
from graphos_core.errors import ItemFailure, UserError
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

FEWEST_OBSERVATIONS = 4
"""A photo with fewer observed points than this is not adjusted."""

SCALE_SIGMAS = 3.0
"""The automatic robust scale in units of the robust standard deviation: weights of good observations stay 1."""

MOST_ROUNDS = 15

ROUGH_TOLERANCE = 1e-4
"""Convergence limit of the rounds that only serve to find what is rejected next; the last adjustment is exact."""


class BundleParams(Params):
    """Parameters of the bundle adjustment."""

    calibration: Annotated[Literal["fixed", "basic"], About(
        label="Calibration",
        help="Whether the camera is calibrated by the photos themselves, or held as it is.",
        effect="Basic: principal distance, principal point and two radial coefficients are unknowns.",
        choices={"fixed": "Fixed", "basic": "Basic (f, x0, y0, k1, k2)"},
        learn="adjustment/self-calibration", level="novice", group="Self-calibration",
    )] = "basic"  # fmt: skip
    free_focal: Annotated[bool, About(
        label="Free principal distance", symbol="f",
        help="Whether the principal distance is an unknown of the self-calibration.",
        effect="On: needs photos that are rotated, convergent, or of a scene with depth.",
        learn="adjustment/self-calibration", group="Self-calibration",
    )] = True  # fmt: skip
    principal_point: Annotated[Literal["automatic", "free", "fixed"], About(
        label="Principal point", symbol="x_0, y_0",
        help="Whether the principal point is an unknown of the self-calibration.",
        effect="Automatic: free where photos are rolled against each other by at least 60°; without roll a shift of "
        "the principal point and a tilt of the photos are nearly the same thing. Free: always. Fixed: never.",
        choices={"automatic": "Automatic", "free": "Free", "fixed": "Fixed"},
        learn="adjustment/self-calibration", group="Self-calibration",
    )] = "automatic"  # fmt: skip
    free_k1: Annotated[bool, About(
        label="Free radial distortion 1", symbol="k_1",
        help="Whether the first radial coefficient is an unknown of the self-calibration.",
        effect="On: needs points up to the edges of the photos.",
        learn="adjustment/distortion", group="Self-calibration",
    )] = True  # fmt: skip
    free_k2: Annotated[bool, About(
        label="Free radial distortion 2", symbol="k_2",
        help="Whether the second radial coefficient is an unknown of the self-calibration.",
        effect="On: needs points in the corners of the photos; strongly correlated with the first.",
        learn="adjustment/distortion", group="Self-calibration",
    )] = True  # fmt: skip
    per_photo: Annotated[bool, About(
        label="One calibration per photo",
        help="Whether every photo has a calibration of its own, as with a zoom lens that moved.",
        effect="On: many more unknowns; weak for blocks with few points per photo.",
        level="expert", group="Self-calibration",
    )] = False  # fmt: skip
    robust: Annotated[Literal["none", "huber", "cauchy"], About(
        label="Robust function",
        help="How observations with large residuals lose weight.",
        effect="None: all count the same. Huber: mild. Cauchy: strong, large residuals hardly count.",
        choices={"none": "None", "huber": "Huber", "cauchy": "Cauchy"},
        learn="adjustment/robust", group="Outliers",
    )] = "huber"  # fmt: skip
    robust_scale_px: Annotated[float | None, About(
        label="Robust scale", symbol="c", unit="px", low=0, low_open=True, high=1000, step=0.5,
        help="Length of a residual from which its weight falls; empty: three times their standard deviation.",
        effect="Higher: fewer observations lose weight.",
        learn="adjustment/robust", level="expert", group="Outliers",
    )] = None  # fmt: skip
    rejection: Annotated[float | None, About(
        label="Rejection limit", symbol="q", unit="σ", low=2.5, high=100, step=0.5,
        help="Observations with residuals longer than this many standard deviations are removed; empty: none is.",
        effect="Higher: more observations are kept, also wrong ones.",
        learn="adjustment/robust", group="Outliers",
    )] = 4.0  # fmt: skip
    max_iterations: Annotated[int, About(
        label="Largest number of iterations", low=1, high=10000, step=10,
        help="When the adjustment stops even if it has not converged.",
        effect="Higher: a bad start has more time to converge.", level="expert", group="Iteration",
    )] = 100  # fmt: skip
    tolerance: Annotated[float, About(
        label="Convergence limit", low=1e-15, high=0.1,
        help="The adjustment has converged when the sum of squares can fall by less than this share of itself.",
        effect="Lower: more iterations, more digits.", level="expert", group="Iteration",
    )] = 1e-8  # fmt: skip


@algorithm(
    stage="adjustment", role="bundle", name="schur",
    label="Bundle adjustment (Schur complement, Levenberg–Marquardt)",
    source="Triggs, McLauchlan, Hartley, Fitzgibbon 2000, sections 4 and 6; Marquardt 1963; Nielsen 1999",
    learn="adjustment/bundle",
)  # fmt: skip
def adjust(block: Block, params: BundleParams, *, run: Run) -> Adjustment:
    """Adjust orientations, object points and the camera together by least squares.

    Rounds of adjustment and rejection follow each other until no observation is longer than ``rejection`` robust
    standard deviations; standard deviations are computed in the end.

    Raises
    ------
    UserError
        When no two oriented photos share enough points.
    Stopped
        When the person asked to stop.
    """
    from graphos_core.adjustment.bundle.adjust import Options, adjust_block
    from graphos_core.adjustment.bundle.problem import Freedom
    from graphos_core.adjustment.bundle.self_calibration import (
        free_parameters,
        prepare,
        warn_of_weak_parameters,
    )

    block = _without_weak_photos(prepare(block, params.calibration, per_photo=params.per_photo))
    freedom = Freedom(interior=free_parameters(block, params, run))
    options = Options(
        robust=params.robust,
        max_iterations=params.max_iterations,
        tolerance=params.tolerance,
        statistics=False,
    )
    rough = replace(options, tolerance=max(params.tolerance, ROUGH_TOLERANCE))
    automatic = params.robust_scale_px is None
    start = adjust_block(block, freedom, replace(options, max_iterations=0))
    scale = params.robust_scale_px or SCALE_SIGMAS * _spread(start)
    rejected, trace = 0, start.iterations[:0]
    for done in range(MOST_ROUNDS):
        run.progress(done, MOST_ROUNDS, Text("rounds of adjustment"))
        result = adjust_block(block, freedom, replace(rough, scale_px=scale), run=run)
        trace += result.iterations
        spread = _spread(result)
        wanted = SCALE_SIGMAS * spread if automatic else scale
        block, dropped = result.block, 0
        if params.robust == "none" or wanted > 0.8 * scale:  # while the scale still falls, good ones look bad
            block, dropped = _reject(result, params.rejection, spread)
            rejected += dropped
            if dropped == 0 and abs(wanted - scale) < 0.05 * scale:
                break
        scale = wanted
    run.check()
    result = adjust_block(block, freedom, replace(options, scale_px=scale, statistics=True), run=run)
    run.progress(1, 1, Text("rounds of adjustment"))
    if rejected:
        run.say(Text(
            "{rejected} observations were longer than {limit:g} standard deviations and were rejected.",
            rejected=rejected, limit=params.rejection,
        ))  # fmt: skip
    if not result.converged:
        run.warn(Text("The adjustment did not converge: {reason}.", reason=result.stop_reason))
    warn_of_weak_parameters(result.block, run)
    trace += result.iterations
    return replace(result, iterations=tuple(replace(r, iteration=i) for i, r in enumerate(trace)))


def _spread(adjustment: Adjustment) -> float:
    """Return the robust standard deviation of an observation, px: NMAD of the residuals, freed from redundancy."""
    v = np.abs(adjustment.residuals)
    share = adjustment.observations / max(adjustment.redundancy, 1)
    return max(float(1.4826 * np.median(v) * np.sqrt(min(share, 10.0))), 1e-6)


def _reject(adjustment: Adjustment, limit: float | None, spread: float) -> tuple[Block, int]:
    """Return the block without observations longer than `limit` times `spread`, and how many they are.

    Of each point only the worst goes at a time: one blunder makes the other rays of its point look bad.
    """
    block = adjustment.block
    if limit is None:
        return block, 0
    length = np.hypot(*adjustment.residuals.T)
    worst = np.zeros(len(block.points))
    np.maximum.at(worst, block.obs_point, length)
    keep: Array = np.asarray((length <= limit * spread) | (length < worst[block.obs_point]))
    dropped = int((~keep).sum())
    if dropped == 0:
        return block, 0
    return _without_weak_photos(replace(
        block, obs_photo=block.obs_photo[keep], obs_point=block.obs_point[keep], obs_xy=block.obs_xy[keep]
    )), dropped  # fmt: skip


def _without_weak_photos(block: Block) -> Block:
    """Return the block with photos that hardly see a point set aside, with the reason."""
    oriented = np.array(block.oriented)
    failures = list(block.failures)
    while True:
        used = oriented[block.obs_photo]
        rays = np.bincount(block.obs_point[used], minlength=len(block.points))
        used &= rays[block.obs_point] >= 2
        seen = np.bincount(block.obs_photo[used], minlength=len(oriented))
        weak = oriented & (seen < FEWEST_OBSERVATIONS)
        if not weak.any():
            break
        failures += [ItemFailure(block.names[n], Text(
            "Only {count} of its points are seen by other photos.", count=int(seen[n]))) for n in np.flatnonzero(weak)]  # fmt: skip
        oriented &= ~weak
    if oriented.sum() < 2:
        raise UserError(
            "The block cannot be adjusted.", "Fewer than two photos share enough points.",
            "Take photos with more overlap, or keep more observations.", learn="adjustment/overlap",
        )  # fmt: skip
    return replace(block, oriented=oriented, failures=tuple(failures))
