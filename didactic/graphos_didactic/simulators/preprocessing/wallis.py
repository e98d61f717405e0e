"""The Wallis filter: drag the window over the photo and see what happens inside it."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.preprocessing.kernels import wallis_value
from graphos_core.preprocessing.wallis import local_statistics, wallis
from graphos_didactic.scene import (
    AnyMark,
    Bars,
    Formula,
    Handle,
    Line,
    Number,
    Panel,
    Picture,
    Points,
    Polygon,
    Scene,
    Sentence,
)
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.pictured_plane import photo_or_simulated
from graphos_didactic.simulators.preprocessing.wallis_model import (
    Filtered,
    WallisSimulatorParams,
    grey_levels,
)
from graphos_didactic.simulators.preprocessing.wallis_tasks import PREDICTION, wallis_task

THINGS = {
    "window": "the window, in both pictures",
    "before": "grey values before the filter",
    "after": "grey values after the filter",
    "truth": "what the filter gives without the shadow",
    "mean": "mean in the window, and its target",
    "gain": "gain: slope of the straight line",
    "shadow": "artificial shadow",
}
STEPS = (
    Step("Window", "Around each pixel lies a window."),
    Step("Mean", "The mean in the window of every pixel: a blurred picture, the shadow is still in it."),
    Step("Deviation", "The standard deviation in every window: bright where there is texture."),
    Step("Result", "The difference from the mean, times the gain, plus the mixed means."),
)
KNOWN = (frozenset[str](), frozenset({"mean"}), frozenset({"mean", "before"}))
"""Things whose numbers are known after each step but the last."""
PRESETS = (
    Preset("shadow", "Into the shadow", "Light and shadow get the same brightness and contrast.", {}),
    Preset("small", "Small window", "Fine texture and noise are lifted; large shapes disappear.", {"window": 9}),
    Preset("mean_only", "Brightness only", "Contrast weight 0: only the mean is levelled.",
           {"contrast": 0.0, "brightness": 1.0}),
    Preset("strict", "Full weights", "c = b = 1: every window gets exactly the target values.",
           {"contrast": 1.0, "brightness": 1.0}),
    Preset("flat", "No texture", "Nothing but noise: the filter blows it up to the target contrast.",
           {"picture": "flat", "shadow": 0.0, "contrast": 1.0, "x": 50.0, "y": 50.0}, "degenerate"),
    Preset("photo", "Your photo", "A photo of the open project as it is, without the artificial shadow.",
           {"picture": "photo", "shadow": 0.0, "x": 50.0, "y": 50.0}, "photo"),
)  # fmt: skip


@simulator(
    room="preprocessing",
    name="wallis",
    title="Wallis filter",
    summary="How local brightness and contrast are pulled to target values, window by window.",
    first="Drag the window from the light into the shadow.",
    source="Wallis 1976; Baltsavias 1991, Multiphoto geometrically constrained matching",
    engine=(wallis, local_statistics, wallis_value),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=wallis_task,
    learn="preprocessing/wallis",
)
def wallis_filter(params: WallisSimulatorParams, setting: Setting) -> Scene:
    """Show the picture before and after, a row through both, the window's histograms, its line and the numbers."""
    seen = Filtered(params, setting)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [
        *_pictures(seen, last),
        *_windows(seen),
        *_profile(seen, last),
        *_histograms(seen, last),
    ]
    if last >= 3:
        marks += _line(seen)
    marks += [*_handles(seen), *_sheet(seen, last)]
    return Scene(panels=_panels(seen, last), marks=tuple(marks), things=THINGS, says=_says(seen, last))


def _panels(seen: Filtered, last: int) -> tuple[Panel, ...]:
    rows, columns = seen.shape
    across, down = (-0.5, columns - 0.5), (-0.5, rows - 0.5)
    name = (
        photo_or_simulated(seen.setting)[1] if seen.params.picture == "photo" else "surface without texture"
    )
    largest = float(seen.statistics[1].max())
    right = (
        "",
        "Local mean",
        f"Local standard deviation · black 0, white {largest:.0f} grey levels",
        "After",
    )[last]
    top = max(_counts(seen.window_grey).max(), _counts(seen.cut(seen.after)).max()) * 1.1
    return (
        Panel(name="before", title=f"Before · {name}", rect=(0.0, 0.0, 0.37, 0.48), kind="picture", x_range=across,
              y_range=down, equal=True, y_down=True),
        Panel(name="after", title=right, rect=(0.37, 0.0, 0.37, 0.48), kind="picture", x_range=across,
              y_range=down, equal=True, y_down=True),
        Panel(name="profile", title="Along the row of the window", rect=(0.0, 0.48, 0.40, 0.52), x_range=across,
              y_range=(0.0, 255.0), x_label="column [px]", y_label="grey level", legend="above"),
        Panel(name="histogram", title="In the window", rect=(0.40, 0.48, 0.34, 0.52), x_range=(0.0, 255.0),
              y_range=(0.0, float(top)), x_label="grey level", y_label="pixels [%]", legend="above"),
        Panel(name="numbers", title="Grey levels in the window", rect=(0.74, 0.0, 0.26, 0.58), kind="sheet"),
        Panel(name="line", title="What becomes of g", rect=(0.74, 0.58, 0.26, 0.42), x_range=(0.0, 255.0),
              y_range=(0.0, 255.0), x_label="g before [grey level]", y_label="g′ after [grey level]"),
    )  # fmt: skip


