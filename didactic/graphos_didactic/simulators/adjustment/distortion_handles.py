"""What can be pulled in the simulator of lens distortion: the grid and the profile, each by a term of the model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from graphos_core.data import Camera
from graphos_core.data.record import Array
from graphos_didactic.scene import AnyMark, Freedom, Handle
from graphos_didactic.simulators.adjustment.distortion_model import (
    COLUMNS,
    CORNER,
    MIDDLE,
    ROWS,
    Lens,
    grid_of,
    radial_at,
)

INNER = 0.68 * CORNER
"""Radius at which the profile is pulled by k2, px."""


def drawn(lens: Lens) -> Array:
    """Return the nodes of the grid as they are drawn, float64 (ROWS, COLUMNS, 2), px: distortion exaggerated."""
    grid = lens.grid
    return np.asarray(grid.ideal_px + lens.times * grid.displacement_px)


def handle_marks(lens: Lens, last: int) -> list[AnyMark]:
    """Return the handles of the terms that the model has and that the steps have added."""
    marks: list[AnyMark] = []
    names = lens.model.names
    if last >= 4:
        marks += [
            _on_profile(lens, name, radius)
            for name, radius in (("k1", CORNER), ("k2", INNER))
            if name in names and np.isfinite(radial_at(lens.camera, radius))
        ]
    if last >= 1 and "k1" in names:
        marks += _on_corner(lens)
    if last >= 2 and "p1" in names:
        marks += [*_on_edge(lens, "p1", 0), *_on_edge(lens, "p2", 1)]
    p = lens.params
    marks.append(
        Handle(panel="profile", name="zero", thing="zero", label="Radius of the balanced zero", role="second", freedom="x",
               at=(p.zero_px, 0.0), parameters=("zero_px",), nudge=(20.0, 0.0), move=lambda x, _: {"zero_px": x})
    )  # fmt: skip
    return marks


def _on_profile(lens: Lens, name: str, radius: float) -> Handle:
    def measure(camera: Camera) -> float:
        return radial_at(camera, radius)

    def pull(_: float, y: float) -> Mapping[str, float]:
        return {name: lens.wished(name, measure, y)}

    return Handle(panel="profile", name=f"profile_{name}", thing="radial", label=f"Profile, by {name}", role="first",
                  freedom="y" if not lens.model.backward else "slide", at=(radius, measure(lens.camera)), parameters=(name,),
                  nudge=(0.0, 4.0), move=pull)  # fmt: skip


def _on_corner(lens: Lens) -> list[AnyMark]:
    """Return the handle at the upper right corner of the grid, which moves along the diagonal by k1."""
    start, at = lens.grid.ideal_px[0, -1], drawn(lens)[0, -1]
    if not np.isfinite(at).all():
        return []
    out = (start - MIDDLE) / np.hypot(*(start - MIDDLE))

    def measure(camera: Camera) -> float:
        return float((grid_of(camera).measured_px[0, -1] - start) @ out)

    def pull(x: float, y: float) -> Mapping[str, float]:
        goal = float((np.array([x, y]) - start) @ out) / lens.times
        return {"k1": lens.wished("k1", measure, goal)}

    return [Handle(panel="grid", name="corner", thing="grid", label="Corner of the grid, by k1", role="first", freedom="slide",
                   at=(float(at[0]), float(at[1])), parameters=("k1",), nudge=(20.0, 20.0), move=pull)]  # fmt: skip


def _on_edge(lens: Lens, name: str, axis: Literal[0, 1]) -> list[AnyMark]:
    """Return the handle in the middle of the right or the lower edge, which moves across it by p1 or p2."""
    node = (ROWS // 2, COLUMNS - 1) if axis == 0 else (ROWS - 1, COLUMNS // 2)
    start, at = lens.grid.ideal_px[node], drawn(lens)[node]
    if not np.isfinite(at).all():
        return []

    def measure(camera: Camera) -> float:
        return float(grid_of(camera).displacement_px[node][axis])

    def pull(x: float, y: float) -> Mapping[str, float]:
        goal = ((x, y)[axis] - float(start[axis])) / lens.times
        return {name: lens.wished(name, measure, goal)}

    nudge = (20.0, 0.0) if axis == 0 else (0.0, 20.0)
    label = ("Right", "Lower")[axis] + f" edge of the grid, by {name}"
    freedom: Freedom = "slide" if lens.model.backward or lens.model.wide else "x" if axis == 0 else "y"
    return [Handle(panel="grid", name=f"edge_{name}", thing="grid", label=label, role="third", freedom=freedom,
                   at=(float(at[0]), float(at[1])), parameters=(name,), nudge=nudge, move=pull)]  # fmt: skip
