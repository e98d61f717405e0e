"""Pictures of the simulator of decolourisation: greys side by side, plane of colours, differences, iterations."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_didactic.scene import AnyMark, Dash, Handle, Line, Marker, Picture, Points, Role, Words
from graphos_didactic.simulators.preprocessing.decolorization_model import (
    HUES,
    LABELS,
    LIGHTS,
    METHODS,
    Decolorized,
    luma_of,
    plane,
    same_luma,
)

ROLES: tuple[Role, ...] = ("first", "second", "third")
DASHES: tuple[Dash, ...] = ("solid", "dash", "dot")
COMPARED: tuple[tuple[str, Marker, Role, float], ...] = (
    ("luma", "cross", "second", 10.0), ("principal", "square", "neutral", 8.0), ("decolor", "circle", "first", 9.0),
)  # fmt: skip
"""Ways to grey in the plot of differences: marker, role and size."""
LARGEST = 105.0


def panel_of(index: int) -> tuple[float, float, float, float]:
    """Return the rectangle of picture 0 to 7: four columns, two rows."""
    return 0.185 * (index % 4), 0.27 * (index // 4), 0.185, 0.27


def picture_marks(seen: Decolorized, step: int) -> list[AnyMark]:
    """Draw the picture and every way to grey as far as the step has come, with the contrast each keeps."""
    rows, columns = seen.picture.shape[:2]
    extent = (-0.5, -0.5, columns - 0.5, rows - 0.5)
    marks: list[AnyMark] = [Picture(panel="colour", thing="colour", pixels=seen.picture, extent=extent)]
    for method in METHODS:
        if step < 1 and method != "luma":
            continue
        if method == "decolor":
            if step >= 3:
                pixels = seen.grey("decolor") if step >= 5 else _bytes(seen.polynomial(step - 3))
                marks.append(Picture(panel=method, thing=method, pixels=pixels, extent=extent, answer=True))
        else:
            marks.append(Picture(panel=method, thing=method if method in ("luma", "principal") else "channels",
                                 pixels=seen.grey(method), extent=extent, answer=method != "luma"))  # fmt: skip
        if step >= 2 and (method != "decolor" or step >= 5):
            marks.append(Words(panel=method, role="text", at=(1.0, rows - 2.0), anchor="bottom", answer=True,
                               text=f"CCPR {seen.ccpr(method):.2f}" + (" ★" if method == seen.best else "")))  # fmt: skip
    return marks


def _bytes(polynomial: Array) -> Array:
    return np.clip(np.rint(255.0 * polynomial), 0, 255).astype(np.uint8)


def plane_marks(seen: Decolorized) -> list[AnyMark]:
    """Draw the plane of colours, the colours in it, and where all colours have the luma of A."""
    p = seen.params
    extent = (-2.0, float(LIGHTS[0]) + 0.5, 362.0, float(LIGHTS[-1]) - 0.5)
    marks: list[AnyMark] = [Picture(panel="plane", thing="colour", pixels=plane(p.chroma), extent=extent)]
    if p.picture in ("two", "three"):
        curve = np.stack([HUES, same_luma(HUES, luma_of(p.a_hue, p.a_light, p.chroma), p.chroma)], axis=1)
        marks.append(Line(panel="plane", thing="luma", role="second", width=2.2, dash="dash", xy=curve,
                          label="the luma of A", answer=True))  # fmt: skip
    else:
        marks.append(
            Points(panel="plane", thing="colour", role="text", marker="ring", size=10.0, xy=seen.on_plane)
        )
    for name, (x, y) in zip(seen.names, places(seen), strict=True):
        marks.append(Words(panel="plane", thing="colour", role="text", at=(float(x), float(y) + 4.5), text=name,
                           anchor="bottom"))  # fmt: skip
    return marks


def places(seen: Decolorized) -> Array:
    """Return hue and lightness of every colour: as set, or as measured in a photo or the wheel."""
    p = seen.params
    if p.picture in ("two", "three"):
        return np.array([[getattr(p, f"{n}_hue"), getattr(p, f"{n}_light")] for n in seen.names.lower()])
    return seen.on_plane


def difference_marks(seen: Decolorized, step: int) -> list[AnyMark]:
    """Draw what each way to grey keeps of the difference of every pair of colours; on the line it keeps all."""
    deltas = np.array([delta for _, delta in seen.pairs])
    marks: list[AnyMark] = [
        Line(panel="differences", thing="truth", role="truth", width=1.8, dash="dashdot", truth=True,
             xy=np.array([[0.0, 0.0], [LARGEST, LARGEST]]))
    ]  # fmt: skip
    for method, marker, role, size in COMPARED:
        if method == "decolor" and step < 5:
            continue
        kept = np.array(seen.kept(method))
        marks.append(Points(panel="differences", thing=method, role=role, marker=marker, size=size, answer=True,
                            xy=np.stack([deltas, kept], axis=1)))  # fmt: skip
    if len(deltas) <= 3:
        for name, delta in seen.pairs:
            marks.append(Words(panel="differences", thing="truth", role="truth", at=(delta, min(delta, 96.0)), text=name,
                               anchor="right", truth=True))  # fmt: skip
    return marks


def iteration_marks(seen: Decolorized, step: int) -> list[AnyMark]:
    """Draw the grey of every colour after each number of iterations."""
    turns, greys = seen.history
    shown = turns <= {3: 0, 4: 1}.get(step, 1000)
    marks: list[AnyMark] = []
    few = len(seen.names) <= 3
    for i, name in enumerate(seen.names):
        xy = np.stack([turns, greys[:, i]], axis=1)[shown]
        marks += [
            Line(panel="iterations", thing="decolor", role=ROLES[i % 3] if few else "neutral", width=2.0 if few else 1.2,
                 dash=DASHES[i % 3] if few else "solid", label=name if few else "", xy=xy, answer=True),
            Points(panel="iterations", thing="decolor", role=ROLES[i % 3] if few else "neutral", size=6.0, xy=xy,
                   answer=True),
        ]  # fmt: skip
    return marks


def iteration_range(seen: Decolorized) -> tuple[float, float]:
    """Return the limits of the greys in the plot of iterations."""
    greys = seen.history[1]
    margin = 0.12 * max(float(np.ptp(greys)), 10.0)
    return float(greys.min()) - 2.0 * margin, float(greys.max()) + margin


def handle_marks(seen: Decolorized) -> list[AnyMark]:
    """Return the handles: colours in the plane, or places in the photo; the number of iterations."""
    p = seen.params
    rows, columns = seen.picture.shape[:2]
    marks: list[AnyMark] = []
    for i, name in enumerate(seen.names.lower() if p.picture != "wheel" else ""):
        label, role = f"Colour {name.upper()}", ROLES[i]
        if p.picture == "photo":
            at = (getattr(p, f"{name}_x") / 100 * (columns - 1), getattr(p, f"{name}_y") / 100 * (rows - 1))
            marks.append(
                Handle(panel="colour", name=name, thing="colour", label=label, role=role, at=at, nudge=(2.0, 2.0),
                       parameters=(f"{name}_x", f"{name}_y"),
                       move=lambda x, y, n=name: {  # type: ignore[misc]
                           f"{n}_x": 100.0 * x / (columns - 1), f"{n}_y": 100.0 * y / (rows - 1)})
            )  # fmt: skip
        else:
            at = (getattr(p, f"{name}_hue"), getattr(p, f"{name}_light"))
            marks.append(
                Handle(panel="plane", name=name, thing="colour", label=label, role=role, at=at, nudge=(4.0, 1.0),
                       parameters=(f"{name}_hue", f"{name}_light"),
                       move=lambda x, y, n=name: {f"{n}_hue": x, f"{n}_light": y})  # type: ignore[misc]
            )  # fmt: skip
    low, high = iteration_range(seen)
    marks.append(
        Handle(panel="iterations", name="iterations", thing="decolor", label="Iterations", role="neutral", freedom="x",
               at=(float(p.iterations), low + 0.07 * (high - low)), parameters=("iterations",), nudge=(1.0, 0.0),
               move=lambda x, _: {"iterations": round(x)})
    )  # fmt: skip
    return marks


def title_of(method: str, step: int) -> str:
    """Return the title of the picture of one way to grey."""
    if method == "decolor" and step < 5:
        return {3: "Mean of the channels", 4: "After one iteration"}.get(step, "")
    return LABELS[method] if step >= 1 or method == "luma" else ""
