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
- **choose**: control and check points of the student's project: at least `control` and `check` of them, the control points
  spread over at least (``spread_at_least``) or at most (``spread_at_most``) this share of all points;
- **calibrate**: the camera is calibrated with photos of a test field (``photos = "all"``, or ``"even"``, ``"odd"``,
  ``"facing"``: every second one, or the half that looks at the board most directly); only in labs with a ``target``;
- **detect**: the detector ``detector = "orb"`` is run on the student's photos with the usual parameters, matched and
  verified; what it gave is kept and shown beside what the others gave; only in labs with a ``block``;
- **measure**: a number read from the student's own results; right within three standard deviations, or within the
  rounding of the answer where the figure has none;
- **compare**: the figure against the truth of the simulated block; passes when they agree within three standard
  deviations;
- **explain**: an answer in words, at least ``words`` long; the instructor reads it.

Instead of a ``block`` a lab can have a test field, photographed for every student or by the student::

    target = { target = "chessboard", columns = 9, rows = 6, square_mm = 25.0, photos = 14, width = 800, height = 600 }

Every other step can name a tab as its ``stage`` too, ``"images"`` included: the page then offers to go there.
"""

from __future__ import annotations

import dataclasses
import hashlib
import re
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, Literal

from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.errors import ParamError, UserError
from graphos_core.params import unknown_name
from graphos_core.registry import STAGES, Stage
from graphos_core.simulation.templates import TEMPLATES
from graphos_core.text import Text
from graphos_didactic.lab_calibration import CALIBRATION_FIGURES, SELECTIONS
from graphos_didactic.lab_detectors import DETECTOR_FIGURES, detectors
from graphos_didactic.lab_figures import FIGURES

Kind = Literal["read", "predict", "do", "choose", "calibrate", "detect", "measure", "compare", "explain"]
KINDS: tuple[Kind, ...] = (
    "read", "predict", "do", "choose", "calibrate", "detect", "measure", "compare", "explain",
)  # fmt: skip
NEEDED = {
    "predict": ("figure",),
    "do": ("stage",),
    "choose": ("control", "check"),
    "calibrate": ("photos",),
    "detect": ("detector",),
    "measure": ("figure",),
    "compare": ("figure",),
    "explain": ("words",),
}
KNOWN: dict[str, type | tuple[type, ...]] = {
    "kind": str,
    "title": str,
    "text": str,
    "figure": str,
    "stage": str,
    "words": int,
    "hints": list,
    "at_least": (int, float),
    "at_most": (int, float),
    "control": int,
    "check": int,
    "spread_at_least": (int, float),
    "spread_at_most": (int, float),
    "photos": str,
    "model": str,
    "detector": str,
    "simulator": str,
    "lesson": str,
}
TOP = {"title": str, "goal": str, "minutes": int, "step": list}
LIMITS = {"photos": (2, 100), "width": (160, 8000), "height": (120, 8000)}
SHAPE = 'For example: block = { template = "facade", photos = 6, width = 800, height = 600 }, and steps as [[step]].'
STEP_LINE = re.compile(r"\s*\[\[\s*step\s*\]\]")


@dataclass(frozen=True)
class Step:
    """One step of a lab; which attributes matter depends on `kind`."""

    kind: Kind
    title: str
    text: str
    figure: str = ""
    stage: Stage | Literal["images"] | None = None
    words: int = 0
    hints: tuple[str, ...] = ()
    at_least: float | None = None
    at_most: float | None = None
    control: int = 0
    check: int = 0
    spread_at_least: float | None = None
    spread_at_most: float | None = None
    photos: str = ""
    model: str = "basic"
    detector: str = ""
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
        Template, photos, width, height of the simulated block that every student gets with a seed of their own;
        empty where the lab has a `target`.
    target : dict
        Test field and number and size of its photos; empty where the lab has a `block`.
    steps : tuple of Step
    """

    name: str
    title: str
    goal: str
    minutes: int
    block: dict[str, Any]
    steps: tuple[Step, ...]
    target: dict[str, Any] = dataclasses.field(default_factory=dict)


