"""Pictures of the simulator of data snooping: photos with residuals, tests, minimal detectable biases, object."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.statistics.reliability import detectable
from graphos_didactic.scene import AnyMark, Bars, Handle, Line, Picture, Points, Polygon, Role, Words
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.adjustment.four_photos import (
    CAMERA,
    CENTRES,
    HEIGHT,
    POINTS_XYZ,
    ROTATIONS,
    WIDTH,
)
from graphos_didactic.simulators.adjustment.snooping_model import Snooping
from graphos_didactic.simulators.adjustment.snooping_params import PHOTOS
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

ROLES: dict[str, Role] = {"a": "first", "b": "second"}
TALLEST, FARTHEST_PX = 9.0, 14.0
"""Tops of the pictures of the test and of the minimal detectable biases."""
OBJECT_ENLARGED = 15.0
"""Errors of points are drawn this many times too large in the plan."""


def photo_marks(block: Snooping, setting: Setting, residuals: bool) -> list[AnyMark]:
    """Draw the points of every photo, their residuals enlarged, and the photo on the ground if wished."""
    marks: list[AnyMark] = []
    picture = photo_or_simulated(setting)[0] if block.params.photo else None
    for k in range(PHOTOS):
        panel, used = f"photo_{k + 1}", k < block.photos
        if picture is not None:
            ground = Plane.centred(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, -1.0, 0]), 9.0, picture)
            pixels = photograph(CAMERA, ROTATIONS[k], CENTRES[k], ground, picture, columns=300)
            marks.append(Picture(panel=panel, pixels=pixels, extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)))
        true = block.true_pixels(k)
        marks.append(
            Points(panel=panel, thing="points", role="neutral" if used else "muted", xy=true, size=5.0,
                   marker="circle" if used else "ring")
        )  # fmt: skip
        if not used:
            continue
        for i, (x, y) in enumerate(true):
            marks.append(
                Words(panel=panel, role="muted", at=(float(x), float(y)), text=str(i + 1), anchor="bottom")
            )
        for name in "ab":
            marks += _blunder(block, name, k)
        if residuals:
            marks += _residuals(block, k)
    return marks


def _blunder(block: Snooping, name: str, k: int) -> list[AnyMark]:
    p = block.params
    if getattr(p, f"{name}_photo") != k + 1:
        return []
    at = block.true_pixels(k)[getattr(p, f"{name}_point") - 1]
    shift = np.array([getattr(p, f"{name}_x"), getattr(p, f"{name}_y")]) * p.exaggeration
    return [Line(panel=f"photo_{k + 1}", thing=name, role=ROLES[name], xy=np.stack([at, at + shift]), dash="dot",
                 width=1.6, truth=True)]  # fmt: skip


def _residuals(block: Snooping, k: int) -> list[AnyMark]:
    found, true = block.result, block.true_pixels(k)
    accused = found.accused
    marks: list[AnyMark] = []
    for i in np.flatnonzero(found.photo == k):
        at = true[found.point[i]]
        way = -found.adjustment.residuals[i] * block.params.exaggeration  # towards where it was measured
        marks.append(Line(panel=f"photo_{k + 1}", thing="accused" if accused[i] else "residuals", answer=True,
                          role="error" if accused[i] else "estimate", xy=np.stack([at, at + way]), arrow=True,
                          width=2.6 if accused[i] else 1.6))  # fmt: skip
    for photo, point in block.dropped:
        if photo == k + 1:
            marks.append(Points(panel=f"photo_{photo}", thing="removed", role="error", xy=true[point - 1][None],
                                marker="cross", size=16, answer=True))  # fmt: skip
    return marks


def bar_marks(block: Snooping) -> list[AnyMark]:
    """Draw |w| (or |τ|) of every coordinate as bars, photo by photo, with the limit."""
    found = block.result
    values = np.minimum(np.abs(found.values), TALLEST * 0.985)
    of_a, of_b = (
        found.find(getattr(block.params, f"{n}_photo"), getattr(block.params, f"{n}_point")) for n in "ab"
    )
    marks: list[AnyMark] = []
    for slot, i in enumerate(_order(block)):
        role: Role = "error" if found.accused[i] else "neutral"
        thing = "a" if i == of_a else "b" if i == of_b else "accused" if found.accused[i] else "residuals"
        edges = np.array([slot, slot + 0.42, slot + 0.84]) + 0.08
        marks.append(Bars(panel="test", thing=thing, role=role, edges=edges, heights=values[i], answer=True,
                          fill=0.85 if found.accused[i] else 0.45))  # fmt: skip
        name = "a" if i == of_a else "b"
        if i in (of_a, of_b) and block.size(name) > 0:
            top = min(float(values[i].max()) + 0.25, TALLEST * 0.9)
            marks.append(Words(panel="test", thing=name, role=ROLES[name], at=(slot + 0.5, top), text=name.upper(),
                               anchor="bottom", answer=True))  # fmt: skip
    width = len(found.photo)
    marks.append(Line(panel="test", thing="limit", role="accent", dash="dash", width=1.8,
                      xy=np.array([[0.0, found.limit], [width, found.limit]])))  # fmt: skip
    start = 0
    for k in range(block.photos):
        count = int((found.photo == k).sum())
        marks.append(Words(panel="test", role="muted", at=(start + count / 2, TALLEST * 0.97), text=f"photo {k + 1}",
                           anchor="centre"))  # fmt: skip
        start += count
        if k + 1 < block.photos:
            marks.append(
                Line(panel="test", role="grid", width=1.2, xy=np.array([[start, 0.0], [start, TALLEST]]))
            )
    return marks


def _order(block: Snooping) -> np.ndarray:
    found = block.result
    return np.lexsort((found.point, found.photo))


def bias_marks(block: Snooping) -> list[AnyMark]:
    """Draw the minimal detectable bias against the redundancy number, and where every coordinate stands."""
    found, p = block.result, block.params
    numbers = np.linspace(0.005, 1.0, 160)
    curve = np.stack([numbers, detectable(np.array(p.sigma_px), numbers, found.reliability.delta0)], axis=1)
    r, mdb = found.reliability.redundancy, np.minimum(found.reliability.mdb_px, FARTHEST_PX * 0.97)
    marks: list[AnyMark] = [
        Line(panel="bias", thing="bias", role="accent", xy=curve, width=2.0),
        Points(panel="bias", thing="residuals", role="neutral", xy=np.stack([r.ravel(), mdb.ravel()], axis=1), size=5.5,
               answer=True),
    ]  # fmt: skip
    for name in "ab":
        i = found.find(getattr(p, f"{name}_photo"), getattr(p, f"{name}_point"))
        if i is None or (name == "b" and block.size("b") == 0):
            continue
        for axis in (0, 1):
            at = np.array([[r[i, axis], mdb[i, axis]]])
            marks.append(Points(panel="bias", thing=name, role=ROLES[name], xy=at, size=10, label=f"{name.upper()} {'xy'[axis]}",
                                marker="diamond" if name == "a" else "square", answer=True))  # fmt: skip
    return marks


def object_marks(block: Snooping, residuals: bool) -> list[AnyMark]:
    """Draw the points from above, their errors enlarged, and what an undetected blunder in A could do."""
    found, p = block.result, block.params
    xy = POINTS_XYZ[:, :2]
    marks: list[AnyMark] = [Points(panel="object", thing="points", role="neutral", xy=xy, size=5.0)]
    i = found.find(p.a_photo, p.a_point)
    effect = float(found.reliability.effect[i].max()) if i is not None else float("nan")
    if np.isfinite(effect):
        turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
        ring = np.stack([np.cos(turn), np.sin(turn)], axis=1) * min(effect * OBJECT_ENLARGED, 50.0)
        marks.append(Polygon(panel="object", thing="a", role="first", xy=xy[p.a_point - 1] + ring, fill=0.1,
                             dash="dash", width=1.4, answer=True))  # fmt: skip
    if residuals:
        for k in range(len(xy)):
            way = block.errors[k, :2] * OBJECT_ENLARGED
            marks.append(Line(panel="object", thing="errors", role="truth", xy=np.stack([xy[k], xy[k] + way]),
                              arrow=True, width=1.8, truth=True, answer=True))  # fmt: skip
    return marks


def handle_marks(block: Snooping) -> list[Handle]:
    """Return the handles of the two wrong observations and of the error probability's limit."""
    p, handles = block.params, []
    for name in "ab":
        k = getattr(p, f"{name}_photo") - 1
        if k >= block.photos:
            continue
        true = block.true_pixels(k)[getattr(p, f"{name}_point") - 1]
        at = true + p.exaggeration * np.array([getattr(p, f"{name}_x"), getattr(p, f"{name}_y")])
        handles.append(
            Handle(panel=f"photo_{k + 1}", name=name, thing=name, label=f"Observation {name.upper()}",
                   role=ROLES[name], at=(float(at[0]), float(at[1])), parameters=(f"{name}_x", f"{name}_y"),
                   move=lambda x, y, n=name, t=true: {  # type: ignore[misc]
                       f"{n}_x": (x - t[0]) / p.exaggeration, f"{n}_y": (y - t[1]) / p.exaggeration},
                   nudge=(0.5 * p.exaggeration, 0.5 * p.exaggeration))
        )  # fmt: skip
    return handles
