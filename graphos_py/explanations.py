"""What the Explain panel says, as paragraphs; generated from declarations, enriched by `graphos_didactic.explain`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from typing import Any, Literal

from graphos_core.params import Declaration
from graphos_core.registry import Algorithm
from graphos_py.form import default_text
from graphos_py.translation import tr

Kind = Literal["heading", "text", "group", "caption", "formula", "picture", "lesson", "try"]


@dataclass(frozen=True)
class Paragraph:
    """One piece of an explanation; `text` is HTML except for formulas, lessons and "try"."""

    kind: Kind
    text: str = ""
    picture: Any = None
    values: Mapping[str, Any] = field(default_factory=dict)


def about_algorithm(algorithm: Algorithm) -> list[Paragraph]:
    """Explain an algorithm: what it does, its parameters, its source."""
    paragraphs = [
        Paragraph("heading", escape(tr(algorithm.label))),
        Paragraph("text", escape(tr(algorithm.summary))),
    ]
    for declaration in algorithm.params.declarations().values():
        about = declaration.about
        paragraphs.append(Paragraph("group", escape(tr(about.label))))
        paragraphs.append(Paragraph("text", escape(tr(about.help))))
    return paragraphs + _source(algorithm)


def about_parameter(algorithm: Algorithm, name: str) -> list[Paragraph]:
    """Explain one parameter: what it is, its effect in both directions, range, default, source."""
    declaration = algorithm.params.declarations()[name]
    about = declaration.about
    paragraphs = [
        Paragraph("caption", escape(tr(algorithm.label))),
        Paragraph("heading", escape(tr(about.label))),
        Paragraph("text", escape(tr(about.help))),
    ]
    if about.symbol:
        paragraphs.insert(2, Paragraph("formula", about.symbol))
    if about.effect:
        paragraphs.append(Paragraph("group", tr("Effect")))
        paragraphs.append(Paragraph("text", escape(tr(about.effect))))
    paragraphs.append(Paragraph("text", _facts(declaration)))
    lesson = about.learn or algorithm.learn
    return paragraphs + _source(algorithm, lesson)


def _facts(declaration: Declaration) -> str:
    rows = [(tr("Possible"), declaration.range_text), (tr("Default"), default_text(declaration))]
    cells = "".join(
        f"<tr><td style='padding-right:12px'><b>{escape(name)}</b></td><td>{escape(value)}</td></tr>"
        for name, value in rows
    )
    return f"<table>{cells}</table>"


def _source(algorithm: Algorithm, lesson: str = "") -> list[Paragraph]:
    paragraphs = [Paragraph("group", tr("Source")), Paragraph("caption", escape(algorithm.source))]
    lesson = lesson or algorithm.learn
    return [*paragraphs, Paragraph("lesson", lesson)] if lesson else paragraphs
