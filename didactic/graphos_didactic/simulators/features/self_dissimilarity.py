"""Maximal self-dissimilarity: a point is worth finding when no patch beside it looks like its own."""

from __future__ import annotations

import math

from graphos_core.features.detectors.self_dissimilarity import (
    maxima,
    nearest_patches,
    pyramid,
    refined,
    saliency,
)
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.features.self_dissimilarity_drawing import (
    LONGEST,
    SHOWN,
    bar_marks,
    bars_top,
    distance_marks,
    handle_marks,
    map_marks,
    map_top,
    patch_marks,
    photo_marks,
    zoom_marks,
)
from graphos_didactic.simulators.features.self_dissimilarity_model import Compared
from graphos_didactic.simulators.features.self_dissimilarity_params import LESSON, SelfDissimilarityParams
from graphos_didactic.simulators.features.self_dissimilarity_tasks import PREDICTION, self_dissimilarity_task
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

THINGS = {
    "point": "the point and its own patch",
    "area": "search area: patches that are compared",
    "nearest": "the k nearest patches",
    "mean": "self-dissimilarity: mean distance of the k nearest",
    "threshold": "threshold",
    "radius": "neighbourhood in which a point must be the largest",
    "found": "points",
    "rejected": "maxima below the threshold",
    "truth": "the three marks, where they really are",
}
STEPS = (
    Step("Patch", "A patch around the point, and the search area around it."),
    Step("Distances", "The patch is compared with every other one of the area: mean squared difference."),
    Step("Nearest", "The k most similar ones are looked at."),
    Step("Dissimilarity", "Their mean says how distinctive the point is."),
    Step("Everywhere", "The same for every pixel: edges stay dark, corners and spots shine."),
    Step("Maxima", "The largest of their neighbourhood and above the threshold."),
    Step("Fit", "A quadratic gives the place between the pixels: the points."),
)
PRESETS = (
    Preset("edge", "On an edge", "Along the edge many patches look the same: not distinctive.", {}),
    Preset("mark", "On a mark", "Nothing beside it looks like it: a large dissimilarity.", {"x": 25.0, "y": 39.0}),
    Preset("wide", "Search wider than a tile", "Every tile finds its like: only the three marks are left.",
           {"search": 11, "x": 27.0, "y": 24.0}),
    Preset("one", "One nearest patch", "With k = 1 noise decides between the points of the tiles.",
           {"neighbours": 1, "noise": 12.0, "x": 25.0, "y": 39.0}),
    Preset("stripes", "Stripes", "Every patch has its like a stripe further: nothing is distinctive.",
           {"picture": "stripes", "x": 50.0, "y": 50.0}, "degenerate"),
    Preset("photo", "Your photo", "A photo of the open project, made small; drag the point over it.",
           {"picture": "photo", "x": 50.0, "y": 40.0}, "photo"),
)  # fmt: skip


@simulator(
    room="features",
    name="self_dissimilarity",
    title="Maximal self-dissimilarity",
    summary="Which points are unlike everything around them, and therefore worth finding again.",
    first="Drag the point from the edge to one of the three marks; watch the nearest patches.",
    source="Tombari and Di Stefano 2014, Interest points via maximal self-dissimilarities",
    engine=(nearest_patches, saliency, maxima, refined, pyramid),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=self_dissimilarity_task,
    learn=LESSON,
    place=30,
)
def self_dissimilarity_simulator(params: SelfDissimilarityParams, setting: Setting) -> Scene:
    """Show photo, search area, distances of all patches, the nearest patches, the map and the numbers."""
    seen = Compared(params, setting)
    step = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [*photo_marks(seen, step), *zoom_marks(seen, step)]
    if step >= 1:
        marks += [*distance_marks(seen, step), *bar_marks(seen, step)]
    if step >= 2:
        marks += patch_marks(seen)
    if step >= 4:
        marks += map_marks(seen, step)
    marks += [*handle_marks(seen, step), *_sheet(seen, step)]
    return Scene(panels=_panels(seen, step), marks=tuple(marks), things=THINGS, says=_says(seen, step))


