"""Pictures of the simulator of the descriptor: patches, gradients, histograms, the 128 numbers."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.data.record import Array
from graphos_core.features.descriptor import CELL, CELLS, DIRECTIONS, ORIENTATIONS, Described
from graphos_core.rendering.colour_maps import colours_of_values
from graphos_didactic.scene import AnyMark, Bars, Dash, Handle, Line, Picture, Points, Polygon, Role, Words
from graphos_didactic.simulators.features.descriptor_model import MIDDLE, SIDE, Compared

ROLES: tuple[Role, Role] = ("first", "second")
THINGS = ("a", "b")
HALF = CELLS / 2
ARROWS = 16
"""Arrows of the gradient field along a side."""
RADIUS = 104.0
"""Distance of the handle that turns from the middle of the picture, px."""
ROWS_APART = DIRECTIONS + 3.4
"""Rows from one picture of the 128 numbers to the next, with the room for its name."""
LARGEST_NUMBER, LARGEST_DIFFERENCE = 0.25, 0.2
"""Numbers of descriptors are drawn up to the first, their differences from minus to plus the second."""


def picture_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw both pictures with the keypoint: its patch, its circle and, once known, its direction."""
    marks: list[AnyMark] = []
    edges = (-0.5, -0.5, SIDE - 0.5, SIDE - 0.5)
    for which, (panel, grey) in enumerate((("first", seen.first), ("second", seen.second))):
        described = (seen.a, seen.b)[which]
        angle = described.angle if step >= 3 else 0.0
        role, thing = ROLES[which], THINGS[which]
        centre, half = np.array([described.x, described.y]), HALF * CELL * described.scale / 2
        way = np.array([math.cos(angle), math.sin(angle)])
        side = np.array([-way[1], way[0]])
        corners = centre + half * np.array([way + side, way - side, -way - side, -way + side])
        marks += [
            Picture(panel=panel, thing=thing, pixels=grey.astype(np.uint8), extent=edges),
            Polygon(panel=panel, thing=thing, role=role, xy=corners, fill=0.0, width=2.2,
                    dash="solid" if which == 0 else "dash"),
        ]  # fmt: skip
        if step >= 2:
            tip = np.stack([centre, centre + half * _way(described.angle)])
            marks.append(
                Line(panel=panel, thing=thing, role=role, xy=tip, width=2.6, arrow=True, answer=which == 1)
            )
    true = math.radians(seen.params.turn)
    spoke = np.array(
        [[MIDDLE, MIDDLE], [MIDDLE + 0.9 * RADIUS * math.cos(true), MIDDLE + 0.9 * RADIUS * math.sin(true)]]
    )
    marks.append(
        Line(panel="second", thing="truth", role="truth", dash="dashdot", width=1.8, truth=True, xy=spoke)
    )
    return marks


def _way(angle: float) -> Array:
    return np.array([math.cos(angle), math.sin(angle)])


