"""Pictures of the simulator of self-dissimilarity: photo, search area, distances, patches, saliency."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.rendering.colour_maps import colours_of_values
from graphos_didactic.scene import AnyMark, Bars, Handle, Line, Picture, Points, Polygon, Role, Words
from graphos_didactic.simulators.features.self_dissimilarity_model import NEAR, Compared

SHOWN = 4
"""Nearest patches that are shown as pictures."""
LONGEST = 60
"""Nearest patches in the plot of distances."""
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
TURN = np.linspace(0.0, 2.0 * np.pi, 25)


def photo_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw the level in the photo's frame with patch, search area, nearest patches and points."""
    rows, columns = seen.grey.shape
    extent = (-0.5, -0.5, columns - 0.5, rows - 0.5)
    marks: list[AnyMark] = [Picture(panel="photo", thing="point", pixels=seen.image, extent=extent)]
    marks += _squares(seen, "photo", step, seen.in_picture, 1.0)
    if step >= 5:
        pixels, strong = seen.tops
        weak = seen.in_picture(pixels[~strong])
        places = seen.points if step >= 6 else seen.in_picture(pixels[strong])
        marks.append(
            Points(
                panel="photo", thing="rejected", role="muted", marker="cross", size=6.0, xy=weak, answer=True
            )
        )
        marks.append(
            Points(
                panel="photo", thing="found", role="first", marker="circle", size=6.0, xy=places, answer=True
            )
        )
    if len(seen.marks):
        marks.append(Line(panel="photo", thing="truth", role="truth", dash="dashdot", width=1.8, truth=True,
                          xy=_circles(seen.marks, 2.2 * NEAR)))  # fmt: skip
    return marks


def _circles(centres: Array, radius: float) -> Array:
    ring = radius * np.stack([np.cos(TURN), np.sin(TURN)], axis=1)
    circles = centres[:, None] + ring
    return np.concatenate([circles, np.full((len(centres), 1, 2), np.nan)], axis=1).reshape(-1, 2)[:-1]


def _squares(seen: Compared, panel: str, step: int, place: object, width: float) -> list[AnyMark]:
    """Draw the outlines of search area, nearest patches and own patch; `place` maps from the level."""
    assert callable(place)
    at = np.array(seen.at, dtype=float)
    half = seen.params.patch + 0.5
    marks: list[AnyMark] = [
        Polygon(panel=panel, thing="area", role="neutral", fill=0.0, width=1.6 * width, dash="dash",
                xy=place(at + CORNERS * (seen.reach + 0.5)))
    ]  # fmt: skip
    if step >= 2:
        for shift in seen.every[0][: seen.count][::-1]:
            marks.append(Polygon(panel=panel, thing="nearest", role="second", fill=0.0, width=1.2 * width, answer=True,
                                 xy=place(at + shift + CORNERS * half)))  # fmt: skip
    marks.append(Polygon(panel=panel, thing="point", role="accent", fill=0.0, width=2.4 * width,
                         xy=place(at + CORNERS * half)))  # fmt: skip
    return marks


def zoom_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw the search area enlarged, pixels of the level around the point as the origin."""
    column, row = seen.at
    reach = seen.reach
    window = seen.image[row - reach : row + reach + 1, column - reach : column + reach + 1]
    edge = reach + 0.5
    marks: list[AnyMark] = [
        Picture(panel="zoom", thing="point", pixels=window, extent=(-edge, -edge, edge, edge))
    ]
    marks += _squares(seen, "zoom", step, lambda xy: xy - (column, row), 1.0)
    if step >= 2:
        for rank, (u, v) in enumerate(seen.every[0][: min(seen.count, SHOWN)], start=1):
            marks.append(Words(panel="zoom", thing="nearest", role="second", at=(float(u), float(v)), text=str(rank),
                               anchor="centre", answer=True))  # fmt: skip
    return marks


def distance_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw the distance of every shift as a picture, its middle left out, and the nearest ones."""
    search = seen.params.search
    side = 2 * search + 1
    shifts, distance = seen.every
    table = np.full((side, side), np.nan)
    table[shifts[:, 1] + search, shifts[:, 0] + search] = np.sqrt(distance)
    pixels = colours_of_values(table, 0.0, float(np.sqrt(distance.max())) or 1.0, "cividis")
    edge = search + 0.5
    marks: list[AnyMark] = [
        Picture(
            panel="distances", thing="area", pixels=pixels, extent=(-edge, -edge, edge, edge), answer=True
        )
    ]
    if step >= 2:
        marks.append(Points(panel="distances", thing="nearest", role="second", marker="square", size=9.0, answer=True,
                            xy=shifts[: seen.count].astype(float)))  # fmt: skip
    marks.append(
        Points(
            panel="distances", thing="point", role="accent", marker="diamond", size=11.0, xy=np.zeros((1, 2))
        )
    )
    return marks


