"""Checks of a lab's steps on the student's own results, and the instructor's key."""

from __future__ import annotations

import math
from dataclasses import dataclass

from graphos_core.pipeline import Pipeline
from graphos_core.simulation.truth import Truth
from graphos_core.text import Text
from graphos_didactic.lab_figures import FIGURES, Figure
from graphos_didactic.labs import Lab, Step

COARSEST = 0.05
"""Share of a value that the rounding of an answer may be off at most, so that “0” is not right for everything small."""


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


def figure_of(step: Step, pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    """Return the figure a step is about, from the student's own results; None while they are missing."""
    return FIGURES[step.figure](pipeline, truth) if step.figure else None


def check(step: Step, answer: str, pipeline: Pipeline, truth: Truth | None) -> Outcome:
    """Judge a step on the student's own results.

    Parameters
    ----------
    step : Step
    answer : str
        What the student typed; not used by read, do and compare.
    pipeline : Pipeline
        Of the student's project.
    truth : Truth or None
    """
    if step.kind == "read":
        return Outcome(True, "")
    if step.kind == "explain":
        words = len(answer.split())
        return Outcome(words >= step.words, Text("{n} words, {needed} needed.", n=words, needed=step.words))
    if step.kind == "predict":
        number = parse_number(answer)
        if number is None:
            return Outcome(False, "Type a number.")
        return Outcome(True, "Kept; you will compare it with the result later.")
    if step.kind == "do":
        return _check_do(step, pipeline, truth)
    figure = figure_of(step, pipeline, truth)
    if figure is None:
        return Outcome(False, "The result is not there yet: run the step of the workflow first.")
    return _check_measure(figure, answer) if step.kind == "measure" else _check_compare(figure)


def parse_number(text: str) -> float | None:
    """Return the number a student typed, with a decimal point or comma; None when it is none."""
    try:
        number = float(text.strip().replace(",", ".").replace("\u2009", "").replace(" ", ""))
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def rounding(text: str) -> float:
    """Return half a unit of the last digit a student typed: ``"12.3"`` gives 0.05."""
    digits = text.strip().replace(",", ".").partition(".")[2]
    return 0.5 * 10.0 ** -len(digits)


def _check_do(step: Step, pipeline: Pipeline, truth: Truth | None) -> Outcome:
    assert step.stage is not None
    if pipeline.result(step.stage) is None:
        state = pipeline.state(step.stage)
        return Outcome(
            False, Text("{stage} is not finished: {line}.", stage=step.stage.capitalize(), line=state.line)
        )
    figure = figure_of(step, pipeline, truth)
    if figure is not None:
        shown = f"{figure.label}: {figure.value:g} {figure.unit}".strip()
        if step.at_least is not None and figure.value < step.at_least:
            return Outcome(
                False, Text("{shown}, at least {limit:g} needed.", shown=shown, limit=step.at_least)
            )
        if step.at_most is not None and figure.value > step.at_most:
            return Outcome(
                False, Text("{shown}, at most {limit:g} allowed.", shown=shown, limit=step.at_most)
            )
        return Outcome(True, shown + ".")
    return Outcome(True, pipeline.state(step.stage).line)


def _check_measure(figure: Figure, answer: str) -> Outcome:
    number = parse_number(answer)
    if number is None:
        return Outcome(False, "Type a number.")
    tolerance = max(3.0 * figure.sigma, min(rounding(answer), COARSEST * abs(figure.value)))
    difference = number - figure.value
    text = Text(
        "difference {d:+.3g} {unit}, allowed ±{t:.2g} {unit}", d=difference, unit=figure.unit, t=tolerance
    )
    return Outcome(abs(difference) <= tolerance * (1 + 1e-9), text)


def _check_compare(figure: Figure) -> Outcome:
    if figure.truth is None:
        return Outcome(False, "The truth is not known here: this step needs the lab's own simulated block.")
    difference = figure.value - figure.truth
    ratio = abs(difference) / figure.sigma if figure.sigma > 0 else (0.0 if difference == 0 else float("inf"))
    text = Text(
        "{label}: estimated {v:.6g}{unit}, true {t:.6g}{unit}; error {d:+.3g}{unit} = {r:.1f} σ",
        label=figure.label, v=figure.value, t=figure.truth, unit=f" {figure.unit}".rstrip(), d=difference, r=ratio,
    )  # fmt: skip
    return Outcome(ratio <= 3.0, text)


def answer_key(lab: Lab, pipeline: Pipeline, truth: Truth | None) -> list[tuple[str, str]]:
    """Return the instructor's key: for each step with a figure its value, σ and truth, computed from the results."""
    return [(step.title, _key_line(figure_of(step, pipeline, truth))) for step in lab.steps if step.figure]


def _key_line(figure: Figure | None) -> str:
    if figure is None:
        return "not computed yet"
    sigma = f" ± {figure.sigma:.2g}" if figure.sigma > 0 else ""
    truth = f"; truth {figure.truth:.6g}" if figure.truth is not None else ""
    return f"{figure.value:.6g}{sigma} {figure.unit}".rstrip() + truth
