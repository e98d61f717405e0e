"""Orientation and descriptor: turn and brighten a patch, and watch its 128 numbers stay."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.features.descriptor import (
    CELLS,
    DIRECTIONS,
    LARGEST_SHARE,
    bin_shares,
    describe,
    orientation_peaks,
)
from graphos_didactic.scene import AnyMark, Formula, Matrix, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.features.descriptor_drawing import (
    HALF,
    ROWS_APART,
    fan_marks,
    handle_marks,
    number_marks,
    orientation_marks,
    patch_marks,
    picture_marks,
)
from graphos_didactic.simulators.features.descriptor_model import SIDE, Compared
from graphos_didactic.simulators.features.descriptor_params import LESSON, DescriptorParams
from graphos_didactic.simulators.features.descriptor_tasks import PREDICTION, descriptor_task
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

THINGS = {
    "a": "key point of the first picture",
    "b": "key point of the second picture",
    "gradients": "gradients: from dark to bright",
    "cells": "the 4 × 4 cells",
    "pixel": "one pixel and the cells it is shared between",
    "limit": "limit for further peaks",
    "cut": "numbers above 0.2, which are cut",
    "difference": "difference of the two descriptors",
    "truth": "how far the second picture really is turned",
}
STEPS = (
    Step("Patch", "Six diameters around the key point, on the layer of its scale."),
    Step("Gradients", "At every pixel: how steep, and where it gets brighter. Brightness has dropped out."),
    Step("Orientation", "Directions around the point in 36 bins; the highest is the key point's own."),
    Step("Upright", "Both patches are turned by their own direction: now they look alike."),
    Step("Cells", "4 × 4 cells with 8 directions each; every pixel is shared between neighbours."),
    Step("Normalise", "Divided by the length, cut at 0.2, divided again: contrast has dropped out."),
    Step("Compare", "The distance of the 128 numbers says how alike the patches are."),
)
PRESETS = (
    Preset("turned", "Turned and brighter", "Another turn, another light, nearly the same 128 numbers.", {}),
    Preset("upright", "Without orientation", "The patch is not turned upright: the descriptors have nothing in common.",
           {"orientation": "upright"}),
    Preset("noisy", "Small and noisy", "A small patch in noise: direction and numbers wander.",
           {"size": 5.0, "noise": 20.0, "x": 38.0, "y": 30.0}),
    Preset("overexposed", "Overexposed", "Light that reaches white is no longer a change of contrast.",
           {"gain": 1.8, "offset": 60.0}),
    Preset("round", "No direction", "A round blob: no direction stands out, and the one that is found says nothing about the turn.",
           {"picture": "round", "noise": 3.0, "size": 20.0}, "degenerate"),
    Preset("photo", "Your photo", "A photo of the open project; drag the key point over it.",
           {"picture": "photo", "x": 50.0, "y": 42.0}, "photo"),
)  # fmt: skip


@simulator(
    room="features",
    name="descriptor",
    title="Orientation and descriptor",
    summary="How a patch becomes 128 numbers that stay when it is turned and lit otherwise.",
    first="Drag the green handle: the second picture turns, and its numbers stay.",
    source="Lowe 2004, Distinctive image features from scale-invariant keypoints, sections 5 and 6",
    engine=(describe, orientation_peaks, bin_shares),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=descriptor_task,
    learn=LESSON,
    place=20,
)
def descriptor_simulator(params: DescriptorParams, setting: Setting) -> Scene:
    """Show both pictures, their patches, the orientation histograms, the fans, the 128 numbers and the figures."""
    seen = Compared(params, setting)
    step = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [*picture_marks(seen, step), *patch_marks(seen, step)]
    if step >= 2:
        marks += orientation_marks(seen)
    if step >= 4:
        marks += fan_marks(seen, step)
    if step >= 5:
        marks += number_marks(seen, step)
    marks += [*handle_marks(seen, step), *_sheet(seen, step)]
    return Scene(panels=_panels(seen, step), marks=tuple(marks), things=THINGS, says=_says(seen, step))


def _panels(seen: Compared, step: int) -> tuple[Panel, ...]:
    whole, cells = (-0.5, SIDE - 0.5), (-HALF, HALF)
    p = seen.params
    first = f"First · {photo_or_simulated(seen.setting)[1]}" if p.picture == "photo" else "First picture"
    upright = "upright" if step >= 3 else "not turned yet"
    return (
        _square("first", first, (0.0, 0.0, 0.265, 0.5), whole),
        _square("second", f"Second · turned by {p.turn:.0f}°", (0.0, 0.5, 0.265, 0.5), whole),
        _square("patch_a", f"First patch · {upright}", (0.265, 0.0, 0.265, 0.5), cells),
        _square("patch_b", f"Second patch · {upright}", (0.265, 0.5, 0.265, 0.5), cells),
        Panel(name="orientation", title="Directions of the gradients", rect=(0.53, 0.0, 0.25, 0.32), x_range=(-5.0, 355.0),
              y_range=(0.0, 1.18), x_label="direction, clockwise from the right [°]", legend="above"),
        _square("fan", "4 × 4 cells × 8 directions", (0.53, 0.32, 0.25, 0.36), cells),
        Panel(name="numbers128", title="The 128 numbers", rect=(0.53, 0.68, 0.25, 0.32),
              kind="picture", x_range=(0.0, float(CELLS * CELLS)), y_range=(0.0, 3 * ROWS_APART), y_down=True),
        Panel(name="numbers", title="Numbers", rect=(0.78, 0.0, 0.22, 1.0), kind="sheet"),
    )  # fmt: skip


def _square(
    name: str, title: str, rect: tuple[float, float, float, float], shown: tuple[float, float]
) -> Panel:
    return Panel(
        name=name, title=title, rect=rect, kind="picture", x_range=shown, y_range=shown, equal=True, y_down=True
    )  # fmt: skip


def _sheet(seen: Compared, step: int) -> list[AnyMark]:
    p, a, b = seen.params, seen.a, seen.b
    marks: list[AnyMark] = [
        Number(thing="a", label="Layer's blur", value=p.size / 2, unit="px", digits=1),
        Number(thing="a", label="Width of the patch", value=6 * p.size, unit="px", digits=0),
    ]  # fmt: skip
    if step >= 2:
        marks += [
            Number(thing="a", role="first", label="Direction 1", value=math.degrees(a.angle) % 360.0, unit="°", digits=1),
            Number(thing="b", role="second", label="Direction 2", value=math.degrees(b.angle) % 360.0, unit="°", digits=1,
                   answer=True),
            Number(thing="limit", label="Key points, first", value=float(len(seen.peaks(0))), unit="", digits=0),
            Number(thing="b", label="Turn found", value=seen.turn_found, unit="°", digits=1, answer=True),
            Number(thing="truth", role="truth", label="True turn", value=p.turn, unit="°", digits=1, truth=True),
            Number(thing="truth", role="truth", label="Error", value=seen.turn_error, unit="°", digits=1, truth=True,
                   answer=True),
        ]  # fmt: skip
    if step >= 4:
        marks += _pixel_sheet(seen)
    if step >= 5:
        length = float(np.linalg.norm(a.raw))
        marks += [
            Sentence(text="Normalise", heading=True, thing="cut"),
            Formula(thing="cut", tex=rf"\hat{{h}} = h \,/\, {length:.0f}, \quad \hat{{h}} \leq {LARGEST_SHARE}"),
            Number(thing="cut", role="third", label="Numbers cut", value=float((a.unit > LARGEST_SHARE).sum()), unit="of 128",
                   digits=0),
        ]  # fmt: skip
    if step >= 6:
        marks += [
            Sentence(text="Compare", heading=True, thing="difference"),
            Formula(thing="difference", tex=r"d = \| \hat{h}_2 - \hat{h}_1 \|"),
            Number(thing="difference", label="Distance d", value=seen.distance, unit="of 1.41", digits=2,
                   answer=True),
        ]  # fmt: skip
    return marks


def _pixel_sheet(seen: Compared) -> list[AnyMark]:
    """Say how the chosen pixel is shared out: its gradient and the four bins that get most."""
    shares = seen.shares
    best = shares.table()[:4]
    rows = (("row", "col", "dir", "share"), *(
        (str(r + 1), str(c + 1), f"{d * 360 // DIRECTIONS}°", f"{100 * share:.0f} %") for r, c, d, share in best
    ))  # fmt: skip
    return [
        Sentence(text="The pixel", heading=True, thing="pixel"),
        Number(thing="pixel", role="third", label="w |∇L|", value=shares.size, unit="levels", digits=1),
        Number(
            thing="pixel",
            role="third",
            label="Direction ↺",
            value=math.degrees(shares.direction),
            unit="°",
            digits=0,
        ),
        Matrix(thing="pixel", label="", rows=rows, answer=True),
    ]


def _says(seen: Compared, step: int) -> str:
    if step < 2:
        return f"A patch of {6 * seen.params.size:.0f} px around the key point, in both pictures."
    found = f"Turned by {seen.params.turn:.0f}°, found {seen.turn_found:.0f}°"
    if step < 6:
        return f"{found}; {len(seen.peaks(0))} direction(s) stand out in the first patch."
    return f"{found}; the distance of the two descriptors is {seen.distance:.2f} of 1.41 at most."
