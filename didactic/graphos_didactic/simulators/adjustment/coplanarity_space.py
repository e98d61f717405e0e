"""The two photos seen from beside, and the four decompositions of the essential matrix seen from above."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import ray_from_pixel
from graphos_core.data.record import Array
from graphos_core.geometry.relative_orientation import depths
from graphos_didactic.scene import AnyMark, Dash, Handle, Line, Points, Polygon, Role, Words
from graphos_didactic.simulators.adjustment.coplanarity_model import (
    Relative,
    TwoPhotos,
)
from graphos_didactic.simulators.observed_space import Observer, pyramid

LOOKS: tuple[tuple[str, Role, Dash], ...] = (("a", "first", "solid"), ("b", "second", "dash"))


def observer(pair: TwoPhotos) -> Observer:
    """Return who looks at cameras and wall."""
    return Observer(np.array([0.2, 3.2, 0.0]), 13.0, pair.params.orbit, 30.0, 500.0)


def space_marks(pair: TwoPhotos, last: int) -> list[AnyMark]:
    """Return wall, photos, base, the rays of point 1 and, from step 1 on, their plane and the gap between them."""
    view = observer(pair)
    marks: list[AnyMark] = [
        Line(panel="space", thing="wall", role="muted", xy=view.seen(pair.wall.outline()), width=1.2)
    ]
    if last >= 2:
        marks.append(
            Points(panel="space", thing="points", role="neutral", xy=view.seen(pair.points[1:]), size=4)
        )
    for i, (name, role, dash) in enumerate(LOOKS):
        marks += pyramid(view, pair.camera, pair.rotations[i], pair.centres[i], thing=f"camera_{name}", role=role,
                         size=0.9, label=name.upper(), dash=dash)  # fmt: skip
        ray = ray_from_pixel(pair.camera, pair.pixels[i, :1])[0] @ pair.rotations[i]
        ends = np.stack([pair.centres[i], pair.centres[i] + 1.15 * float(pair.points[0, 1]) * ray])
        marks.append(
            Line(panel="space", thing=f"ray_{name}", role=role, xy=view.seen(ends), width=2.0, dash=dash)
        )
    if pair.base > 1e-9:
        marks.append(
            Line(
                panel="space", thing="base", role="accent", xy=view.seen(pair.centres), width=3.0, arrow=True
            )
        )
    nearest = pair.nearest()
    if last >= 1 and nearest is not None:
        plane = np.stack([*pair.centres, nearest[0]])
        marks += [
            Polygon(
                panel="space",
                thing="plane",
                role="third",
                xy=view.seen(plane),
                fill=0.2,
                width=1.2,
                dash="dashdot",
            ),
            Line(panel="space", thing="gap", role="error", xy=view.seen(nearest), width=3.0),
        ]
    return marks


def space_handles(pair: TwoPhotos) -> list[AnyMark]:
    """Return the handles of camera B, at its own height, and of the observer."""
    view = observer(pair)
    at = view.seen(pair.centres[1:])[0]

    def move(x: float, y: float) -> dict[str, float]:
        place = view.on_plane(pair.centres[1], np.array([0.0, 0.0, 1.0]), x, y)
        return {} if place is None else {"base_x": float(place[0]), "base_y": float(place[1])}

    return [
        Handle(panel="space", name="camera_b", thing="camera_b", label="Camera B", role="second",
               at=(float(at[0]), float(at[1])), parameters=("base_x", "base_y"), move=move, nudge=(4.0, 4.0)),
        view.orbit_handle(),
    ]  # fmt: skip


def four_marks(pair: TwoPhotos) -> list[AnyMark]:
    """Return the four decompositions, each in a square of side 2 of the panel ``"four"``, seen from above."""
    marks: list[AnyMark] = []
    for i, choice in enumerate(pair.four):
        middle = np.array([2.0 * (i % 2), -2.0 * (i // 2)])
        marks += _one_of_four(pair, choice, middle, f"{i + 1}", i == pair.right_one)
    return marks


def _one_of_four(pair: TwoPhotos, choice: Relative, middle: Array, name: str, right: bool) -> list[AnyMark]:
    rotation, base = choice
    lengths = _lengths(pair, choice)
    found = lengths[:, None] * pair.rays[0]
    centre, ahead = -rotation.T @ base, rotation[2]
    everything = np.concatenate([np.zeros((1, 3)), centre[None], found])[:, [0, 2]]
    ordered = np.sort(everything[np.isfinite(everything).all(axis=1)], axis=0)
    few = len(ordered) // 25
    low = np.minimum(ordered[few], everything[:2].min(axis=0))
    high = np.maximum(ordered[-1 - few], everything[:2].max(axis=0))
    scale = 1.45 / max(float((high - low).max()), 2.5)

    def place(points: Array) -> Array:
        return middle + scale * (np.asarray(points)[:, [0, 2]] - (low + high) / 2)

    shown = place(found)
    inside = np.abs(shown - middle).max(axis=1) < 0.93
    before = pair.before_both(choice)
    size = 0.13 / scale
    marks: list[AnyMark] = []
    for (thing, role, dash), c, way in zip(
        LOOKS, (np.zeros(3), centre), (np.array([0.0, 0, 1]), ahead), strict=True
    ):
        aside = np.array([way[2], 0.0, -way[0]])
        shape = np.stack([c, c + size * (1.5 * way + 0.8 * aside), c + size * (1.5 * way - 0.8 * aside)])
        marks.append(
            Polygon(panel="four", thing=f"camera_{thing}", role=role, xy=place(shape), fill=0.3, dash=dash)
        )
    ends = place(np.stack([np.zeros(3), centre]))
    marks += [
        Line(panel="four", thing="base", role="accent", xy=ends, width=2.0),
        Points(panel="four", thing="points", role="neutral", xy=shown[inside], size=4.5, marker="circle"),
        Points(panel="four", thing="points", role="error", xy=shown[inside & ~before], size=8, marker="cross", answer=True),
        Words(panel="four", role="text", at=(middle[0] - 0.95, middle[1] + 0.85), text=name),
        Words(panel="four", role="truth" if right else "muted", at=(middle[0], middle[1] - 0.88), anchor="centre",
              text=f"{int(before.sum())} of {len(before)} before both" + (" ✓" if right else ""), answer=True),
    ]  # fmt: skip
    return marks


def _lengths(pair: TwoPhotos, choice: Relative) -> Array:
    return np.asarray(depths(*choice, *pair.rays[..., :2])[0])
