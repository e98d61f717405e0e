"""What the simulator of self-dissimilarity asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.features.self_dissimilarity_model import Compared
from graphos_didactic.simulators.features.self_dissimilarity_params import SelfDissimilarityParams

TOLERANCE = 0.02
"""Of the mean."""
LARGEST_SEARCH = 14
LISTED = 8
"""Distances that the challenge names."""


def _wider(params: SelfDissimilarityParams) -> SelfDissimilarityParams:
    return params.replace(
        search=min(2 * params.search, LARGEST_SEARCH) if params.search < LARGEST_SEARCH else 7
    )


def _answer(params: SelfDissimilarityParams, setting: Setting) -> int:
    before, after = (len(Compared(p, setting).points) for p in (params, _wider(params)))
    if after < 0.8 * before:
        return 2
    return 0 if after > 1.2 * before else 1


def _explain(params: SelfDissimilarityParams, setting: Setting) -> str:
    before, after = Compared(params, setting), Compared(_wider(params), setting)
    return (
        f"With r_s from {before.params.search} to {after.params.search} px each patch is compared with "
        f"{len(after.every[1])} others instead of {len(before.every[1])}. Points: {len(before.points)} before, "
        f"{len(after.points)} after. At the marked point λ goes from {before.dissimilarity:.1f} to "
        f"{after.dissimilarity:.1f}: more patches can only bring nearer ones. What comes again inside of the search area "
        "is no longer distinctive."
    )


PREDICTION = Prediction(
    question="The search radius is changed to twice as much (from the largest back to half). How many points are there?",
    choices=("clearly more", "about as many", "clearly fewer"),
    change=_wider,
    answer=_answer,
    explain=_explain,
)


def self_dissimilarity_task(seed: int) -> Task:
    """Ask for the self-dissimilarity of a point whose smallest distances are listed."""
    draw = np.random.default_rng(seed)
    while True:
        sheet = SelfDissimilarityParams(
            x=float(draw.integers(10, 90)), y=float(draw.integers(10, 90)), neighbours=int(draw.integers(3, 6)),
            noise=4.0, seed=seed % 9999,
        )  # fmt: skip
        listed = np.round(Compared(sheet, Setting()).every[1][:LISTED], 1)
        k = sheet.neighbours
        right = float(listed[:k].mean())
        mistakes = {
            "Sum instead of mean": float(listed[:k].sum()),
            "Only the nearest": float(listed[0]),
            "Only the k-th": float(listed[k - 1]),
            "All that are listed": float(listed.mean()),
        }
        values = np.sort([right, *mistakes.values()])
        if right > 20 and (np.diff(values) > 3 * TOLERANCE * values[1:]).all():
            break

    def check(params: SelfDissimilarityParams, number: float | None) -> Verdict:
        return _judge(number, right, mistakes)

    texts = ", ".join(f"{value:.1f}" for value in listed)
    text = (
        f"At the marked point the {LISTED} smallest patch distances are {texts} (squared grey levels). What is the "
        f"self-dissimilarity λ with k = {k} (± {100 * TOLERANCE:g} %)?"
    )
    return Task(text, sheet, "grey level²", check, right, mistakes)


_WHY = {
    "Sum instead of mean": "λ is the mean of the k distances: otherwise it would grow with k.",
    "Only the nearest": "One similar patch may be chance: the k nearest are averaged.",
    "Only the k-th": "All k nearest count, not the last of them alone.",
    "All that are listed": "Only the k nearest count; the others are what the patch is unlike anyway.",
}


def _judge(number: float | None, right: float, mistakes: dict[str, float]) -> Verdict:
    if number is None:
        return Verdict(False, "A number is asked.")
    if abs(number - right) <= TOLERANCE * right:
        return Verdict(True, f"Right: {right:.1f}.")
    for name, value in mistakes.items():
        if abs(number - value) <= TOLERANCE * value:
            return Verdict(False, _WHY[name], name)
    way = "smaller" if number > right else "larger"
    return Verdict(False, f"It is {way}: the mean of the k smallest distances.")
