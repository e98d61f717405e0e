"""The one way a scene is drawn, on whatever canvas: the window's painter and the SVG writer implement `Canvas`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, Protocol

import numpy as np

from graphos_core.data.record import Array
from graphos_didactic.formula_outline import Outline
from graphos_didactic.scene import (
    Bars,
    Dash,
    Line,
    Mark,
    Marker,
    Picture,
    Points,
    Polygon,
    Scene,
    Words,
)
from graphos_didactic.scene_colours import PALETTES, Theme
from graphos_didactic.scene_layout import Box, Frame, clipped, corners, place, ticks

Horizontal = Literal["left", "centre", "right"]
Vertical = Literal["top", "middle", "baseline"]

DASHES: Mapping[Dash, tuple[float, ...]] = {
    "solid": (), "dash": (7.0, 4.0), "dot": (1.6, 3.2), "dashdot": (8.0, 3.0, 1.6, 3.0),
}  # fmt: skip
"""Lengths of dashes and gaps in px at 100 % font scale."""


class Canvas(Protocol):
    """What a canvas can do; all positions in px, colours as ``#rrggbb``."""

    def polyline(self, xy: Array, colour: str, width: float, dash: tuple[float, ...]) -> None: ...

    def polygon(
        self,
        xy: Array,
        fill: str,
        opacity: float,
        colour: str = "",
        width: float = 0.0,
        dash: tuple[float, ...] = (),
    ) -> None: ...

    def discs(self, xy: Array, radius: float, fill: str, colour: str, width: float) -> None: ...

    def text(
        self,
        at: tuple[float, float],
        text: str,
        size: float,
        colour: str,
        horizontal: Horizontal = "left",
        vertical: Vertical = "baseline",
        bold: bool = False,
        upright: bool = True,
    ) -> None: ...

    def text_width(self, text: str, size: float, bold: bool = False) -> float: ...

    def outline(self, outline: Outline, at: tuple[float, float], scale: float, colour: str) -> None: ...

    def picture(self, pixels: Array, box: Box) -> None: ...

    def clip(self, box: Box) -> None: ...

    def unclip(self) -> None: ...


@dataclass(frozen=True)
class Look:
    """How a scene is shown: not what it says.

    Attributes
    ----------
    theme : {"light", "dark"}
    font : float
        Body font in px; everything else follows it.
    truth, answers : bool
        Whether the truth and the answers are shown.
    chosen : str
        Thing that is marked in every panel, or empty.
    active : str
        Handle that has the keyboard, or empty.
    handles : bool
        Whether handles are drawn; not in print.
    formulas : bool
        Whether formulas are drawn; not while the typesetter is still being loaded.
    """

    theme: Theme = "light"
    font: float = 13.0
    truth: bool = True
    answers: bool = True
    chosen: str = ""
    active: str = ""
    handles: bool = True
    formulas: bool = True
    colours: Mapping[str, str] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "colours", PALETTES[self.theme])

    @property
    def unit(self) -> float:
        """Px for a length of 1 px at 100 % font scale."""
        return self.font / 13.0

    def dashes(self, dash: Dash) -> tuple[float, ...]:
        """Lengths of the dashes and gaps of a kind of line, px."""
        return tuple(self.unit * part for part in DASHES[dash])


def frames(scene: Scene, width: float, height: float, font: float) -> dict[str, Frame]:
    """Return where each panel lies on a canvas of `width` × `height` px."""
    return {panel.name: place(panel, width, height, font) for panel in scene.panels}


def draw(scene: Scene, canvas: Canvas, width: float, height: float, look: Look) -> None:
    """Draw `scene` on `canvas` of `width` × `height` px."""
    from graphos_didactic.scene_handles import draw_handles
    from graphos_didactic.scene_key import draw_key
    from graphos_didactic.scene_sheet import draw_sheet

    canvas.polygon(corners((0, 0, width, height)), look.colours["background"], 1.0)
    where = frames(scene, width, height, look.font)
    marks = scene.visible(truth=look.truth, answers=look.answers)
    for panel in scene.panels:
        frame = where[panel.name]
        mine = [mark for mark in marks if mark.panel == panel.name]
        canvas.polygon(corners(frame.outer), look.colours["surface"], 1.0, look.colours["border"], 1.0)
        if panel.title:
            at = (frame.outer[0] + 0.9 * look.font, frame.outer[1] + 1.45 * look.font)
            title = _shortened(panel.title, frame.outer[2] - 1.8 * look.font, canvas, look)
            canvas.text(at, title, look.font, look.colours["text"], bold=True)
        if panel.kind == "sheet":
            draw_sheet(mine, frame, canvas, look)
            continue
        if panel.kind == "plot":
            _draw_axes(frame, canvas, look)
        else:
            canvas.polygon(corners(frame.plot), look.colours["surface"], 1.0, look.colours["border"], 1.0)
        canvas.clip(frame.plot)
        photo = any(isinstance(mark, Picture) for mark in mine)
        for mark in mine:
            if photo:
                _draw_halo(mark, frame, canvas, look)
            _draw_mark(mark, frame, canvas, look)
        canvas.unclip()
        draw_key(mine, frame, canvas, look)
    if look.handles:
        draw_handles(scene, where, canvas, look)


