"""Where a panel's coordinates lie on the screen, and where its axes have ticks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from graphos_core.data.record import Array
from graphos_didactic.scene import Panel, Point

Box = tuple[float, float, float, float]
"""Left, top, width, height in px of the canvas."""


@dataclass(frozen=True)
class Frame:
    """A panel on a canvas.

    Attributes
    ----------
    panel : Panel
    outer, plot : Box
        The whole panel with its title; the part that carries coordinates.
    scale : tuple of float
        px of the canvas per unit of the panel, in x and y; y is negative where it grows upwards.
    origin : tuple of float
        Canvas position of the panel's (0, 0).
    """

    panel: Panel
    outer: Box
    plot: Box
    scale: Point
    origin: Point

    def to_canvas(self, xy: Array) -> Array:
        """Return canvas positions (n, 2) of panel coordinates (n, 2)."""
        return np.asarray(xy, dtype=np.float64) * self.scale + self.origin

    def to_panel(self, x: float, y: float) -> Point:
        """Return panel coordinates of a canvas position."""
        return (x - self.origin[0]) / self.scale[0], (y - self.origin[1]) / self.scale[1]

    def contains(self, x: float, y: float) -> bool:
        """Whether a canvas position lies in the plot."""
        left, top, width, height = self.plot
        return left <= x <= left + width and top <= y <= top + height

    @property
    def shown(self) -> tuple[Point, Point]:
        """The coordinates that are visible, which an equal scale can make more than the panel asked for."""
        left, top, width, height = self.plot
        a, b = self.to_panel(left, top), self.to_panel(left + width, top + height)
        return (min(a[0], b[0]), max(a[0], b[0])), (min(a[1], b[1]), max(a[1], b[1]))


def place(panel: Panel, width: float, height: float, font: float) -> Frame:
    """Return where `panel` lies on a canvas of `width` × `height` px with a body font of `font` px."""
    gap = round(0.4 * font)
    left, top = panel.rect[0] * width + gap, panel.rect[1] * height + gap
    outer = (left, top, panel.rect[2] * width - 2 * gap, panel.rect[3] * height - 2 * gap)
    head = (2.1 if panel.title else 0.6) * font + (2.9 * font if panel.legend == "above" else 0.0)
    edges = {"plot": (3.9, 0.9, 3.2), "picture": (0.5, 0.5, 0.5), "sheet": (0.9, 0.9, 0.5)}[panel.kind]
    before, after, foot = (edge * font for edge in edges)
    if panel.kind == "plot" and not panel.y_label:
        before = 0.9 * font
    plot = (left + before, top + head, max(outer[2] - before - after, 8.0), max(outer[3] - head - foot, 8.0))
    (x0, x1), (y0, y1) = panel.x_range, panel.y_range
    sx, sy = plot[2] / (x1 - x0), plot[3] / (y1 - y0)
    if panel.equal:
        sx = sy = min(sx, sy)
    if panel.kind == "picture":  # shrink to what is shown, so that the frame hugs the photo
        w, h = (x1 - x0) * sx, (y1 - y0) * sy
        plot = (plot[0] + (plot[2] - w) / 2, plot[1] + (plot[3] - h) / 2, w, h)
    sy = sy if panel.y_down else -sy
    origin = (plot[0] + plot[2] / 2 - sx * (x0 + x1) / 2, plot[1] + plot[3] / 2 - sy * (y0 + y1) / 2)
    return Frame(panel, outer, plot, (sx, sy), origin)


def ticks(low: float, high: float, most: int) -> list[float]:
    """Return at most `most` round numbers from `low` to `high`."""
    span = high - low
    if not (span > 0 and math.isfinite(span)) or most < 2:
        return []
    raw = span / most
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * m for m in (1, 2, 5, 10) if power * m >= raw * (1 - 1e-9))
    first = math.ceil(low / step - 1e-9)
    return [round(i * step, 12) for i in range(first, math.floor(high / step + 1e-9) + 1)]


def clipped(xy: Array, box: Box) -> Array:
    """Return a polyline (n, 2) cut to `box` (Liang and Barsky 1984), parts separated by a row of NaN.

    Dashes of a line that goes on for miles outside the panel would take a painter seconds.
    """
    left, top, width, height = box
    inside = (xy >= (left, top)) & (xy <= (left + width, top + height)) | np.isnan(xy)
    if len(xy) < 2 or inside.all():
        return xy
    start, along = xy[:-1], np.diff(xy, axis=0)
    low, high = np.zeros(len(along)), np.ones(len(along))
    with np.errstate(divide="ignore", invalid="ignore"):
        for axis, (near, far) in enumerate(((left, left + width), (top, top + height))):
            a, b = (near - start[:, axis]) / along[:, axis], (far - start[:, axis]) / along[:, axis]
            still = along[:, axis] == 0
            out = still & ((start[:, axis] < near) | (start[:, axis] > far))
            low = np.where(still, np.where(out, 2.0, low), np.maximum(low, np.minimum(a, b)))
            high = np.where(still, high, np.minimum(high, np.maximum(a, b)))
    keep = (low < high) & np.isfinite(along).all(axis=1)
    start, along = start[keep], along[keep]
    first, last = start + low[keep, None] * along, start + high[keep, None] * along
    fresh = np.ones(len(start), bool)  # a piece that does not go on where the one before it ended
    fresh[1:] = (first[1:] != last[:-1]).any(axis=1)
    pieces = np.stack([np.full_like(first, np.nan), first, last], axis=1)
    return np.asarray(pieces[np.stack([fresh, fresh, np.ones_like(fresh)], axis=1)][1:]).reshape(-1, 2)


def corners(box: Box) -> Array:
    """Return the corners (4, 2) of a box, clockwise from the top left."""
    left, top, width, height = box
    return np.array([[left, top], [left + width, top], [left + width, top + height], [left, top + height]])
