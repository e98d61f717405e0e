"""Lessons: Markdown files with a head in TOML, from the program's resources; numbers in them come from declarations.

A lesson ``resources/graphos_resources/lessons/ROOM/NAME.md`` begins with a head between two lines ``+++``::

    +++
    title = "Wallis filter"
    algorithm = "preprocessing.wallis"
    simulator = "preprocessing/wallis"
    formula = 'a (g - m) + b'
    fails = "Where a neighbourhood is empty, only noise is lifted."
    [[try]]
    what = "a wide window"
    values = { window = 101 }
    +++

In the text ``$…$`` is a formula, and these directives stand for what the program itself knows:

- ``{{preprocessing.wallis.window}}``: default of a parameter with its unit; with ``.range`` its range;
- ``:::parameters preprocessing.wallis``: table of the parameters;
- ``:::picture adjustment/intersection PRESET`` or ``… a_x=-3 b_x=3``: the scene of a simulator, drawn by the engine;
- ``:::filtered clahe clip=4``: a difficult photo before and after a filter, drawn by the engine;
- ``:::detected harris levels=1``: a detector's points on the simulated façade, and which are found again;
- ``:::selected sift``: the four ways to choose among a detector's points;
- ``:::camera fraser``: formula, direction and parameters of a camera model.

What there is to try are parameters of the algorithm; with ``simulator = true``, or in a lesson without an algorithm, those
of its simulator.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

from graphos_core.cameras.model import Parameter, camera_model
from graphos_core.errors import UserError
from graphos_core.params import Declaration, Params, unknown_name
from graphos_core.registry import STAGES, find
from graphos_core.text import Text

FILTER = "filter"
"""Stands for a simulator in the address of a picture of a filter."""
DETECTOR, SELECTION = "detector", "selection"
"""The same for pictures of a detector and of the selection among its points."""
PICTURES = {"filtered": FILTER, "detected": DETECTOR, "selected": SELECTION}
"""Directives of pictures that are no simulator's."""

HEAD = re.compile(r"\A\+\+\+\n(.*?)\n\+\+\+\n", re.DOTALL)
DIRECTIVE = re.compile(r"^:::(\w+) +(.+)$", re.MULTILINE)
NUMBER = re.compile(r"\{\{(\w+)\.(\w+)\.(\w+)(\.range)?\}\}")


@dataclass(frozen=True)
class Trial:
    """Something to try: what, the parameter values that do it, and whether they are those of the simulator."""

    what: str
    values: dict[str, Any]
    simulator: bool = False


@dataclass(frozen=True)
class Lesson:
    """A lesson.

    Attributes
    ----------
    name : str
        ``"preprocessing/wallis"``.
    title : str
    text : str
        Markdown as written, without the head.
    algorithm, simulator : str
        What it is about; empty where there is none.
    formula : str
        In mathtext, without dollar signs.
    fails : str
        When the method fails and how one sees it.
    trials : tuple of Trial
    """

    name: str
    title: str
    text: str
    algorithm: str = ""
    simulator: str = ""
    formula: str = ""
    fails: str = ""
    trials: tuple[Trial, ...] = ()

    @property
    def room(self) -> str:
        """The room it belongs to."""
        return self.name.partition("/")[0]

    @property
    def summary(self) -> str:
        """First sentence of the text, without marks."""
        plain = " ".join(re.sub(r"[*_$`]|\[([^\]]*)\]\([^)]*\)", r"\1", self.text).split())
        return plain.partition(". ")[0].partition(": ")[0].rstrip(".") + "."

    def markdown(self, picture: Callable[[str, str], str]) -> str:
        """Return the text with directives filled in.

        Parameters
        ----------
        picture : callable
            ``picture(simulator, what)`` returns the address of the picture for the Markdown; `what` is read by
            `Simulator.described`, or where the simulator is one of `PICTURES` by its own; see
            `graphos_didactic.lesson_pictures.lesson_scene`.
        """

        def block(found: re.Match[str]) -> str:
            words = found[2].split()
            if found[1] == "parameters":
                return parameter_table(*words[0].split(".", 1))
            if found[1] == "camera":
                return camera_table(words[0])
            if found[1] == "picture":
                return f"![{self.title}]({picture(words[0], ','.join(words[1:]))})"
            if found[1] in PICTURES:
                return f"![{self.title}]({picture(PICTURES[found[1]], ','.join(words))})"
            raise UserError(
                Text("The lesson {name} has an unknown directive “{word}”.", name=self.name, word=found[1])
            )

        return NUMBER.sub(_number, DIRECTIVE.sub(block, self.text))


