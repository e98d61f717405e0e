"""What a report page is made of, and the page itself: sections of text, tables and pictures, one template for all.

The same page is read in the browser and printed by Qt, whose text engine knows tables, headings and paragraphs but
neither grids nor ``figure``; the template keeps to what both know.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import jinja2

from graphos_core.report.explanations import Explanation, explanations


@dataclass(frozen=True)
class Paragraph:
    """A paragraph; `soft` for definitions and notes, `strong` for a verdict; of the kind ``"code"`` as it is written."""

    text: str
    soft: bool = False
    strong: bool = False
    kind: str = "paragraph"


@dataclass(frozen=True)
class Table:
    """A table of finished texts.

    Attributes
    ----------
    heads : sequence of str
        Column headings; empty strings only for a table of labels and values, which has no head row.
    rows : sequence of sequence of str
    left : int
        So many columns from the left are texts, the others numbers, right-aligned.
    last_text : bool
        The last column is a text too, such as a definition.
    title, note : str
        Heading above, and definitions below.
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    left: int = 1
    title: str = ""
    note: str = ""
    last_text: bool = False
    kind: str = "table"

    def is_text(self, column: int) -> bool:
        """Say whether a column holds texts."""
        return column < self.left or (self.last_text and column == len(self.heads) - 1)


@dataclass(frozen=True)
class Picture:
    """A picture: ``svg`` markup or the data URL of an ``image``, with what a reader who cannot see it is told."""

    alt: str
    svg: str = ""
    image: str = ""
    caption: str = ""
    kind: str = "picture"


@dataclass(frozen=True)
class Pictures:
    """Small pictures side by side, so many in a row."""

    pictures: Sequence[Picture]
    per_row: int = 3
    caption: str = ""
    kind: str = "pictures"


Part = Paragraph | Table | Picture | Pictures


@dataclass(frozen=True)
class Section:
    """A section with its anchor, the lesson that explains it (or empty), and its parts."""

    anchor: str
    title: str
    learn: str
    parts: Sequence[Part]


@dataclass(frozen=True)
class Problem:
    """A line of the box on top: severity in words, the sentences, and the lesson (or empty)."""

    severity: str
    text: str
    todo: str = ""
    learn: str = ""


@dataclass(frozen=True)
class Page:
    """A whole page.

    Attributes
    ----------
    title, subtitle : str
    problems : sequence of Problem
        Shown first.
    tiles : sequence of (str, str)
        The figures that sum it up: value and label.
    sections : sequence of Section
    no_problem : str
        What the box says where there is none.
    """

    title: str
    subtitle: str
    problems: Sequence[Problem]
    tiles: Sequence[tuple[str, str]]
    sections: Sequence[Section]
    no_problem: str = "No problem was found."

    def html(self) -> str:
        """Return the page as self-contained HTML; every text is escaped."""
        folder = resources.files("graphos_resources").joinpath("report")
        environment = jinja2.Environment(
            autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
        )
        template = environment.from_string(folder.joinpath("report.html.j2").read_text("utf-8"))
        return template.render(
            page=self, style=folder.joinpath("screen.css").read_text("utf-8"), lessons=self._lessons()
        )

    def _lessons(self) -> dict[str, Explanation]:
        keys = [s.learn for s in self.sections] + [p.learn for p in self.problems]
        return explanations(dict.fromkeys(k for k in keys if k))


def rows_of(figures: Sequence[tuple[str, Any]]) -> tuple[tuple[str, str], ...]:
    """Return rows of a table of labels and values, without those that have no value."""
    return tuple((label, str(value)) for label, value in figures if value not in (None, "", "–"))
