"""Datum and rank defect: what no photo notices, and what holds the block."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.bundle.problem import make_problem
from graphos_core.adjustment.bundle.rank import datum_findings
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.cameras import pixel_from_ray
from graphos_core.geometry.intersection_precision import error_ellipse
from graphos_core.geometry.similarity import estimate_similarity
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.datum_drawing import (
    FLOOR,
    handle_marks,
    largest_change,
    photo_marks,
    plan_marks,
    space_marks,
    spectrum_marks,
)
from graphos_didactic.simulators.adjustment.datum_model import Held
from graphos_didactic.simulators.adjustment.datum_params import LESSON, DatumParams
from graphos_didactic.simulators.adjustment.datum_tasks import PREDICTION, datum_task
from graphos_didactic.simulators.adjustment.four_photos import HEIGHT, POINTS_XYZ, WIDTH
from graphos_didactic.simulators.observed_space import space_panel

THINGS = {
    "block": "the adjusted block",
    "motion": "the block moved along a free motion: every photo stays as it is",
    "control": "what is known of the object",
    "ellipses": "error ellipses of the points, 95 %",
    "truth": "where the points really are",
}
STEPS = (
    Step("Photos", "The photos fix the shape of the block, and nothing else."),
    Step("Control", "Known coordinates or a distance say where it is, which way it looks, how large it is."),
    Step("Free motions", "What is not known leaves motions that change no image point."),
    Step("Spectrum", "The normal matrix feels them as eigenvalues of zero: one for each."),
    Step("Ellipses", "To state a precision, the free motions must be fixed somehow: that is the datum."),
)
NOTHING = {"p1": "none", "p3": "none", "p7": "none", "p9": "none"}
ALL = {"p1": "full", "p3": "full", "p7": "full", "p9": "full"}
PRESETS = (
    Preset("axis", "Two points", "Six numbers: the block still turns about the line through both.", {}, "degenerate"),
    Preset("nothing", "Nothing known", "Seven free motions: shifts, turns, scale.", {**NOTHING, "motion": 1},
           "degenerate"),
    Preset("minimal", "Hung from few", "The same block by minimal constraints: larger ellipses, the same shape.",
           {**NOTHING, "kind": "minimal"}),
    Preset("seven", "Just seven numbers", "A wrong coordinate moves and scales the block, the photos do not mind.",
           {"p3": "height", "wrong_x": 400.0, "wrong_y": -300.0}),
    Preset("more", "More than seven", "The same wrong coordinate among twelve: shape and sigma0 suffer.",
           {**ALL, "wrong_x": 400.0, "wrong_y": -300.0}),
    Preset("photo", "With photos", "The dashed block gives the same photos as the other.",
           {"photo": True, "p9": "none", "motion": 1, "amount": 0.8}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="datum",
    title="Datum and rank defect",
    summary="What photos cannot know, which control fixes it, and what the error ellipses have to do with it.",
    first="Drag the dashed block along its free motion: the photos do not change.",
    source="Baarda 1973; Förstner and Wrobel 2016, section 4.5",
    engine=(
        adjust_block, make_problem, datum_findings, ReducedSystem, estimate_similarity, error_ellipse, pixel_from_ray,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=datum_task,
    learn=LESSON,
    place=75,
)  # fmt: skip
def datum(params: DatumParams, setting: Setting) -> Scene:
    """Show the block in space and plan, two photos, the spectrum of the normal matrix and the numbers."""
    held = Held(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [
        *photo_marks(held, setting, last >= 2),
        *space_marks(held, last >= 1, last >= 2),
        *plan_marks(held, last >= 1, last >= 4),
    ]
    if last >= 3:
        marks += spectrum_marks(held)
    marks += [*handle_marks(held), *_sheet(held)]
    return Scene(panels=_panels(held), marks=tuple(marks), things=THINGS, says=_says(held))


def _panels(held: Held) -> tuple[Panel, ...]:
    across, down = (-0.5, WIDTH - 0.5), (-0.5, HEIGHT - 0.5)
    return (
        space_panel("The block, and a free motion (dashed)", (0.0, 0.0, 0.40, 0.62)),
        Panel(name="plan", title=f"From above · ellipses {held.params.exaggeration}×", rect=(0.40, 0.0, 0.33, 0.62),
              x_range=(-4.4, 4.4), y_range=(-3.9, 3.9), x_label="X [m]", y_label="Y [m]", equal=True),
        Panel(name="spectrum", title="Eigenvalues of the normal matrix", rect=(0.0, 0.62, 0.25, 0.38),
              x_range=(0.0, len(held.spectrum) + 1.0), y_range=(FLOOR - 1.0, 1.0), x_label="number",
              y_label="log₁₀ λ / λ₁"),
        *(Panel(name=f"photo_{i + 1}", title=f"Photo {i + 1}", rect=(0.25 + 0.24 * i, 0.62, 0.24, 0.38), kind="picture",
                x_range=across, y_range=down, equal=True, y_down=True) for i in (0, 1)),
        Panel(name="numbers", title="Numbers", rect=(0.73, 0.0, 0.27, 1.0), kind="sheet"),
    )  # fmt: skip


def _sheet(held: Held) -> list[AnyMark]:
    points = np.asarray(held.adjustment.block.points)
    error = float(np.sqrt(((points - POINTS_XYZ) ** 2).mean()))
    marks: list[AnyMark] = [
        Formula(thing="motion", tex=r"\mathbf{N}\,\mathbf{g} = \mathbf{0}, \quad \mathbf{g} \neq \mathbf{0}"),
        Number(thing="control", label="Known numbers", value=held.count, unit="", digits=0, role="truth"),
        Number(thing="motion", label="Free motions (defect)", value=held.defect, unit="", digits=0, role="third",
               answer=True),
        Sentence(text="Free motions", heading=True, thing="motion"),
    ]  # fmt: skip
    for k, motion in enumerate(held.motions):
        mark = " ◂ shown" if motion is held.shown else ""
        marks.append(
            Sentence(thing="motion", role="third", text=f"{k + 1}  {motion.name}{mark}", answer=True)
        )
    if not held.motions:
        marks.append(Sentence(thing="motion", role="muted", text="none: the datum is complete", answer=True))
    marks += [
        Number(thing="motion", label="Largest change in a photo", value=largest_change(held), unit="px", digits=3,
               role="third", answer=True),
        Sentence(text="Precision in this datum", heading=True, thing="ellipses"),
        Number(thing="ellipses", label="Mean σ of a point", value=1e3 * float(held.sigmas.mean()), unit="mm", digits=1,
               role="third", answer=True),
        Number(thing="ellipses", label="Largest σ of a point", value=1e3 * float(held.sigmas.max()), unit="mm", digits=1,
               role="third", answer=True),
        Sentence(text="Shape", heading=True, thing="block"),
        Number(thing="block", label="Sigma0", value=held.adjustment.sigma0, unit="", digits=3, role="estimate",
               answer=True),
        Number(thing="block", label="Bent by control", value=1e3 * held.bending, unit="mm", digits=1, role="estimate",
               answer=True),
        Number(thing="truth", label="Error of the points (RMS)", value=1e3 * error, unit="mm", digits=1, role="truth",
               truth=True, answer=True),
        *((Sentence(text="The program says", heading=True, thing="motion"),
           Sentence(role="muted", text=held.advice, thing="motion", answer=True)) if held.advice else ()),
        Sentence(role="muted", text=f"Datum: {held.equations.cofactors.datum}.", answer=True),
    ]  # fmt: skip
    return marks


def _says(held: Held) -> str:
    s0, bent = held.adjustment.sigma0, 1e3 * held.bending
    if held.shown is None:
        more = f", {held.count - 7} more than needed" if held.count > 7 else ""
        return f"{held.count} known numbers{more}: nothing is free. Sigma0 is {s0:.2f}, the shape is bent by {bent:.1f} mm."
    free = "one motion is" if held.defect == 1 else f"{held.defect} motions are"
    return f"{held.count} known numbers: {free} free; shown is number {held.motions.index(held.shown) + 1}, {held.shown.name}."
