"""What the simulator of the datum asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.datum_model import AXES, Held
from graphos_didactic.simulators.adjustment.datum_params import CORNERS, DatumParams

NEEDED = 7
"""Numbers that a block needs: three shifts, three turns, a scale."""
CHANGED = 0.02
"""Share from which on a value is said to change."""
TWO, MORE, PLAN = "Two points hold everything", "The more the better", "Position is enough"


def _other_kind(params: DatumParams) -> DatumParams:
    return params.replace(kind="minimal" if params.kind == "inner" else "inner")


def _changes(params: DatumParams) -> tuple[float, float]:
    """Return by which share the mean σ of the points and sigma0 change with the other way to fix free motions."""
    before, after = Held(params), Held(_other_kind(params))
    return (
        abs(float(after.sigmas.mean() / before.sigmas.mean()) - 1.0),
        abs(after.adjustment.sigma0 / before.adjustment.sigma0 - 1.0),
    )


def _answer(params: DatumParams, setting: Setting) -> int:
    ellipses, shape = (change > CHANGED for change in _changes(params))
    return 2 if ellipses and shape else 0 if ellipses else 1 if shape else 3


def _explain(params: DatumParams, setting: Setting) -> str:
    before, after = Held(params), Held(_other_kind(params))
    sigmas = [1e3 * float(h.sigmas.mean()) for h in (before, after)]
    found = (
        f"Mean σ of a point {sigmas[0]:.1f} → {sigmas[1]:.1f} mm, sigma0 {before.adjustment.sigma0:.3f} → "
        f"{after.adjustment.sigma0:.3f}. "
    )
    if before.defect == 0:
        return found + "Nothing is free here, so there is nothing to fix in another way."
    return (
        found
        + "The residuals do not know where the block hangs; σ of a coordinate means: relative to the datum."
    )


PREDICTION = Prediction(
    question="The free motions are fixed in the other way (inner or minimal constraints). What changes?",
    choices=("only the ellipses", "only sigma0", "both", "neither"),
    change=_other_kind,
    answer=_answer,
    explain=_explain,
)


def datum_task(seed: int) -> Task:
    """Ask for a complete datum from just seven numbers, one corner not being available."""
    rng = np.random.default_rng([seed, 19])
    blocked = int(rng.choice(CORNERS))
    corners = [n for n in CORNERS if n != blocked]
    sheet = DatumParams(
        p1="none", p3="none", p7="none", p9="none", seed=int(rng.integers(0, 9999)), motion=1,
        sigma_px=float(rng.integers(2, 9)) / 10,
    )  # fmt: skip
    a, b, c = (f"p{n}" for n in rng.permutation(corners))
    right = sheet.replace(**{a: "full", b: "full", c: "height"})
    mistakes = {
        TWO: sheet.replace(**{a: "full", b: "full"}),
        MORE: sheet.replace(**{a: "full", b: "full", c: "full"}),
        PLAN: sheet.replace(**{a: "position", b: "position", c: "position"}),
    }
    text = (
        f"Choose what is measured in the terrain: just {NEEDED} numbers (coordinates of corners) that leave no motion free. "
        f"Point {blocked} cannot be reached, and no distance can be measured."
    )
    free = (*(f"p{n}" for n in corners), "motion", "amount")
    return Task(text, sheet, None, _judge, right, mistakes, free)


def _judge(params: DatumParams, number: float | None) -> Verdict:
    held = Held(params)
    names = "; ".join(motion.name for motion in held.motions)
    seen = f"{held.count} numbers, {held.defect} free motion{'' if held.defect == 1 else 's'}. "
    if held.defect == 0 and held.count == NEEDED:
        return Verdict(True, f"Right: {seen}")
    if held.defect == 0:
        why = "More numbers control each other, but asked were just enough; now an error of one bends the block."
        return Verdict(False, seen + why, MORE)
    full = sum(len(AXES[role]) == 3 for role in held.roles.values())
    if full == 2 and held.count == 6:
        return Verdict(False, f"{seen}Free is: {names}. Two points leave the turn about their line.", TWO)
    if held.count >= 4 and not any(2 in AXES[role] for role in held.roles.values()):
        return Verdict(False, f"{seen}Free is: {names}. Nothing says how high the block lies.", PLAN)
    return Verdict(False, f"{seen}Free is: {names}.")