def patch_marks(seen: Compared) -> list[AnyMark]:
    """Draw the own patch and the nearest ones below each other, each with its squared difference beside it."""
    patch = seen.params.patch
    side, (column, row) = 2 * patch + 1, seen.at

    def cut(u: int, v: int) -> Array:
        return seen.image[row + v - patch : row + v + patch + 1, column + u - patch : column + u + patch + 1]

    own = cut(0, 0)
    marks: list[AnyMark] = [_cell("patches", "point", np.repeat(own[..., None], 3, axis=2), 0.0, 0.0)]
    marks.append(
        Words(panel="patches", thing="point", role="accent", at=(1.08, 0.5), text="own patch", anchor="left")
    )
    shown = min(seen.count, SHOWN)
    largest = max(float(((cut(*seen.every[0][i]).astype(float) - own) ** 2).max()) for i in range(shown))
    for i in range(shown):
        other = cut(*seen.every[0][i])
        squared = (other.astype(float) - own) ** 2
        marks += [
            _cell("patches", "nearest", np.repeat(other[..., None], 3, axis=2), 0.0, i + 1.0),
            _cell("patches", "nearest", colours_of_values(squared, 0.0, largest or 1.0, "cividis"), 1.0, i + 1.0),
            Words(panel="patches", thing="nearest", role="second", at=(0.02, i + 1.86), text=str(i + 1), anchor="left",
                  answer=True),
            Words(panel="patches", thing="nearest", role="second", at=(1.02, i + 1.86), anchor="left", answer=True,
                  text=f"mean {seen.every[1][i]:.1f}"),
        ]  # fmt: skip
    assert side == own.shape[0]
    return marks


def _cell(panel: str, thing: str, pixels: Array, column: float, row: float) -> Picture:
    gap = 0.03
    extent = (column + gap, row + gap, column + 1 - gap, row + 1 - gap)
    return Picture(panel=panel, thing=thing, pixels=pixels, extent=extent, answer=row > 0)


def bar_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw the roots of the smallest distances in order, the k that count, their mean and the threshold."""
    distance = np.sqrt(seen.every[1][:LONGEST])
    edges = np.arange(len(distance) + 1, dtype=float) + 0.5
    k = seen.count
    marks: list[AnyMark] = [
        Bars(panel="bars", thing="area", role="neutral", label="all distances, in order", edges=edges[: len(distance) + 1],
             heights=distance, fill=0.3, answer=True)
    ]  # fmt: skip
    if step >= 2:
        marks.append(Bars(panel="bars", thing="nearest", role="second", label=f"the k = {k} smallest", edges=edges[: k + 1],
                          heights=distance[:k], fill=0.8, answer=True))  # fmt: skip
    if step >= 3:
        marks.append(_level("mean", "accent", seen.dissimilarity, "solid", "√λ, λ their mean", True))
    if step >= 5:
        marks.append(_level("threshold", "third", seen.params.threshold, "dash", "threshold √λ₀", False))
    return marks


def _level(thing: str, role: Role, value: float, dash: str, label: str, answer: bool) -> Line:
    return Line(panel="bars", thing=thing, role=role, width=2.2, dash=dash, label=label, answer=answer,  # type: ignore[arg-type]
                xy=np.array([[0.5, value**0.5], [LONGEST + 0.5, value**0.5]]))  # fmt: skip


def bars_top(seen: Compared) -> float:
    """Return the end of the axis of the roots of distances, grey levels."""
    shown = seen.every[1][: min(3 * seen.count, len(seen.every[1]))]
    return float(max(1.3 * np.sqrt(shown.max()), 1.25 * np.sqrt(seen.params.threshold), 3.0))


def map_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Draw the self-dissimilarity of every pixel, square roots so that weak ones are seen, and its maxima."""
    rows, columns = seen.grey.shape
    root = np.sqrt(seen.map)
    pixels = colours_of_values(root, 0.0, map_top(seen), "viridis")
    marks: list[AnyMark] = [
        Picture(
            panel="map",
            thing="mean",
            pixels=pixels,
            extent=(-0.5, -0.5, columns - 0.5, rows - 0.5),
            answer=True,
        )
    ]
    if step >= 5:
        tops, strong = seen.tops
        for which, thing, marker, role in (
            (~strong, "rejected", "cross", "muted"),
            (strong, "found", "ring", "first"),
        ):
            marks.append(Points(panel="map", thing=thing, role=role, marker=marker, size=7.0, answer=True,  # type: ignore[arg-type]
                                xy=seen.in_picture(tops[which])))  # fmt: skip
        half = seen.params.nms + 0.5
        marks.append(Polygon(panel="map", thing="radius", role="neutral", fill=0.0, width=1.6, dash="dot",
                             xy=seen.in_picture(np.array(seen.at) + CORNERS * half)))  # fmt: skip
    return marks


def map_top(seen: Compared) -> float:
    """Return the square root of the self-dissimilarity at which the colours end, grey levels."""
    return max(float(np.sqrt(np.percentile(seen.map, 99.8))), 1.0)


def handle_marks(seen: Compared, step: int) -> list[AnyMark]:
    """Return the handles: the point in photo and map, patch and search radius in the enlarged search area."""
    rows, columns = seen.grey.shape
    x, y = seen.handle

    def move(x: float, y: float) -> dict[str, float]:
        return {"x": 100.0 * x / (columns - 1), "y": 100.0 * y / (rows - 1)}

    p = seen.params
    marks: list[AnyMark] = [
        Handle(panel=panel, name=f"point_{panel}", thing="point", label="Point", role="accent", at=(x, y),
               parameters=("x", "y"), move=move, nudge=(2.0, 2.0))
        for panel in (("photo", "map") if step >= 4 else ("photo",))
    ]  # fmt: skip
    marks += [
        Handle(panel="zoom", name="patch", thing="point", label="Patch radius", role="accent", freedom="slide",
               at=(float(p.patch), float(p.patch)), parameters=("patch",), nudge=(1.0, 1.0),
               move=lambda x, y: {"patch": round(max(x, y))}),
        Handle(panel="zoom", name="search", thing="area", label="Search radius", role="neutral", freedom="slide",
               at=(float(seen.reach), float(seen.reach)), parameters=("search",), nudge=(1.0, 1.0),
               move=lambda x, y: {"search": round(max(x, y)) - p.patch}),
    ]  # fmt: skip
    return marks