def _pictures(seen: Filtered, last: int) -> list[AnyMark]:
    rows, columns = seen.shape
    extent = (-0.5, -0.5, columns - 0.5, rows - 0.5)
    marks: list[AnyMark] = [Picture(panel="before", thing="before", pixels=seen.before, extent=extent)]
    mean, std = seen.statistics
    if last == 1:
        marks.append(Picture(panel="after", thing="mean", pixels=mean.astype(np.uint8), extent=extent))
    elif last == 2:
        spread = std * (255.0 / max(float(std.max()), 1.0))
        marks.append(Picture(panel="after", thing="gain", pixels=spread.astype(np.uint8), extent=extent))
    elif last >= 3:
        marks.append(Picture(panel="after", thing="after", pixels=seen.after, extent=extent))
    return marks


def _windows(seen: Filtered) -> list[AnyMark]:
    row, column = seen.centre
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (seen.half + 0.5) + (column, row)
    rows = seen.shape[0]
    edge = np.array([[1.0, 0.0], [1.0, rows]]) * (seen.params.shadow_x / 100 * seen.shape[1], 1.0)
    marks: list[AnyMark] = [
        Polygon(panel=panel, thing="window", role="second", xy=corners, fill=0.0, width=2.4)
        for panel in ("before", "after")
    ]
    if seen.params.shadow > 0:
        marks.append(Line(panel="before", thing="shadow", role="neutral", xy=edge, dash="dash", width=1.2))
    return marks


