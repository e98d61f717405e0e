"""Checks of a lab's steps on the student's own results, and the instructor's key."""

from __future__ import annotations

import math
from dataclasses import dataclass

from graphos_core.pipeline import Pipeline
from graphos_core.registry import Stage
from graphos_core.run import Run
from graphos_core.simulation.truth import Truth
from graphos_core.text import Text
from graphos_didactic.lab_calibration import CALIBRATION_FIGURES, Bench, calibration_line
from graphos_didactic.lab_detectors import DETECTOR_FIGURES, detector_line, measure
from graphos_didactic.lab_figures import FIGURES, Figure, control_roles, figure_text
from graphos_didactic.labs import Lab, Step

COARSEST = 0.05
"""Share of a value that the rounding of an answer may be off at most, so that “0” is not right for everything small."""


STAGE_NAMES: dict[Stage, str] = {
    "preprocessing": "Preprocessing",
    "features": "Features",
    "adjustment": "Bundle adjustment",
    "dense": "Dense matching",
    "quality": "Quality control",
}
NO_NUMBER = "Type a number alone, without words; for example 12.3."


@dataclass(frozen=True)
class Outcome:
    """What a check says.

    Attributes
    ----------
    passed : bool
    text : str
        With numbers, units and the tolerance.
    """

    passed: bool
    text: str


def figure_of(
    step: Step, pipeline: Pipeline | None, truth: Truth | None, bench: Bench | None = None
) -> Figure | None:
    """Return the figure a step is about, from the student's own results; None while they are missing."""
    if not step.figure:
        return None
    if step.figure in CALIBRATION_FIGURES:
        return CALIBRATION_FIGURES[step.figure](bench) if bench is not None else None
    if step.figure in DETECTOR_FIGURES:
        return DETECTOR_FIGURES[step.figure](pipeline, truth)
    return FIGURES[step.figure](pipeline, truth) if pipeline is not None else None


def check(
    step: Step,
    answer: str,
    pipeline: Pipeline | None,
    truth: Truth | None,
    bench: Bench | None = None,
    run: Run | None = None,
) -> Outcome:
    """Judge a step on the student's own results.

    Parameters
    ----------
    step : Step
    answer : str
        What the student typed; not used by read, do and compare.
    pipeline : Pipeline or None
        Of the student's project; None in a lab with a test field.
    truth : Truth or None
    bench : Bench or None
        Where the student calibrates, in a lab with a test field.
    run : Run, optional
        Told the progress of a calibration, or of a detector on all photos.
    """
    if step.kind == "read":
        return Outcome(True, "")
    if step.kind == "explain":
        words = len(answer.split())
        return Outcome(words >= step.words, Text("{n} words, {needed} needed.", n=words, needed=step.words))
    if step.kind == "predict":
        number = parse_number(answer)
        if number is None:
            return Outcome(False, NO_NUMBER)
        return Outcome(True, "Kept; you will compare it with the result later.")
    if step.kind == "calibrate":
        assert bench is not None
        report = bench.calibrate(step.photos, step.model, run or Run())
        warnings = "".join(f"\n• {line}" for line in report["warnings"])
        return Outcome(True, calibration_line(report, step.photos) + warnings)
    if step.kind == "detect":
        if truth is None:
            return Outcome(False, "This step needs the lab's own simulated block.")
        return Outcome(True, detector_line(step.detector, measure(truth, step.detector, run or Run())))
    if step.kind in ("do", "choose"):
        assert pipeline is not None
        return _check_do(step, pipeline, truth) if step.kind == "do" else _check_choice(step, pipeline)
    figure = figure_of(step, pipeline, truth, bench)
    if figure is None:
        return Outcome(False, "The result is not there yet: run the step of the workflow first.")
    if step.kind == "measure":
        return _check_measure(figure, answer)
    if figure.truth is None and bench is not None:
        return Outcome(True, Text("{label}: {shown}. Nobody knows the truth of your own camera; this step is for simulated photos.",
                                  label=figure.label, shown=figure_text(figure)))  # fmt: skip
    return _check_compare(figure)


def parse_number(text: str, unit: str = "") -> float | None:
    """Return the number a student typed, with a decimal point or comma, and `unit` or not; None when it is none."""
    plain = text.strip().removesuffix(unit) if unit else text.strip()
    for written, meant in ((",", "."), ("−", "-"), ("\u2009", ""), ("\u00a0", ""), ("\u202f", ""), (" ", "")):
        plain = plain.replace(written, meant)
    try:
        number = float(plain)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def rounding(text: str) -> float:
    """Return half a unit of the last digit a student typed: ``"12.3"`` gives 0.05."""
    digits = text.strip().replace(",", ".").partition(".")[2]
    return 0.5 * 10.0 ** -len(digits)


