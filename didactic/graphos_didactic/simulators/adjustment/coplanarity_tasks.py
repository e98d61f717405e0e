"""What the simulator of coplanarity asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.coplanarity_model import TwoPhotos
from graphos_didactic.simulators.adjustment.coplanarity_params import CoplanarityParams

GOOD_DEG = 5.0
"""A base whose direction is off by less is usable."""
REVERSED, TWISTED = "The base reversed", "The twisted pair"


def _flat(params: CoplanarityParams) -> CoplanarityParams:
    return params.replace(fold=0.0 if params.fold > 0.05 else 2.5)


def _usable(params: CoplanarityParams) -> tuple[bool, bool]:
    pair = TwoPhotos(params)
    return pair.errors(pair.by_eight)[0] < GOOD_DEG, pair.errors(pair.by_five)[0] < GOOD_DEG


def _answer(params: CoplanarityParams, setting: Setting) -> int:
    return {(True, True): 0, (False, True): 1, (True, False): 2, (False, False): 3}[_usable(_flat(params))]


def _explain(params: CoplanarityParams, setting: Setting) -> str:
    after = TwoPhotos(_flat(params))
    values = after.linear.singular_values
    eight, five = after.errors(after.by_eight)[0], after.errors(after.by_five)[0]
    said = [f"{error:.1f}° off" if np.isfinite(error) else "not determined" for error in (eight, five)]
    return (
        f"Depth {after.params.fold:.1f} m: the direction of the base is {said[0]} with eight points and {said[1]} "
        f"with five. On a plane the linear system has more than one solution (its last singular values are "
        f"{values[-3]:.1e}, {values[-2]:.1e} and {values[-1]:.1e}); the five points also use that E has two equal singular values."
    )


PREDICTION = Prediction(
    question="The wall is unfolded (or folded, if it is flat). Which solution then gives the base within 5°?",
    choices=("both", "only five points", "only eight points", "neither"),
    change=_flat,
    answer=_answer,
    explain=_explain,
)


def coplanarity_task(seed: int) -> Task:
    """Ask which of the four decompositions is the right one."""
    draw = np.random.default_rng(seed)
    while True:
        side = float(draw.choice([-1.0, 1.0]))
        sheet = CoplanarityParams(
            base_x=side * float(np.round(draw.uniform(1.5, 3.0), 1)),
            base_y=float(np.round(draw.uniform(-1.0, 1.0), 1)),
            base_z=float(np.round(draw.uniform(-0.8, 0.8), 1)),
            turn=-side * float(draw.integers(8, 24)),
            tilt=float(draw.integers(-5, 6)),
            seed=int(draw.integers(1, 9999)),
            count=14,
            sigma_px=0.3,
        )
        pair = TwoPhotos(sheet)
        if len(pair.four) == 4 and pair.before_both(pair.four[pair.right_one]).all():
            break
    mistakes = {name: float(i + 1) for i, name in enumerate(_kinds(pair)) if name in (REVERSED, TWISTED)}
    text = (
        "The essential matrix has four decompositions, drawn from above: A looks up the page, B where its triangle opens. "
        "Which of them, 1 to 4, can be the real one?"
    )

    def check(params: CoplanarityParams, number: float | None) -> Verdict:
        return _judge(pair, number)

    return Task(text, sheet, "solution", check, float(pair.right_one + 1), mistakes, ("orbit",))


def _kinds(pair: TwoPhotos) -> list[str]:
    """Return what is wrong with each of the four; empty for the right one."""
    rotation, base = pair.four[pair.right_one]
    names = []
    for other, t in pair.four:
        if np.allclose(other, rotation, atol=1e-6):
            names.append("" if t @ base > 0 else REVERSED)
        else:
            names.append(TWISTED if t @ base > 0 else "The twisted pair, reversed")
    return names


def _judge(pair: TwoPhotos, number: float | None) -> Verdict:
    if number is None or round(number) not in (1, 2, 3, 4):
        return Verdict(False, "Answer with 1, 2, 3 or 4.")
    which = round(number) - 1
    before, count = int(pair.before_both(pair.four[which]).sum()), int(pair.used.sum())
    seen = f"In solution {which + 1}, {before} of {count} points lie before both cameras. "
    name = _kinds(pair)[which]
    if not name:
        return Verdict(True, f"Right: {seen}A camera sees only what is before it.")
    why = {
        REVERSED: "The rotation is right, but with the base reversed all rays meet behind the cameras.",
        TWISTED: "Camera B is turned by 180° about the base: one of the two always has the points behind it.",
    }
    return Verdict(False, seen + why.get(name, "B is turned about the base, and the base is reversed."), name)
