"""A sheet: a column of read-outs, formulas and sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from graphos_didactic.formula_outline import SIZE, formula_outline
from graphos_didactic.scene import Formula, Mark, Matrix, Number, Sentence
from graphos_didactic.scene_layout import Box, Frame
from graphos_didactic.scene_text import draw_label, label_width

if TYPE_CHECKING:
    from graphos_didactic.scene_drawing import Canvas, Look

THIN = "\u2009"


def number_text(mark: Number) -> str:
    """Return value, standard deviation and unit of a read-out: ``12.3 ± 0.4 mm``."""
    if not math.isfinite(mark.value):
        return "not determined"
    text = f"{mark.value:,.{mark.digits}f}"
    if mark.sigma is not None:
        text += f" ± {mark.sigma:,.{mark.digits}f}" if math.isfinite(mark.sigma) else " ± ∞"
    text = text.replace(",", THIN).replace("-", "−")
    return f"{text} {mark.unit}" if mark.unit else text


def draw_sheet(marks: Sequence[Mark], frame: Frame, canvas: Canvas, look: Look) -> None:
    """Draw the read-outs, formulas and sentences of a sheet from top to bottom, as large as the panel allows."""
    left, top, width, height = frame.plot
    needed = _draw_all(marks, (left, top, width, height), _Ruler(canvas), look)
    font = look.font * min(max(height / max(needed, 1.0), SMALLEST), LARGEST)
    for _ in range(2):  # larger letters wrap earlier: look again
        needed = _draw_all(marks, (left, top, width, height), _Ruler(canvas), replace(look, font=font))
        if needed > height:
            font *= max(height / needed, 0.8)
    canvas.clip(frame.outer)
    _draw_all(marks, (left, top, width, height), canvas, replace(look, font=font))
    canvas.unclip()


SMALLEST, LARGEST = 0.7, 1.25
"""Limits of the size of a sheet's letters, relative to the body font."""


def _draw_all(marks: Sequence[Mark], box: Box, canvas: Canvas, look: Look) -> float:
    """Draw all marks and return the height they take, px."""
    left, top, width, _ = box
    y = top + 0.2 * look.font
    for mark in marks:
        before = y
        match mark:
            case Number():
                y = _draw_number(mark, left, y, width, canvas, look)
            case Formula() if look.formulas:
                y = _draw_formula(mark, left, y, width, canvas, look)
            case Matrix():
                y = _draw_matrix(mark, left, y, width, canvas, look)
            case Sentence():
                y = _draw_sentence(mark, left, y, width, canvas, look)
            case _:
                pass
        if mark.thing and mark.thing == look.chosen:
            bar = np.array([[left - 0.5 * look.font, before], [left - 0.5 * look.font, y - 2]])
            canvas.polyline(bar, look.colours["selected"], 4 * look.unit, ())
    return y - top


class _Ruler:
    """A canvas that draws nothing and only measures texts."""

    def __init__(self, canvas: Canvas) -> None:
        self.text_width = canvas.text_width

    def __getattr__(self, name: str) -> Any:
        return _nothing


def _nothing(*_: object, **__: object) -> None:
    return None


def _draw_number(mark: Number, left: float, y: float, width: float, canvas: Canvas, look: Look) -> float:
    base = y + 1.15 * look.font
    colour, size, text = look.colours[mark.role], 0.92 * look.font, number_text(mark)
    draw_label(canvas, (left, base), mark.label, size, look.colours["text"])
    taken = label_width(canvas, mark.label, size) + canvas.text_width(text, look.font, True)
    if taken + look.font > width:  # no room beside the label
        base += 1.3 * look.font
    canvas.text((left + width, base), text, look.font, colour, "right", bold=True)
    return base + 0.5 * look.font


def _draw_formula(mark: Formula, left: float, y: float, width: float, canvas: Canvas, look: Look) -> float:
    outline = formula_outline(mark.tex)
    scale = 1.08 * look.font / SIZE
    if outline.width * scale > width:
        scale = width / outline.width
    base = y + 0.3 * look.font + outline.ascent * scale
    canvas.outline(outline, (left, base), scale, look.colours[mark.role])
    return base + outline.descent * scale + 0.6 * look.font


def _draw_matrix(mark: Matrix, left: float, y: float, width: float, canvas: Canvas, look: Look) -> float:
    size, step, colour = 0.92 * look.font, 1.45 * look.font, look.colours[mark.role]
    start = left + canvas.text_width(mark.label, look.font, True) + 0.9 * look.font
    columns = len(mark.rows[0])
    cell = min((left + width - start - look.font) / columns, 6.6 * look.font)
    top, bottom, middle = y + 0.2 * look.font, y + 0.3 * look.font + step * len(mark.rows), 0.0
    for i, row in enumerate(mark.rows):
        base = y + step * (i + 0.8) + 0.2 * look.font
        for j, entry in enumerate(row):
            canvas.text((start + cell * (j + 1), base), entry, size, colour, "right")
    middle = (top + bottom) / 2
    canvas.text((left, middle), mark.label, look.font, colour, "left", "middle", bold=True)
    hook = 0.4 * look.font
    for x, way in ((start, 1), (start + cell * columns + 0.5 * look.font, -1)):
        edge = np.array([[x + way * hook, top], [x, top], [x, bottom], [x + way * hook, bottom]])
        canvas.polyline(edge, colour, 1.4 * look.unit, ())
    return bottom + 0.5 * look.font


def _draw_sentence(mark: Sentence, left: float, y: float, width: float, canvas: Canvas, look: Look) -> float:
    size = look.font if mark.heading else 0.92 * look.font
    y += 0.35 * look.font if mark.heading else 0.0
    for line in wrap(mark.text, width, size, canvas, bold=mark.heading):
        y += 1.4 * size
        canvas.text((left, y - 0.25 * size), line, size, look.colours[mark.role], bold=mark.heading)
    return y + 0.3 * look.font


def wrap(text: str, width: float, size: float, canvas: Canvas, *, bold: bool = False) -> list[str]:
    """Break `text` into lines of at most `width` px."""
    lines: list[str] = []
    line = ""
    for word in text.split():
        longer = f"{line} {word}" if line else word
        if line and canvas.text_width(longer, size, bold) > width:
            lines.append(line)
            line = word
        else:
            line = longer
    return [*lines, line] if line else lines
