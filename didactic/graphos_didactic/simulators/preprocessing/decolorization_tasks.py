"""What the simulator of decolourisation asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.preprocessing.decolorization_model import Decolorized, luma_of, same_luma
from graphos_didactic.simulators.preprocessing.decolorization_params import DecolorizationParams

LUMA_APART = 2.0
"""Levels of luma below which two colours are the same grey."""
COLOUR_APART = 25.0
"""CIELAB difference above which they are different colours, units of L."""


def _moved(params: DecolorizationParams) -> DecolorizationParams:
    return params.replace(picture="two", b_hue=(params.b_hue + 120.0) % 360.0)


def _apart(params: DecolorizationParams, setting: Setting) -> list[float]:
    seen = Decolorized(_moved(params), setting)
    return [seen.kept(channel)[0] for channel in ("red", "green", "blue")]


def _answer(params: DecolorizationParams, setting: Setting) -> int:
    return int(np.argmax(_apart(params, setting)))


def _explain(params: DecolorizationParams, setting: Setting) -> str:
    red, green, blue = _apart(params, setting)
    seen = Decolorized(_moved(params), setting)
    return (
        f"A and B now differ by {red:.0f} in red, {green:.0f} in green and {blue:.0f} in blue (of 100), by "
        f"{seen.kept('luma')[0]:.0f} in luma; their colour difference is {seen.pairs[0][1]:.0f}. No single channel is best "
        f"for all colours: that is why the weights are looked for in each photo."
    )


PREDICTION = Prediction(
    question="The hue of B goes on by 120°. In which channel do A and B differ most then?",
    choices=("red", "green", "blue"),
    change=_moved,
    answer=_answer,
    explain=_explain,
)


def decolorization_task(seed: int) -> Task:
    """Ask to move colour B to where luma cannot tell it from A, though it is another colour."""
    draw = np.random.default_rng(seed)
    while True:
        a_hue, b_hue = (float(draw.integers(0, 36) * 10) for _ in "ab")
        a_light, chroma = float(draw.integers(45, 66)), float(draw.integers(30, 46))
        start = DecolorizationParams(
            a_hue=a_hue,
            a_light=a_light,
            b_hue=b_hue,
            b_light=float(draw.choice([35.0, 78.0])),
            chroma=chroma,
            noise=1.0,
        )
        level = luma_of(a_hue, a_light, chroma)
        light = float(same_luma(np.array([b_hue]), level, chroma)[0])
        far = abs((b_hue - a_hue + 180.0) % 360.0 - 180.0) > 70.0
        same_lightness = abs(luma_of(b_hue, a_light, chroma) - level)
        if far and np.isfinite(light) and same_lightness > 3.0 * LUMA_APART:
            break
    solution = start.replace(b_light=min(max(light, 20.0), 90.0))
    mistakes = {
        "Same lightness is not the same luma": start.replace(b_light=a_light),
        "The same colour": start.replace(b_hue=a_hue, b_light=a_light),
    }
    text = (
        f"Drag colour B in the plane to where luma cannot tell it from A (less than {LUMA_APART:g} of 255 levels apart), "
        f"while it stays another colour (CIELAB difference above {COLOUR_APART:g}). The dashed curve is not shown the way."
    ).replace(" The dashed curve is not shown the way.", "")
    return Task(text, start, None, _check, solution, mistakes, free=("b_hue", "b_light"))


def _check(params: DecolorizationParams, number: float | None) -> Verdict:
    p = params
    apart = abs(luma_of(p.b_hue, p.b_light, p.chroma) - luma_of(p.a_hue, p.a_light, p.chroma))
    colour = Decolorized(p.replace(picture="two"), Setting()).pairs[0][1]
    if colour <= COLOUR_APART:
        return Verdict(False, f"A and B are nearly the same colour: their difference is {colour:.0f} of the "
                       f"{COLOUR_APART:g} that are asked for.", "The same colour")  # fmt: skip
    if apart < LUMA_APART:
        return Verdict(True, f"Right: luma differs by {apart:.1f} levels, the colours by {colour:.0f}.")
    if abs(p.b_light - p.a_light) < 0.75:
        return Verdict(False, f"Both have the same CIELAB lightness, but luma weighs the channels as they are stored: it "
                       f"differs by {apart:.1f} levels.", "Same lightness is not the same luma")  # fmt: skip
    return Verdict(False, f"Luma still differs by {apart:.1f} levels (colours by {colour:.0f}).")
