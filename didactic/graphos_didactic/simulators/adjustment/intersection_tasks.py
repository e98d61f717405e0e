"""What the simulator of the intersection asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.intersection_model import (
    IntersectionParams,
    Pair,
    with_base,
)

TOLERANCE = 0.05
"""A challenge is met within this part of the asked standard deviation."""
FACTORS = (0.25, 0.5, 1.0, 2.0)
"""The factors that the prediction offers."""


def _sigma_z(params: IntersectionParams) -> float:
    """Return the engine's σ_Z, mm."""
    return 1e3 * float(Pair(params).precision.sigma_xyz[2])


def _doubled(params: IntersectionParams) -> IntersectionParams:
    base = max(Pair(params).base, 0.4)
    return with_base(params, min(2 * base, 15.0))


def _answer(params: IntersectionParams, setting: Setting) -> int:
    factor = _sigma_z(_doubled(params)) / _sigma_z(params)
    if not np.isfinite(factor):
        return 0
    return int(np.argmin([abs(np.log(factor / f)) for f in FACTORS]))


def _explain(params: IntersectionParams, setting: Setting) -> str:
    before, after = Pair(params), Pair(_doubled(params))
    return (
        f"Base {before.base:.2f} → {after.base:.2f} m: σ_Z {_sigma_z(params):.2f} → {_sigma_z(after.params):.2f} mm, "
        f"factor {_sigma_z(after.params) / _sigma_z(params):.2f}. Depth comes from the parallax, which grows with "
        "the base; its precision does too. The height counts twice, the base once."
    )


PREDICTION = Prediction(
    question="The base is doubled, all else stays. What becomes of σ_Z?",
    choices=("a quarter", "about half", "nearly the same", "about double"),
    change=_doubled,
    answer=_answer,
    explain=_explain,
)


def base_for(params: IntersectionParams, sigma_z_mm: float) -> float:
    """Return the base, m, at which the engine's σ_Z has the given value, mm; by halving the interval."""
    low, high = 0.05, 16.0
    for _ in range(60):
        middle = (low + high) / 2
        if _sigma_z(with_base(params, middle)) > sigma_z_mm:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def intersection_task(seed: int) -> Task:
    """Ask for the base that gives a certain σ_Z, in the normal case."""
    draw = np.random.default_rng(seed)
    height = float(draw.integers(60, 120)) / 10
    sheet = IntersectionParams(
        aim="down",
        a_x=-0.2,
        b_x=0.2,
        a_z=height,
        b_z=height,
        focal_px=float(draw.integers(24, 50) * 100),
        sigma_px=float(draw.integers(6, 16)) / 20,
    )
    goal = float(f"{_sigma_z(with_base(sheet, height * float(draw.uniform(0.3, 0.55)))):.2g}")
    right = base_for(sheet, goal)

    def check(params: IntersectionParams, number: float | None) -> Verdict:
        return _judge(params, goal)

    mistakes = {
        "One measurement instead of a parallax": with_base(sheet, base_for(sheet, goal * np.sqrt(2.0))),
        "Height counted once": with_base(sheet, right / height),
    }
    mistakes["As wide as possible"] = with_base(sheet, 15.0)
    text = (
        f"Both cameras stand {height:.1f} m above the point and look straight down; f = {sheet.focal_px:.0f} px, "
        f"σ = {sheet.sigma_px:.2f} px. Set the base so that σ_Z = {goal:g} mm (within {TOLERANCE:.0%})."
    )
    return Task(text, sheet, None, check, with_base(sheet, right), mistakes, ("a_x", "b_x"))


def _judge(params: IntersectionParams, goal: float) -> Verdict:
    got = _sigma_z(params)
    if abs(got - goal) <= TOLERANCE * goal:
        return Verdict(True, f"Right: with B = {Pair(params).base:.2f} m, σ_Z is {got:.2f} mm.")
    pair = Pair(params)
    seen = f"With B = {pair.base:.2f} m, σ_Z is {got:.2f} mm, asked were {goal:g} mm. "
    if abs(got / np.sqrt(2.0) - goal) <= TOLERANCE * goal:
        name = "One measurement instead of a parallax"
        return Verdict(False, seen + "The parallax is the difference of two measurements: factor √2.", name)
    if abs(got / pair.height - goal) <= TOLERANCE * goal:
        name = "Height counted once"
        return Verdict(
            False, seen + "The height enters twice: by the scale and by the base/height ratio.", name
        )
    if pair.base > 1.2 * base_for(params, goal):
        name = "As wide as possible"
        more = "More precise than asked: a base this long costs overlap and makes matching harder."
        return Verdict(False, seen + more, name)
    return Verdict(False, seen + "A longer base is needed.")
