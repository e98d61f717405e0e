"""What a simulator shows: panels, marks in them, and handles that can be dragged; plain records without any window.

A `Scene` is made by a simulator, drawn by `graphos_didactic.scene_drawing` on any canvas (window, SVG), and read by
tests. Every mark names the *thing* it shows (``"camera_a"``): choosing it in one panel marks it in all of them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from graphos_core.data.record import Array

Role = Literal[
    "text", "muted", "grid", "accent", "truth", "estimate", "error", "first", "second", "third", "neutral"
]
Dash = Literal["solid", "dash", "dot", "dashdot"]
Marker = Literal["circle", "ring", "square", "cross", "plus", "triangle", "diamond"]
PanelKind = Literal["plot", "picture", "sheet"]
Freedom = Literal["both", "x", "y", "turn", "slide"]
Point: TypeAlias = tuple[float, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """One of several linked representations.

    Attributes
    ----------
    name, title : str
    rect : tuple of float
        Left, top, width and height as parts of the whole scene, 0 to 1.
    kind : {"plot", "picture", "sheet"}
        With axes; without axes; or a column of numbers, formulas and sentences.
    x_range, y_range : tuple of float
        What is shown, in the panel's own coordinates.
    x_label, y_label : str
        What the axes carry, with unit.
    equal : bool
        Whether both axes have the same scale.
    y_down : bool
        Whether y grows downwards, as in photos.
    legend : {"", "top left", "top right", "bottom left", "bottom right", "above"}
        Where the key of labelled lines stands; empty for none.
    """

    name: str
    title: str
    rect: tuple[float, float, float, float]
    kind: PanelKind = "plot"
    x_range: Point = (0.0, 1.0)
    y_range: Point = (0.0, 1.0)
    x_label: str = ""
    y_label: str = ""
    equal: bool = False
    y_down: bool = False
    legend: Literal["", "top left", "top right", "bottom left", "bottom right", "above"] = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Mark:
    """What all marks have.

    Attributes
    ----------
    panel : str
        Name of the panel.
    thing : str
        What it shows; the same name in every panel. Empty for decoration.
    role : Role
        Colour by meaning; the painter chooses the colour for light and dark.
    label : str
        Its name in the picture or in the key.
    truth : bool
        Shown only while the truth is shown.
    answer : bool
        Hidden while a prediction or a challenge waits for the person.
    """

    panel: str
    thing: str = ""
    role: Role = "neutral"
    label: str = ""
    truth: bool = False
    answer: bool = False

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                view = value.view()
                view.flags.writeable = False
                object.__setattr__(self, field.name, view)


@dataclass(frozen=True, kw_only=True, eq=False)
class Points(Mark):
    """Points (n, 2) in panel coordinates; `size` is the diameter in px at 100 % font scale."""

    xy: Array
    marker: Marker = "circle"
    size: float = 7.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Line(Mark):
    """A polyline (n, 2) in panel coordinates; `label` goes into the panel's key."""

    xy: Array
    width: float = 1.6
    dash: Dash = "solid"
    arrow: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Polygon(Mark):
    """A closed polygon (n, 2) in panel coordinates; `fill` is its opacity, 0 to 1."""

    xy: Array
    fill: float = 0.15
    width: float = 1.6
    dash: Dash = "solid"


