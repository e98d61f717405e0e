"""Labs: a folder of text that an instructor writes, played on the student's own results.

A lab is a folder with ``lab.toml``::

    title = "From photos to a model"
    goal = "…"
    minutes = 45
    block = { template = "facade", photos = 6, width = 800, height = 600 }

    [[step]]
    kind = "predict"            # read, predict, do, measure, compare, explain
    title = "How many photos?"
    text = "Markdown with $formulas$"
    figure = "photos_oriented"  # what is predicted, measured or compared; see lab_figures.FIGURES
    hints = ["first grade", "second grade"]

- **read**: nothing to answer;
- **predict**: a number before it is computed; kept, never judged, compared later;
- **do**: a stage of the workflow (``stage = "features"``) has to be finished, optionally with one figure ``at_least`` or
  ``at_most`` a number;
- **measure**: a number read from the student's own results; right within three standard deviations, or within the
  rounding of the answer where the figure has none;
- **compare**: the figure against the truth of the simulated block; passes when they agree within three standard
  deviations;
- **explain**: an answer in words, at least ``words`` long; the instructor reads it.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, Literal

from graphos_core.errors import UserError
from graphos_core.params import unknown_name
from graphos_core.pipeline import Pipeline
from graphos_core.registry import STAGES, Stage
from graphos_core.simulation.truth import Truth
from graphos_core.text import Text
from graphos_didactic.lab_figures import FIGURES, Figure

Kind = Literal["read", "predict", "do", "measure", "compare", "explain"]
KINDS: tuple[Kind, ...] = ("read", "predict", "do", "measure", "compare", "explain")
NEEDED = {
    "predict": ("figure",),
    "do": ("stage",),
    "measure": ("figure",),
    "compare": ("figure",),
    "explain": ("words",),
}
KNOWN = {
    "kind",
    "title",
    "text",
    "figure",
    "stage",
    "words",
    "hints",
    "at_least",
    "at_most",
    "simulator",
    "lesson",
}


@dataclass(frozen=True)
class Step:
    """One step of a lab; which attributes matter depends on `kind`."""

    kind: Kind
    title: str
    text: str
    figure: str = ""
    stage: Stage | None = None
    words: int = 0
    hints: tuple[str, ...] = ()
    at_least: float | None = None
    at_most: float | None = None
    simulator: str = ""
    lesson: str = ""


@dataclass(frozen=True)
class Lab:
    """A lab.

    Attributes
    ----------
    name : str
        Name of its folder.
    title, goal : str
    minutes : int
    block : dict
        Template, photos, width, height of the simulated block that every student gets with a seed of their own.
    steps : tuple of Step
    """

    name: str
    title: str
    goal: str
    minutes: int
    block: dict[str, Any]
    steps: tuple[Step, ...]


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


def read_lab(name: str, source: str) -> Lab:
    """Read a lab from the text of its ``lab.toml``.

    Raises
    ------
    UserError
        Naming the line or the step that is wrong.
    """
    try:
        document = tomllib.loads(source)
    except tomllib.TOMLDecodeError as problem:
        raise UserError(
            Text("The lab {name} cannot be read.", name=name), f"{problem}.", "Correct that line."
        ) from problem
    for key in ("title", "goal", "minutes", "block", "step"):
        if key not in document:
            raise UserError(Text("The lab {name} has no “{key}”.", name=name, key=key))
    lines = [i + 1 for i, line in enumerate(source.splitlines()) if line.strip() == "[[step]]"]
    steps = tuple(_step(name, line, entry) for line, entry in zip(lines, document["step"], strict=True))
    return Lab(
        name,
        str(document["title"]),
        str(document["goal"]),
        int(document["minutes"]),
        dict(document["block"]),
        steps,
    )


def _step(lab: str, line: int, entry: dict[str, Any]) -> Step:
    def wrong(what: str) -> UserError:
        return UserError(Text("The lab {lab} is wrong in the step of line {line}.", lab=lab, line=line), what)

    for key in entry:
        if key not in KNOWN:
            raise wrong(unknown_name(key, sorted(KNOWN), "entry"))
    kind = entry.get("kind")
    if kind not in KINDS:
        raise wrong(unknown_name(str(kind), list(KINDS), "kind"))
    for key in ("title", "text", *NEEDED.get(kind, ())):
        if key not in entry:
            raise wrong(Text("A step of kind {kind} needs “{key}”.", kind=kind, key=key))
    if entry.get("figure") and entry["figure"] not in FIGURES:
        raise wrong(unknown_name(entry["figure"], list(FIGURES), "figure"))
    if entry.get("stage") and entry["stage"] not in STAGES:
        raise wrong(unknown_name(entry["stage"], list(STAGES), "stage"))
    return Step(**{**entry, "hints": tuple(entry.get("hints", ()))})


@cache
def labs() -> dict[str, Lab]:
    """Return the labs of the program by name."""
    folder = resources.files("graphos_resources") / "labs"
    found = {}
    for entry in sorted(folder.iterdir(), key=lambda e: e.name):
        if (entry / "lab.toml").is_file():
            found[entry.name] = read_lab(entry.name, (entry / "lab.toml").read_text("utf-8"))
    return found


def read_lab_folder(folder: Path) -> Lab:
    """Read a lab that an instructor wrote; see `read_lab` for what is raised."""
    try:
        return read_lab(folder.name, (folder / "lab.toml").read_text("utf-8"))
    except OSError as problem:
        raise UserError(
            Text("{folder} is not a lab.", folder=folder),
            "It has no lab.toml that can be read.",
            "Choose a lab's folder.",
        ) from problem


def student_seed(student: str, lab: str) -> int:
    """Return the seed of a student's own block: the same for the same name and lab, everywhere."""
    plain = " ".join(student.casefold().split())
    return int.from_bytes(hashlib.sha256(f"{lab}\n{plain}".encode()).digest()[:3], "big")


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
        return float(text.strip().replace(",", ".").replace("\u2009", "").replace(" ", ""))
    except ValueError:
        return None


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
    tolerance = max(3.0 * figure.sigma, rounding(answer))
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
        "{label}: estimated {v:.6g}, true {t:.6g} {unit}; error {d:+.3g} {unit} = {r:.1f} σ",
        label=figure.label, v=figure.value, t=figure.truth, unit=figure.unit, d=difference, r=ratio,
    )  # fmt: skip
    return Outcome(ratio <= 3.0, text)


def answer_key(lab: Lab, pipeline: Pipeline, truth: Truth | None) -> list[tuple[str, str]]:
    """Return the instructor's key: for each step with a figure its value, σ and truth, computed from the results."""
    return [(step.title, _key_line(figure_of(step, pipeline, truth))) for step in _with_figure(lab.steps)]


def _with_figure(steps: Iterable[Step]) -> list[Step]:
    return [step for step in steps if step.figure]


def _key_line(figure: Figure | None) -> str:
    if figure is None:
        return "not computed yet"
    sigma = f" ± {figure.sigma:.2g}" if figure.sigma > 0 else ""
    truth = f"; truth {figure.truth:.6g}" if figure.truth is not None else ""
    return f"{figure.value:.6g}{sigma} {figure.unit}{truth}"
