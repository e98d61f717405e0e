"""What the simulator of robust weights asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.robust import ROBUST
from graphos_core.geometry.intersection_precision import intersection_precision
from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.robust_model import (
    CAMERA,
    CENTRES,
    ROTATIONS,
    Bundle,
    aimed_at,
    mm,
)
from graphos_didactic.simulators.adjustment.robust_params import LARGEST_PX, RAYS, RobustParams, blunders

FOLLOWS, RETURNS = 1.3, 0.75
"""Beyond these factors of its error an estimate is said to follow or to return."""
CONVEX = "A limited pull is enough"
BLIND = "Any start will do"


def _worst(params: RobustParams) -> int:
    """Return the ray with the largest blunder, counted from 0; the seventh where there is none."""
    sizes = np.abs(blunders(params))
    return int(np.argmax(sizes)) if sizes.max() > 0 else 6


def _farther(params: RobustParams) -> RobustParams:
    k = _worst(params)
    size = blunders(params)[k]
    goal = float(np.copysign(LARGEST_PX if abs(size) < LARGEST_PX else LARGEST_PX / 2, size))
    return params.replace(**{f"ray_{k + 1}": goal})


def _pulled(params: RobustParams, k: int) -> float:
    """Return how far ray k pulls the robust estimate from where it is without the blunder, mm."""
    without = Bundle(params.replace(**{f"ray_{k + 1}": 0.0})).robust.point
    return float(np.linalg.norm(mm(Bundle(params).robust.point - without)))


def _pulls(params: RobustParams) -> tuple[float, float]:
    k = _worst(params)
    return _pulled(params, k), _pulled(_farther(params), k)


def _answer(params: RobustParams, setting: Setting) -> int:
    before, after = _pulls(params)
    if after > FOLLOWS * before + 0.5:
        return 0
    return 2 if after < RETURNS * before - 0.05 else 1


def _explain(params: RobustParams, setting: Setting) -> str:
    before, after = _pulls(params)
    k = _worst(params)
    function = ROBUST[params.function]
    return (
        f"Ray {k + 1} pulled the estimate {before:.1f} mm away, now {after:.1f} mm. {function.label}: "
        f"{function.effect.lower()} Least squares now misses the point by "
        f"{float(np.linalg.norm(mm(Bundle(_farther(params)).least_squares))):.1f} mm."
    )


PREDICTION = Prediction(
    question="The worst ray is moved much farther. What does the robust estimate do?",
    choices=("it follows", "it hardly moves", "it goes back to the other rays"),
    change=_farther,
    answer=_answer,
    explain=_explain,
)


def tolerance_mm(params: RobustParams) -> float:
    """Return 3σ of the point intersected from the good rays, mm: largest axis of the engine's covariance."""
    keep = np.flatnonzero(Bundle(params).good)
    found = intersection_precision(
        [CAMERA] * len(keep), list(ROTATIONS[keep]), list(CENTRES[keep]), np.zeros(3), params.sigma_px
    )
    return 3e3 * float(found.sigmas[0])


def robust_task(seed: int) -> Task:
    """Ask for weights that find the point although four of nine rays agree on another."""
    rng = np.random.default_rng([seed, 11])
    while True:
        rays = tuple(int(k) for k in np.sort(rng.choice(RAYS, 4, replace=False)) + 1)
        angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(60, 100)
        wrong = aimed_at(far * np.cos(angle), far * np.sin(angle), rays)
        sheet = RobustParams(function="none", draws=1, seed=int(rng.integers(0, 9999)), ray_7=0.0).replace(
            **wrong
        )
        answers = _answers(sheet)
        if answers is not None:
            break
    right, mistakes = answers
    text = (
        f"Some of the {RAYS} rays agree on a wrong point. Choose function, scale, start and samples so that the robust "
        f"estimate is within {tolerance_mm(sheet):.1f} mm (3σ of the good rays) of the true point. No ray may be moved."
    )
    free = ("function", "scale", "start", "iterations", "draws", "threshold", "confidence")
    return Task(text, sheet, None, _judge, right, mistakes, free)


def _answers(sheet: RobustParams) -> tuple[RobustParams, dict[str, RobustParams]] | None:
    """Return a right answer and the typical wrong ones; None when they cannot be told apart."""
    right = sheet.replace(function="tukey", scale=5.0, start="ransac", draws=40)
    mistakes = {
        CONVEX: sheet.replace(function="huber", scale=2.0),
        BLIND: sheet.replace(function="tukey", scale=5.0),
    }
    if not _judge(right, None).right or _judge(sheet, None).right:
        return None
    if any(_judge(wrong, None).misconception != name for name, wrong in mistakes.items()):
        return None
    return right, mistakes


def _judge(params: RobustParams, number: float | None) -> Verdict:
    off, limit = float(np.linalg.norm(mm(Bundle(params).robust.point))), tolerance_mm(params)
    seen = f"The robust estimate is {off:.1f} mm from the point, allowed are {limit:.1f} mm. "
    if off <= limit:
        return Verdict(True, f"Right: {seen}")
    if params.function == "none":
        return Verdict(False, seen + "Least squares gives every ray its full weight.")
    if ROBUST[params.function].convex:
        why = f"{ROBUST[params.function].label} limits the pull of each wrong ray, but several pull together."
        return Verdict(False, seen + why, CONVEX)
    if params.start == "least squares":
        why = "From the start by least squares, downhill leads into the wrong valley."
        return Verdict(False, seen + why, BLIND)
    return Verdict(False, seen + "The best sample is still a wrong one: draw more, or look at the threshold.")
