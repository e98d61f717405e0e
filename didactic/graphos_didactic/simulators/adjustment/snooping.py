"""Data snooping: a wrong observation, what the tests say about it, and what they cannot see."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.statistics.reliability import critical_value, detectable, tau_limit
from graphos_core.cameras import pixel_from_ray
from graphos_core.geometry.similarity import estimate_similarity
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.four_photos import HEIGHT, WIDTH
from graphos_didactic.simulators.adjustment.snooping_drawing import (
    FARTHEST_PX,
    OBJECT_ENLARGED,
    TALLEST,
    bar_marks,
    bias_marks,
    handle_marks,
    object_marks,
    photo_marks,
)
from graphos_didactic.simulators.adjustment.snooping_model import Snooping
from graphos_didactic.simulators.adjustment.snooping_params import LESSON, PHOTOS, SnoopingParams
from graphos_didactic.simulators.adjustment.snooping_tasks import PREDICTION, snooping_task

THINGS = {
    "a": "observation A",
    "b": "observation B",
    "points": "the points: where they really are",
    "residuals": "residuals of observations that pass the test",
    "accused": "observations above the limit",
    "removed": "observations that were removed",
    "limit": "limit of the test",
    "bias": "minimal detectable bias",
    "errors": "errors of the adjusted points",
}
STEPS = (
    Step("Measured", "Every point was measured in every photo; A (and B) can be wrong."),
    Step("Residuals", "The adjustment spreads the blunder: innocent neighbours get residuals too."),
    Step("Test", "Each residual over its own standard deviation: the largest is the suspect."),
    Step("Reliability", "How large a blunder must be to be found, and what an unseen one can do."),
)
PRESETS = (
    Preset("one", "One blunder", "The wrong observation has the largest w, though not always the largest residual.", {}),
    Preset("small", "Too small to find", "Below the minimal detectable bias: it stays in, and does little harm.",
           {"a_x": 1.5, "a_y": 0.0}),
    Preset("swamped", "The innocent accused", "Two blunders in one point put the blame on a third observation.",
           {"a_photo": 3, "a_x": 8.0, "a_y": 0.0, "b_photo": 1, "b_x": 6.9, "b_y": -4.0}),
    Preset("masked", "Masked", "Two large blunders that agree: every w stays below the limit.",
           {"a_photo": 1, "a_x": 8.0, "a_y": 0.0, "b_photo": 3, "b_x": 6.9, "b_y": 4.0}, "degenerate"),
    Preset("two_photos", "Two photos", "Along the epipolar line nothing controls the observation.",
           {"photos": 2, "a_x": 12.0, "a_y": 0.0}, "degenerate"),
    Preset("photo", "On photos", "The same block above a photo; drag A over the picture.",
           {"photo": True, "photos": 4, "a_x": 3.0, "a_y": 2.0}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="snooping",
    title="Data snooping",
    summary="Which observation is wrong, how large a blunder must be to be found, and how two can hide.",
    first="Drag observation A in photo 2 and watch whose bar crosses the limit.",
    source="Baarda 1968; Pope 1976; Förstner and Wrobel 2016, section 4.6",
    engine=(
        adjust_block, critical_value, tau_limit, detectable, estimate_similarity, pixel_from_ray,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=snooping_task,
    learn=LESSON,
    place=80,
)  # fmt: skip
def snooping(params: SnoopingParams, setting: Setting) -> Scene:
    """Show the photos with residuals, the test of every coordinate, minimal biases, the object and the numbers."""
    block = Snooping(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [*photo_marks(block, setting, last >= 1), *object_marks(block, last >= 1)]
    if last >= 2:
        marks += bar_marks(block)
    if last >= 3:
        marks += bias_marks(block)
    marks += [*handle_marks(block), *_sheet(block)]
    return Scene(panels=_panels(block), marks=tuple(marks), things=THINGS, says=_says(block))


def _panels(block: Snooping) -> tuple[Panel, ...]:
    across, down = (-0.5, WIDTH - 0.5), (-0.5, HEIGHT - 0.5)
    wide, high = 0.26, 0.32
    panels = [
        Panel(name=f"photo_{k + 1}", kind="picture",
              title=f"Photo {k + 1} · " + (f"errors {block.params.exaggeration}×" if k < block.photos else "not used"),
              rect=(wide * (k % 2), high * (k // 2), wide, high), x_range=across, y_range=down, equal=True, y_down=True)
        for k in range(PHOTOS)
    ]  # fmt: skip
    name = "|τ|" if block.params.test == "tau" else "|w|"
    panels += [
        Panel(name="test", title=f"Test of every coordinate · {name}", rect=(0.0, 2 * high, 2 * wide, 1 - 2 * high),
              x_range=(0.0, float(len(block.result.photo))), y_range=(0.0, TALLEST),
              x_label="observations, photo by photo, x and y", y_label=name),
        Panel(name="bias", title="Minimal detectable bias", rect=(2 * wide, 0.0, 0.24, 0.5), x_range=(0.0, 1.0),
              y_range=(0.0, FARTHEST_PX), x_label="redundancy number r", y_label="∇ [px]"),
        Panel(name="object", title=f"From above · errors {OBJECT_ENLARGED:.0f}×", rect=(2 * wide, 0.5, 0.24, 0.5),
              x_range=(-4.2, 4.2), y_range=(-4.2, 4.2), x_label="X [m]", y_label="Y [m]", equal=True),
        Panel(name="numbers", title="Numbers", rect=(2 * wide + 0.24, 0.0, 0.76 - 2 * wide, 1.0), kind="sheet"),
    ]  # fmt: skip
    return tuple(panels)


def _sheet(block: Snooping) -> list[AnyMark]:
    found, p = block.result, block.params
    adjusted, reliability = found.adjustment, found.reliability
    i = found.find(p.a_photo, p.a_point)
    marks: list[AnyMark] = [
        Formula(thing="accused", tex=r"w_i = \dfrac{v_i}{\sigma\sqrt{r_i}} \qquad \tau_i = \dfrac{w_i}{\hat{\sigma}_0}"),
        Formula(thing="bias", tex=r"\nabla_i = \delta_0\,\dfrac{\sigma}{\sqrt{r_i}}"),
        Number(thing="limit", label="Limit", value=found.limit, unit="", role="accent"),
        Number(thing="bias", label="δ0", value=reliability.delta0, unit="", role="accent"),
        Number(label="Sigma0", value=adjusted.sigma0, unit="", answer=True),
        Sentence(role="muted", text=_global(block), answer=True),
        Sentence(text=f"A · point {p.a_point}, photo {p.a_photo}", heading=True, thing="a"),
    ]  # fmt: skip
    if i is None:
        marks.append(Sentence(thing="a", role="first", text="It does not take part (any more)."))
    for axis in (0, 1) if i is not None else ():
        letter = "xy"[axis]
        marks += [
            Number(thing="a", label=f"r of {letter}", value=float(reliability.redundancy[i, axis]), unit="", role="first"),
            Number(thing="a", label=f"w of {letter}", value=float(reliability.standardised[i, axis]), unit="", role="first",
                   answer=True),
            Number(thing="a", label=f"∇ of {letter}", value=float(reliability.mdb_px[i, axis]), unit="px", role="first",
                   answer=True),
        ]  # fmt: skip
    if i is not None:
        marks.append(Number(thing="a", label="Unseen, it moves the point",
                            value=1e3 * float(reliability.effect[i].max()), unit="mm", digits=0, role="first",
                            answer=True))  # fmt: skip
    marks += [
        Sentence(text="Suspects", heading=True, thing="accused"),
        *(Sentence(thing="accused", role="error", text=text, answer=True) for text in _suspects(block)),
        Number(thing="a", label="True blunder A", value=block.size("a"), unit="px", truth=True, role="truth"),
        Number(thing="b", label="True blunder B", value=block.size("b"), unit="px", truth=True, role="truth"),
        Number(thing="errors", label="Largest error of a point", unit="mm", digits=0, truth=True, role="truth",
               value=1e3 * float(np.linalg.norm(block.errors, axis=1).max()), answer=True),
    ]  # fmt: skip
    return marks


def _global(block: Snooping) -> str:
    test = block.result.adjustment.global_test
    if test is None:
        return "Without redundancy nothing can be tested."
    verdict = "passed" if test.passed else "failed"
    return f"Global test {verdict}: vᵀPv {test.statistic:.1f}, bounds {test.lower:.1f} and {test.upper:.1f}."


def _suspects(block: Snooping) -> list[str]:
    """Return the removed observations and the three worst of those above the limit, in words."""
    found, name = block.result, "τ" if block.params.test == "tau" else "w"
    texts = [f"removed: point {point}, photo {photo}" for photo, point in block.dropped]
    largest = np.abs(found.values).max(axis=1)
    for i in np.argsort(-largest)[:3]:
        if largest[i] > found.limit:
            texts.append(f"point {found.point[i] + 1}, photo {found.photo[i] + 1}: |{name}| {largest[i]:.1f}")
    return texts or ["none: every observation passes"]


def _says(block: Snooping) -> str:
    found = block.result
    i, _ = found.worst
    largest, name = float(np.abs(found.values).max()), "τ" if block.params.test == "tau" else "w"
    where = f"point {found.point[i] + 1} in photo {found.photo[i] + 1}"
    if largest <= found.limit:
        return f"Nothing is accused: the largest |{name}| is {largest:.1f}, at {where}; the limit is {found.limit:.1f}."
    p = block.params
    real = {(p.a_photo, p.a_point): block.size("a"), (p.b_photo, p.b_point): block.size("b")}
    right = real.get((int(found.photo[i]) + 1, int(found.point[i]) + 1), 0.0) > 0
    return f"Accused is {where} with |{name}| {largest:.1f}: {'rightly' if right else 'wrongly'}."