def _shortened(text: str, width: float, canvas: Canvas, look: Look) -> str:
    if canvas.text_width(text, look.font, True) <= width:
        return text
    while text and canvas.text_width(text + "…", look.font, True) > width:
        text = text[:-1]
    return text.rstrip() + "…"


def _draw_axes(frame: Frame, canvas: Canvas, look: Look) -> None:
    left, top, width, height = frame.plot
    (x0, x1), (y0, y1) = frame.shown
    grid, muted, small = look.colours["grid"], look.colours["muted"], 0.85 * look.font
    x_ticks = ticks(x0, x1, int(width / (5 * look.font)) + 1)
    y_ticks = ticks(y0, y1, int(height / (3.2 * look.font)) + 1) if frame.panel.y_label else []
    for value in x_ticks:
        x = float(frame.to_canvas(np.array([[value, 0.0]]))[0, 0])
        canvas.polyline(np.array([[x, top], [x, top + height]]), grid, 1.0, ())
        at = (x, top + height + 1.15 * look.font)
        canvas.text(at, _tick_text(value), small, muted, "centre")
    for value in y_ticks:
        y = float(frame.to_canvas(np.array([[0.0, value]]))[0, 1])
        canvas.polyline(np.array([[left, y], [left + width, y]]), grid, 1.0, ())
        canvas.text((left - 0.4 * look.font, y), _tick_text(value), small, muted, "right", "middle")
    canvas.polyline(corners(frame.plot)[[0, 3, 2]], look.colours["border"], 1.0, ())
    at = (left + width / 2, top + height + 2.45 * look.font)
    canvas.text(at, frame.panel.x_label, small, muted, "centre")
    if frame.panel.y_label:
        at = (frame.outer[0] + 1.15 * look.font, top + height / 2)
        canvas.text(at, frame.panel.y_label, small, muted, "centre", upright=False)


def _tick_text(value: float) -> str:
    return f"{value:g}".replace("-", "−")


def _draw_mark(mark: Mark, frame: Frame, canvas: Canvas, look: Look) -> None:
    colour = look.colours[mark.role]
    if mark.thing and mark.thing == look.chosen:
        _draw_glow(mark, frame, canvas, look)
    match mark:
        case Picture():
            corners = frame.to_canvas(np.array(mark.extent).reshape(2, 2))
            (left, top), (right, bottom) = corners.min(axis=0), corners.max(axis=0)
            canvas.picture(mark.pixels, (left, top, right - left, bottom - top))
        case Polygon():
            dash = look.dashes(mark.dash)
            outline = frame.to_canvas(mark.xy)
            canvas.polygon(outline, colour, mark.fill, colour, mark.width * look.unit, dash)
        case Line():
            _draw_line(mark, frame, canvas, look, colour)
        case Bars():
            steps = np.repeat(np.asarray(mark.edges, dtype=float), 2)
            tops = np.concatenate([[0.0], np.repeat(np.asarray(mark.heights, dtype=float), 2), [0.0]])
            canvas.polygon(frame.to_canvas(np.stack([steps, tops], axis=1)), colour, mark.fill)
        case Points():
            _draw_points(mark, frame, canvas, look, colour)
        case Words():
            _draw_words(mark, frame, canvas, look, colour)
        case _:
            pass


def _draw_halo(mark: Mark, frame: Frame, canvas: Canvas, look: Look) -> None:
    """Put a light (or dark) edge under lines, so that they stand out from any photo."""
    if isinstance(mark, (Line, Polygon)) and mark.width > 1.0:
        xy = frame.to_canvas(mark.xy)
        xy = np.concatenate([xy, xy[:1]]) if isinstance(mark, Polygon) else xy
        wide = (mark.width + 1.8) * look.unit
        canvas.polyline(clipped(xy, frame.outer), look.colours["surface"], wide, ())


