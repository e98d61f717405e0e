"""Decolourisation: two colours that luma cannot tell apart, and grey that keeps them apart."""

from __future__ import annotations

from graphos_core.preprocessing.decolorization import cielab, decolor, fit_weights
from graphos_core.preprocessing.decolorization_quality import decolorization_quality
from graphos_core.preprocessing.grey import grey, luma
from graphos_core.preprocessing.kernels import polynomial_grey
from graphos_core.preprocessing.lightness import lightness
from graphos_core.preprocessing.principal_component import principal
from graphos_didactic.scene import AnyMark, Formula, Matrix, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.pictured_plane import photo_or_simulated
from graphos_didactic.simulators.preprocessing.decolorization_drawing import (
    LARGEST,
    difference_marks,
    handle_marks,
    iteration_marks,
    iteration_range,
    panel_of,
    picture_marks,
    plane_marks,
    title_of,
)
from graphos_didactic.simulators.preprocessing.decolorization_model import (
    HUES,
    LABELS,
    LIGHTS,
    METHODS,
    Decolorized,
)
from graphos_didactic.simulators.preprocessing.decolorization_params import LESSON, DecolorizationParams
from graphos_didactic.simulators.preprocessing.decolorization_tasks import PREDICTION, decolorization_task

THINGS = {
    "colour": "the colours",
    "luma": "luma, and where it is that of A",
    "channels": "lightness and single channels",
    "principal": "principal component",
    "decolor": "contrast-preserving grey",
    "truth": "difference of the colours: what could be kept",
}
STEPS = (
    Step("Luma", "Each colour as bright as it looks: different colours can become the same grey."),
    Step("Other greys", "Lightness, one channel, or the mixture that varies most."),
    Step("Difference", "How far the colours are apart in CIELAB: that much the greys should differ."),
    Step("Start", "A polynomial of the channels; it begins as their mean."),
    Step(
        "One iteration",
        "Signs of the differences are guessed from the present greys, then weights are solved for.",
    ),
    Step("Result", "Repeated and stretched: neighbours of different colour get different greys."),
)
PRESETS = (
    Preset("same", "Same luma", "B lies on the curve of A's luma: in luma it is gone.", {}),
    Preset("three", "Three colours", "Three colours of one luma: two differences can be kept well, the third by half.",
           {"picture": "three"}),
    Preset("bright", "Light and dark", "Where brightness differs anyway, every way to grey will do.",
           {"a_light": 35.0, "b_light": 75.0}),
    Preset("start", "One iteration", "The signs are not settled yet.", {"picture": "three", "iterations": 1}),
    Preset("wheel", "All hues", "Twelve hues on one axis of grey: whatever the weights, some pairs fall together.",
           {"picture": "wheel"}, "degenerate"),
    Preset("photo", "Your photo", "A photo of the open project; drag A, B and C over it.", {"picture": "photo"}, "photo"),
)  # fmt: skip


