"""What the simulator of data snooping asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.statistics.reliability import critical_value, non_centrality
from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.snooping_model import Snooping
from graphos_didactic.simulators.adjustment.snooping_params import LARGEST_PX, POINTS, SnoopingParams

TOLERANCE = 0.03
"""A challenge is met within this part of the right value."""
WITHOUT, ROOTLESS, LIMIT = "Redundancy forgotten", "Root forgotten", "Limit instead of δ0"


def _doubled(params: SnoopingParams) -> SnoopingParams:
    size = max(abs(params.a_x), abs(params.a_y))
    factor = min(2.0, LARGEST_PX / size) if size > 0 else 1.0
    if factor <= 1.0:
        return params.replace(
            a_x=6.0 if size == 0 else params.a_x / 2, a_y=0.0 if size == 0 else params.a_y / 2
        )
    return params.replace(a_x=params.a_x * factor, a_y=params.a_y * factor)


def _answer(params: SnoopingParams, setting: Setting) -> int:
    changed = _doubled(params)
    found = Snooping(changed).result
    i, _ = found.worst
    if not found.accused.any():
        return 3
    if (found.photo[i] + 1, found.point[i] + 1) == (changed.a_photo, changed.a_point):
        return 0
    return 1 if found.point[i] + 1 == changed.a_point else 2


def _explain(params: SnoopingParams, setting: Setting) -> str:
    block = Snooping(_doubled(params))
    found, p = block.result, block.params
    i, j = found.worst
    a = found.find(p.a_photo, p.a_point)
    own = "" if a is None else (
        f" A itself has r {found.reliability.redundancy[a].min():.2f} to {found.reliability.redundancy[a].max():.2f} "
        f"and |w| {np.abs(found.values[a]).max():.1f}."
    )  # fmt: skip
    return (
        f"The largest value, {abs(found.values[i, j]):.1f} (limit {found.limit:.1f}), stands at point "
        f"{found.point[i] + 1} in photo {found.photo[i] + 1}.{own} With a single blunder the wrong observation has "
        "the largest w; with two that need not be so."
    )


PREDICTION = Prediction(
    question="The blunder of A is doubled (halved at its limit). Which observation has the largest |w|?",
    choices=("A itself", "another one of A's point", "one of another point", "none is above the limit"),
    change=_doubled,
    answer=_answer,
    explain=_explain,
)


def snooping_task(seed: int) -> Task:
    """Ask for the smallest blunder that the test finds with the given power."""
    rng = np.random.default_rng([seed, 17])
    while True:
        sheet = SnoopingParams(
            a_x=0.0, a_y=0.0, a_photo=int(rng.integers(1, 4)), a_point=int(rng.integers(1, POINTS + 1)),
            photos=int(rng.integers(3, 5)), sigma_px=float(rng.integers(3, 12)) / 10,
            alpha=float(rng.choice([0.001, 0.01, 0.05])), power=float(rng.choice([0.8, 0.9])),
            seed=int(rng.integers(0, 9999)),
        )  # fmt: skip
        found = Snooping(sheet).result
        i = found.find(sheet.a_photo, sheet.a_point)
        if i is None:
            continue
        r, right = float(found.reliability.redundancy[i, 0]), float(found.reliability.mdb_px[i, 0])
        mistakes = _mistakes(sheet, r)
        if all(_judge(wrong, right, mistakes).misconception == name for name, wrong in mistakes.items()):
            break
    text = (
        f"{sheet.photos} photos, σ = {sheet.sigma_px:.1f} px; the test has α = {sheet.alpha:g} and finds its blunders with "
        f"a power of {sheet.power:.0%}. r and δ0 stand in the numbers. How large must a blunder in x of point "
        f"{sheet.a_point} in photo {sheet.a_photo} (A) be to be found?"
    )

    def check(params: SnoopingParams, number: float | None) -> Verdict:
        return _judge(number, right, mistakes)

    return Task(text, sheet, "px", check, right, dict(mistakes), ("exaggeration",))


def _mistakes(sheet: SnoopingParams, r: float) -> dict[str, float]:
    delta0, limit = non_centrality(sheet.alpha, sheet.power), critical_value(sheet.alpha)
    return {
        WITHOUT: delta0 * sheet.sigma_px,
        ROOTLESS: delta0 * sheet.sigma_px / r,
        LIMIT: limit * sheet.sigma_px / float(np.sqrt(r)),
    }


def _judge(number: float | None, right: float, mistakes: dict[str, float]) -> Verdict:
    if number is None:
        return Verdict(False, "Enter the size of the blunder, px.")
    if abs(abs(number) - right) <= TOLERANCE * right:
        return Verdict(True, f"Right: the minimal detectable bias is {right:.2f} px.")
    why = {
        WITHOUT: "That would be so if the residual showed the whole blunder; it shows only the part r of it.",
        ROOTLESS: "The residual shrinks by r, but its standard deviation by √r: √r is left.",
        LIMIT: "A blunder as large as the limit is found only half the time; δ0 allows for the power.",
    }
    seen = f"{number:g} px is not it. "
    for name, wrong in mistakes.items():
        if abs(abs(number) - wrong) <= TOLERANCE * wrong:
            return Verdict(False, seen + why[name], name)
    return Verdict(False, seen + "Take δ0 and r from the numbers: σ over the root of r, times δ0.")
