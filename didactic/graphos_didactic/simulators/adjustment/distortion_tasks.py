"""What the simulator of lens distortion asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.distortion_model import CORNER, Lens, radial_at
from graphos_didactic.simulators.adjustment.distortion_params import DistortionParams

TOLERANCE_PX = 4.0
"""A lens is met within this root mean square distance of the grid."""
SAME_PX = 1e-6
"""Positions that differ by less are the same."""
SIGN, CORNER_ONLY = "The sign turned", "Only the corner fits"


def _rebalanced(params: DistortionParams) -> DistortionParams:
    return params.replace(zero_px=2500.0 if params.zero_px < 2000.0 else 1200.0)


def _moved(params: DistortionParams) -> tuple[float, float, float]:
    """Return how far any image radius moves, px, and both balanced principal distances."""
    before, after = Lens(params).balanced, Lens(_rebalanced(params)).balanced
    f = params.focal_px
    places = [p.radius_px * p.focal_px / f + p.displacement_px for p in (before, after)]
    return float(np.nanmax(np.abs(places[1] - places[0]))), before.focal_px, after.focal_px


def _answer(params: DistortionParams, setting: Setting) -> int:
    return 0 if _moved(params)[0] < SAME_PX else 1


def _explain(params: DistortionParams, setting: Setting) -> str:
    moved, before, after = _moved(params)
    return (
        f"The principal distance changes from {before:.1f} to {after:.1f} px and the distortion that is left changes with "
        f"it, so no point moves by more than {max(moved, SAME_PX):g} px. Gaussian and balanced are two ways to write one lens: compare "
        "coefficients only together with their principal distance."
    )


PREDICTION = Prediction(
    question="The distortion is balanced at another radius. What happens to the points in the photo?",
    choices=("nothing", "they move outwards or inwards", "only the corners move"),
    change=_rebalanced,
    answer=_answer,
    explain=_explain,
)


def distortion_task(seed: int) -> Task:
    """Ask for the radial coefficients of a lens whose grid is shown."""
    draw = np.random.default_rng(seed)
    while True:
        k1 = float(np.round(draw.choice([-1.0, 1.0]) * draw.uniform(0.08, 0.25), 2))
        k2 = float(np.round(-np.sign(k1) * draw.uniform(0.06, 0.16), 2))
        sheet = DistortionParams(
            model="basic", k1=0.0, k2=0.0, p1=0.0, p2=0.0, b1=0.0, b2=0.0, true_k1=k1, true_k2=k2,
            focal_px=float(draw.integers(24, 34) * 100), exaggeration=2,
        )  # fmt: skip
        lens = Lens(sheet)
        alone = lens.wished("k1", lambda camera: radial_at(camera, CORNER), radial_at(lens.truth, CORNER))
        wrong = {
            SIGN: sheet.replace(k1=-k1, k2=-k2),
            CORNER_ONLY: sheet.replace(k1=float(np.clip(alone, -0.5, 0.5))),
        }
        if all(_judge(answer, None).misconception == name for name, answer in wrong.items()):
            break
    text = (
        "The rings show where a real lens images the grid. Set k1 and k2 so that the grid runs through them "
        f"(root mean square within {TOLERANCE_PX:g} px)."
    )
    return Task(text, sheet, None, _judge, sheet.replace(k1=k1, k2=k2), wrong, ("k1", "k2"))


def _judge(params: DistortionParams, number: float | None) -> Verdict:
    lens = Lens(params)
    if lens.rms_px <= TOLERANCE_PX:
        return Verdict(True, f"Right: the grid is {lens.rms_px:.1f} px (RMS) from the real lens.")
    seen = f"The grid is {lens.rms_px:.1f} px (RMS) from the real lens. "
    if Lens(params.replace(k1=-params.k1, k2=-params.k2)).rms_px <= TOLERANCE_PX:
        why = "Here positive moves outwards, from the ideal to the measured point; other programs go the other way."
        return Verdict(False, seen + why, SIGN)
    if abs(radial_at(lens.camera, CORNER) - radial_at(lens.truth, CORNER)) <= TOLERANCE_PX:
        why = "The corner fits, the curve between does not: look at the profile, not at one point."
        return Verdict(False, seen + why, CORNER_ONLY)
    return Verdict(False, seen + "Begin with k1 near the middle, then bend the corner with k2.")