@simulator(
    room="preprocessing",
    name="decolorization",
    title="Decolourisation",
    summary="What becomes of colours that are equally bright, in luma, channels and contrast-preserving grey.",
    first="Drag colour B along the dashed curve: in luma it disappears.",
    source="Lu, Xu, Jia 2012, Contrast preserving decolorization (ICCP); quality: Lu, Xu, Jia 2014, section 5",
    engine=(
        grey, luma, lightness, principal, decolor, fit_weights, polynomial_grey, decolorization_quality, cielab,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=decolorization_task,
    learn=LESSON,
    place=10,
)  # fmt: skip
def decolorization_simulator(params: DecolorizationParams, setting: Setting) -> Scene:
    """Show seven ways to grey side by side, the plane of colours, the differences, the iterations and the weights."""
    seen = Decolorized(params, setting)
    step = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [*picture_marks(seen, step), *plane_marks(seen)]
    if step >= 2:
        marks += difference_marks(seen, step)
    if step >= 3:
        marks += iteration_marks(seen, step)
    marks += [*handle_marks(seen), *_sheet(seen, step)]
    return Scene(panels=_panels(seen, step), marks=tuple(marks), things=THINGS, says=_says(seen, step))


def _panels(seen: Decolorized, step: int) -> tuple[Panel, ...]:
    rows, columns = seen.picture.shape[:2]
    across, down = (-0.5, columns - 0.5), (-0.5, rows - 0.5)
    p = seen.params
    name = photo_or_simulated(seen.setting)[1] if p.picture == "photo" else "The colours"
    titles = [("colour", name), *((method, title_of(method, step)) for method in METHODS)]
    pictures = [
        Panel(name=key, title=title, rect=panel_of(i), kind="picture", x_range=across, y_range=down, equal=True, y_down=True)
        for i, (key, title) in enumerate(titles)
    ]  # fmt: skip
    return (
        *pictures,
        Panel(name="plane", title=f"Colours of chroma {p.chroma:.0f}", rect=(0.0, 0.54, 0.27, 0.46),
              x_range=(float(HUES[0]), float(HUES[-1])), y_range=(float(LIGHTS[-1]), float(LIGHTS[0])), x_label="hue [°]",
              y_label="lightness L"),
        Panel(name="differences", title="Kept: ✕ luma  ■ principal  ● new", rect=(0.27, 0.54, 0.25, 0.46),
              x_range=(0.0, LARGEST), y_range=(-4.0, LARGEST), x_label="difference of colours [units of L]",
              y_label="difference of greys [of 100]"),
        Panel(name="iterations", title="Greys while it iterates", rect=(0.52, 0.54, 0.22, 0.46),
              x_range=(-0.6, p.iterations + 1.2), y_range=iteration_range(seen), x_label="iterations",
              y_label="polynomial [× 100]", legend="above"),
        Panel(name="numbers", title="Numbers", rect=(0.74, 0.0, 0.26, 1.0), kind="sheet"),
    )  # fmt: skip


def _sheet(seen: Decolorized, step: int) -> list[AnyMark]:
    marks: list[AnyMark] = []
    if step >= 3:
        turns = {3: 0, 4: 1}.get(step, seen.params.iterations)
        w = [f"{value:.2f}".replace("-", "−") for value in seen.weights(turns)]
        names = ("r", "g", "b", "rg", "rb", "gb", "r²", "g²", "b²")
        rows = tuple(tuple(f"{w[i]} {names[i]}" for i in (k, k + 3, k + 6)) for k in range(3))
        marks += [
            Formula(thing="decolor", tex=r"g = \sum_{i=1}^{9} \omega_i\, m_i(r, g, b)"),
            Sentence(
                thing="decolor",
                text=f"Weights after {turns} iteration{'s' if turns != 1 else ''}",
                role="muted",
            ),
            Matrix(thing="decolor", label="", rows=rows, answer=True),
        ]
    if step >= 2:
        marks.append(Sentence(text="Contrast kept (CCPR)", heading=True))
        for method in METHODS:
            if method == "decolor" and step < 5:
                continue
            marks.append(Number(thing=method if method in THINGS else "channels", label=LABELS[method],
                                value=seen.ccpr(method), unit="", answer=True,
                                role="first" if method == "decolor" else "text"))  # fmt: skip
        marks += _differences(seen, step)
    if not marks:
        pair = seen.kept("luma")
        marks.append(Number(thing="luma", label="Largest difference in luma", value=max(pair), unit="of 100", digits=1,
                            answer=True))  # fmt: skip
    return marks


def _differences(seen: Decolorized, step: int) -> list[AnyMark]:
    """Give colour and grey differences of the pairs; of many pairs, how many are lost."""
    if len(seen.pairs) > 3:
        marks: list[AnyMark] = [
            Sentence(text=f"Half lost, of {len(seen.pairs)} pairs", heading=True, thing="truth")
        ]
        for method in ("luma", "principal", "decolor"):
            if method != "decolor" or step >= 5:
                marks.append(Number(thing=method, label=LABELS[method], unit="pairs", digits=0,
                                    value=float(seen.lost(method)), role="truth", truth=True, answer=True))  # fmt: skip
        return marks
    marks = [Sentence(text="Differences of 100", heading=True, thing="truth")]
    luma_kept, new_kept = seen.kept("luma"), seen.kept("decolor")
    for i, (name, delta) in enumerate(seen.pairs):
        marks += [
            Number(thing="truth", role="truth", label=f"{name}: colours", value=delta, unit="units of L", digits=0, truth=True),
            Number(thing="luma", role="second", label=f"{name}: luma", value=luma_kept[i], unit="", digits=0, answer=True),
        ]  # fmt: skip
        if step >= 5:
            marks.append(Number(thing="decolor", role="first", label=f"{name}: new", value=new_kept[i], unit="",
                                digits=0, answer=True))  # fmt: skip
    if step >= 5:
        error = min(new_kept[i] - delta for i, (_, delta) in enumerate(seen.pairs))
        marks.append(Number(thing="truth", role="truth", label="Largest loss", value=min(error, 0.0), unit="units of L",
                            digits=0, truth=True, answer=True))  # fmt: skip
    return marks


def _says(seen: Decolorized, step: int) -> str:
    if step < 2:
        return f"In luma the colours differ by at most {max(seen.kept('luma')):.0f} of 100."
    text = f"Luma keeps {100 * seen.ccpr('luma'):.0f} % of the colour contrasts"
    if step < 5:
        return f"{text}."
    return f"{text}, contrast-preserving grey {100 * seen.ccpr('decolor'):.0f} % after {seen.params.iterations} iterations."
