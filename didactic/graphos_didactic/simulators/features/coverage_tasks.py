"""What the simulator of the coverage asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.features.coverage_model import NAMES, Covered
from graphos_didactic.simulators.features.coverage_params import GROUPS, CoverageSimulatorParams

MORE, SIDE = "More points instead of others", "One side is enough"
K1 = NAMES.index("k1")
SAME, MUCH = 1.3, 3.0
"""Factors of a standard deviation that stays about the same, and that grows very much."""
PLACES = tuple(f"{group}_{axis}" for group in GROUPS for axis in "xy")


def _moved(params: CoverageSimulatorParams, factor: float) -> CoverageSimulatorParams:
    places = {name: float(np.clip(50.0 + factor * (getattr(params, name) - 50.0), 0, 100)) for name in PLACES}
    return params.replace(**places)


def _other(params: CoverageSimulatorParams) -> CoverageSimulatorParams:
    """Move wide groups to the middle, narrow ones outwards."""
    far = max(abs(getattr(params, name) - 50.0) for name in PLACES)
    if far < 1.0:
        return params.replace(a_x=20.0, a_y=20.0, b_x=80.0, b_y=20.0, c_x=20.0, c_y=80.0, d_x=80.0, d_y=80.0)
    return _moved(params, 0.4 if far > 22.0 else 3.0)


def _sigmas(params: CoverageSimulatorParams, setting: Setting) -> tuple[float, float]:
    before, after = (Covered(p, setting).sigmas[K1] for p in (params, _other(params)))
    return float(before), float(after)


def _answer(params: CoverageSimulatorParams, setting: Setting) -> int:
    before, after = _sigmas(params, setting)
    if not np.isfinite(after):
        return 3
    factor = before / after if np.isfinite(before) else np.inf
    if factor > MUCH:
        return 0
    return 1 if factor > SAME else 2 if factor > 1 / SAME else 3


def _explain(params: CoverageSimulatorParams, setting: Setting) -> str:
    sigmas = [
        f"{1e3 * s:.2f} · 10⁻³" if np.isfinite(s) else "not determined" for s in _sigmas(params, setting)
    ]
    return (
        f"σ of k₁ goes from {sigmas[0]} to {sigmas[1]}. Distortion grows with the third power of the radius: a point near "
        "the middle hardly feels it, one in the corner does. The number of points stayed the same."
    )


PREDICTION = Prediction(
    question="All groups move away from the middle (or, if they are there, back to it). What does σ of k₁ do?",
    choices=("it falls to less than a third", "it falls, but less", "it stays about the same", "it grows"),
    change=_other,
    answer=_answer,
    explain=_explain,
)


def coverage_task(seed: int) -> Task:
    """Ask for places of the groups that determine principal point and distortion well enough."""
    rng = np.random.default_rng([seed, 29])
    while True:
        middle = {name: float(rng.integers(40, 61)) for name in PLACES}
        sheet = CoverageSimulatorParams(
            points=int(rng.integers(10, 21)) * 4, spread=float(rng.integers(8, 15)),
            sigma_px=float(rng.integers(4, 10)) / 10, seed=int(rng.integers(0, 9999)),
        ).replace(**middle)  # fmt: skip
        low, high = float(rng.integers(10, 17)), float(rng.integers(84, 91))
        right = sheet.replace(a_x=low, a_y=low, b_x=high, b_y=low, c_x=low, c_y=high, d_x=high, d_y=high)
        best = Covered(right, Setting())
        limits = (
            float(f"{1.35 * best.sigmas[1:3].max():.2g}"),
            float(f"{1.5 * best.image_sigmas[-1]:.2g}"),
        )
        mistakes = {
            MORE: sheet.replace(points=200),
            SIDE: right.replace(b_x=low + 6.0, d_x=low + 6.0),
        }
        named = all(_judge(wrong, limits, sheet).misconception == name for name, wrong in mistakes.items())
        if named and _judge(right, limits, sheet).right and not _judge(sheet, limits, sheet).right:
            break
    text = (
        f"{sheet.points} points in each photo, σ = {sheet.sigma_px:.1f} px. Drag the groups so that σ of x₀ and of y₀ is at "
        f"most {limits[0]:g} px and the image in the corner is known to {limits[1]:g} px."
    )
    free = (*PLACES, "points")
    return Task(text, sheet, None, lambda p, _: _judge(p, limits, sheet), right, mistakes, free)


def _judge(
    params: CoverageSimulatorParams, limits: tuple[float, float], start: CoverageSimulatorParams
) -> Verdict:
    found = Covered(params, Setting())
    point, corner = float(found.sigmas[1:3].max()), float(found.image_sigmas[-1])
    if not np.isfinite(corner):
        return Verdict(False, "The camera is not determined at all: the points lie too near together.", MORE)
    seen = f"σ of the principal point is {point:.2f} px (at most {limits[0]:g}), of the corner {corner:.2f} px ({limits[1]:g}). "
    if point <= limits[0] and corner <= limits[1]:
        return Verdict(True, f"Right: {seen}")
    x = np.array([getattr(params, f"{g}_x") for g in GROUPS])
    y = np.array([getattr(params, f"{g}_y") for g in GROUPS])
    if max(abs(x.mean() - 50.0), abs(y.mean() - 50.0)) > 15.0:
        why = "Radial distortion and principal point look alike from one side: points on the other side tell them apart."
        return Verdict(False, seen + why, SIDE)
    if params.points > start.points:
        why = "Twice the points are worth √2 everywhere they are, and nothing where they are not."
        return Verdict(False, seen + why, MORE)
    return Verdict(
        False, seen + "Distortion grows with the third power of the radius: what do the corners say?"
    )