def patch_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw both patches in cells, with the gradients and the grid of cells."""
    marks: list[AnyMark] = []
    for which, panel in enumerate(("patch_a", "patch_b")):
        described = (seen.a, seen.b)[which] if step >= 3 else seen.unturned(which)
        pixels = np.clip(described.patch, 0, 255).astype(np.uint8)
        marks.append(
            Picture(panel=panel, thing=THINGS[which], pixels=pixels, extent=(-HALF, -HALF, HALF, HALF))
        )
        if step >= 1:
            marks.append(
                Line(panel=panel, thing="gradients", role=ROLES[which], width=1.6, xy=_arrows(described))
            )
        if step >= 4:
            marks.append(Line(panel=panel, thing="cells", role="neutral", width=1.2, xy=_grid()))
    if step >= 4:
        marks += _pixel_marks(seen)
    return marks


def _arrows(described: Described) -> Array:
    """Return gradients of every fourth pixel as short lines with a tick at the root, NaN between them, in cells."""
    side = described.patch.shape[0]
    every = side // ARROWS
    index = np.arange(every // 2, side, every)
    size = described.magnitude[np.ix_(index, index)]
    angle = described.direction[np.ix_(index, index)]
    length = size / max(float(size.max()), 1e-6) * (1.6 * CELLS / ARROWS)
    place = ((index + 0.5) / side - 0.5) * CELLS
    x, y = np.meshgrid(place, place)
    tip_x, tip_y = x + length * np.cos(angle), y + length * np.sin(angle)
    left, right = angle + 2.6, angle - 2.6
    barb = 0.4 * length
    lines = [
        (x, y), (tip_x, tip_y), (tip_x + barb * np.cos(left), tip_y + barb * np.sin(left)), (tip_x, tip_y),
        (tip_x + barb * np.cos(right), tip_y + barb * np.sin(right)), (np.full_like(x, np.nan),) * 2,
    ]  # fmt: skip
    strong = (length > 0.04).ravel()
    xy = np.stack([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in lines], axis=1)[strong]
    return xy.reshape(-1, 2)[:-1] if len(xy) else np.empty((0, 2))


def _grid() -> Array:
    lines = []
    for k in np.arange(-HALF, HALF + 1):
        lines += [[-HALF, k], [HALF, k], [np.nan, np.nan], [k, -HALF], [k, HALF], [np.nan, np.nan]]
    return np.array(lines[:-1])


def _pixel_marks(seen: Compared) -> list[AnyMark]:
    """Mark the cells between which the chosen pixel is shared out: by lines to their middles."""
    p, shares = seen.params, seen.shares
    marks: list[AnyMark] = []
    for row, a in shares.rows.items():
        for column, b in shares.columns.items():
            middle = np.array([column, row]) - (CELLS - 1) / 2
            if a * b > 0:
                marks.append(Line(panel="patch_a", thing="pixel", role="third", width=0.8 + 4.0 * a * b, answer=True,
                                  xy=np.stack([[p.u, p.v], middle])))  # fmt: skip
                marks.append(Words(panel="patch_a", thing="pixel", role="third", at=(float(middle[0]), float(middle[1])),
                                   text=f"{100 * a * b:.0f} %", anchor="centre", answer=True))  # fmt: skip
    return marks


def orientation_marks(seen: Compared) -> list[AnyMark]:
    """Draw both orientation histograms in parts of their highest bin, the limit for further peaks, the peaks."""
    marks: list[AnyMark] = []
    width = 360.0 / ORIENTATIONS
    edges = np.arange(ORIENTATIONS + 1) * width - width / 2
    for which in (0, 1):
        histogram = seen.unturned(which).orientation
        top = max(float(histogram.max()), 1e-9)
        role, name = ROLES[which], ("first", "second")[which]
        if which == 0:
            marks.append(Bars(panel="orientation", thing="a", role=role, label=name, edges=edges, heights=histogram / top,
                              fill=0.4))  # fmt: skip
        else:
            steps = np.stack([np.repeat(edges, 2)[1:-1], np.repeat(histogram / top, 2)], axis=1)
            marks.append(
                Line(panel="orientation", thing="b", role=role, label=name, xy=steps, width=1.8, answer=True)
            )
        for angle in seen.peaks(which) if seen.params.orientation == "histogram" else ():
            place = math.degrees(angle) % 360.0
            height = float(histogram[round(place / width) % ORIENTATIONS]) / top
            marks.append(Points(panel="orientation", thing=THINGS[which], role=role, xy=np.array([[place, height + 0.06]]),
                                marker="triangle" if which == 0 else "diamond", size=10, answer=which == 1))  # fmt: skip
    share = seen.params.share
    marks.append(Line(panel="orientation", thing="limit", role="neutral", dash="dash", width=1.4, label=f"{100 * share:.0f} %",
                      xy=np.array([[-5.0, share], [355.0, share]])))  # fmt: skip
    return marks


def fan_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw the histogram of every cell as a fan of eight lines; the first solid, the second dashed."""
    marks: list[AnyMark] = [Line(panel="fan", thing="cells", role="grid", width=1.2, xy=_grid())]
    styles: tuple[tuple[Dash, float], ...] = (("solid", 2.4), ("dash", 1.6))
    histograms = [described.raw if step == 4 else described.final for described in (seen.a, seen.b)]
    longest = max(float(np.max(histograms)), 1e-12)
    for which, (dash, width) in enumerate(styles):
        marks.append(Line(panel="fan", thing=THINGS[which], role=ROLES[which], dash=dash, width=width,
                          xy=_fan(histograms[which], longest), answer=which == 1))  # fmt: skip
    if step >= 5:
        cut = np.argwhere(seen.a.unit > 0.2)
        if len(cut):
            marks.append(Points(panel="fan", thing="cut", role="third", marker="ring", size=9,
                                xy=np.array([_tip(r, c, d, 0.46 * seen.a.final[r, c, d] / longest) for r, c, d in cut])))  # fmt: skip
    return marks


