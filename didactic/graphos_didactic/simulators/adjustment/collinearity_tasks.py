"""What the simulator of collinearity asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.collinearity_model import (
    X0,
    CollinearityParams,
    ControlPhoto,
)

TOLERANCE_PX = 3.0
"""A computed image coordinate is right within this distance."""
THIN, DEEP = 0.35, 2.0
"""Depths of the control between which the prediction changes, m."""


def _pressed(params: CollinearityParams) -> CollinearityParams:
    return params.replace(fold=THIN if params.fold > 1.1 * THIN else DEEP)


def _both(params: CollinearityParams) -> tuple[ControlPhoto, ControlPhoto]:
    return ControlPhoto(params), ControlPhoto(_pressed(params))


def _answer(params: CollinearityParams, setting: Setting) -> int:
    before, after = _both(params)
    if not after.linear:
        return 3
    if not before.linear:
        return 1
    ratio = after.linear.rms_px / max(before.linear.rms_px, 1e-9)
    return 0 if ratio > 2 else 2 if ratio < 0.5 else 1


def _explain(params: CollinearityParams, setting: Setting) -> str:
    before, after = _both(params)
    rms = [f"{p.linear.rms_px:.2f} px" if p.linear else "refused" for p in (before, after)]
    errors = [1e3 * p.centre_errors[0] for p in (before, after)]
    said = [f"{e:.0f} mm" if np.isfinite(e) else "not determined" for e in errors]
    return (
        f"Depth {before.params.fold:.2f} → {after.params.fold:.2f} m: RMS residual {rms[0]} → {rms[1]}, error of the "
        f"projection centre {said[0]} → {said[1]}. Residuals say how well the points are met, not how well the camera "
        "is known."
    )


PREDICTION = Prediction(
    question=f"The control is pressed nearly flat ({THIN:g} m), or unfolded to {DEEP:g} m if it is flat already. What do the residuals of the DLT do?",
    choices=("more than double", "stay about the same", "less than half", "the DLT is refused"),
    change=_pressed,
    answer=_answer,
    explain=_explain,
)


def collinearity_task(seed: int) -> Task:
    """Ask for an image coordinate, by the collinearity equation of a level camera."""
    draw = np.random.default_rng(seed)
    while True:
        sheet = CollinearityParams(
            x=float(np.round(draw.uniform(-1.5, 1.5), 1)),
            y=float(np.round(draw.uniform(-2.0, 1.0), 1)),
            z=float(np.round(draw.uniform(-0.5, 0.5), 1)),
            aim="ahead",
            focal_px=float(draw.integers(16, 30) * 50),
            seed=int(draw.integers(1, 9999)),
            sigma_px=0.0,
        )
        photo = ControlPhoto(sheet)
        right = float(photo.true_pixels[0, 0])
        mistakes = _mistakes(photo)
        values = [right, *mistakes.values()]
        gaps = [abs(a - b) for i, a in enumerate(values) for b in values[:i]]
        if bool(photo.used[0]) and min(gaps) > 4 * TOLERANCE_PX:
            break
    px, py, pz = photo.points[0]
    text = (
        f"The camera looks straight along Y from ({sheet.x:.1f}, {sheet.y:.1f}, {sheet.z:.1f}) m, f = {sheet.focal_px:.0f} px, "
        f"x₀ = {X0:.1f} px. Point 1 lies at ({px:.2f}, {py:.2f}, {pz:.2f}) m. At which x does it appear in the photo "
        f"(within {TOLERANCE_PX:g} px)?"
    ).replace("-", "−")

    def check(params: CollinearityParams, number: float | None) -> Verdict:
        return _judge(photo, number)

    return Task(text, sheet, "px", check, right, mistakes, ("orbit",))


def _mistakes(photo: ControlPhoto) -> dict[str, float]:
    x, _, z = photo.in_camera[0]
    f = photo.params.focal_px
    return {
        "Principal point forgotten": float(f * x / z),
        "Centre minus point": float(X0 - f * x / z),
        "Coordinate instead of depth": float(X0 + f * x / photo.points[0, 1]),
    }


def _judge(photo: ControlPhoto, number: float | None) -> Verdict:
    if number is None or not np.isfinite(number):
        return Verdict(False, "Answer with a number in px.")
    right = float(photo.true_pixels[0, 0])
    x, _, z = photo.in_camera[0]
    if abs(number - right) <= TOLERANCE_PX:
        return Verdict(True, f"Right: x = x₀ + f · {x:.2f} / {z:.2f} = {right:.1f} px.".replace("-", "−"))
    why = {
        "Principal point forgotten": "That counts from the principal point; pixels count from the first one.",
        "Centre minus point": "The vector goes from the projection centre to the point, X − C.",
        "Coordinate instead of depth": "Divide by the depth from the camera, Y − Y₀, not by the point's own Y.",
    }
    for name, value in _mistakes(photo).items():
        if abs(number - value) <= TOLERANCE_PX:
            return Verdict(False, f"{number:.1f} px is {abs(number - right):.1f} px off. {why[name]}", name)
    return Verdict(False, f"{number:.1f} px is {abs(number - right):.1f} px off.".replace("-", "−"))