def read_lab(name: str, source: str) -> Lab:
    """Read a lab from the text of its ``lab.toml``.

    Raises
    ------
    UserError
        Naming the line or the step that is wrong.
    """
    try:
        document = tomllib.loads(source)
    except (tomllib.TOMLDecodeError, RecursionError) as problem:
        raise UserError(
            Text("The lab {name} cannot be read.", name=name), f"{problem}.", "Correct that line."
        ) from problem
    for key, kind in TOP.items():
        if key not in document:
            raise UserError(Text("The lab {name} has no “{key}”.", name=name, key=key))
        if not isinstance(document[key], kind) or document[key] in ([], {}):
            raise UserError(Text("The lab {name} has a wrong “{key}”.", name=name, key=key), todo=SHAPE)
    target = document.get("target", {})
    if target:
        _check_target(name, target)
    elif not isinstance(document.get("block"), dict) or not document["block"]:
        raise UserError(Text("The lab {name} has no “block” and no “target”.", name=name), todo=SHAPE)
    else:
        _check_block(name, document["block"])
    lines = [i + 1 for i, line in enumerate(source.splitlines()) if STEP_LINE.match(line)]
    entries = document["step"]
    if len(lines) != len(entries):  # written as an array, or the words stand in a text
        lines = [0] * len(entries)
    steps = tuple(
        _step(name, i + 1, line, entry) for i, (line, entry) in enumerate(zip(lines, entries, strict=True))
    )
    for step, line in zip(steps, lines, strict=True):
        figures: list[str] = [*(CALIBRATION_FIGURES if target else FIGURES | DETECTOR_FIGURES)]
        if step.figure and step.figure not in figures:
            raise UserError(Text("The lab {lab} is wrong in the step of line {line}.", lab=name, line=line),
                            unknown_name(step.figure, figures, "figure of this kind of lab"))  # fmt: skip
        if (step.kind == "calibrate") > bool(target) or (step.kind in ("do", "choose", "detect") and target):
            raise UserError(
                Text("The lab {lab} is wrong in the step of line {line}.", lab=name, line=line),
                Text("A step of kind {kind} needs a lab with a {what}.", kind=step.kind,
                     what="block" if target else "target"),
            )  # fmt: skip
    return Lab(
        name,
        document["title"],
        document["goal"],
        document["minutes"],
        document.get("block", {}),
        steps,
        target,
    )


def _check_block(lab: str, block: dict[str, Any]) -> None:
    wrong = Text("The lab {lab} has a wrong “block”.", lab=lab)
    for key in ("template", "photos", "width", "height"):
        if key not in block:
            raise UserError(wrong, Text("“{key}” is missing.", key=key), SHAPE)
    if block["template"] not in TEMPLATES:
        raise UserError(wrong, unknown_name(str(block["template"]), list(TEMPLATES), "template"))
    for key, (least, most) in LIMITS.items():
        if type(block[key]) is not int or not least <= block[key] <= most:
            raise UserError(
                wrong,
                Text("“{key}” is {value}, needs {a} to {b}.", key=key, value=block[key], a=least, b=most),
            )


def _check_target(lab: str, target: dict[str, Any]) -> None:
    wrong = Text("The lab {lab} has a wrong “target”.", lab=lab)
    for key, (least, most) in LIMITS.items():
        value = target.get(key)
        if type(value) is not int or not (3 if key == "photos" else least) <= value <= most:
            raise UserError(wrong, Text("“{key}” is {value}, needs {a} to {b}.", key=key, value=value,
                                        a=3 if key == "photos" else least, b=most))  # fmt: skip
    try:
        target_sheet(target)
    except ParamError as problem:
        raise UserError(wrong, problem.message) from problem


def target_sheet(target: dict[str, Any]) -> TargetParams:
    """Return the test field of a lab's ``target``."""
    return TargetParams.from_dict({k: v for k, v in target.items() if k not in LIMITS})


def _step(lab: str, number: int, line: int, entry: dict[str, Any]) -> Step:
    def wrong(what: str) -> UserError:
        where = Text("the step of line {line}", line=line) if line else Text("step {number}", number=number)
        return UserError(Text("The lab {lab} is wrong in {where}.", lab=lab, where=where), what)

    if not isinstance(entry, dict):
        raise wrong("It is not a table.")
    for key, value in entry.items():
        if key not in KNOWN:
            raise wrong(unknown_name(key, sorted(KNOWN), "entry"))
        if not isinstance(value, KNOWN[key]) or isinstance(value, bool):
            raise wrong(Text("“{key}” has the wrong kind of value: {value}.", key=key, value=value))
    kind = entry.get("kind")
    if kind not in KINDS:
        raise wrong(unknown_name(str(kind), list(KINDS), "kind"))
    for key in ("title", "text", *NEEDED.get(kind, ())):
        if key not in entry:
            raise wrong(Text("A step of kind {kind} needs “{key}”.", kind=kind, key=key))
    known = [*FIGURES, *CALIBRATION_FIGURES, *DETECTOR_FIGURES]
    if entry.get("figure") and entry["figure"] not in known:
        raise wrong(unknown_name(entry["figure"], known, "figure"))
    places: list[str] = [*STAGES] if kind == "do" else ["images", *STAGES]
    if entry.get("stage") and entry["stage"] not in places:
        raise wrong(unknown_name(entry["stage"], places, "stage"))
    if entry.get("photos") and entry["photos"] not in SELECTIONS:
        raise wrong(unknown_name(entry["photos"], list(SELECTIONS), "choice of photos"))
    if entry.get("detector") and entry["detector"] not in detectors():
        raise wrong(unknown_name(entry["detector"], detectors(), "detector"))
    hints = tuple(entry.get("hints", ()))
    if not all(isinstance(hint, str) for hint in hints):
        raise wrong("Every hint is a text.")
    return Step(**{**entry, "hints": hints})


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
    except (OSError, UnicodeDecodeError) as problem:
        raise UserError(
            Text("{folder} is not a lab.", folder=folder),
            "It has no lab.toml that can be read.",
            "Choose a lab's folder.",
        ) from problem


def student_seed(student: str, lab: str) -> int:
    """Return the seed of a student's own block: the same for the same name and lab, everywhere."""
    plain = " ".join(student.casefold().split())
    return int.from_bytes(hashlib.sha256(f"{lab}\n{plain}".encode()).digest()[:3], "big")