@dataclass(frozen=True, kw_only=True, eq=False)
class Bars(Mark):
    """A histogram: `edges` (n + 1,) and `heights` (n,) in panel coordinates."""

    edges: Array
    heights: Array
    fill: float = 0.45


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture(Mark):
    """An image, uint8 (h, w) or (h, w, 3) RGB; `extent` is left, top, right, bottom in panel coordinates."""

    pixels: Array
    extent: tuple[float, float, float, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class Words(Mark):
    """A short text at a point; `anchor` is the side of the text that touches the point."""

    at: Point
    text: str
    anchor: Literal["left", "right", "top", "bottom", "centre"] = "left"


@dataclass(frozen=True, kw_only=True, eq=False)
class Number(Mark):
    """A read-out of a sheet: ``label  value ± sigma unit``; not finite values read “not determined”.

    `digits` counts decimals. `estimate` and `true_value` of the same quantity are two numbers; an error is a third.
    """

    panel: str = "numbers"
    value: float
    unit: str
    sigma: float | None = None
    digits: int = 2


@dataclass(frozen=True, kw_only=True, eq=False)
class Formula(Mark):
    """A formula of a sheet in mathtext without dollar signs, numbers already put in where they are live."""

    panel: str = "numbers"
    tex: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Matrix(Mark):
    """A matrix of a sheet: its entries as texts, row by row; `label` stands before it."""

    panel: str = "numbers"
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Sentence(Mark):
    """A sentence of a sheet, wrapped; `heading` makes it a heading."""

    panel: str = "numbers"
    text: str
    heading: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Handle(Mark):
    """A place that can be dragged and changes one or more parameters.

    Attributes
    ----------
    name : str
        Its own name, the same from scene to scene.
    at : tuple of float
        Where it is, in panel coordinates.
    parameters : tuple of str
        Which parameters it changes; their declarations hold its limits.
    move : callable
        ``move(x, y)`` gives the wished values by parameter name for a place in panel coordinates; limits are
        applied by `graphos_didactic.simulator.drag`.
    freedom : {"both", "x", "y", "turn", "slide"}
        Which way it can go; ``"slide"`` stays on a line or surface, not always under the pointer.
    nudge : tuple of float
        Step of an arrow key in panel coordinates.
    grip : float64 (n, 2) or None
        A polygon inside which it can be taken, beside the handle itself.
    """

    name: str
    at: Point
    parameters: tuple[str, ...]
    move: Callable[[float, float], Mapping[str, float]]
    freedom: Freedom = "both"
    nudge: Point = (1.0, 1.0)
    grip: Array | None = None


AnyMark: TypeAlias = (
    Points | Line | Polygon | Bars | Picture | Words | Number | Formula | Matrix | Sentence | Handle
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """Everything to see.

    Attributes
    ----------
    panels : tuple of Panel
    marks : tuple of marks
        In drawing order.
    things : mapping of str to str
        What each thing is, in words, by name.
    says : str
        What the picture shows now, in one sentence, with computed numbers.
    """

    panels: tuple[Panel, ...]
    marks: tuple[AnyMark, ...]
    things: Mapping[str, str]
    says: str = ""

    def panel(self, name: str) -> Panel:
        """Return a panel by name."""
        return next(panel for panel in self.panels if panel.name == name)

    @property
    def handles(self) -> tuple[Handle, ...]:
        """The handles, in the order of the keyboard."""
        return tuple(mark for mark in self.marks if isinstance(mark, Handle))

    def numbers(self) -> dict[str, Number]:
        """Return the read-outs by label."""
        return {mark.label: mark for mark in self.marks if isinstance(mark, Number)}

    def visible(self, *, truth: bool, answers: bool) -> tuple[AnyMark, ...]:
        """Return the marks that are shown, with or without the truth and the answers."""
        return tuple(m for m in self.marks if (truth or not m.truth) and (answers or not m.answer))


def scene_table(scene: Scene) -> list[dict[str, Any]]:
    """Return the data of a scene as rows: read-outs first, then every point and curve that shows a thing.

    Each row has ``panel, thing, label, index, x, x_axis, y, y_axis, value, sigma, unit``.
    """
    rows: list[dict[str, Any]] = []
    for mark in scene.marks:
        base = {"panel": mark.panel, "thing": mark.thing, "label": mark.label}
        if isinstance(mark, Number):
            rows.append(base | {"value": mark.value, "sigma": mark.sigma, "unit": mark.unit})
        elif isinstance(mark, (Points, Line, Polygon)) and mark.thing:
            places = enumerate(
                mark.xy[np.isfinite(mark.xy).all(axis=1)]
            )  # NaN only separates parts of a line
            rows += [base | _place(scene, mark.panel, i, x, y) for i, (x, y) in places]
        elif isinstance(mark, Bars):
            centres = (mark.edges[:-1] + mark.edges[1:]) / 2
            rows += [
                base | _place(scene, mark.panel, i, x, y)
                for i, (x, y) in enumerate(zip(centres, mark.heights, strict=True))
            ]
    return sorted(rows, key=lambda row: "value" not in row)


def _place(scene: Scene, panel: str, index: int, x: float, y: float) -> dict[str, Any]:
    where = scene.panel(panel)
    return {
        "index": index, "x": float(x), "x_axis": where.x_label, "y": float(y), "y_axis": where.y_label,
    }  # fmt: skip
