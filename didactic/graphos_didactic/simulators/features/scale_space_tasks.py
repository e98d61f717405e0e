"""What the simulator of the scale space asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_core.features.detectors.scale_space import ScaleSpace
from graphos_core.features.detectors.scale_space_extrema import KEPT
from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.features.scale_space_model import BLOB, HEIGHT, WIDTH, WORDS, Looked
from graphos_didactic.simulators.features.scale_space_params import OCTAVES, ScaleSpaceParams

TOLERANCE = 0.03
"""Of the diameter."""
LARGEST_SIZE = 14.0


def _at_blob(params: ScaleSpaceParams) -> ScaleSpaceParams:
    return params.replace(picture="blobs", x=100.0 * BLOB[0] / (WIDTH - 1), y=100.0 * BLOB[1] / (HEIGHT - 1))


def _doubled(params: ScaleSpaceParams) -> ScaleSpaceParams:
    return _at_blob(params).replace(size=min(2.0 * params.size, LARGEST_SIZE))


def _answer(params: ScaleSpaceParams, setting: Setting) -> int:
    before, after = Looked(_at_blob(params), setting), Looked(_doubled(params), setting)
    a, b = before.chosen, after.chosen
    if b is None or after.extrema.verdict[b] != KEPT:
        return 3
    moved = after.scale_of(b) - before.scale_of(a) if a is not None else 0.0
    return int(np.argmin(np.abs(np.array([0.0, 1.0 / params.layers, 1.0]) - moved)))


def _explain(params: ScaleSpaceParams, setting: Setting) -> str:
    before, after = Looked(_at_blob(params), setting), Looked(_doubled(params), setting)
    a, b = before.chosen, after.chosen
    sizes = f"s from {before.params.size:g} to {after.params.size:g} px"
    if b is None:
        return f"{sizes}: no extremum is left; the blob is too weak or too large for {OCTAVES} octaves."
    verdict = WORDS[int(after.extrema.verdict[b])]
    if a is None:
        return f"{sizes}: now there is an extremum at {after.scale_of(b):.2f} octaves ({verdict})."
    return (
        f"{sizes}: the extremum goes from {before.scale_of(a):.2f} to {after.scale_of(b):.2f} octaves ({verdict}). Twice "
        f"as wide is one octave, which is {params.layers} layer{'s' if params.layers > 1 else ''}: that is why the same "
        "wall is recognised from half the distance."
    )


PREDICTION = Prediction(
    question="The blob becomes twice as wide. Where does its extremum go?",
    choices=("it stays", "one layer up", "one octave up", "it is lost as a keypoint"),
    change=_doubled,
    answer=_answer,
    explain=_explain,
)


def scale_space_task(seed: int) -> Task:
    """Ask for the diameter of a keypoint whose octave, layer and fitted offset are given."""
    draw = np.random.default_rng(seed)
    octave, layers = int(draw.integers(1, OCTAVES)), int(draw.integers(2, 5))
    layer = int(draw.integers(1, layers + 1))
    offset = round(float(draw.choice([-1.0, 1.0]) * draw.uniform(0.25, 0.49)), 2)
    sigma = float(draw.integers(14, 21)) / 10
    start = ScaleSpaceParams(
        layers=layers,
        sigma=sigma,
        level=octave * layers + layer,
        size=float(draw.integers(4, 20)) / 2,
        seed=seed % 9999,
    )
    space = ScaleSpace(gaussians=(), differences=(), layers=layers, sigma=sigma)
    right = 2.0 * space.blur(octave, layer + offset)
    mistakes = {
        "Octave forgotten": 2.0 * space.blur(0, layer + offset),
        "Radius instead of diameter": right / 2.0,
        "Enlargement forgotten": 2.0 * right,
        "Offset forgotten": 2.0 * space.blur(octave, layer),
    }
    if octave == 1:  # half the size in both cases
        del mistakes["Octave forgotten"]

    def check(params: ScaleSpaceParams, number: float | None) -> Verdict:
        return _judge(number, right, mistakes)

    text = (
        f"A keypoint was found in octave {octave} (the first is 0), layer {layer} of n = {layers}, and the fit moved it by "
        f"{offset:+.2f} layers. The first blur is σ₀ = {sigma:g} px of the photo enlarged twice. What is its diameter "
        f"2σ in px of the photo (± {100 * TOLERANCE:g} %)?"
    )
    return Task(text, start, "px", check, right, mistakes)


_WHY = {
    "Octave forgotten": "Every octave halves the picture: a pixel of octave o is 2ᵒ pixels of the first one.",
    "Radius instead of diameter": "That is σ; the diameter is twice as much.",
    "Enlargement forgotten": "The first octave is the photo enlarged twice: its pixels are half as large.",
    "Offset forgotten": "The fit x counts too: σ = σ₀ 2^(o + (i + x)/n) times the first pixel.",
}


def _judge(number: float | None, right: float, mistakes: dict[str, float]) -> Verdict:
    if number is None:
        return Verdict(False, "A number is asked.")
    if abs(number - right) <= TOLERANCE * right:
        return Verdict(True, f"Right: {right:.2f} px.")
    for name, value in mistakes.items():
        if abs(number - value) <= TOLERANCE * value:
            return Verdict(False, _WHY[name], name)
    way = "smaller" if number > right else "larger"
    return Verdict(False, f"It is {way}: σ = ½ σ₀ 2^(o + (i + x)/n) px of the photo, and the diameter is 2σ.")
