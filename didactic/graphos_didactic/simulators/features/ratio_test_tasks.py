"""What the simulator of the ratio test asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.features.ratio_test_model import Counts, Judged
from graphos_didactic.simulators.features.ratio_test_params import RatioTestParams

GENEROUS, STRICT, ALONE = "More matches are better", "Fewer matches are safer", "One distance for all"
ABOUT = 0.15
"""A count of false matches that changes by less than this part stays about the same."""


def _other_rule(params: RatioTestParams, setting: Setting | None = None) -> RatioTestParams:
    """Return the rule by distance with about as many accepted matches; or the ratio, if it was the distance."""
    if params.rule == "distance":
        return params.replace(rule="ratio")
    seen = Judged(params, setting or Setting())
    return params.replace(rule="distance", limit=round(min(seen.limit_for(seen.counts.accepted), 500.0), 1))


def _compared(params: RatioTestParams, setting: Setting) -> tuple[Counts, Counts]:
    return Judged(params, setting).counts, Judged(_other_rule(params, setting), setting).counts


def _answer(params: RatioTestParams, setting: Setting) -> int:
    before, after = (c.false_accepted / max(c.accepted, 1) for c in _compared(params, setting))
    if abs(after - before) <= max(ABOUT * before, 0.01):
        return 1
    return 2 if after > before else 0


def _explain(params: RatioTestParams, setting: Setting) -> str:
    before, after = _compared(params, setting)
    names = ("the ratio", "the distance") if params.rule == "ratio" else ("the distance", "the ratio")
    return (
        f"By {names[0]}: {before.accepted} accepted, {before.false_accepted} of them false; by {names[1]}: "
        f"{after.accepted} accepted, {after.false_accepted} false. The second distance tells how far a wrong descriptor "
        "typically is from this one: each point brings its own measure along."
    )


PREDICTION = Prediction(
    question="The test looks at the distance alone (or again at the ratio). Which share of the accepted is false?",
    choices=("a smaller share", "about the same", "a larger share"),
    change=_other_rule,
    answer=_answer,
    explain=_explain,
)


def ratio_test_task(seed: int) -> Task:
    """Ask for a threshold that keeps a share of the true matches with few false ones."""
    draw = np.random.default_rng([seed, 23])
    while True:
        sheet = RatioTestParams(
            tilt=float(draw.integers(22, 42)), aside=float(draw.integers(-24, 25)) * 5.0,
            noise=float(draw.integers(4, 16)), seed=int(draw.integers(0, 9999)), ratio=0.99, mutual=False,
        )  # fmt: skip
        right = sheet.replace(ratio=float(draw.integers(62, 78)) / 100)
        best = Judged(right, Setting())
        limits = (float(np.floor(best.counts.precision - 1.0)), float(np.floor(best.counts.recall - 3.0)))
        mistakes = {
            GENEROUS: sheet.replace(ratio=0.95),
            STRICT: sheet.replace(ratio=0.35),
            ALONE: sheet.replace(rule="distance", limit=round(best.limit_for(best.counts.accepted), 1)),
        }
        named = all(_judge(wrong, limits).misconception == name for name, wrong in mistakes.items())
        if named and _judge(right, limits).right:
            break
    text = (
        f"At least {limits[0]:.0f} % of the accepted matches shall be true (precision), and at least {limits[1]:.0f} % of "
        "the true ones accepted (recall). Drag the threshold there."
    )
    free = ("ratio", "rule", "limit", "look_x", "look_y")
    return Task(text, sheet, None, lambda params, _: _judge(params, limits), right, mistakes, free)


def _judge(params: RatioTestParams, limits: tuple[float, float]) -> Verdict:
    counts = Judged(params, Setting()).counts
    seen = (
        f"Precision {counts.precision:.1f} % (at least {limits[0]:.0f}), recall {counts.recall:.1f} % ({limits[1]:.0f}). "
        if counts.accepted
        else "Nothing is accepted. "
    )
    if counts.accepted and counts.precision >= limits[0] and counts.recall >= limits[1]:
        return Verdict(True, f"Right: {seen}")
    if params.rule == "distance":
        why = "A plain point has near neighbours everywhere, a distinctive one has none: no single distance suits both."
        return Verdict(False, seen + why, ALONE)
    if counts.accepted and counts.precision < limits[0]:
        why = "Beyond the hump of the true ones, more matches are mostly false ones, and they must be found out later."
        return Verdict(False, seen + why, GENEROUS)
    why = "What is rejected cannot help the orientation: with noise and oblique views true ratios grow too."
    return Verdict(False, seen + why, STRICT)
