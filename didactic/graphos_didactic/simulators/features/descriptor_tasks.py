"""What the simulator of the descriptor asks: a prediction and a challenge."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.features.descriptor import CELLS, DIRECTIONS, bin_shares
from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.features.descriptor_model import Compared
from graphos_didactic.simulators.features.descriptor_params import DescriptorParams

TOLERANCE = 0.03
"""Of the share."""
SMALL = 0.1
"""Distances that differ by less are nearly the same."""


def _turned(params: DescriptorParams) -> DescriptorParams:
    return params.replace(turn=(params.turn + 90.0 + 180.0) % 360.0 - 180.0)


def _answer(params: DescriptorParams, setting: Setting) -> int:
    before, after = Compared(params, setting).distance, Compared(_turned(params), setting).distance
    if abs(after - before) < SMALL:
        return 0
    return 1 if after > before else 2


def _explain(params: DescriptorParams, setting: Setting) -> str:
    before, after = Compared(params, setting), Compared(_turned(params), setting)
    text = f"The distance goes from {before.distance:.2f} to {after.distance:.2f}."
    if params.orientation == "upright":
        return f"{text} Nobody turned the patch upright: other cells and other directions are compared."
    return (
        f"{text} The direction of the second key point went from {math.degrees(before.b.angle) % 360:.0f}° to "
        f"{math.degrees(after.b.angle) % 360:.0f}°: the patch was turned upright by it before the gradients were counted, so a "
        f"direction that is found well (error {after.turn_error:.1f}°) leaves the numbers alone."
    )


PREDICTION = Prediction(
    question="The second picture is turned by another 90°. What does the distance of the descriptors do?",
    choices=("it stays nearly the same", "it grows", "it shrinks"),
    change=_turned,
    answer=_answer,
    explain=_explain,
)


def descriptor_task(seed: int) -> Task:
    """Ask how much of one pixel's gradient goes to one number of the 128."""
    draw = np.random.default_rng(seed)
    half = (CELLS - 1) / 2
    while True:
        row, column = (
            int(draw.integers(0, CELLS - 1)) + round(float(draw.uniform(0.2, 0.45)), 2) for _ in "rc"
        )
        start = DescriptorParams(
            u=column - half, v=row - half, turn=float(draw.integers(-17, 17) * 10), seed=seed % 9999
        )
        pixel = Compared(start, Setting()).shares
        size, degrees = round(pixel.size, 1), round(math.degrees(pixel.direction), 1)
        turn = degrees * DIRECTIONS / 360.0
        if size > 3.0 and 0.15 < turn % 1.0 < 0.45:
            break
    r, c, d = math.floor(row), math.floor(column), math.floor(turn)
    along, across = bin_shares(column, CELLS)[c], bin_shares(row, CELLS)[r]
    around = bin_shares(turn, DIRECTIONS, circular=True)[d % DIRECTIONS]
    right = size * along * across * around
    mistakes = {
        "All to the nearest bin": size,
        "Direction not shared": size * along * across,
        "Cells not shared": size * around,
        "Share of the far side": size * (1 - along) * (1 - across) * (1 - around),
    }

    def check(params: DescriptorParams, number: float | None) -> Verdict:
        return _judge(number, right, mistakes)

    angle = 360 // DIRECTIONS
    text = (
        f"The marked pixel has gradient times weight {size:g} grey levels and the direction {degrees:g}°. It lies "
        f"{row - r:.2f} cells below the middle of cell row {r + 1} and {column - c:.2f} cells to the right of the middle of "
        f"cell column {c + 1}. How much goes into the bin of {d % DIRECTIONS * angle}° of that cell (bins are {angle}° apart; "
        f"± {100 * TOLERANCE:g} %)?"
    )
    return Task(text, start, "grey level", check, right, mistakes)


_WHY = {
    "All to the nearest bin": "Then the numbers would jump when the patch moves by a pixel: a pixel is shared.",
    "Direction not shared": "The direction lies between two bins as well: a third factor.",
    "Cells not shared": "The pixel lies between the middles of four cells: two more factors.",
    "Share of the far side": "The share is 1 minus the distance: nearer gets more.",
}


def _judge(number: float | None, right: float, mistakes: dict[str, float]) -> Verdict:
    if number is None:
        return Verdict(False, "A number is asked.")
    if abs(number - right) <= TOLERANCE * right:
        return Verdict(True, f"Right: {right:.1f} grey levels.")
    for name, value in mistakes.items():
        if abs(number - value) <= TOLERANCE * value:
            return Verdict(False, _WHY[name], name)
    way = "less" if number > right else "more"
    return Verdict(
        False, f"It is {way}: three factors, 1 minus the distance in rows, in columns and in directions."
    )