def _panels(seen: Compared, step: int) -> tuple[Panel, ...]:
    rows, columns = seen.grey.shape
    across, down = (-0.5, columns - 0.5), (-0.5, rows - 0.5)
    p, edge, search = seen.params, seen.reach + 0.5, seen.params.search + 0.5
    name = photo_or_simulated(seen.setting)[1] if p.picture == "photo" else f"simulated {p.picture}"
    largest = math.sqrt(float(seen.every[1].max()))
    return (
        Panel(name="photo", title=f"Level {p.level} · {name}", rect=(0.0, 0.0, 0.31, 0.5), kind="picture", x_range=across,
              y_range=down, equal=True, y_down=True),
        Panel(name="map", title=f"√λ of every pixel · 0 to {map_top(seen):.0f} grey levels" if step >= 4 else "",
              rect=(0.0, 0.5, 0.31, 0.5), kind="picture", x_range=across, y_range=down, equal=True, y_down=True),
        Panel(name="zoom", title="Search area, enlarged", rect=(0.31, 0.0, 0.24, 0.37), kind="picture",
              x_range=(-edge, edge), y_range=(-edge, edge), equal=True, y_down=True),
        Panel(name="distances", title=f"√distance · 0 to {largest:.0f}" if step >= 1 else "",
              rect=(0.31, 0.37, 0.24, 0.35), kind="picture", x_range=(-search, search), y_range=(-search, search),
              equal=True, y_down=True),
        Panel(name="patches", title="Nearest patches" if step >= 2 else "", rect=(0.55, 0.0, 0.21, 0.72),
              kind="picture", x_range=(0.0, 2.0), y_range=(0.0, SHOWN + 1.0), equal=True, y_down=True),
        Panel(name="bars", title="√distances, smallest first", rect=(0.31, 0.72, 0.45, 0.28), x_range=(0.5, LONGEST + 0.5),
              y_range=(0.0, bars_top(seen)), x_label="rank", y_label="√distance [grey levels]", legend="top right"),
        Panel(name="numbers", title="At the point", rect=(0.76, 0.0, 0.24, 1.0), kind="sheet"),
    )  # fmt: skip


def _sheet(seen: Compared, step: int) -> list[AnyMark]:
    p = seen.params
    marks: list[AnyMark] = [
        Number(thing="point", role="accent", label="Pixels of a patch", value=float((2 * p.patch + 1) ** 2), unit="", digits=0),
        Number(thing="area", label="Patches compared", value=float(len(seen.every[1])), unit="", digits=0),
    ]  # fmt: skip
    if step >= 2:
        marks += [
            Formula(thing="nearest", tex=r"\delta_i = \frac{1}{n} \sum (g - g_i)^2"),
            Number(thing="nearest", role="second", label="Nearest δ", value=float(seen.every[1][0]), unit="grey²", digits=1,
                   answer=True),
            Number(thing="nearest", role="second", label=f"δ of rank {seen.count}", value=float(seen.every[1][seen.count - 1]),
                   unit="grey²", digits=1, answer=True),
        ]  # fmt: skip
    if step >= 3:
        marks += [
            Formula(thing="mean", tex=r"\lambda = \frac{1}{k} \sum_{i=1}^{k} \delta_i"),
            Number(thing="mean", role="accent", label=f"λ with k = {seen.count}", value=seen.dissimilarity, unit="grey²",
                   digits=1, answer=True),
            Number(thing="mean", label="That is, √λ", value=math.sqrt(seen.dissimilarity), unit="levels", digits=1, answer=True),
        ]  # fmt: skip
    if step >= 5:
        weak = int((~seen.tops[1]).sum())
        passes = seen.dissimilarity > p.threshold
        marks += [
            Number(thing="threshold", role="third", label="Threshold λ₀", value=p.threshold, unit="grey²", digits=0),
            Sentence(thing="mean", role="text", answer=True,
                     text="Distinctive enough." if passes else "Not distinctive enough: below the threshold."),
            Sentence(text="On this level", heading=True),
            Number(thing="found", role="first", label="Points ●", value=float(len(seen.points)), unit="", digits=0, answer=True),
            Number(thing="rejected", label="Below threshold ✕", value=float(weak), unit="", digits=0, answer=True),
        ]  # fmt: skip
    if step >= 6 and len(seen.marks):
        found = seen.errors[seen.errors < 4.0]
        marks += [
            Number(thing="truth", role="truth", label="Marks found", value=float(seen.marked), unit="of 3", digits=0, truth=True,
                   answer=True),
            Number(thing="truth", role="truth", label="Largest error there", unit="px", truth=True, answer=True,
                   value=float(found.max()) if len(found) else math.nan),
            Number(thing="truth", role="truth", label="Points elsewhere", value=float(seen.elsewhere), unit="points", digits=0,
                   truth=True, answer=True),
        ]  # fmt: skip
    return marks


def _says(seen: Compared, step: int) -> str:
    if step < 2:
        return f"The patch is compared with {len(seen.every[1])} others."
    text = f"The {seen.count} nearest of {len(seen.every[1])} patches differ by λ = {seen.dissimilarity:.1f} squared grey levels"
    if step < 6:
        return f"{text}."
    return f"{text}; {len(seen.points)} points on this level" + (
        f", {seen.marked} of 3 marks found." if len(seen.marks) else "."
    )
