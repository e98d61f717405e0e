"""What the simulator of the Wallis filter asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.preprocessing.wallis_model import (
    Filtered,
    WallisSimulatorParams,
    filtered_value,
)

TOLERANCE = 1.5
"""Grey levels."""


def _stronger(params: WallisSimulatorParams) -> WallisSimulatorParams:
    return params.replace(target_std=min(2.0 * params.target_std, 120.0))


def _ratio(params: WallisSimulatorParams, setting: Setting) -> float:
    return Filtered(_stronger(params), setting).gain / max(Filtered(params, setting).gain, 1e-9)


def _answer(params: WallisSimulatorParams, setting: Setting) -> int:
    asked = _stronger(params).target_std / params.target_std
    ratio = _ratio(params, setting)
    if ratio < 1.02:
        return 2
    return 0 if ratio > 0.98 * asked else 1


def _explain(params: WallisSimulatorParams, setting: Setting) -> str:
    before, after = Filtered(params, setting), Filtered(_stronger(params), setting)
    return (
        f"s_t from {params.target_std:.0f} to {after.params.target_std:.0f}: the gain goes from {before.gain:.2f} to "
        f"{after.gain:.2f}, factor {_ratio(params, setting):.2f}. With contrast weight c = {params.contrast:.2f} the "
        f"local standard deviation ({before.std:.1f}) is pulled only part of the way; only c = 1 reaches s_t."
    )


PREDICTION = Prediction(
    question="The target standard deviation is doubled. What does the gain in this window do?",
    choices=("it doubles", "it grows, but less", "it stays"),
    change=_stronger,
    answer=_answer,
    explain=_explain,
)


def wallis_task(seed: int) -> Task:
    """Ask for the filtered grey value of one pixel, from the window's statistics."""
    draw = np.random.default_rng(seed)
    while True:
        sheet = WallisSimulatorParams(
            target_mean=float(draw.integers(100, 150)),
            target_std=float(draw.integers(40, 70)),
            contrast=float(draw.integers(10, 18)) / 20,
            brightness=float(draw.integers(8, 18)) / 20,
            x=float(draw.integers(15, 85)),
            y=float(draw.integers(20, 80)),
        )
        seen = Filtered(sheet, Setting())
        mean, std = round(seen.mean, 1), round(seen.std, 1)
        grey = float(round(mean + float(draw.uniform(-1.2, 1.2)) * std))
        right = filtered_value(sheet, grey, mean, std)
        mistakes = _mistakes(sheet, grey, mean, std)
        values = sorted([right, *mistakes.values()])
        if std > 8 and 5 < right < 250 and float(np.diff(values).min()) > 2.5 * TOLERANCE:
            break

    def check(params: WallisSimulatorParams, number: float | None) -> Verdict:
        return _judge(number, right, mistakes)

    text = (
        f"In the marked window the mean is m = {mean:.1f} and the standard deviation s = {std:.1f}. Targets: m_t = "
        f"{sheet.target_mean:.0f}, s_t = {sheet.target_std:.0f}; weights c = {sheet.contrast:.2f}, b = "
        f"{sheet.brightness:.2f}. What becomes of the grey value {grey:.0f} in its middle (± {TOLERANCE:g})?"
    )
    return Task(text, sheet, "grey level", check, right, mistakes)


def _mistakes(sheet: WallisSimulatorParams, grey: float, mean: float, std: float) -> dict[str, float]:
    """Return what typical misconceptions give, each by the engine with the wrong input."""
    return {
        "Brightness weight forgotten": filtered_value(sheet.replace(brightness=1.0), grey, mean, std),
        "Contrast weight forgotten": filtered_value(sheet.replace(contrast=1.0), grey, mean, std),
        "Variance instead of standard deviation": filtered_value(sheet, grey, mean, std * std),
        "Local mean not subtracted": filtered_value(sheet, grey + mean, mean, std),
    }


_WHY = {
    "Brightness weight forgotten": "Only the part b of the mean is pulled to m_t; (1 − b) m stays.",
    "Contrast weight forgotten": "With c below 1 the gain is smaller than s_t / s.",
    "Variance instead of standard deviation": "The gain divides by s, not by s².",
    "Local mean not subtracted": "The gain acts on the difference g − m, not on g itself.",
}


def _judge(number: float | None, right: float, mistakes: dict[str, float]) -> Verdict:
    if number is None:
        return Verdict(False, "A number is asked.")
    if abs(number - right) <= TOLERANCE:
        return Verdict(True, f"Right: the engine gives {right:.1f}.")
    for name, value in mistakes.items():
        if abs(number - value) <= TOLERANCE:
            return Verdict(False, _WHY[name], name)
    way = "less" if number > right else "more"
    return Verdict(
        False, f"The engine gives {way}. Gain first: it acts on g − m; then the two means are mixed."
    )