def _profile(seen: Filtered, last: int) -> list[AnyMark]:
    row, column = seen.centre
    every = slice(None, None, max(1, seen.shape[1] // 240))  # as fine as the panel can show
    columns = np.arange(seen.shape[1], dtype=float)[every]
    band = np.array([[-1, 0], [1, 0], [1, 255], [-1, 255]]) * (seen.half + 0.5, 1.0) + (column, 0.0)
    marks: list[AnyMark] = [
        Polygon(panel="profile", thing="window", role="second", xy=band, fill=0.12, width=1.0),
        Line(panel="profile", thing="before", role="neutral", label="before", width=1.2, dash="dot",
             xy=np.stack([columns, seen.row_grey[every]], axis=1)),
        Line(panel="profile", thing="mean", role="second", label="local mean before", width=1.6, dash="dash",
             xy=np.stack([columns, seen.statistics[0][row, every]], axis=1)),
    ]  # fmt: skip
    if last >= 3:
        marks.append(Line(panel="profile", thing="after", role="accent", label="after", width=1.3,
                          xy=np.stack([columns, seen.after[row, every].astype(float)], axis=1)))  # fmt: skip
        if seen.params.shadow > 0:
            marks.append(Line(panel="profile", thing="truth", role="truth", label="truth: no shadow",
                              width=1.3, dash="dashdot", truth=True,
                              xy=np.stack([columns, seen.ideal[row, every].astype(float)], axis=1)))  # fmt: skip
    return marks


EDGES = np.linspace(0.0, 256.0, 65)


def _counts(values: Array) -> Array:
    return 100.0 * np.histogram(values, EDGES)[0] / max(values.size, 1)


def _histograms(seen: Filtered, last: int) -> list[AnyMark]:
    top = 1e4
    p = seen.params
    marks: list[AnyMark] = [
        Bars(panel="histogram", thing="before", role="neutral", label="before", edges=EDGES,
             heights=_counts(seen.window_grey), fill=0.4),
        Line(panel="histogram", thing="mean", role="second", label="mean m", dash="dash", width=1.8,
             xy=np.array([[seen.mean, 0.0], [seen.mean, top]])),
        Line(panel="histogram", thing="mean", role="third", label="target m_t", dash="dashdot", width=1.8,
             xy=np.array([[p.target_mean, 0.0], [p.target_mean, top]])),
    ]  # fmt: skip
    if last >= 3:
        marks.insert(1, Bars(panel="histogram", thing="after", role="accent", label="after", edges=EDGES,
                             heights=_counts(seen.cut(seen.after)), fill=0.55))  # fmt: skip
    return marks


def _line(seen: Filtered) -> list[AnyMark]:
    column = seen.centre[1]
    here = float(seen.row_grey[column])
    ends = np.array([[0.0, seen.value(0.0)], [255.0, seen.value(255.0)]])
    return [
        Line(panel="line", role="muted", width=1.0, dash="dot", xy=np.array([[0.0, 0.0], [255.0, 255.0]])),
        Line(panel="line", thing="gain", role="accent", width=2.4, xy=ends, answer=True),
        Line(panel="line", thing="mean", role="second", dash="dash", width=1.6, xy=np.array([[seen.mean, 0], [seen.mean, 255]])),
        Points(panel="line", thing="gain", role="accent", xy=np.array([[here, seen.value(here)]]), marker="diamond",
               size=11, answer=True),
    ]  # fmt: skip


def _handles(seen: Filtered) -> list[AnyMark]:
    rows, columns = seen.shape
    row, column = seen.centre
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (seen.half + 0.5) + (column, row)

    def move(x: float, y: float) -> dict[str, float]:
        return {"x": 100.0 * x / (columns - 1), "y": 100.0 * y / (rows - 1)}

    def size(x: float, _: float) -> dict[str, float]:
        return {"window": 2 * round(max(x - column - 0.5, 1.0)) + 1}

    marks: list[AnyMark] = [
        Handle(panel=panel, name=f"window_{panel}", thing="window", label="Window", role="second", grip=square,
               at=(float(column), float(row)), parameters=("x", "y"), move=move, nudge=(4.0, 4.0))
        for panel in ("before", "after")
    ]  # fmt: skip
    corner = (float(min(column + seen.half + 0.5, columns - 1)), float(min(row + seen.half + 0.5, rows - 1)))
    marks.append(
        Handle(panel="before", name="size", thing="window", label="Size of the window", role="second", freedom="x",
               at=corner, parameters=("window",), move=size, nudge=(1.0, 0.0))
    )  # fmt: skip
    if seen.params.shadow > 0:
        at = (seen.params.shadow_x / 100 * columns, 0.94 * rows)
        marks.append(Handle(panel="before", name="shadow", thing="shadow", label="Edge of the shadow", role="neutral",
                            freedom="x", at=at, parameters=("shadow_x",), nudge=(0.01 * columns, 0.0),
                            move=lambda x, _: {"shadow_x": 100.0 * x / columns}))  # fmt: skip
    target = (seen.params.target_mean, 0.0)
    top = max(_counts(seen.window_grey).max(), _counts(seen.cut(seen.after)).max())
    marks.append(Handle(panel="histogram", name="target", thing="mean", label="Target mean", role="third", freedom="x",
                        at=(target[0], 0.62 * float(top)), parameters=("target_mean",), nudge=(1.0, 0.0),
                        move=lambda x, _: {"target_mean": float(round(x))}))  # fmt: skip
    return marks


def _sheet(seen: Filtered, last: int) -> list[AnyMark]:
    p = seen.params
    unit = "levels"
    c, b, s, m = p.contrast, p.brightness, seen.std, seen.mean
    gain = (
        rf"\quad = \dfrac{{{c:.2f}\cdot{p.target_std:.0f}}}"
        rf"{{{c:.2f}\cdot{s:.1f} + {1 - c:.2f}\cdot{p.target_std:.0f}}} = {seen.gain:.2f}"
    )
    value = (
        rf"g' = {seen.gain:.2f}\,(g - {m:.1f})",
        rf"\quad + {b:.2f}\cdot{p.target_mean:.0f} + {1 - b:.2f}\cdot{m:.1f}",
    )
    marks: list[AnyMark] = [
        Number(thing="mean", label="Mean m", value=m, unit=unit, digits=1, role="second"),
        Number(thing="before", label="Deviation s", value=s, unit=unit, digits=1),
        Formula(thing="gain", tex=r"r_1 = \dfrac{c\,s_t}{c\,s + (1-c)\,s_t}"),
        Formula(thing="gain", tex=gain, answer=True),
        Formula(thing="after", tex=r"g' = r_1 (g - m) + b\,m_t + (1-b)\,m"),
        *(Formula(thing="after", tex=part, answer=True) for part in value),
        Number(thing="after", label="Mean after", value=float(seen.cut(seen.after).mean()), unit=unit, digits=1,
               role="accent", answer=True),
        Number(thing="after", label="Deviation after", value=float(seen.cut(seen.after).std()), unit=unit, digits=1,
               role="accent", answer=True),
        Number(label="Cut off at 0 or 255", value=seen.cut_off, unit="%", digits=1),
    ]  # fmt: skip
    if p.shadow > 0:
        before = float(seen.window_grey.mean() - grey_levels(seen.cut(seen.truth)).mean())
        after = float(seen.cut(seen.after).mean() - seen.cut(seen.ideal).mean())
        marks += [
            Sentence(text="Error by the shadow", role="truth", truth=True),
            Number(thing="truth", label="before", value=before, unit=unit, digits=1, role="truth", truth=True),
            Number(thing="truth", label="after", value=after, unit=unit, digits=1, role="truth", truth=True,
                   answer=True),
        ]  # fmt: skip
    if last < len(KNOWN):
        return [mark for mark in marks if mark.thing in KNOWN[last]]
    return marks


def _says(seen: Filtered, last: int) -> str:
    if last < len(KNOWN):
        deviation = f", standard deviation {seen.std:.0f}" if last == 2 else ""
        return (
            f"In this window: mean {seen.mean:.0f}{deviation} grey levels."
            if last
            else "One window for every pixel."
        )
    after = seen.cut(seen.after)
    return (
        f"In this window: mean {seen.mean:.0f} → {float(after.mean()):.0f}, standard deviation {seen.std:.0f} → "
        f"{float(after.std()):.0f} grey levels; contrast times {seen.gain:.2f}."
    )
