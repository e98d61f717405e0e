"""What the simulator of networks asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.network_model import Network
from graphos_didactic.simulators.adjustment.network_params import MOST, NetworkParams

CLEARLY = 1.6
"""A standard deviation that changes by less than this factor is said to stay about the same."""
MORE, TILT, ROLL = "More photos of the same kind", "Tilt alone", "Roll alone"


def _other_roll(params: NetworkParams) -> NetworkParams:
    return params.replace(roll=90.0 if params.roll < 45.0 else 0.0)


def _factor(params: NetworkParams) -> float:
    before, after = (Network(p).sigmas["x0"] for p in (params, _other_roll(params)))
    if np.isfinite(before) and np.isfinite(after):
        return after / before
    return 1.0 if np.isfinite(before) == np.isfinite(after) else (np.inf if np.isfinite(before) else 0.0)


def _answer(params: NetworkParams, setting: Setting) -> int:
    factor = _factor(params)
    return 0 if factor < 1 / CLEARLY else 2 if factor > CLEARLY else 1


def _explain(params: NetworkParams, setting: Setting) -> str:
    before, after = Network(params), Network(_other_roll(params))
    shown = [
        f"{n.sigmas['x0']:.2f} px" if np.isfinite(n.sigmas["x0"]) else "not determined"
        for n in (before, after)
    ]
    return (
        f"Roll {params.roll:.0f}° → {after.params.roll:.0f}°: σ of x₀ {shown[0]} → {shown[1]}. A tilt of the camera "
        "shifts the image as the principal point does. Turned about its axis, the camera takes the principal point "
        "along, but not the tilt: then they can be told apart."
    )


PREDICTION = Prediction(
    question="Every second photo is rolled by 90° (or, if it was, back to 0°). What does σ of x₀ do?",
    choices=("it falls clearly", "it stays about the same", "it rises clearly"),
    change=_other_roll,
    answer=_answer,
    explain=_explain,
)


def _worst_point(net: Network) -> float:
    return max(net.sigmas["x0"], net.sigmas["y0"])


def network_task(seed: int) -> Task:
    """Ask for a network that determines f and the principal point well enough."""
    rng = np.random.default_rng([seed, 13])
    while True:
        sheet = NetworkParams(
            tilt=float(rng.integers(4, 10)), roll=0.0, depth=float(rng.integers(0, 4)) / 10, photos=4,
            sigma_px=float(rng.integers(2, 8)) / 10, terms="radial", seed=int(rng.integers(0, 9999)),
        )  # fmt: skip
        right = sheet.replace(tilt=float(rng.integers(32, 45)), roll=90.0, photos=5)
        best = Network(right)
        limits = (float(f"{1.3 * best.sigmas['focal_px']:.2g}"), float(f"{1.3 * _worst_point(best):.2g}"))
        mistakes = {
            MORE: sheet.replace(photos=MOST),
            TILT: right.replace(roll=0.0),
            ROLL: right.replace(tilt=sheet.tilt),
        }
        named = all(_judge(p, limits).misconception == name for name, p in mistakes.items())
        if named and _judge(right, limits).right and not _judge(sheet, limits).right:
            break
    text = (
        f"σ = {sheet.sigma_px:.1f} px, depth {sheet.depth:.1f} m. Change tilt, roll and number of photos so that σ of f "
        f"is at most {limits[0]:g} px and σ of x₀ and of y₀ at most {limits[1]:g} px."
    )
    free = ("tilt", "roll", "photos", "orbit")
    return Task(text, sheet, None, lambda params, _: _judge(params, limits), right, mistakes, free)


def _judge(params: NetworkParams, limits: tuple[float, float]) -> Verdict:
    net = Network(params)
    focal, point = net.sigmas["focal_px"], _worst_point(net)
    if not np.isfinite(focal):
        return Verdict(
            False, "The photos do not determine the principal distance at all: tilt the camera.", MORE
        )
    seen = f"σ of f is {focal:.2f} px (at most {limits[0]:g}), of the principal point {point:.2f} px ({limits[1]:g}). "
    if focal <= limits[0] and point <= limits[1]:
        return Verdict(True, f"Right: {seen}")
    if focal <= limits[0]:
        return Verdict(
            False, seen + "The principal point still imitates the tilts: only roll separates them.", TILT
        )
    if point <= limits[1] or params.roll > 45.0:
        return Verdict(
            False,
            seen + "The principal distance still imitates the distance: only tilt separates them.",
            ROLL,
        )
    return Verdict(
        False, seen + "Another photo of the same kind repeats what is known; a different one adds.", MORE
    )
