"""Scale space: blur a photo more and more, subtract neighbours, and see which extrema become keypoints."""

from __future__ import annotations

import numpy as np

from graphos_core.features.detectors.scale_space import scale_space
from graphos_core.features.detectors.scale_space_extrema import (
    EDGE,
    KEPT,
    UNSTABLE,
    WEAK,
    find_extrema,
    quadratic,
)
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.features.scale_space_drawing import (
    STYLES,
    extremum_marks,
    handle_marks,
    layer_marks,
    pyramid_marks,
    response_marks,
    response_top,
    still_shown,
    truth_marks,
)
from graphos_didactic.simulators.features.scale_space_model import WORDS, Looked
from graphos_didactic.simulators.features.scale_space_params import LESSON, OCTAVES, ScaleSpaceParams
from graphos_didactic.simulators.features.scale_space_tasks import PREDICTION, scale_space_task
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

THINGS = {
    "point": "the point, in all pictures, and the response there",
    "layer": "the layer looked at",
    "candidates": "extrema among their 26 neighbours",
    "kept": "keypoints, with their size",
    "weak": "extrema with too little contrast",
    "edge": "extrema on edges",
    "unstable": "extrema whose fit does not come to rest",
    "truth": "what is known: the blob's size, keypoints that come again",
}
STEPS = (
    Step("Blur", "Gaussians of growing width; after every octave the picture is halved."),
    Step("Difference", "Neighbouring layers are subtracted: blobs of the right size stand out."),
    Step("Extrema", "Larger or smaller than all 26 neighbours in place and scale (dashed: three layers)."),
    Step("Fit", "A quadratic gives place and scale between the samples; what wanders off is dropped."),
    Step("Contrast", "Fitted responses below C / n are dropped."),
    Step("Edges", "Where one curvature is more than r times the other, the point would slide: dropped."),
)
PRESETS = (
    Preset("blobs", "Blobs", "Every blob answers at the scale of its own size.", {}),
    Preset("small", "Small and large", "A blob half as wide: its extremum lies one octave lower.", {"size": 2.5, "level": 5}),
    Preset("faint", "Faint blob", "The extremum is there, but below the contrast threshold.",
           {"strength": 5.0, "noise": 0.5}),
    Preset("long", "Stretched blob", "One curvature is much larger than the other: on an edge.",
           {"size": 3.0, "stretch": 5.0, "level": 6}),
    Preset("edges", "Straight edges only", "Noise decides where extrema lie along an edge: the keypoints left do not come again.",
           {"picture": "edges", "noise": 4.0, "level": 3, "x": 31.5, "y": 40.0}, "degenerate"),
    Preset("photo", "Your photo", "A photo of the open project, made small; drag the point over it.",
           {"picture": "photo", "level": 4, "x": 50.0, "y": 50.0}, "photo"),
)  # fmt: skip


@simulator(
    room="features",
    name="scale_space",
    title="Scale space and DoG",
    summary="How blobs of every size are found in one pyramid of blurred photos, and why some are rejected.",
    first="Drag the green handle: the blob grows, and its extremum moves along the scale.",
    source="Lowe 2004, Distinctive image features from scale-invariant keypoints, sections 3 and 4",
    engine=(scale_space, find_extrema, quadratic),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=scale_space_task,
    learn=LESSON,
    place=10,
)
def scale_space_simulator(params: ScaleSpaceParams, setting: Setting) -> Scene:
    """Show photo, blurred layer, difference, the whole pyramid, the response along the scale and the numbers."""
    seen = Looked(params, setting)
    step = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [*layer_marks(seen, step), *truth_marks(seen)]
    if step >= 2:
        marks += extremum_marks(seen, step)
    marks += [
        *pyramid_marks(seen, step),
        *response_marks(seen, step),
        *handle_marks(seen, step),
        *_sheet(seen, step),
    ]
    return Scene(panels=_panels(seen, step), marks=tuple(marks), things=THINGS, says=_says(seen, step))


def _panels(seen: Looked, step: int) -> tuple[Panel, ...]:
    rows, columns = seen.shape
    across, down = (-0.5, columns - 0.5), (-0.5, rows - 0.5)
    p, top = seen.params, response_top(seen)
    name = {"blobs": "blobs", "edges": "edges"}.get(p.picture, photo_or_simulated(seen.setting)[1])
    blur, wider = (seen.space.blur(seen.octave, seen.layer + i) for i in (0, 1))
    difference = f"D = L({wider:.1f}) − L({blur:.1f}) · ±{1e3 * seen.strongest:.0f} ‰" if step >= 1 else ""
    what = "D" if step >= 1 else "L"
    return (
        Panel(name="photo", title=f"{name} · octave {seen.octave}" if step >= 2 else name, rect=(0.0, 0.0, 0.25, 0.345), kind="picture", x_range=across,
              y_range=down, equal=True, y_down=True),
        Panel(name="blurred", title=f"L {blur:.1f} px · octave {seen.octave}, layer {seen.layer}",
              rect=(0.25, 0.0, 0.25, 0.345), kind="picture", x_range=across, y_range=down, equal=True, y_down=True),
        Panel(name="difference", title=difference, rect=(0.5, 0.0, 0.25, 0.345), kind="picture", x_range=across,
              y_range=down, equal=True, y_down=True),
        Panel(name="pyramid", title=f"All layers {what} · octaves ↓ layers →", rect=(0.0, 0.345, 0.36, 0.655),
              kind="picture", x_range=(0.0, p.layers + (2.0 if step >= 1 else 3.0)), y_range=(0.0, float(OCTAVES)),
              y_down=True),
        Panel(name="response", title="Response at the point along the scale", rect=(0.36, 0.345, 0.39, 0.655),
              x_range=(0.0, seen.octaves + 0.6), y_range=(-top, top), legend="above",
              x_label=f"scale [octaves above {seen.space.blur(0, 0.0):.2f} px]", y_label="D [‰ of the grey range]"),
        Panel(name="numbers", title="The extremum at the point", rect=(0.75, 0.0, 0.25, 1.0), kind="sheet"),
    )  # fmt: skip


