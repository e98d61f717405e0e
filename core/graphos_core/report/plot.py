"""Plots as plain SVG: text stays text, every mark has a shape beside its colour, and any browser or Qt draws them.

Only presentation attributes of SVG Tiny are used, so that the printed page shows what the screen shows. Colours are
those of Okabe and Ito (2008), which people with a colour vision deficiency can tell apart.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from graphos_core.data import Array
from graphos_core.number_format import MINUS, group_thousands

INK, SOFT, GRID = "#1d2430", "#525a66", "#dfe3e9"
BLUE, ORANGE, GREEN, RED, SKY, GREY = "#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#8a93a0"
FONT = "Noto Sans, DejaVu Sans, Segoe UI, Helvetica, sans-serif"
SIZE = 13


@dataclass(frozen=True)
class Axis:
    """One axis: its interval, label with unit, and whether it has ticks."""

    low: float
    high: float
    label: str = ""
    ticks: bool = True


class Plot:
    """A frame with two axes on which marks are put.

    Parameters
    ----------
    x, y : Axis
    alt : str
        What the plot shows, for those who cannot see it.
    width, height : int
        In px of the page.
    downwards : bool
        y grows downwards, as in photos.
    margins : tuple of int
        Left, top (with room for the legend), right, bottom.
    """

    def __init__(
        self, x: Axis, y: Axis, alt: str, *, width: int = 720, height: int = 260, downwards: bool = False,
        margins: tuple[int, int, int, int] = (74, 30, 16, 46),
    ) -> None:  # fmt: skip
        self.x, self.y, self.alt = x, y, alt
        self.width, self.height, self.downwards, self.margins = width, height, downwards, margins
        self._marks: list[str] = []
        self._legend: list[tuple[str, str]] = []

    def px(self, values: Array | Sequence[float] | float) -> Array:
        """Return the horizontal position on the page."""
        left, _, right, _ = self.margins
        share = (np.asarray(values, dtype=np.float64) - self.x.low) / ((self.x.high - self.x.low) or 1.0)
        return np.asarray(left + share * (self.width - left - right))

    def py(self, values: Array | Sequence[float] | float) -> Array:
        """Return the vertical position on the page."""
        _, top, _, bottom = self.margins
        share = (np.asarray(values, dtype=np.float64) - self.y.low) / ((self.y.high - self.y.low) or 1.0)
        share = share if self.downwards else 1.0 - share
        return np.asarray(top + share * (self.height - top - bottom))

    def bars(
        self, edges: Array, counts: Array, label: str = "", colour: str = BLUE, opacity: float = 0.75
    ) -> None:
        """Put bars from zero between `edges` (k + 1) of height `counts` (k)."""
        xs, tops, base = self.px(edges), self.py(counts), float(self.py(0.0))
        for i, top in enumerate(tops):
            if counts[i] > 0:
                self._marks.append(
                    f'<rect x="{xs[i]:.1f}" y="{top:.1f}" width="{max(xs[i + 1] - xs[i] - 0.6, 0.6):.1f}" '
                    f'height="{max(base - top, 0.5):.1f}" fill="{colour}" fill-opacity="{opacity}"/>'
                )
        if label:
            self._legend.append((_swatch(colour, opacity), label))

    def line(
        self, xs: Array, ys: Array, label: str = "", colour: str = INK, dash: str = "", weight: float = 1.5
    ) -> None:
        """Put a polyline; points that are not finite interrupt it."""
        style = f'fill="none" stroke="{colour}" stroke-width="{weight}"' + (
            f' stroke-dasharray="{dash}"' if dash else ""
        )
        px, py = self.px(xs), np.clip(self.py(ys), -1e4, 1e4)
        good = np.isfinite(px) & np.isfinite(py)
        for run in np.split(np.arange(len(px)), np.flatnonzero(np.diff(good.astype(int))) + 1):
            if len(run) > 1 and good[run[0]]:
                path = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(px[run], py[run], strict=True))
                self._marks.append(f'<polyline points="{path}" {style}/>')
        if label:
            self._legend.append((f'<line x1="0" y1="0" x2="22" y2="0" {style}/>', label))

    def band(self, xs: Array, low: Array, high: Array, label: str = "", colour: str = BLUE) -> None:
        """Put a filled band between two curves."""
        good = np.isfinite(low) & np.isfinite(high)
        px = self.px(np.asarray(xs)[good])
        upper, lower = self.py(np.asarray(high)[good]), self.py(np.asarray(low)[good])
        path = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(px, upper, strict=True))
        back = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(px[::-1], lower[::-1], strict=True))
        self._marks.append(f'<polygon points="{path} {back}" fill="{colour}" fill-opacity="0.22"/>')
        if label:
            self._legend.append((_swatch(colour, 0.22), label))

    def dots(self, xs: Array, ys: Array, label: str = "", colour: str = BLUE, radius: float = 2.0) -> None:
        """Put one disc per point."""
        for a, b in zip(self.px(xs), self.py(ys), strict=True):
            self._marks.append(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{radius}" fill="{colour}"/>')
        if label:
            self._legend.append((f'<circle cx="11" cy="0" r="{radius + 1}" fill="{colour}"/>', label))

    def arrows(
        self, xs: Array, ys: Array, dx: Array, dy: Array, colour: str = BLUE, weight: float = 1.0
    ) -> None:
        """Put vectors from a dot at (x, y); `dx`, `dy` in the units of the axes."""
        if not len(xs):
            return
        ax, ay, bx, by = self.px(xs), self.py(ys), self.px(xs + dx), self.py(ys + dy)
        path = "".join(f"M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}" for a, b, c, d in zip(ax, ay, bx, by, strict=True))
        self._marks.append(f'<path d="{path}" stroke="{colour}" stroke-width="{weight}" fill="none"/>')
        tails = "".join(f"M{a - 0.9:.1f} {b - 0.9:.1f}h1.8v1.8h-1.8z" for a, b in zip(ax, ay, strict=True))
        self._marks.append(f'<path d="{tails}" fill="{INK}"/>')

    def cells(
        self, x_edges: Array, y_edges: Array, colours: Array, texts: Sequence[Sequence[str]] = ()
    ) -> None:
        """Put a grid of coloured cells, uint8 (rows, columns, 3), each with its text."""
        xs, ys = self.px(x_edges), self.py(y_edges)
        for i in range(len(ys) - 1):
            for j in range(len(xs) - 1):
                left, top = xs[j], min(ys[i], ys[i + 1])
                wide, high = abs(xs[j + 1] - xs[j]), abs(ys[i + 1] - ys[i])
                red, green, blue = (int(c) for c in colours[i, j])
                self._marks.append(
                    f'<rect x="{left:.1f}" y="{top:.1f}" width="{wide + 0.3:.1f}" height="{high + 0.3:.1f}" '
                    f'fill="#{red:02x}{green:02x}{blue:02x}"/>'
                )
                if texts:
                    light = 0.299 * red + 0.587 * green + 0.114 * blue
                    self._marks.append(
                        _text(left + wide / 2, top + high / 2 + 4, texts[i][j], "middle", 11,
                              INK if light > 120 else "#ffffff")
                    )  # fmt: skip

    def mark_x(self, value: float, label: str, colour: str = RED) -> None:
        """Put a vertical dashed line with its label in the legend."""
        a, top, bottom = float(self.px(value)), self.margins[1], self.height - self.margins[3]
        style = f'stroke="{colour}" stroke-width="1.5" stroke-dasharray="5 3"'
        self._marks.append(f'<line x1="{a:.1f}" y1="{top}" x2="{a:.1f}" y2="{bottom}" {style}/>')
        if label:
            self._legend.append((f'<line x1="0" y1="0" x2="22" y2="0" {style}/>', label))

    def text(self, x: float, y: float, text: str, anchor: str = "start") -> None:
        """Put text at a place of the axes."""
        self._marks.append(_text(float(self.px(x)), float(self.py(y)), text, anchor, SIZE - 1, INK))

    def svg(self) -> str:
        """Return the markup of the plot."""
        parts = [*self._axes(), *self._marks, *self._frame(), *self._legend_marks()]
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
            f'viewBox="0 0 {self.width} {self.height}" role="img" aria-label="{escape(self.alt)}">'
            f"<title>{escape(self.alt)}</title>{''.join(parts)}</svg>"
        )

    def _axes(self) -> list[str]:
        left, top, right, bottom = self.margins
        base, end, parts = self.height - bottom, self.width - right, []
        if self.x.ticks:
            values = nice_ticks(self.x.low, self.x.high, max(4, (end - left) // 64))
            for value, label in zip(values, tick_labels(values), strict=True):
                a = float(self.px(value))
                parts.append(f'<line x1="{a:.1f}" y1="{top}" x2="{a:.1f}" y2="{base}" stroke="{GRID}"/>')
                parts.append(_text(a, base + 17, label, "middle"))
        if self.y.ticks:
            values = nice_ticks(self.y.low, self.y.high, max(4, (base - top) // 40))
            for value, label in zip(values, tick_labels(values), strict=True):
                b = float(self.py(value))
                parts.append(f'<line x1="{left}" y1="{b:.1f}" x2="{end}" y2="{b:.1f}" stroke="{GRID}"/>')
                parts.append(_text(left - 7, b + 4, label, "end"))
        if self.x.label:
            parts.append(_text((left + end) / 2, self.height - 8, self.x.label, "middle", SIZE, INK))
        if self.y.label:
            middle = (top + base) / 2
            parts.append(
                f'<g transform="translate(15 {middle:.1f}) rotate(-90)">'
                f"{_text(0, 0, self.y.label, 'middle', SIZE, INK)}</g>"
            )
        return parts

    def _frame(self) -> list[str]:
        left, top, right, bottom = self.margins
        base, end = self.height - bottom, self.width - right
        if not (self.x.ticks or self.y.ticks):
            return [f'<rect x="{left}" y="{top}" width="{end - left}" height="{base - top}" fill="none" '
                    f'stroke="{GREY}"/>']  # fmt: skip
        return [f'<path d="M{left} {top}V{base}H{end}" fill="none" stroke="{SOFT}"/>']

    def _legend_marks(self) -> list[str]:
        """Return the legend: one line above the frame, from left to right."""
        parts, x, y = [], float(self.margins[0]), 16
        for mark, label in self._legend:
            parts.append(f'<g transform="translate({x:.1f} {y - 4})">{mark}</g>')
            parts.append(_text(x + 28, y, label, "start", SIZE - 1, INK))
            x += 48 + 6.7 * len(label)
        return parts


def fitted(wide: float, high: float, width: int, height: int) -> tuple[int, int]:
    """Return the largest size (width, height) with the shape wide : high that fits into a box, px."""
    scale = min(width / wide, height / high)
    return max(1, round(scale * wide)), max(1, round(scale * high))


def nice_ticks(low: float, high: float, most: int) -> Array:
    """Return about `most` values from `low` to `high` with a step of 1, 2 or 5 times a power of ten."""
    span = high - low
    if not (math.isfinite(span) and span > 0):
        return np.array([low])
    raw = span / max(most, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = min((f * power for f in (1.0, 2.0, 5.0, 10.0)), key=lambda s: abs(math.log(s / raw)))
    return np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1) * step


def tick_labels(values: Array) -> list[str]:
    """Return the labels of ticks, all with the same decimals."""
    if len(values) < 2:
        return [f"{v:g}".replace("-", MINUS) for v in values]
    step, largest = float(values[1] - values[0]), float(np.abs(values).max())
    if largest < 1e-3 or largest >= 1e6:
        return ["0" if abs(v) < step / 2 else f"{v:.3g}".replace("-", MINUS) for v in values]
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return [group_thousands(f"{0.0 if abs(v) < step / 2 else v:.{decimals}f}") for v in values]


def _swatch(colour: str, opacity: float) -> str:
    return f'<rect x="3" y="-6" width="16" height="11" fill="{colour}" fill-opacity="{opacity}"/>'


def _text(x: float, y: float, text: str, anchor: str, size: int = SIZE - 1, colour: str = SOFT) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-family="{FONT}" font-size="{size}" text-anchor="{anchor}" '
        f'fill="{colour}">{escape(text)}</text>'
    )
