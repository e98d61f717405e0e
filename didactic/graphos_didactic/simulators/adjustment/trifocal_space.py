"""The three cameras from above and from beside, with the plane of their projection centres."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import ray_from_pixel
from graphos_didactic.scene import AnyMark, Dash, Line, Points, Polygon, Role, Words
from graphos_didactic.simulators.adjustment.trifocal_model import HEIGHT, WALL_Y, WIDTH, ThreePhotos
from graphos_didactic.simulators.observed_space import Observer, pyramid

LOOKS: tuple[tuple[str, Role, Dash], ...] = (
    ("a", "first", "solid"),
    ("b", "second", "dash"),
    ("c", "third", "dot"),
)


def view_of(photos: ThreePhotos) -> Observer:
    """Return who looks at the three cameras."""
    return Observer(np.array([0.0, -1.2, 0.0]), 15.0, photos.params.orbit, 32.0, 520.0)


def plan_marks(photos: ThreePhotos, last: int) -> list[AnyMark]:
    """Return the cameras, their rays to the point and the triangle of the centres, from above."""
    wall = np.array([[-4.5, WALL_Y], [4.5, WALL_Y]])
    marks: list[AnyMark] = [Line(panel="plan", thing="wall", role="muted", xy=wall, width=3.0)]
    edge = np.array([[-0.5, (HEIGHT - 1) / 2], [WIDTH - 0.5, (HEIGHT - 1) / 2]])
    for i, (name, role, dash) in enumerate(LOOKS):
        rays = ray_from_pixel(photos.camera, edge) @ photos.rotations[i]
        frustum = np.concatenate([photos.centres[i][None], photos.centres[i] + 1.1 * rays])[:, :2]
        marks.append(
            Polygon(panel="plan", thing=f"camera_{name}", role=role, xy=frustum, fill=0.22, dash=dash)
        )
        ray = np.stack([photos.centres[i], photos.point])[:, :2]
        if i < 2 and i <= last:
            marks.append(Line(panel="plan", thing=f"camera_{name}", role=role, xy=ray, width=1.8, dash=dash))
    for i, (name, role, _) in enumerate(LOOKS):
        x, y = photos.centres[i, :2]
        marks.append(Words(panel="plan", thing=f"camera_{name}", role=role, at=(float(x), float(y) - 0.9), anchor="centre",
                           text=name.upper()))  # fmt: skip
    return marks


def space_marks(photos: ThreePhotos, last: int) -> list[AnyMark]:
    """Return the three photos, the rays to the point and, from step 3 on, the trifocal plane."""
    view = view_of(photos)
    marks: list[AnyMark] = []
    if last >= 3:
        outline = np.concatenate([photos.centres, photos.centres[:1]])
        marks.append(
            Polygon(panel="space", thing="plane", role="third", xy=view.seen(outline), fill=0.2, width=1.2)
        )
        if photos.plane is not None:
            normal, offset = photos.plane[:3], photos.plane[3]
            foot = photos.point - (normal @ photos.point - offset) * normal
            around = np.concatenate([photos.centres[:1], foot[None], photos.centres[2:]])
            marks += [
                Polygon(panel="space", thing="plane", role="third", xy=view.seen(around), fill=0.1, width=0.8, dash="dot"),
                Line(panel="space", thing="height", role="truth", xy=view.seen(np.stack([foot, photos.point])), width=2.0,
                     dash="dot"),
            ]  # fmt: skip
    for i, (name, role, dash) in enumerate(LOOKS):
        marks += pyramid(view, photos.camera, photos.rotations[i], photos.centres[i], thing=f"camera_{name}", role=role,
                         size=1.0, label=name.upper(), dash=dash)  # fmt: skip
        if i < 2 and i <= last:
            ray = view.seen(np.stack([photos.centres[i], photos.point]))
            marks.append(Line(panel="space", thing=f"camera_{name}", role=role, xy=ray, width=1.8, dash=dash))
    marks.append(
        Points(
            panel="space", thing="point", role="truth", xy=view.seen(photos.point[None]), size=9, label="P"
        )
    )
    return marks
