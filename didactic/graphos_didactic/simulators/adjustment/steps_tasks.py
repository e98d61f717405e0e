"""What the simulator of the adjustment step by step asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.steps_model import POWERS, Iteration
from graphos_didactic.simulators.adjustment.steps_params import HIGHEST, LOWEST, StepsParams

ENOUGH = 0.9
"""A step is good that brings this share of the largest possible fall of the cost."""
FULL, SAFE = "The full step is the best", "Small steps are safe"


def _turned(params: StepsParams) -> StepsParams:
    return params.replace(turn=90.0 if abs(params.turn) < 60.0 else 0.0)


def _counts(params: StepsParams) -> tuple[int, int]:
    """Return the iterations now and with photo 1 turned the other way; −1 where the minimum was not reached."""
    found = []
    for sheet in (params, _turned(params)):
        run = Iteration(sheet)
        found.append(len(run.solution.iterations) - 1 if run.solution.converged else -1)
    return found[0], found[1]


def _answer(params: StepsParams, setting: Setting) -> int:
    before, after = _counts(params)
    if after < 0:
        return 3
    if before < 0 or after < before:
        return 0
    return 1 if after - before <= 2 else 2


def _explain(params: StepsParams, setting: Setting) -> str:
    counts = [f"{c} iterations" if c >= 0 else "not converged" for c in _counts(params)]
    changed = Iteration(_turned(params))
    refused = sum(not r.accepted for r in changed.solution.iterations)
    return (
        f"Turn {params.turn:.0f}°: {counts[0]}; {changed.params.turn:.0f}°: {counts[1]}, {refused} steps refused. "
        "A shift is nearly linear in the photo, a turn is not: a straight step in the angles leads past the goal, so "
        "the damping has to grow first."
    )


PREDICTION = Prediction(
    question="Photo 1 starts turned by 90° (or, if it does, upright). How many iterations will it take?",
    choices=("fewer", "about as many", "clearly more", "it does not arrive"),
    change=_turned,
    answer=_answer,
    explain=_explain,
)


def steps_task(seed: int) -> Task:
    """Ask for the damping with which one step lowers the cost most."""
    rng = np.random.default_rng([seed, 23])
    while True:
        sheet = StepsParams(
            turn=float(rng.choice([-1, 1]) * rng.integers(8, 26) * 5), start_x=float(rng.integers(-40, 41)) / 10,
            start_y=float(rng.integers(-40, 41)) / 10, rough=float(rng.integers(2, 10)) / 10,
            iteration=int(rng.integers(0, 5)), seed=int(rng.integers(0, 9999)), damping=LOWEST + 0.5,
        )  # fmt: skip
        run = Iteration(sheet)
        right = sheet.replace(damping=float(POWERS[int(np.argmin(run.curve))]))
        mistakes = {FULL: sheet.replace(damping=LOWEST), SAFE: sheet.replace(damping=HIGHEST)}
        if not _judge(right, None).right or _judge(sheet, None).right:
            continue
        if all(_judge(wrong, None).misconception == name for name, wrong in mistakes.items()):
            break
    text = (
        f"Photo 1 started turned by {sheet.turn:.0f}°; shown is the state after iteration {sheet.iteration}. Choose the "
        f"damping so that your step brings at least {ENOUGH:.0%} of the largest fall of the cost that one step can bring."
    ).replace("-", "−")
    return Task(text, sheet, None, _judge, right, mistakes, ("damping",))


def _judge(params: StepsParams, number: float | None) -> Verdict:
    run = Iteration(params)
    best = float(run.curve.min())
    after = run.mine.cost if run.mine is not None and run.mine.lost == 0 else np.inf
    possible = run.cost - best
    share = (run.cost - after) / possible if possible > 0 else 0.0
    if not np.isfinite(share):
        return Verdict(False, "This step leads behind a camera: more damping.", FULL)
    seen = f"The cost goes from {run.cost:.4g} to {after:.4g}, {share:.0%} of the largest fall. ".replace(
        "-", "−"
    )
    if share >= ENOUGH:
        return Verdict(True, f"Right: {seen}")
    if params.damping < POWERS[int(np.argmin(run.curve))]:
        why = "The full step trusts the linearisation far beyond where it holds: more damping."
        return Verdict(False, seen + why, FULL)
    return Verdict(False, seen + "Downhill, but hardly moved: less damping goes farther.", SAFE)
