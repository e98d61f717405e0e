"""What the simulator of the epipolar geometry asks: a prediction and a challenge."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.epipolar import line_distances
from graphos_didactic.simulator import Prediction, Setting, Task, Verdict
from graphos_didactic.simulators.features.epipolar_model import (
    HEIGHT,
    WIDTH,
    EpipolarParams,
    TwoCameras,
)
from graphos_didactic.simulators.format_edges import line_in_format

TOLERANCE_PX = 10.0
"""A guess this near to the line is right."""
DEPTHS = np.geomspace(0.05, 1e4, 4000)
"""Depths at which the line in B can be reached from A, m."""


def _farther(params: EpipolarParams) -> EpipolarParams:
    both = TwoCameras(params)
    low, high = -8.0, 8.0
    factor = 1.6
    place = both.on_ray(both.pixels[0], both.depth * factor) if both.depth > 0 else both.point
    if not (abs(place[0]) <= 6 and low <= place[1] <= high and abs(place[2]) <= 3):
        place = both.on_ray(both.pixels[0], both.depth / factor)
    x, y, z = (float(np.clip(c, -b, b)) for c, b in zip(place, (6.0, 8.0, 3.0), strict=True))
    return params.replace(p_x=x, p_y=y, p_z=z)


def _moved(params: EpipolarParams) -> tuple[float, float]:
    """Return how far the image in B moves, and how far it then is from the old line, px."""
    before, after = TwoCameras(params), TwoCameras(_farther(params))
    way = float(np.hypot(*(after.pixels[1] - before.pixels[1])))
    if before.line is None:
        return way, 0.0
    off = line_distances(before.fundamental, before.pixels[:1], after.pixels[1:])[1][0]
    return way, float(off)


def _answer(params: EpipolarParams, setting: Setting) -> int:
    way, off = _moved(params)
    if not way > 0.5:
        return 0
    return 1 if off < 0.5 else 2


def _explain(params: EpipolarParams, setting: Setting) -> str:
    way, off = _moved(params)
    both = TwoCameras(params)
    if not way > 0.5:
        return f"Base {both.base:.2f} m: without parallax the image in B stays ({way:.1f} px), whatever the depth."
    return (
        f"The image in B moved {way:.0f} px and is {off:.1f} px from the line. The ray of A and both projection "
        "centres lie in one plane; B sees that plane as the line. Only the place on the line tells the depth."
    )


PREDICTION = Prediction(
    question="The point moves away along the ray of camera A. What does its image in photo B do?",
    choices=("it stays", "it moves along a line", "it can move anywhere"),
    change=_farther,
    answer=_answer,
    explain=_explain,
)


def epipolar_task(seed: int) -> Task:
    """Ask for a place in photo B where the partner of a point of photo A can lie."""
    draw = np.random.default_rng(seed)
    while True:
        sheet = EpipolarParams(
            a_x=float(draw.uniform(-3, -1.5)),
            b_x=float(draw.uniform(1.5, 3)),
            b_y=float(draw.uniform(-7, -5)),
            b_z=float(draw.choice([-1.0, 1.0]) * draw.uniform(1.0, 2.2)),
            a_turn=float(draw.integers(4, 16)),
            b_turn=float(draw.integers(-20, -6)),
            p_x=float(draw.uniform(-1.5, 1.5)),
            p_y=float(draw.uniform(-1, 3)),
            p_z=float(draw.uniform(-1.2, 1.2)),
            noise_px=0.0,
            photo=False,
            guessing=True,
            guess_x=WIDTH / 2,
            guess_y=HEIGHT / 2,
        )
        found = _answers(sheet)
        if found is not None:
            break
    right, mistakes = found
    text = (
        "Photo A shows the point P. Drag the mark in photo B to any place where P can appear there "
        f"(within {TOLERANCE_PX:.0f} px)."
    )
    free = ("guess_x", "guess_y")
    return Task(text, sheet, None, _judge, right, mistakes, free)


def _answers(sheet: EpipolarParams) -> tuple[EpipolarParams, dict[str, EpipolarParams]] | None:
    """Return a right answer and the typical wrong ones; None when they cannot be told apart."""
    both = TwoCameras(sheet)
    (x, y), line = both.pixels[0], both.line
    if line is None or not _inside(both.pixels).all():
        return None
    right = sheet.replace(guess_x=float(both.pixels[1, 0]), guess_y=float(both.pixels[1, 1]))
    if line_in_format(line, both.camera) is None or _judge(sheet, None).right:
        return None
    mistakes = {
        "Same place": sheet.replace(guess_x=float(x), guess_y=float(y)),
        "Same row": sheet.replace(guess_x=float((x + WIDTH / 2) % (WIDTH - 1)), guess_y=float(y)),
    }
    if any(_judge(wrong, None).misconception != name for name, wrong in mistakes.items()):
        return None
    return right, mistakes


def _inside(pixels: Array) -> Array:
    return np.all((pixels > 30) & (pixels < (WIDTH - 30, HEIGHT - 30)), axis=-1)


def _judge(params: EpipolarParams, number: float | None) -> Verdict:
    both = TwoCameras(params)
    guess = np.array([[params.guess_x, params.guess_y]])
    miss = float(line_distances(both.fundamental, both.pixels[:1], guess)[1][0])
    seen = f"The mark is {miss:.0f} px from the epipolar line. "
    if miss <= TOLERANCE_PX:
        reachable = both.images_of_depths(DEPTHS)
        gap = float(np.nanmin(np.hypot(*(reachable - guess[0]).T), initial=np.inf))
        if gap > 3 * TOLERANCE_PX:
            why = "But only a point behind camera A would appear there."
            return Verdict(False, f"{seen}{why}", "Behind the camera")
        return Verdict(True, f"Right: {seen}Each place on this line belongs to another depth.")
    offset = np.abs(guess[0] - both.pixels[0])
    if offset.max() <= 3 * TOLERANCE_PX:
        why = "That is the place in photo A; camera B stands and looks elsewhere."
        return Verdict(False, seen + why, "Same place")
    if offset[1] <= 2 * TOLERANCE_PX:
        why = "The same row holds only in the normal case: same height, parallel axes, base along the rows."
        return Verdict(False, seen + why, "Same row")
    return Verdict(False, seen + "Think of the ray of camera A as a rod: how does camera B see it?")
