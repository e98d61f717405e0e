"""What the simulator of random sampling asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_core.geometry.consensus import samples_needed
from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.features.sampling_model import Search
from graphos_didactic.simulators.features.sampling_params import SamplingParams

TOLERANCE = 0.04
"""A challenge is met within this part of the right number, or within one sample."""
ALONE, FALSE, OTHER = "One true match is enough", "Share of the false ones", "Size of the sample forgotten"
SIZES = {"homography": 4, "fundamental": 7}


def _fewer(params: SamplingParams) -> SamplingParams:
    return params.replace(good=round(max(0.5 * params.good, 0.1), 3))


def _numbers(params: SamplingParams, setting: Setting) -> tuple[float, float]:
    size = SIZES[params.model]
    before, after = (samples_needed(p.good, size, p.confidence) for p in (params, _fewer(params)))
    return before, after


def _answer(params: SamplingParams, setting: Setting) -> int:
    before, after = _numbers(params, setting)
    factor = after / before
    return 0 if factor < 3.0 else 1 if factor < 12.0 else 2


def _explain(params: SamplingParams, setting: Setting) -> str:
    before, after = _numbers(params, setting)
    size = SIZES[params.model]
    share = _fewer(params).good
    return (
        f"From {before:.0f} to {after:.0f} samples. A sample of {size} is free of false matches with the probability "
        f"w^{size}: {params.good**size:.4f} with w = {params.good:.2f}, {share**size:.6f} with {share:.2f}. "
        "Each match of the sample must be a true one."
    )


PREDICTION = Prediction(
    question="Only half as many of the matches are true. How many times more samples are needed?",
    choices=("about twice as many", "about 3 to 12 times", "more than 12 times"),
    change=_fewer,
    answer=_answer,
    explain=_explain,
)


def sampling_task(seed: int) -> Task:
    """Ask for the number of samples that finds a clean one with the given confidence."""
    rng = np.random.default_rng([seed, 31])
    while True:
        sheet = SamplingParams(
            good=float(rng.integers(7, 18)) * 0.05, model=str(rng.choice(["homography", "fundamental"])),  # type: ignore[arg-type]
            confidence=float(rng.choice([0.9, 0.95, 0.99, 0.999])), count=int(rng.integers(8, 24)) * 5,
            off_x=0.0, off_y=0.0, draw=1, seed=int(rng.integers(0, 9999)),
        )  # fmt: skip
        sheet = sheet.replace(good=round(sheet.good, 2), depth=0.0 if sheet.model == "homography" else 40.0)
        share = round(Search(sheet, Setting()).share, 2)
        size = SIZES[sheet.model]
        right = samples_needed(share, size, sheet.confidence)
        mistakes = {
            ALONE: samples_needed(1.0 - (1.0 - share) ** size, 1, sheet.confidence),
            FALSE: samples_needed(1.0 - share, size, sheet.confidence),
            OTHER: samples_needed(share, 1, sheet.confidence),
        }
        values = [right, *mistakes.values()]
        apart = all(
            abs(a - b) > max(3.0, 3 * TOLERANCE * a) for i, a in enumerate(values) for b in values[:i]
        )
        if apart and 5 <= right < 5000:
            break
    text = (
        f"{share:.0%} of {sheet.count} matches are true. A {'homography' if size == 4 else 'fundamental matrix'} is estimated "
        f"from samples of {size}. How many samples are needed to have one without a false match with a probability of "
        f"{sheet.confidence:.1%}?"
    )

    def check(params: SamplingParams, number: float | None) -> Verdict:
        return _judge(number, right, mistakes, size)

    return Task(text, sheet, "samples", check, right, dict(mistakes), ("threshold", "cost"))


def _judge(number: float | None, right: float, mistakes: dict[str, float], size: int) -> Verdict:
    if number is None:
        return Verdict(False, "Enter the number of samples.")
    if abs(number - right) <= max(1.0, TOLERANCE * right):
        return Verdict(True, f"Right: {right:.0f} samples.")
    why = {
        ALONE: f"One false match spoils the model: all {size} of the sample must be true.",
        FALSE: "w is the share of the true ones: a sample of false ones agrees on nothing.",
        OTHER: f"One match determines no model: {size} must be true at once, with the probability w^{size}.",
    }
    for name, wrong in mistakes.items():
        if abs(number - wrong) <= max(1.0, TOLERANCE * wrong):
            return Verdict(False, f"{number:g} is not it. {why[name]}", name)
    hint = "All samples contain a false match with the probability (1 − w^m)^n; that shall be 1 − p."
    return Verdict(False, f"{number:g} is not it. {hint}")
