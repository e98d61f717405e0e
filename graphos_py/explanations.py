"""What the Explain panel says, as paragraphs made of an `Explanation` of the teaching floor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any, Literal

from graphos_core.registry import Algorithm
from graphos_py.translation import tr

if TYPE_CHECKING:
    from graphos_didactic.explain import Explanation

Kind = Literal["heading", "text", "group", "caption", "formula", "picture", "lesson", "simulator", "try"]


@dataclass(frozen=True)
class Paragraph:
    """One piece of an explanation; `text` is HTML except for formulas, lessons and "try"."""

    kind: Kind
    text: str = ""
    picture: Any = None
    values: Mapping[str, Any] = field(default_factory=dict)


def about_algorithm(algorithm: Algorithm) -> list[Paragraph]:
    """Explain an algorithm: what it does, formula, parameters, when it fails, what to try, source."""
    from graphos_didactic.explain import explain_algorithm

    found = explain_algorithm(algorithm)
    paragraphs = _opening(found)
    declarations = algorithm.params.declarations().values()
    if declarations:
        paragraphs.append(Paragraph("group", tr("Parameters")))
        items = "".join(
            f"<p><b>{escape(tr(d.about.label))}</b>: {escape(tr(d.about.help))}</p>" for d in declarations
        )
        paragraphs.append(Paragraph("text", items))
    return paragraphs + _ending(found)


def about_parameter(algorithm: Algorithm, name: str) -> list[Paragraph]:
    """Explain one parameter: what it is, its effect in both directions, range, default, what to try, source."""
    from graphos_didactic.explain import explain_parameter

    found = explain_parameter(algorithm, name)
    return [Paragraph("caption", escape(tr(algorithm.label))), *_opening(found), *_ending(found)]


def _opening(found: Explanation) -> list[Paragraph]:
    paragraphs = [Paragraph("heading", escape(tr(found.title)))]
    if found.what:
        paragraphs.append(Paragraph("text", escape(tr(found.what))))
    if found.formula:
        paragraphs.append(Paragraph("formula", found.formula))
    if found.effect:
        paragraphs.append(Paragraph("group", tr("Effect")))
        paragraphs.append(Paragraph("text", effect_html(tr(found.effect))))
    if found.facts:
        cells = "".join(
            f"<tr><td style='padding-right:12px'><b>{escape(tr(k))}</b></td><td>{escape(tr(v))}</td></tr>"
            for k, v in found.facts
        )
        paragraphs.append(Paragraph("text", f"<table>{cells}</table>"))
    return paragraphs


def _ending(found: Explanation) -> list[Paragraph]:
    paragraphs = []
    if found.fails:
        paragraphs += [
            Paragraph("group", tr("When it fails, and how one sees it")),
            Paragraph("text", escape(tr(found.fails))),
        ]
    paragraphs += [Paragraph("try", tr(trial.what), values=trial.values) for trial in found.trials]
    if found.lesson:
        paragraphs.append(Paragraph("lesson", found.lesson))
    if found.simulator:
        paragraphs.append(Paragraph("simulator", found.simulator))
    if found.source:
        paragraphs += [Paragraph("group", tr("Source")), Paragraph("caption", escape(tr(found.source)))]
    return paragraphs


def effect_html(effect: str) -> str:
    """Put an arrow before each direction of an effect: ``"Higher: …  Lower: …"``."""
    text = escape(effect)
    for word, arrow in ((tr("Higher"), "↑"), (tr("Larger"), "↑"), (tr("More"), "↑"), (tr("Lower"), "↓"),
                        (tr("Smaller"), "↓"), (tr("Fewer"), "↓")):  # fmt: skip
        text = text.replace(f"{word}:", f"<br>{arrow} <b>{word}</b>:")
    return text.removeprefix("<br>")
