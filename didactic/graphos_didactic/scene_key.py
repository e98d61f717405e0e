"""The key of a panel: what its labelled lines, polygons and bars mean, with the dash of each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from graphos_didactic.scene import Bars, Line, Mark, Polygon
from graphos_didactic.scene_layout import Frame, corners
from graphos_didactic.scene_text import draw_label, label_width

if TYPE_CHECKING:
    from graphos_didactic.scene_drawing import Canvas, Look


def draw_key(marks: Sequence[Mark], frame: Frame, canvas: Canvas, look: Look) -> None:
    """Draw the key of labelled lines, polygons and bars, with the dash of each: not by colour alone."""
    corner = frame.panel.legend
    rows = [m for m in marks if m.label and isinstance(m, (Line, Polygon, Bars))]
    if not corner or not rows:
        return
    size, step, sample = 0.85 * look.font, 1.45 * look.font, 2.2 * look.font
    if corner == "above":
        _draw_key_above(rows, frame, canvas, look, size, step, sample)
        return
    width = sample + 1.5 * look.font + max(label_width(canvas, m.label, size) for m in rows)
    height = step * len(rows) + 0.5 * look.font
    left, top, plot_width, plot_height = frame.plot
    edge = 0.4 * look.font
    x = left + plot_width - width - edge if corner.endswith("right") else left + edge
    y = top + edge if corner.startswith("top") else top + plot_height - height - edge
    canvas.polygon(corners((x, y, width, height)), look.colours["surface"], 0.88, look.colours["border"], 1.0)
    for i, mark in enumerate(rows):
        middle = y + 0.25 * look.font + step * (i + 0.5)
        _draw_sample(mark, (x + 0.5 * look.font, middle), canvas, look, size, sample)


def _draw_key_above(
    rows: Sequence[Line | Polygon | Bars],
    frame: Frame,
    canvas: Canvas,
    look: Look,
    size: float,
    step: float,
    sample: float,
) -> None:
    """Draw the key in two columns between the title and the plot."""
    left, top, width, _ = frame.plot
    for i, mark in enumerate(rows):
        at = (left + (i % 2) * width / 2, top - step * (2 - i // 2 - 0.4))
        _draw_sample(mark, at, canvas, look, size, sample)


def _draw_sample(
    mark: Line | Polygon | Bars,
    at: tuple[float, float],
    canvas: Canvas,
    look: Look,
    size: float,
    sample: float,
) -> None:
    middle = at[1]
    ends = np.array([[at[0], middle], [at[0] + sample, middle]])
    colour = look.colours[mark.role]
    if isinstance(mark, Bars) or (isinstance(mark, Polygon) and mark.fill >= 0.3):
        half = 0.4 * look.font
        canvas.polygon(corners((ends[0, 0], middle - half, sample, 2 * half)), colour, mark.fill)
    if not isinstance(mark, Bars):
        dash = look.dashes(mark.dash)
        canvas.polyline(ends, colour, mark.width * look.unit, dash)
    at = (ends[1, 0] + 0.5 * look.font, middle + 0.35 * size)
    draw_label(canvas, at, mark.label, size, look.colours["text"])