def _draw_glow(mark: Mark, frame: Frame, canvas: Canvas, look: Look) -> None:
    """Mark the chosen thing: a wide line or ring behind it, so that shape changes and not only colour."""
    colour, wide = look.colours["selected"], 6.0 * look.unit
    match mark:
        case Line():
            canvas.polyline(clipped(frame.to_canvas(mark.xy), frame.plot), colour, wide + mark.width, ())
        case Polygon():
            canvas.polygon(frame.to_canvas(mark.xy), colour, 0.25, colour, wide)
        case Points():
            canvas.discs(frame.to_canvas(mark.xy), (mark.size / 2 + 5) * look.unit, "", colour, wide / 2)
        case _:
            pass


def _draw_line(mark: Line, frame: Frame, canvas: Canvas, look: Look, colour: str) -> None:
    xy = frame.to_canvas(mark.xy)
    dash = look.dashes(mark.dash)
    canvas.polyline(clipped(xy, frame.plot), colour, mark.width * look.unit, dash)
    if mark.arrow and len(xy) > 1:
        ahead = xy[-1] - xy[-2]
        length = float(np.hypot(*ahead))
        if length > 1e-9:
            ahead = ahead / length * 9 * look.unit
            aside = np.array([-ahead[1], ahead[0]]) * 0.42
            canvas.polygon(np.array([xy[-1], xy[-1] - ahead + aside, xy[-1] - ahead - aside]), colour, 1.0)


_SHAPES: Mapping[str, Array] = {
    "square": np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.9,
    "triangle": np.array([[0, -1.15], [1.1, 0.85], [-1.1, 0.85]]),
    "diamond": np.array([[0, -1.2], [1.2, 0], [0, 1.2], [-1.2, 0]]),
}


def draw_marker(canvas: Canvas, xy: Array, marker: Marker, radius: float, colour: str, look: Look) -> None:
    """Draw one marker at every canvas position (n, 2)."""
    halo = look.colours["surface"]
    if marker == "circle":
        canvas.discs(xy, radius, colour, halo, look.unit if radius > 3 * look.unit else 0.0)
    elif marker == "ring":
        canvas.discs(xy, radius, "", colour, 1.8 * look.unit)
    elif marker in _SHAPES:
        for place_ in xy:
            canvas.polygon(place_ + _SHAPES[marker] * radius, colour, 1.0, halo, look.unit)
    else:
        arms = np.array([[[-1, -1], [1, 1]], [[-1, 1], [1, -1]]]) * 0.85
        if marker == "plus":
            arms = np.array([[[-1.1, 0], [1.1, 0]], [[0, -1.1], [0, 1.1]]])
        for place_ in xy:
            for shade, width in ((halo, 4.6), (colour, 2.2)):
                for arm in arms:
                    canvas.polyline(place_ + arm * radius, shade, width * look.unit, ())


def _draw_points(mark: Points, frame: Frame, canvas: Canvas, look: Look, colour: str) -> None:
    xy = frame.to_canvas(mark.xy)
    if not len(xy):
        return
    draw_marker(canvas, xy, mark.marker, mark.size / 2 * look.unit, colour, look)
    if mark.label:
        off = (mark.size / 2 + 5) * look.unit
        words = Words(panel=mark.panel, at=(0.0, 0.0), text=mark.label, role=mark.role)
        _draw_plate(words, (float(xy[0, 0]) + off, float(xy[0, 1]) - off), frame, canvas, look, colour)


def _draw_words(mark: Words, frame: Frame, canvas: Canvas, look: Look, colour: str) -> None:
    x, y = frame.to_canvas(np.array([mark.at]))[0]
    off = 0.55 * look.font
    dx, dy = {"left": (off, 0), "right": (-off, 0), "top": (0, 1.6 * off), "bottom": (0, -1.6 * off)}.get(
        mark.anchor, (0, 0)
    )
    _draw_plate(mark, (float(x + dx), float(y + dy)), frame, canvas, look, colour)


def _draw_plate(
    mark: Words, at: tuple[float, float], frame: Frame, canvas: Canvas, look: Look, colour: str
) -> None:
    """Write on a small plate that keeps text readable over photos and lines, inside the plot."""
    size = 0.92 * look.font
    width = canvas.text_width(mark.text, size)
    shift = {"left": 0.0, "right": -width}.get(mark.anchor, -width / 2)
    left, top, plot_width, plot_height = frame.plot
    pad = 0.3 * look.font
    x = min(max(at[0] + shift, left + pad), left + plot_width - width - pad)
    y = min(max(at[1], top + size), top + plot_height - size)
    plate = (x - pad, y - 0.72 * size, width + 2 * pad, 1.44 * size)
    canvas.polygon(corners(plate), look.colours["surface"], 0.82)
    canvas.text((x, y), mark.text, size, colour, "left", "middle")


def for_print(look: Look) -> Look:
    """Return the look of an exported figure: no handles, nothing marked."""
    return replace(look, handles=False, formulas=True, chosen="", active="")
