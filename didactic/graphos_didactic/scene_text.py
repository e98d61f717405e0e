"""Short texts with indices: ``σ_Z`` is written with a lowered Z."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from graphos_didactic.scene_drawing import Canvas

_INDEX = re.compile(r"(?<=\w)_(\w)\b")
SMALL, LOWERED = 0.74, 0.2
"""Size of an index and how far it is lowered, relative to the text."""


def html_text(text: str) -> str:
    """Return a text as HTML, escaped, with its indices lowered."""
    return _INDEX.sub(r"<sub>\1</sub>", escape(text, quote=False))


def label_width(canvas: Canvas, text: str, size: float, bold: bool = False) -> float:
    """Return the width of a text with indices, px."""
    return sum(
        canvas.text_width(part, size * (SMALL if i % 2 else 1.0), bold)
        for i, part in enumerate(_INDEX.split(text))
        if part
    )


def draw_label(
    canvas: Canvas, at: tuple[float, float], text: str, size: float, colour: str, bold: bool = False
) -> None:
    """Write a text with indices, its left end on the baseline at `at`."""
    x, y = at
    for i, part in enumerate(_INDEX.split(text)):
        if part:
            small = size * (SMALL if i % 2 else 1.0)
            canvas.text((x, y + (LOWERED * size if i % 2 else 0.0)), part, small, colour, bold=bold)
            x += canvas.text_width(part, small, bold)
