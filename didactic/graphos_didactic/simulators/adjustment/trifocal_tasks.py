"""What the simulator of the trifocal tensor asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.epipolar import epipolar_lines, fundamental_from_essential
from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.adjustment.trifocal_model import (
    HEIGHT,
    HEIGHTS,
    WIDTH,
    ThreePhotos,
    TrifocalParams,
)

TOLERANCE_PX = 14.0
"""A mark in photo C is right within this distance of the true image."""
USABLE_PX = 20.0
"""A transfer with a smaller median error is usable."""
FIRST, SECOND = "Only the line of photo A", "Only the line of photo B"


def _into_plane(params: TrifocalParams) -> TrifocalParams:
    height = ThreePhotos(params).height_in_plane
    if not abs(height) <= 1.6 or abs(height - params.p_z) < 0.02:
        return params.replace(p_z=0.9 if params.p_z < 0.4 else -0.9)
    return params.replace(p_z=height)


def _typical(params: TrifocalParams) -> tuple[float, float]:
    """Return the median errors by lines and by the tensor, px, at the point's height."""
    errors = ThreePhotos(params).errors_of_heights()[int(np.argmin(np.abs(HEIGHTS - params.p_z)))]
    return float(errors[0]), float(errors[1])


def _answer(params: TrifocalParams, setting: Setting) -> int:
    lines, tensor = (error < USABLE_PX for error in _typical(_into_plane(params)))
    return {(True, True): 0, (False, True): 1, (True, False): 2, (False, False): 3}[lines, tensor]


def _explain(params: TrifocalParams, setting: Setting) -> str:
    after = _into_plane(params)
    lines, tensor = _typical(after)
    shown = f"{lines:.0f} px" if lines < 9999 else "beyond all measure"
    return (
        f"At height {after.p_z:.2f} m the median error in photo C is {shown} by lines and {tensor:.1f} px by the tensor. "
        "In the plane of the three centres both epipolar lines are one line; the tensor also uses where the point "
        "lies on it in photo B."
    ).replace("-", "−")


PREDICTION = Prediction(
    question="P moves into the plane of the three projection centres (or out of it, if it is there). "
    f"Which transfer then finds it in photo C within {USABLE_PX:.0f} px?",
    choices=("both", "only the tensor", "only the epipolar lines", "neither"),
    change=_into_plane,
    answer=_answer,
    explain=_explain,
)


def trifocal_task(seed: int) -> Task:
    """Ask for the place of the point in the third photo."""
    draw = np.random.default_rng(seed)
    while True:
        sheet = TrifocalParams(
            a_x=float(np.round(draw.uniform(-4, -2), 1)),
            b_x=float(np.round(draw.uniform(-0.8, 0.8), 1)),
            c_x=float(np.round(draw.uniform(2, 4), 1)),
            c_z=float(np.round(draw.uniform(-1.2, 1.2), 1)),
            p_x=float(np.round(draw.uniform(-1.2, 1.2), 1)),
            p_y=float(np.round(draw.uniform(0, 3), 1)),
            p_z=float(np.round(draw.choice([-1.0, 1.0]) * draw.uniform(0.6, 1.2), 1)),
            sigma_px=0.0,
            seed=int(draw.integers(0, 9999)),
            guessing=True,
        )
        found = _answers(sheet)
        if found is not None:
            break
    right, mistakes = found
    text = (
        "P is measured in photos A and B; both epipolar lines are drawn in photo C. Drag the mark in photo C to where P "
        f"must appear (within {TOLERANCE_PX:.0f} px)."
    )
    return Task(text, sheet, None, _judge, right, mistakes, ("guess_x", "guess_y"))


def _answers(sheet: TrifocalParams) -> tuple[TrifocalParams, dict[str, TrifocalParams]] | None:
    photos = ThreePhotos(sheet)
    right, lines = photos.pixels[2], lines_in_c(photos)
    angle = abs(float(lines[0][0] * lines[1][1] - lines[0][1] * lines[1][0]))
    if not np.all((photos.pixels > 60) & (photos.pixels < (WIDTH - 60, HEIGHT - 60))) or angle < 0.35:
        return None
    if np.hypot(*(right - (sheet.guess_x, sheet.guess_y))) < 3 * TOLERANCE_PX:
        return None
    along = [np.array([-line[1], line[0]]) * np.sign(-line[1] or 1.0) for line in lines]
    places = [right + way * (120 if right[0] < WIDTH / 2 else -120) for way in along]
    if not all(np.all((place > 0) & (place < (WIDTH, HEIGHT))) for place in places):
        return None
    wrong = {
        name: sheet.replace(guess_x=float(place[0]), guess_y=float(place[1]))
        for name, place in zip((FIRST, SECOND), places, strict=True)
    }
    return sheet.replace(guess_x=float(right[0]), guess_y=float(right[1])), wrong


def lines_in_c(photos: ThreePhotos) -> list[Array]:
    """Return the epipolar lines (3,) in photo C of the point measured in A and in B, px; NaN where there are none."""
    return [
        epipolar_lines(fundamental_from_essential(essential, photos.camera, photos.camera), xy[None])[0]
        for essential, xy in zip(photos.into_c, photos.measured, strict=True)
    ]


def _judge(params: TrifocalParams, number: float | None) -> Verdict:
    photos = ThreePhotos(params)
    guess = np.array([params.guess_x, params.guess_y])
    gap = float(np.hypot(*(guess - photos.pixels[2])))
    seen = f"The mark is {gap:.0f} px from where P appears. "
    if gap <= TOLERANCE_PX:
        return Verdict(True, f"Right: {seen}The point lies on both lines.")
    for name, line in zip((FIRST, SECOND), lines_in_c(photos), strict=True):
        if abs(line[:2] @ guess + line[2]) <= TOLERANCE_PX:
            why = "It lies on one line, so it fits one of the two photos: the other says how far along."
            return Verdict(False, seen + why, name)
    return Verdict(False, f"{seen}Each photo says that P lies on its line.")
