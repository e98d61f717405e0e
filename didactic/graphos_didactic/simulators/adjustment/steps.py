"""The adjustment step by step: residuals, Jacobian, normal matrix, Schur complement, damping, iteration."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.gauss_newton import minimise as gauss_newton
from graphos_core.adjustment.bundle.levenberg_marquardt import minimise as levenberg_marquardt
from graphos_core.adjustment.bundle.powell import minimise as powell
from graphos_core.adjustment.bundle.problem import make_problem
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.cameras import pixel_from_ray
from graphos_core.geometry.intersection_precision import image_derivatives
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.four_photos import HEIGHT, WIDTH
from graphos_didactic.simulators.adjustment.steps_drawing import (
    STEERS,
    handle_marks,
    jacobian_marks,
    normal_marks,
    photo_marks,
    plan_marks,
    schur_marks,
    step_marks,
    trace_marks,
)
from graphos_didactic.simulators.adjustment.steps_model import Iteration
from graphos_didactic.simulators.adjustment.steps_params import HIGHEST, LESSON, LOWEST, StepsParams
from graphos_didactic.simulators.adjustment.steps_tasks import PREDICTION, steps_task

THINGS = {
    "start": "where photo 1 starts",
    "now": "the present values",
    "measured": "where the points were measured",
    "residuals": "residuals: projected − measured",
    "known": "known points",
    "truth": "where everything really is",
    "jacobian": "Jacobian A: how every image coordinate depends on every unknown",
    "normal": "normal matrix N = AᵀPA",
    "schur": "Schur complement S: the normal matrix without the points",
    "step": "the step with your damping λ",
    "trace": "the iteration of the engine by the chosen method",
    "others": "the other methods, from the same start",
    "refused": "refused steps: the cost would have grown",
    "damping": "what the method steers with",
}
STEPS = (
    Step("Residuals", "From wrong start values the points are projected beside where they were measured."),
    Step("Jacobian", "Each row is a measured coordinate: it depends on one photo and one point only."),
    Step("Normal matrix", "AᵀPA: blocks of photos, small blocks of points, and what joins them."),
    Step("Schur complement", "The points are eliminated one by one: a small system for the photos is left."),
    Step("Step", "Solved with damping λ: small λ is the full step, large λ a short one straight downhill."),
    Step(
        "Iteration", "Linearise, solve, move, and again; λ falls when steps succeed and grows when they fail."
    ),
)
PRESETS = (
    Preset("good", "Good start", "Near the minimum the problem is nearly linear: a few full steps.",
           {"start_x": -0.5, "start_y": 0.3, "turn": 2.0, "rough": 0.2}),
    Preset("rough", "Rough start", "The first steps are long; from then on the cost falls like a stone.",
           {"start_x": 5.0, "start_y": 4.0, "turn": 20.0, "rough": 1.0}),
    Preset("turned", "Turned by 90°", "Full steps fail, damping grows, the iteration feels its way round.",
           {"turn": 90.0, "iteration": 1}),
    Preset("dogleg", "Dogleg", "Powell's dogleg from the same start: its radius shrinks where damping would grow.",
           {"turn": 90.0, "method": "powell", "iteration": 3}),
    Preset("upside", "Upside down", "Turned by 180°: it creeps in a wrong valley and never arrives.",
           {"turn": 180.0, "start_x": 0.0, "start_y": 0.0, "iteration": 25}, "degenerate"),
    Preset("photo", "With a photo", "Play the iteration and watch the picture move into place.",
           {"photo": True, "turn": 25.0, "iteration": 1}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="steps",
    title="Adjustment step by step",
    summary="What happens inside a bundle adjustment, from residuals to the last iteration.",
    first="Drag photo 1 away from its place, then drag the iteration and watch it come back.",
    source="Triggs et al. 2000, sections 4 and 6; Nielsen 1999; Powell 1970; Börlin and Grussenmeyer 2013",
    engine=(
        levenberg_marquardt, gauss_newton, powell, ReducedSystem, make_problem, image_derivatives, pixel_from_ray, matrix_from_vector,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=steps_task,
    learn=LESSON,
    place=70,
)  # fmt: skip
def steps(params: StepsParams, setting: Setting) -> Scene:
    """Show photo 1 and the plan, Jacobian, normal matrix and its Schur complement, the step, the trace, the numbers."""
    run = Iteration(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [*photo_marks(run, setting, last >= 4), *plan_marks(run, last >= 4, last >= 5)]
    if last >= 1:
        marks += jacobian_marks(run)
    if last >= 2:
        marks += normal_marks(run)
    if last >= 3:
        marks += schur_marks(run)
    if last >= 4:
        marks += step_marks(run)
    if last >= 5:
        marks += trace_marks(run)
    (low, _), (bottom, _) = _step_range(run), _trace_range(run)
    marks += [*handle_marks(run, low + 0.25, bottom + 0.8), *_sheet(run)]
    return Scene(panels=_panels(run), marks=tuple(marks), things=THINGS, says=_says(run))


def _step_range(run: Iteration) -> tuple[float, float]:
    """Return bottom and top of the picture of the step: whole powers of ten round what is drawn."""
    finite = run.curve[np.isfinite(run.curve)]
    drawn = np.log10(np.maximum(np.append(finite, run.cost), 1e-12))
    return float(np.floor(drawn.min())) - 1.0, float(np.ceil(drawn.max())) + 1.0


def _trace_range(run: Iteration) -> tuple[float, float]:
    records = run.solution.iterations
    values = np.log10(np.maximum([v for r in records for v in (r.cost, r.damping)], 1e-15))
    return float(np.floor(values.min())) - 1.5, float(np.ceil(values.max())) + 1.0


def _panels(run: Iteration) -> tuple[Panel, ...]:
    rows, columns = run.jacobian.shape
    u, count = run.problem.unknowns, run.longest
    return (
        Panel(name="photo", title="Photo 1", rect=(0.0, 0.0, 0.28, 0.42), kind="picture", x_range=(-0.5, WIDTH - 0.5),
              y_range=(-0.5, HEIGHT - 0.5), equal=True, y_down=True),
        Panel(name="plan", title="From above", rect=(0.0, 0.42, 0.28, 0.58), x_range=(-8.2, 5.6),
              y_range=(-5.2, 6.4), x_label="X [m]", y_label="Y [m]", equal=True),
        Panel(name="jacobian", title="Jacobian A", rect=(0.28, 0.0, 0.15, 0.52), kind="picture",
              x_range=(-0.5, columns - 0.5), y_range=(-0.5, rows - 0.5), y_down=True),
        Panel(name="normal", title="Normal matrix AᵀPA", rect=(0.43, 0.0, 0.19, 0.52), kind="picture",
              x_range=(-0.5, columns - 0.5), y_range=(-0.5, columns - 0.5), equal=True, y_down=True),
        Panel(name="schur", title="Reduced: S", rect=(0.62, 0.0, 0.14, 0.52), kind="picture",
              x_range=(-0.5, u - 0.5), y_range=(-0.5, u - 0.5), equal=True, y_down=True),
        Panel(name="trace", title="The engine's iteration", rect=(0.28, 0.52, 0.26, 0.48),
              x_range=(-0.6, max(count, 8) - 0.2), y_range=_trace_range(run), x_label="iteration", y_label="log₁₀",
              legend="above"),
        Panel(name="step", title="A step from here", rect=(0.54, 0.52, 0.22, 0.48), x_range=(LOWEST - 0.4, HIGHEST + 0.4),
              y_range=_step_range(run), x_label="log₁₀ of the damping λ", y_label="log₁₀ cost", legend="top left"),
        Panel(name="numbers", title="Numbers", rect=(0.76, 0.0, 0.24, 1.0), kind="sheet"),
    )  # fmt: skip


def _sheet(run: Iteration) -> list[AnyMark]:
    rows, columns = run.jacobian.shape
    record, mine, cost = run.solution.iterations[run.number], run.mine, run.cost
    marks: list[AnyMark] = [
        Formula(thing="step", tex=r"(\mathbf{N} + \lambda\mathbf{D})\,\Delta x = -\mathbf{A}^T\mathbf{P}\,v"),
        Formula(thing="schur", tex=r"\mathbf{S} = \mathbf{N}_{cc} - \mathbf{N}_{cp}\mathbf{N}_{pp}^{-1}\mathbf{N}_{pc}"),
        Number(thing="jacobian", label="Observations", value=rows, unit="", digits=0),
        Number(thing="normal", label="Unknowns", value=columns, unit="", digits=0),
        Number(thing="schur", label="of these in S", value=run.problem.unknowns, unit="", digits=0),
        Sentence(text=f"After iteration {run.number} of {len(run.solution.iterations) - 1}", heading=True, thing="trace"),
        Number(thing="now", label="Cost ½ vᵀPv", value=cost, unit="", digits=1 if cost < 1e4 else 0, role="estimate"),
        Number(thing="residuals", label="RMS residual", value=_rms(run), unit="px", role="error"),
        Number(thing="truth", label="Photo 1 from its place", value=run.error(run.scene), unit="m", digits=3,
               role="truth", truth=True),
        Number(thing="damping", label=f"log₁₀ {STEERS[run.params.method]}", unit="", digits=1, answer=True,
               value=float(np.log10(record.damping))),
    ]  # fmt: skip
    if run.number and not record.accepted:
        marks.append(Sentence(thing="refused", role="error", text="This step was refused.", answer=True))
    marks.append(Sentence(text="Your step from here", heading=True, thing="step"))
    if mine is None:
        marks.append(
            Sentence(thing="step", role="error", text="The matrix cannot be factorised: more damping.")
        )
        return marks
    gain = (cost - mine.cost) / mine.predicted if mine.predicted > 0 else float("nan")
    marks += [
        Number(thing="step", label="Cost after it", value=mine.cost, unit="", digits=1 if mine.cost < 1e4 else 0,
               role="third", answer=True),
        Number(thing="step", label="Real / predicted fall", value=gain, unit="", role="third", answer=True),
        Number(thing="truth", label="Photo 1 then from its place", value=run.error(mine.scene), unit="m", digits=3,
               role="truth", truth=True, answer=True),
    ]  # fmt: skip
    return marks


def _rms(run: Iteration) -> float:
    return float(np.sqrt(2.0 * run.cost * run.params.sigma_px**2 / run.jacobian.shape[0]))


def _says(run: Iteration) -> str:
    solution = run.solution
    end = f"after {len(solution.iterations) - 1} iterations: {solution.reason}"
    return f"Iteration {run.number}: RMS residual {_rms(run):.2f} px. {run.params.declarations()['method'].about.choices[run.params.method]} ends {end}."
