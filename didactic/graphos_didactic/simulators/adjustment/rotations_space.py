"""The photo on its three rings, seen from beside, and the handles that turn it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.rotation import shortest_turn
from graphos_didactic.scene import AnyMark, Dash, Handle, Line, Points, Role, Words
from graphos_didactic.simulators.adjustment.rotations_model import ABOVE, MARKS, TurnedPhoto, with_frame
from graphos_didactic.simulators.observed_space import (
    Observer,
    format_corners,
    ground_lines,
    on_screen,
    pyramid,
)

AXIS, RING = 1.62, 1.3
"""Length of the photo's axes and radius of the outer ring, m."""
AXES: tuple[tuple[str, Role, Dash], ...] = (
    ("x", "first", "solid"),
    ("y", "second", "dash"),
    ("z", "third", "dot"),
)


def observer(photo: TurnedPhoto) -> Observer:
    """Return who looks at the photo: the camera in the middle, the ground below."""
    return Observer(np.array([0.0, 0.0, 0.82 * ABOVE]), 9.0, photo.params.orbit, 22.0, 780.0, 200.0)


def space_marks(photo: TurnedPhoto, last: int) -> list[AnyMark]:
    """Return ground, photo, its axes, the true photo and, from step 3 on, the one axis and the way."""
    view = observer(photo)
    ground = np.concatenate(
        [np.concatenate([line, np.full((1, 3), np.nan)]) for line in ground_lines(2.5, 0.5, pieces=1)]
    )
    marks: list[AnyMark] = [
        Line(panel="space", thing="ground", role="muted", xy=view.seen(ground), width=0.5),
        Points(panel="space", thing="marks", role="estimate", xy=view.seen(MARKS), marker="cross", size=9),
        *_world_axes(view),
    ]
    screen = on_screen(photo.camera, photo.true_rotation, photo.centre, format_corners(photo.camera), 0.8)
    edges = np.full((12, 3), np.nan)
    edges[0::3], edges[1::3] = photo.centre, screen
    for xy in (np.concatenate([screen, screen[:1]]), edges):
        marks.append(Line(panel="space", thing="truth", role="truth", xy=view.seen(xy), dash="dash", width=1.1,
                          truth=True, answer=True))  # fmt: skip
    marks += pyramid(
        view, photo.camera, photo.rotation, photo.centre, thing="frame", role="neutral", size=0.8
    )
    for n, (name, role, dash) in enumerate(AXES):
        tip = photo.centre + AXIS * photo.frame[:, n]
        marks += [
            Line(panel="space", thing="frame", role=role, xy=view.seen(np.stack([photo.centre, tip])), width=2.6,
                 dash=dash),
            Words(panel="space", thing="frame", role=role, at=_beside(view, photo, tip), anchor="centre",
                  text=f"{name}′"),
        ]  # fmt: skip
    if last >= 3:
        axis, _ = photo.one_turn
        ends = view.seen(np.stack([photo.centre - 1.75 * axis, photo.centre + 1.75 * axis]))
        marks.append(
            Line(panel="space", thing="axis", role="accent", xy=ends, width=1.6, dash="dashdot", arrow=True)
        )
    if last >= 4:
        frames, _ = photo.on_the_way(np.array([photo.params.part]))
        for n, (_, _, dash) in enumerate(AXES):
            ends = np.stack([photo.centre, photo.centre + 0.8 * AXIS * frames[0][:, n]])
            marks.append(
                Line(panel="space", thing="way", role="muted", xy=view.seen(ends), width=1.6, dash=dash)
            )
    return marks


def _world_axes(view: Observer) -> list[AnyMark]:
    marks: list[AnyMark] = []
    corner = np.zeros(3)
    for axis, name in zip(np.eye(3), "XYZ", strict=True):
        ends = view.seen(np.stack([corner, corner + 0.9 * axis]))
        end = view.seen((corner + 1.15 * axis)[None])[0]
        marks += [
            Line(panel="space", role="muted", xy=ends, width=1.6, arrow=True),
            Words(panel="space", role="muted", at=(float(end[0]), float(end[1])), anchor="centre", text=name),
        ]
    return marks


def _beside(view: Observer, photo: TurnedPhoto, tip: Array) -> tuple[float, float]:
    """Return a place for a letter a little beyond the tip, never on its handle."""
    centre, end = view.seen(np.stack([photo.centre, tip]))
    away = end - centre
    away /= max(float(np.hypot(*away)), 8.0)
    return float(end[0] + 21 * away[0]), float(end[1] + 21 * away[1])


def rings(photo: TurnedPhoto, turns: Mapping[str, tuple[str, str, Role, Dash]]) -> list[AnyMark]:
    """Return three rings: each is carried by one turn and carries the axis of the next."""
    view = observer(photo)
    around = np.linspace(0.0, 2.0 * np.pi, 73)
    across = _across(photo)
    pairs = ((photo.axes[0], photo.axes[1]), (photo.axes[1], photo.axes[2]), across)
    marks: list[AnyMark] = []
    for n, (axis, (u, v)) in enumerate(zip(photo.params.order, pairs, strict=True)):
        thing, _, role, dash = turns[axis]
        radius = RING - 0.11 * n
        v = v - (v @ u) * u
        length = float(np.linalg.norm(v))
        v = v / length if length > 1e-6 else np.zeros(3)
        ring = photo.centre + radius * (np.cos(around)[:, None] * u + np.sin(around)[:, None] * v)
        pins = np.stack([photo.centre - (radius + 0.11) * photo.axes[n], photo.centre - (radius - 0.02) * photo.axes[n],
                         np.full(3, np.nan), photo.centre + (radius - 0.02) * photo.axes[n],
                         photo.centre + (radius + 0.11) * photo.axes[n]])  # fmt: skip
        marks += [
            Line(panel="space", thing=thing, role=role, xy=view.seen(ring), width=2.0, dash=dash),
            Line(panel="space", thing=thing, role=role, xy=view.seen(pins), width=4.0),
        ]
    return marks


def _across(photo: TurnedPhoto) -> tuple[Array, Array]:
    """Return two unit vectors at right angles to the last axis, which turn with the photo."""
    last = "xyz".index(photo.params.order[2])
    first, second = (n for n in range(3) if n != last)
    return photo.frame[:, first], photo.frame[:, second]


def space_handles(photo: TurnedPhoto, last: int) -> list[AnyMark]:
    """Return the handles at the tips of the photo's axes, once all turns are done, and the observer's."""
    view = observer(photo)
    marks: list[AnyMark] = []
    for n, (name, role, _) in enumerate(AXES if last >= 2 else ()):
        tip = view.seen((photo.centre + AXIS * photo.frame[:, n])[None])[0]

        def pull(x: float, y: float, n: int = n) -> Mapping[str, float]:
            way = view.on_sphere(photo.centre, AXIS, x, y)
            turn = shortest_turn(photo.frame[:, n], way)
            return with_frame(photo.params, turn @ photo.frame)

        marks.append(
            Handle(panel="space", name=f"axis_{name}", thing="frame", label=f"Axis {name} of the photo", role=role,
                   at=(float(tip[0]), float(tip[1])), parameters=("omega", "phi", "kappa"), move=pull,
                   freedom="slide", nudge=(4.0, 4.0))
        )  # fmt: skip
    return [*marks, view.orbit_handle()]
