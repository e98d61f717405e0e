"""What the simulator of rotations asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.rotation import FLIP, angle_between, matrix_from_turns, turns_from_matrix
from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.rotations_model import (
    MARKS,
    RotationsParams,
    TurnedPhoto,
    with_frame,
)

TOLERANCE_DEG = 2.0
"""A photo is turned rightly within this angle."""
LIMITS = (0.5, 10.0, 40.0)
"""Where the choices of the prediction end, degrees."""


def _reversed(params: RotationsParams) -> RotationsParams:
    return params.replace(order=params.order[::-1])


def _answer(params: RotationsParams, setting: Setting) -> int:
    return int(np.searchsorted(LIMITS, TurnedPhoto(params).reversed_turn))


def _explain(params: RotationsParams, setting: Setting) -> str:
    photo = TurnedPhoto(params)
    return (
        f"The two orientations are {photo.reversed_turn:.1f}° apart. Each turn carries the axes of the following "
        f"turns with it, so {params.omega:.0f}°, {params.phi:.0f}° and {params.kappa:.0f}° mean something only together "
        "with their order. Small angles nearly commute; large ones do not."
    ).replace("-", "−")


PREDICTION = Prediction(
    question="The same three angles, but the turns in reverse order. How far is the photo then from where it is now?",
    choices=("it is the same", "up to 10°", "10° to 40°", "more than 40°"),
    change=_reversed,
    answer=_answer,
    explain=_explain,
)


def _wrong_frames(right: Array) -> dict[str, Array]:
    """Return what typical confusions make of an orientation."""
    return {
        "The inverse rotation": right.T,
        "The order of the turns": matrix_from_turns("xyz", turns_from_matrix("zyx", right)[::-1]),
    }


def rotations_task(seed: int) -> Task:
    """Ask for the orientation in which the marks were photographed."""
    draw = np.random.default_rng(seed)
    while True:
        angles = np.round([draw.uniform(-25, 25), draw.uniform(-25, 25), draw.uniform(-120, 120)])
        sheet = RotationsParams(omega=0.0, phi=0.0, kappa=0.0, true_omega=float(angles[0]),
                                true_phi=float(angles[1]), true_kappa=float(angles[2]))  # fmt: skip
        photo = TurnedPhoto(sheet)
        right = (FLIP @ photo.true_rotation).T
        wrong = _wrong_frames(right)
        frames = [right, np.eye(3), *wrong.values()]
        gaps = [angle_between(a, b) for i, a in enumerate(frames) for b in frames[:i]]
        seen = photo.image(photo.true_rotation, MARKS)
        if np.degrees(min(gaps)) > 4 * TOLERANCE_DEG and np.isfinite(seen).all():
            break
    text = (
        "The rings show where the five marks on the ground really appeared in the photo. Turn the photo until the "
        f"marks lie in the rings: within {TOLERANCE_DEG:g}°."
    )
    answers = {name: sheet.replace(**with_frame(sheet, frame)) for name, frame in wrong.items()}
    solution = sheet.replace(**with_frame(sheet, right))
    return Task(text, sheet, None, _judge, solution, answers, ("omega", "phi", "kappa"))


def _judge(params: RotationsParams, number: float | None) -> Verdict:
    photo = TurnedPhoto(params)
    if photo.error <= TOLERANCE_DEG:
        return Verdict(True, f"Right: the photo is {photo.error:.1f}° from the true orientation.")
    seen = f"The photo is {photo.error:.1f}° from the true orientation. "
    why = {
        "The inverse rotation": "This is the transposed matrix: object into photo instead of photo into object.",
        "The order of the turns": "These are the angles for the order κ, φ, ω; the sheet turns ω, φ, κ.",
    }
    for name, frame in _wrong_frames((FLIP @ photo.true_rotation).T).items():
        if np.degrees(angle_between(frame, photo.frame)) <= TOLERANCE_DEG:
            return Verdict(False, seen + why[name], name)
    aside = np.degrees(np.arccos(np.clip(photo.rotation[2] @ photo.true_rotation[2], -1.0, 1.0)))
    if aside <= TOLERANCE_DEG:
        return Verdict(False, seen + "It looks the right way; only κ, the turn in its own plane, is missing.")
    return Verdict(False, seen + f"Its direction of view is {aside:.1f}° off: begin with ω and φ.")