def read_lesson(name: str, source: str) -> Lesson:
    """Read a lesson from its text.

    Raises
    ------
    UserError
        When the head is missing or wrong.
    """
    head = HEAD.match(source)
    try:
        if head is None:
            raise ValueError("it does not begin with +++")
        about = tomllib.loads(f"\n{head[1]}\n")  # so that lines are counted as in the file
        plain = {k: str(about.get(k, "")) for k in ("algorithm", "simulator", "formula", "fails")}
        trials = tuple(
            Trial(str(t["what"]), dict(t["values"]), bool(t.get("simulator", not plain["algorithm"])))
            for t in about.get("try", ())
        )
        return Lesson(name, str(about["title"]), source[head.end() :].strip() + "\n", trials=trials, **plain)
    except (ValueError, KeyError, TypeError) as problem:
        raise UserError(Text("The lesson {name} cannot be read: {why}.", name=name, why=problem)) from problem


@cache
def lessons() -> dict[str, Lesson]:
    """Return all lessons by name, in the order of the workflow."""
    folder = resources.files("graphos_resources") / "lessons"
    found: dict[str, Lesson] = {}
    for room in STAGES:
        if (folder / room).is_dir():
            for file in sorted((folder / room).iterdir(), key=lambda f: f.name):
                if file.name.endswith(".md"):
                    name = f"{room}/{file.name[:-3]}"
                    found[name] = read_lesson(name, file.read_text("utf-8"))
    return found


def find_lesson(name: str) -> Lesson:
    """Return a lesson by name.

    Raises
    ------
    UserError
        When there is none of that name.
    """
    if name not in lessons():
        raise UserError(unknown_name(name, list(lessons()), "lesson"))
    return lessons()[name]


def parameter_table(stage: str, name: str) -> str:
    """Return a Markdown table of an algorithm's parameters, made from their declarations."""
    rows = ["| parameter | default | possible | effect |", "|---|---|---|---|"]
    for declaration in find(stage, name).params.declarations().values():
        about = declaration.about
        cells = [
            about.label,
            default_text(declaration),
            declaration.range_text,
            f"{about.help} {about.effect}",
        ]
        rows.append("| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows)


def camera_table(name: str) -> str:
    """Return formula, direction and parameters of a camera model in Markdown, made from its declaration."""
    model = camera_model(name)
    lines = [part for formula in model.formula.split(r",\quad ") for part in (f"$${formula.strip()}$$", "")]
    lines += [f"Direction: {model.direction}.", ""]
    lines += ["| parameter | symbol | unit | in self-calibration |", "|---|---|---|---|"]
    for alike in _alike(model.parameters):
        first, last = alike[0], alike[-1]
        label, symbol = first.label, f"${first.symbol}$"
        if len(alike) > 1:
            label, symbol = f"{len(alike)} terms", f"${first.symbol}$ … ${last.symbol}$"
        lines.append(f"| {label} | {symbol} | {first.unit or '–'} | {_handled(first)} |")
    return "\n".join([*lines, "", *(f"- {sentence}" for sentence in model.dependences)])


def _alike(parameters: tuple[Parameter, ...]) -> list[list[Parameter]]:
    """Return neighbours of one group that are handled alike together, where a model has many of them."""
    groups: list[list[Parameter]] = []
    many = len(parameters) > 14
    for parameter in parameters:
        last = groups[-1][-1] if groups else None
        if (
            many
            and last
            and (last.group, last.default) == (parameter.group, parameter.default)
            and last.group == "polynomial"
        ):
            groups[-1].append(parameter)
        else:
            groups.append([parameter])
    return groups


def _handled(parameter: Parameter) -> str:
    """Return what a self-calibration does with a parameter unless told otherwise, and why."""
    words = {
        "free": "estimated",
        "fixed": "held fixed",
        "constant": "not estimated",
        "prior": "estimated with a prior",
    }
    return f"{words[parameter.default]}. {parameter.reason}" if parameter.reason else words[parameter.default]


def trial_sheet(lesson: Lesson, trial: Trial) -> type[Params] | None:
    """Return the sheet whose parameters a trial sets: of the lesson's algorithm or of its simulator."""
    if trial.simulator and lesson.simulator:
        from graphos_didactic.simulator import find_simulator

        return find_simulator(lesson.simulator).params
    if lesson.algorithm:
        return find(*lesson.algorithm.split(".", 1)).params
    return None


def default_text(declaration: Declaration) -> str:
    """Return the default of a parameter with its unit."""
    value = declaration.default
    if value is None:
        return "none"
    shown = (
        f"{value:g}"
        if isinstance(value, float)
        else str(value).lower()
        if isinstance(value, bool)
        else str(value)
    )
    return f"{shown} {declaration.about.unit}".strip()


def _number(found: re.Match[str]) -> str:
    stage, algorithm, parameter, wants_range = found.groups()
    declarations = find(stage, algorithm).params.declarations()
    if parameter not in declarations:
        raise UserError(unknown_name(parameter, declarations, f"parameter of {stage}.{algorithm}"))
    return declarations[parameter].range_text if wants_range else default_text(declarations[parameter])
