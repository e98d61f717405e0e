"""What the simulator of affine simulation asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.features.affine_model import Simulated
from graphos_didactic.simulators.features.affine_params import AffineParams

TOLERANCE = 0.03
"""A challenge is met within this part of the right number."""
ANGLE, INVERSE, SINE = "Angle instead of its tilt", "Cosine not inverted", "Sine instead of cosine"


def _rolled(params: AffineParams) -> AffineParams:
    return params.replace(roll=params.roll + 90.0 if params.roll <= 90.0 else params.roll - 90.0)


def _counts(params: AffineParams, setting: Setting) -> tuple[int, int]:
    before, after = (Simulated(p, setting).together.right for p in (params, _rolled(params)))
    return before, after


def _answer(params: AffineParams, setting: Setting) -> int:
    before, after = _counts(params, setting)
    if max(before, after) < 8 or 0.6 <= after / max(before, 1) <= 1.67:
        return 1
    return 0 if after < before else 2


def _explain(params: AffineParams, setting: Setting) -> str:
    before, after = _counts(params, setting)
    return (
        f"{before} true matches before, {after} after. A = λ R(ψ) T_t R(φ): SIFT undoes scale λ and rotation ψ by itself, "
        f"that is what its scale and orientation are for. Only tilt (here t = {Simulated(params, setting).true_tilt:.2f}) "
        "and its direction φ must be simulated."
    )


PREDICTION = Prediction(
    question="Camera B is turned about its own axis by 90°. What happens to the number of true matches?",
    choices=("most are lost", "it stays about the same", "it grows much"),
    change=_rolled,
    answer=_answer,
    explain=_explain,
)


def affine_task(seed: int) -> Task:
    """Ask for the tilt t that is left when the photo is simulated with the nearest tilt."""
    rng = np.random.default_rng([seed, 37])
    while True:
        sheet = AffineParams(
            tilt=float(rng.integers(35, 76)), swing=float(rng.integers(-35, 36)) * 5.0, tilts=0,
            seed=int(rng.integers(0, 9999)), noise=2.0,
        )  # fmt: skip
        theta = np.radians(sheet.tilt)
        right = Simulated(sheet, Setting()).true_tilt
        mistakes = {ANGLE: sheet.tilt / 45.0, INVERSE: float(np.cos(theta)), SINE: float(1.0 / np.sin(theta))}
        values = [right, *mistakes.values()]
        if all(abs(a - b) > 3 * TOLERANCE * max(a, b) for i, a in enumerate(values) for b in values[:i]):
            break
    text = (
        f"Camera B looks at the wall from {sheet.tilt:.0f}° beside its normal. Which tilt t must be simulated so that photo A "
        "looks as photo B does, but for scale and rotation?"
    )

    def check(params: AffineParams, number: float | None) -> Verdict:
        return _judge(number, right, mistakes, sheet.tilt)

    return Task(text, sheet, "times compressed", check, right, dict(mistakes), ("orbit",))


def _judge(number: float | None, right: float, mistakes: dict[str, float], tilt: float) -> Verdict:
    if number is None:
        return Verdict(False, "Enter the tilt t, a number of at least 1.")
    if abs(number - right) <= TOLERANCE * right:
        return Verdict(True, f"Right: t = 1 / cos {tilt:.0f}° = {right:.2f}.")
    why = {
        ANGLE: "The compression does not grow in proportion to the angle: it is slow first and without limit near 90°.",
        INVERSE: "That is how wide a thing still looks; t says by how much it was compressed.",
        SINE: "Seen from the front nothing is compressed: t must be 1 at 0°.",
    }
    for name, wrong in mistakes.items():
        if abs(number - wrong) <= TOLERANCE * wrong:
            return Verdict(False, f"{number:g} is not it. {why[name]}", name)
    return Verdict(
        False, f"{number:g} is not it. Think of a ruler on the wall: how long does it look from there?"
    )
