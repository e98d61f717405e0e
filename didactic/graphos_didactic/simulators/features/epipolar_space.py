"""The space of the epipolar simulator, seen by an observer: a third camera of the engine."""

from __future__ import annotations

import numpy as np

from graphos_didactic.scene import AnyMark, Dash, Line, Points, Polygon, Role
from graphos_didactic.simulators.features.epipolar_model import WALL_Y, EpipolarParams, TwoCameras
from graphos_didactic.simulators.format_edges import line_in_format
from graphos_didactic.simulators.observed_space import Observer, on_screen, pyramid

LOOKS: tuple[tuple[str, Role, Dash], ...] = (("a", "first", "solid"), ("b", "second", "dash"))
SCREEN = 1.7
"""The photos stand this far before their projection centres, m."""


def observer(params: EpipolarParams) -> Observer:
    """Return who looks at both cameras and the wall."""
    return Observer(np.array([0.0, -1.0, 0.2]), 17.0, params.orbit)


def space_marks(both: TwoCameras, last: int) -> list[AnyMark]:
    """Return cameras, ray, point and, from step 2 on, the epipolar plane, as the observer sees them."""
    view = observer(both.params)
    wall = np.array([[-5, WALL_Y, -3.4], [5, WALL_Y, -3.4], [5, WALL_Y, 3.4], [-5, WALL_Y, 3.4]])
    marks: list[AnyMark] = [
        Polygon(panel="space", thing="wall", role="muted", xy=view.seen(wall), fill=0.08, width=1.0)
    ]
    if last >= 2:
        corners = np.stack([both.centres[0], both.centres[1], both.point])
        marks.append(Polygon(panel="space", thing="plane", role="third", xy=view.seen(corners), fill=0.22, width=1.4,
                             dash="dashdot"))  # fmt: skip
    if both.depth > 0:
        ray = np.stack([both.centres[0], both.on_ray(both.pixels[0], min(14.0, 2.2 * both.depth))])
        marks.append(Line(panel="space", thing="ray", role="first", xy=view.seen(ray), width=1.8))
    for i, (name, role, dash) in enumerate(LOOKS):
        marks += pyramid(view, both.camera, both.rotations[i], both.centres[i], thing=f"camera_{name}", role=role,
                         size=SCREEN, label=name.upper(), dash=dash)  # fmt: skip
    ends = line_in_format(both.line, both.camera) if last >= 1 and both.line is not None else None
    if ends is not None:
        line = on_screen(both.camera, both.rotations[1], both.centres[1], ends, SCREEN)
        marks.append(
            Line(panel="space", thing="ray", role="first", xy=view.seen(line), width=2.6, answer=True)
        )
    point = view.seen(both.point[None])
    marks.append(Points(panel="space", thing="point", role="truth", xy=point, size=9, label="P"))
    return marks
