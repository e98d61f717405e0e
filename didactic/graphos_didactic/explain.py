"""Explanations of algorithms and parameters, made from declarations and lessons; the Explain panel shows them."""

from __future__ import annotations

import re
from dataclasses import dataclass

from graphos_core.registry import Algorithm
from graphos_didactic.lessons import Lesson, Trial, default_text, lessons

CAMERA_TABLE = re.compile(r"^:::camera (\w+)", re.MULTILINE)


@dataclass(frozen=True)
class Explanation:
    """What there is to say about an algorithm or one of its parameters.

    Attributes
    ----------
    title : str
    what : str
        What it does, in one sentence.
    formula : str
        In mathtext, without dollar signs; empty where there is none.
    effect : str
        What happens in both directions; empty for an algorithm.
    facts : tuple of (str, str)
        Label and value: range, default.
    fails : str
        When it fails and how one sees it.
    trials : tuple of Trial
        Parameter sets worth trying.
    source : str
    lesson, simulator : str
        Where to go on; empty where there is none.
    """

    title: str
    what: str
    formula: str
    effect: str
    facts: tuple[tuple[str, str], ...]
    fails: str
    trials: tuple[Trial, ...]
    source: str
    lesson: str
    simulator: str


def lesson_about(algorithm: Algorithm) -> Lesson | None:
    """Return the lesson about an algorithm, if there is one."""
    if algorithm.learn in lessons():
        return lessons()[algorithm.learn]
    name = full_name(algorithm)
    return next((lesson for lesson in lessons().values() if lesson.algorithm == name), None)


def camera_lesson(model: str) -> str:
    """Return the name of the lesson about a camera model, or of one of its kind; empty where there is none.

    Parameters
    ----------
    model : str
        Name of a camera model, such as ``"polynomial5"``.
    """
    told = {
        found: lesson.name for lesson in lessons().values() for found in CAMERA_TABLE.findall(lesson.text)
    }
    kind = re.split(r"[_\d]", model)[0]
    return told.get(model) or next(
        (name for found, name in told.items() if re.split(r"[_\d]", found)[0] == kind), ""
    )


def full_name(algorithm: Algorithm) -> str:
    """Return stage and name: ``"preprocessing.wallis"``."""
    return f"{algorithm.stage}.{algorithm.name}"


def explain_algorithm(algorithm: Algorithm) -> Explanation:
    """Explain an algorithm."""
    lesson = lesson_about(algorithm)
    own = lesson if lesson and lesson.algorithm in ("", full_name(algorithm)) else None
    return Explanation(
        title=algorithm.label,
        what=algorithm.summary,
        formula=own.formula if own else "",
        effect="",
        facts=(),
        fails=own.fails if own else "",
        trials=tuple(t for t in own.trials if not t.simulator) if own else (),
        source=algorithm.source,
        lesson=lesson.name if lesson else "",
        simulator=lesson.simulator if lesson else "",
    )


def explain_parameter(algorithm: Algorithm, name: str) -> Explanation:
    """Explain one parameter of an algorithm; what there is to try is what concerns this parameter."""
    declaration = algorithm.params.declarations()[name]
    about = declaration.about
    own = lessons().get(about.learn) or lesson_about(algorithm)
    fitting = own is not None and own.algorithm == full_name(algorithm)
    trials = tuple(t for t in (own.trials if own and fitting else ()) if name in t.values and not t.simulator)
    return Explanation(
        title=about.label,
        what=about.help,
        formula=about.symbol,
        effect=about.effect,
        facts=(("Possible", declaration.range_text), ("Default", default_text(declaration))),
        fails="",
        trials=trials,
        source=algorithm.source,
        lesson=own.name if own else "",
        simulator=own.simulator if own else "",
    )