def _sheet(seen: Looked, step: int) -> list[AnyMark]:
    marks: list[AnyMark] = []
    i = seen.chosen if step >= 2 else None
    if i is None:
        marks.append(
            Sentence(thing="point", text="No extremum here." if step >= 2 else "Not looked for yet.")
        )
    else:
        marks += _numbers(seen, i, step)
    if step >= 2:
        marks.append(Sentence(text="In the whole picture", heading=True))
        shown = still_shown(seen, step)
        marks.append(Number(thing="candidates" if step < 5 else "", label="Extrema", value=float(shown.sum()), unit="",
                            digits=0, answer=True))  # fmt: skip
    if step == 5 and seen.params.picture == "edges":
        marks.append(Number(thing="truth", role="truth", label="Found again with other noise", unit="%", digits=0,
                            value=100.0 * seen.repeated, truth=True, answer=True))  # fmt: skip
    if step == 5:
        names = {KEPT: "Keypoints ●", UNSTABLE: "Unstable ■", WEAK: "Too weak ✕", EDGE: "On edges ▲"}
        marks += [
            Number(thing=STYLES[verdict][0], role=STYLES[verdict][2], label=label, unit="", digits=0, answer=True,
                   value=float((seen.extrema.verdict == verdict).sum()))
            for verdict, label in names.items()
        ]  # fmt: skip
    return marks


def _numbers(seen: Looked, i: int, step: int) -> list[AnyMark]:
    found, p = seen.extrema, seen.params
    verdict = int(found.verdict[i])
    thing, _, role, _ = STYLES[verdict]
    rests, limit = verdict != UNSTABLE, p.contrast / p.layers
    marks: list[AnyMark] = [
        Number(thing="candidates" if step < 5 else thing, label="D at the sample", value=1e3 * float(found.sample[i]),
               unit="‰", digits=1, answer=True),
        Number(label="Nearest of 26", value=1e3 * seen.neighbour(i), unit="‰", digits=1, answer=True),
    ]  # fmt: skip
    if step >= 3:
        x, y, s = found.offset[i]
        marks += [
            Formula(thing=thing, tex=r"\hat{x} = -H^{-1} g"),
            Formula(thing=thing, tex=rf"\quad = ({x:.2f},\; {y:.2f},\; {s:.2f})" if rests else r"\quad \mathrm{does\ not\ rest}",
                    answer=True),
            Formula(thing=thing, tex=r"D(\hat{x}) = D + \frac{1}{2}\, g^T \hat{x}"),
            Number(thing=thing, label="D at the fit", value=1e3 * float(found.value[i]), unit="‰", digits=1, answer=True),
            Number(label="Diameter", value=float(found.diameter[i]), unit="px", digits=1, answer=True),
        ]  # fmt: skip
    if step >= 4:
        marks.append(
            Number(thing="weak", role="second", label="Limit C / n", value=1e3 * limit, unit="‰", digits=1)
        )
    if step >= 5:
        marks += [
            Formula(thing="edge", tex=r"\dfrac{\mathrm{tr}^2}{\det} < \dfrac{(r+1)^2}{r}"),
            Number(thing=thing, label="r of the point", value=float(found.ratio[i]), unit="", digits=1, answer=True),
            Number(thing="edge", role="third", label="Limit r", value=p.edge, unit="", digits=1),
            Sentence(thing=thing, role=role, text=f"Verdict: {WORDS[verdict]}.", answer=True),
        ]  # fmt: skip
    if step >= 3 and seen.on_blob:
        size = seen.found_size(i)
        marks += [
            Number(thing="truth", role="truth", label="True size s", value=p.size, unit="px", truth=True),
            Number(thing="truth", role="truth", label="From the scale, σ√k", value=size, unit="px", truth=True, answer=True),
            Number(thing="truth", role="truth", label="Error", value=size - p.size, unit="px", truth=True, answer=True),
        ]  # fmt: skip
    return marks


def _says(seen: Looked, step: int) -> str:
    if step < 2:
        return f"{seen.octaves} octaves of {seen.params.layers} layers; here the blur is {seen.space.blur(seen.octave, seen.layer):.1f} px."
    found = seen.extrema
    counts = np.bincount(found.verdict, minlength=4)
    text = f"{len(found)} extrema, {counts[KEPT]} keypoints"
    i = seen.chosen
    if i is None:
        return f"{text}; none at the point."
    return (
        f"{text}; at the point: {WORDS[int(found.verdict[i])]}, response {1e3 * float(found.value[i]):.1f} ‰, "
        f"diameter {float(found.diameter[i]):.1f} px."
    )