def _fan(values: Array, longest: float) -> Array:
    lines = []
    for (row, column, turn), value in np.ndenumerate(values):
        if value > 0.01 * longest:
            lines += [
                _tip(row, column, turn, 0.0),
                _tip(row, column, turn, 0.46 * value / longest),
                (np.nan, np.nan),
            ]
    return np.array(lines[:-1]) if lines else np.empty((0, 2))


def _tip(row: float, column: float, turn: float, length: float) -> tuple[float, float]:
    """Return the end of a line of a fan; directions count counter-clockwise, y grows downwards."""
    angle, half = 2 * math.pi * turn / DIRECTIONS, (CELLS - 1) / 2
    return column - half + length * math.cos(angle), row - half - length * math.sin(angle)


def number_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw the 128 numbers of both as 8 × 16 pictures, and their difference once they are compared."""
    grids = [d.final.reshape(CELLS * CELLS, DIRECTIONS).T for d in (seen.a, seen.b)]
    marks: list[AnyMark] = []
    rows: list[tuple[str, Array, str, bool]] = [
        (
            "a",
            colours_of_values(grids[0], 0.0, LARGEST_NUMBER),
            f"first · 0 to {LARGEST_NUMBER:g} · cells →, directions ↓",
            False,
        ),
        ("b", colours_of_values(grids[1], 0.0, LARGEST_NUMBER), f"second · 0 to {LARGEST_NUMBER:g}", True),
    ]
    if step >= 6:
        difference = colours_of_values(
            grids[1] - grids[0], -LARGEST_DIFFERENCE, LARGEST_DIFFERENCE, "diverging"
        )
        rows.append(("difference", difference, f"second − first · ±{LARGEST_DIFFERENCE:g}", True))
    for i, (thing, pixels, text, answer) in enumerate(rows):
        top = i * ROWS_APART + 3.0
        marks.append(Picture(panel="numbers128", thing=thing, pixels=pixels, answer=answer,
                             extent=(0.0, top, float(CELLS * CELLS), top + DIRECTIONS)))  # fmt: skip
        marks.append(
            Words(panel="numbers128", thing=thing, role="text", at=(0.0, top - 1.6), text=text, answer=answer)
        )
    return marks


def handle_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Return the handles: the keypoint, its size, the turn of the second picture, the pixel."""
    p, a = seen.params, seen.a
    x, y = seen.at_first
    angle = math.radians(p.turn)
    reach = min(3.0 * p.size, 0.42 * SIDE)
    corner = np.array([x, y]) + reach * _way((a.angle if step >= 3 else 0.0) + math.pi / 2)
    marks: list[AnyMark] = [
        Handle(panel="second", name="turn", thing="truth", label="Turn of the second picture", role="truth",
               freedom="turn", at=(MIDDLE + RADIUS * math.cos(angle), MIDDLE + RADIUS * math.sin(angle)),
               parameters=("turn",), nudge=(4.0, 4.0),
               move=lambda x, y: {"turn": float(round(math.degrees(math.atan2(y - MIDDLE, x - MIDDLE))))}),
        Handle(panel="first", name="point", thing="a", label="Key point", role="first", at=(x, y), parameters=("x", "y"),
               move=lambda x, y: {"x": 100.0 * x / (SIDE - 1), "y": 100.0 * y / (SIDE - 1)}, nudge=(2.0, 2.0)),
        Handle(panel="first", name="size", thing="a", label="Diameter", role="neutral", freedom="slide",
               at=(float(corner[0]), float(corner[1])), parameters=("size",), nudge=(3.0, 3.0),
               move=lambda u, v: {"size": math.hypot(u - x, v - y) / 3.0}),
    ]  # fmt: skip
    if step >= 4:
        marks.append(Handle(panel="patch_a", name="pixel", thing="pixel", label="Pixel", role="third", at=(p.u, p.v),
                            parameters=("u", "v"), move=lambda u, v: {"u": u, "v": v}, nudge=(0.05, 0.05)))  # fmt: skip
    return marks