def _check_do(step: Step, pipeline: Pipeline, truth: Truth | None) -> Outcome:
    assert step.stage is not None and step.stage != "images"
    if pipeline.result(step.stage) is None:
        state = pipeline.state(step.stage)
        return Outcome(
            False, Text("{stage} is not finished: {line}.", stage=STAGE_NAMES[step.stage], line=state.line)
        )
    figure = figure_of(step, pipeline, truth)
    if figure is not None:
        shown = f"{figure.label}: {figure_text(figure)}"
        if step.at_least is not None and figure.value < step.at_least:
            return Outcome(
                False, Text("{shown}, at least {limit:g} needed.", shown=shown, limit=step.at_least)
            )
        if step.at_most is not None and figure.value > step.at_most:
            return Outcome(
                False, Text("{shown}, at most {limit:g} allowed.", shown=shown, limit=step.at_most)
            )
        return Outcome(True, shown + ".")
    return Outcome(
        True,
        Text("{stage} is done: {line}.", stage=STAGE_NAMES[step.stage], line=pipeline.state(step.stage).line),
    )


def _check_choice(step: Step, pipeline: Pipeline) -> Outcome:
    found = control_roles(pipeline)
    if found is None:
        return Outcome(False, "The project has no control points.")
    control, check_names, spread = found
    shown = Text(
        "Control: {names}. Check points: {n}. The control points span {spread:.0f} % of the extent of all",
        names=", ".join(control) or "none", n=len(check_names), spread=100.0 * spread,
    )  # fmt: skip
    if len(control) < step.control:
        return Outcome(
            False, Text("{shown}. At least {n} control points are needed.", shown=shown, n=step.control)
        )
    if len(check_names) < step.check:
        return Outcome(
            False, Text("{shown}. At least {n} check points are needed.", shown=shown, n=step.check)
        )
    if step.spread_at_least is not None and spread < step.spread_at_least:
        return Outcome(False, Text("{shown}; at least {limit:.0f} % are wanted.", shown=shown,
                                   limit=100.0 * step.spread_at_least))  # fmt: skip
    if step.spread_at_most is not None and spread > step.spread_at_most:
        return Outcome(False, Text("{shown}; at most {limit:.0f} % are wanted.", shown=shown,
                                   limit=100.0 * step.spread_at_most))  # fmt: skip
    return Outcome(True, Text("{shown}.", shown=shown))


def _check_measure(figure: Figure, answer: str) -> Outcome:
    number = parse_number(answer, figure.unit)
    if number is None:
        return Outcome(False, NO_NUMBER)
    typed = answer.strip().removesuffix(figure.unit).strip()
    tolerance = max(3.0 * figure.sigma, min(rounding(typed), COARSEST * abs(figure.value)))
    difference = number - figure.value
    allowed = Text("allowed ±{t:.2g} {unit}", t=tolerance, unit=figure.unit)
    if abs(difference) <= tolerance * (1 + 1e-9):
        text = Text(
            "Right: difference {d:+.2g} {unit}, {allowed}.", d=difference, unit=figure.unit, allowed=allowed
        )
        return Outcome(True, text)
    way = "Too large" if difference > 0 else "Too small"  # not by how much: that would be the answer
    return Outcome(False, Text("{way}; {allowed}. Read the number once more.", way=way, allowed=allowed))


def _check_compare(figure: Figure) -> Outcome:
    if figure.truth is None:
        return Outcome(False, "The truth is not known here: this step needs the lab's own simulated block.")
    difference = figure.value - figure.truth
    ratio = abs(difference) / figure.sigma if figure.sigma > 0 else (0.0 if difference == 0 else float("inf"))
    text = Text(
        "{label}: estimated {v:.6g}{unit}, true {t:.6g}{unit}; error {d:+.3g}{unit} = {r:.1f} σ: {verdict}",
        label=figure.label, v=figure.value, t=figure.truth, unit=f" {figure.unit}".rstrip(), d=difference, r=ratio,
        verdict=Text("within 3 σ, as good as it claims.") if ratio <= 3.0 else Text("beyond 3 σ, worse than it claims."),
    )  # fmt: skip
    return Outcome(ratio <= 3.0, text)


def answer_key(
    lab: Lab, pipeline: Pipeline | None, truth: Truth | None, bench: Bench | None = None
) -> list[tuple[str, str]]:
    """Return the instructor's key: for each step with a figure its value, σ and truth, computed from the results."""
    return [
        (step.title, _key_line(figure_of(step, pipeline, truth, bench))) for step in lab.steps if step.figure
    ]


def _key_line(figure: Figure | None) -> str:
    if figure is None:
        return "not computed yet"
    return figure_text(figure) + (f"; truth {figure.truth:.6g}" if figure.truth is not None else "")
