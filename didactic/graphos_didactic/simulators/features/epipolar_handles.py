"""What can be dragged in the simulator of the epipolar geometry."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphos_didactic.scene import AnyMark, Handle, Role
from graphos_didactic.simulators.features.epipolar_model import FAR, NEAR, TwoCameras
from graphos_didactic.simulators.features.epipolar_space import observer

ROLES: tuple[Role, Role] = ("first", "second")


def handle_marks(both: TwoCameras) -> list[AnyMark]:
    """Return the handles of cameras, directions, point and view; in the photos those of the point."""
    p = both.params
    marks: list[AnyMark] = []
    for i, name in enumerate("ab"):
        x, y = (float(c) for c in both.centres[i, :2])
        turn = np.radians(p.a_turn if i == 0 else p.b_turn)
        marks += [
            Handle(panel="plan", name=f"camera_{name}", thing=f"camera_{name}", label=f"Camera {name.upper()}",
                   role=ROLES[i], at=(x, y), parameters=(f"{name}_x", f"{name}_y"), nudge=(0.1, 0.1),
                   move=lambda u, v, n=name: {f"{n}_x": u, f"{n}_y": v}),  # type: ignore[misc]
            Handle(panel="plan", name=f"turn_{name}", thing=f"camera_{name}", role=ROLES[i], freedom="turn",
                   label=f"Direction of camera {name.upper()}", parameters=(f"{name}_turn",), nudge=(0.1, 0.1),
                   at=(x + 2.6 * float(np.sin(turn)), y + 2.6 * float(np.cos(turn))),
                   move=lambda u, v, n=name, x=x, y=y: {  # type: ignore[misc]
                       f"{n}_turn": float(np.degrees(np.arctan2(u - x, v - y)))}),
        ]  # fmt: skip
    marks.append(
        Handle(panel="plan", name="point", thing="point", label="Point P", role="truth", nudge=(0.1, 0.1),
               at=(p.p_x, p.p_y), parameters=("p_x", "p_y"), move=lambda u, v: {"p_x": u, "p_y": v})
    )  # fmt: skip
    return [*marks, *_photo_handles(both), observer(p).orbit_handle()]


def _photo_handles(both: TwoCameras) -> list[AnyMark]:
    """In photo A the point keeps its depth; in photo B it slides along the ray of A."""
    p, names = both.params, ("p_x", "p_y", "p_z")

    def in_a(x: float, y: float) -> Mapping[str, float]:
        return dict(zip(names, both.on_ray(np.array([x, y]), both.depth).tolist(), strict=True))

    depths = np.geomspace(NEAR, FAR, 600)
    seen = both.images_of_depths(depths) if np.isfinite(both.pixels[0]).all() else np.empty((0, 2))

    def in_b(x: float, y: float) -> Mapping[str, float]:
        gap = np.hypot(*(seen - (x, y)).T)
        if not np.isfinite(gap).any():
            return {}
        depth = float(depths[int(np.nanargmin(gap))])
        return dict(zip(names, both.on_ray(both.pixels[0], depth).tolist(), strict=True))

    marks: list[AnyMark] = []
    step = (4.0, 4.0)
    if np.isfinite(both.pixels[0]).all() and both.depth > 0:
        at = (float(both.pixels[0, 0]), float(both.pixels[0, 1]))
        marks.append(Handle(panel="photo_a", name="in_a", thing="point", label="P in photo A", role="first", at=at,
                            parameters=names, move=in_a, nudge=step))  # fmt: skip
    if len(seen) and np.isfinite(both.pixels[1]).all():
        at = (float(both.pixels[1, 0]), float(both.pixels[1, 1]))
        marks.append(Handle(panel="photo_b", name="in_b", thing="point", label="P in photo B", role="truth", at=at,
                            parameters=names, move=in_b, nudge=(12.0, 12.0), answer=True, freedom="slide"))  # fmt: skip
    if p.guessing:
        marks.append(Handle(panel="photo_b", name="guess", thing="guess", label="Your guess", role="accent",
                            at=(p.guess_x, p.guess_y), parameters=("guess_x", "guess_y"), nudge=step,
                            move=lambda x, y: {"guess_x": x, "guess_y": y}))  # fmt: skip
    return marks
