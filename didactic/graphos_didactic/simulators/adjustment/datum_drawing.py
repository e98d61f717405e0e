"""Pictures of the simulator of the datum: the block in space and plan, the spectrum, the photos."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from graphos_core.cameras import pixel_from_ray
from graphos_core.data.record import Array
from graphos_core.geometry.intersection_precision import error_ellipse
from graphos_didactic.scene import AnyMark, Handle, Line, Marker, Picture, Points, Polygon, Words
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.adjustment.datum_model import Held
from graphos_didactic.simulators.adjustment.four_photos import CAMERA, HEIGHT, POINTS_XYZ, WIDTH
from graphos_didactic.simulators.observed_space import Observer, pyramid
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

GRID_LINES = ((0, 1, 2), (3, 4, 5), (6, 7, 8), (0, 3, 6), (1, 4, 7), (2, 5, 8))
"""Points joined by lines, so that the block is seen as a surface."""
FLOOR = -17.0
"""Bottom of the spectrum, log₁₀."""
TAKEN = 2
"""The point by which the moved block is taken: point 3."""
MARKERS: Mapping[str, Marker] = {"full": "triangle", "position": "square", "height": "plus"}
LARGEST_DRAWN = 3.0
"""Semi-axes of ellipses are drawn at most this large, m."""


WATCHER = Observer(np.array([0.0, 0.0, 4.0]), 20.5, 24.0, height=21.0)
"""Who looks at the block."""


def _net(points: Array) -> Array:
    parts = [
        part for line in GRID_LINES for part in (points[list(line)], np.full((1, points.shape[1]), np.nan))
    ]
    return np.concatenate(parts[:-1])


def _seen_net(points: Array, seen: Callable[[Array], Array]) -> Array:
    return _net(seen(points))


def moved(held: Held) -> tuple[Array, Array, Array] | None:
    """Return points, projection centres and rotations of the block moved along the shown motion."""
    if held.shown is None:
        return None
    block, motion = held.adjustment.block, held.shown.of(held.params.amount)
    return motion.apply(block.points), motion.apply(block.centres), motion.rotate_camera(block.rotations)


def space_marks(held: Held, control: bool, ghost: bool) -> list[AnyMark]:
    """Draw the adjusted block and, dashed, where a free motion carries it."""
    seen, block = WATCHER.seen, held.adjustment.block
    points = np.asarray(block.points)
    marks: list[AnyMark] = [
        Line(panel="space", thing="block", role="estimate", xy=_seen_net(points, seen), width=1.6),
        Points(panel="space", thing="block", role="estimate", xy=seen(points), size=6.0),
    ]
    for i in range(len(block.names)):
        marks += pyramid(
            WATCHER, CAMERA, block.rotations[i], block.centres[i], thing="block", role="estimate", size=1.1
        )
    if ghost and (there := moved(held)) is not None:
        marks += [
            Line(
                panel="space",
                thing="motion",
                role="third",
                xy=_seen_net(there[0], seen),
                width=1.8,
                dash="dash",
            ),
            Points(panel="space", thing="motion", role="third", xy=seen(there[0]), size=6.0, marker="ring"),
        ]
        for i in range(len(block.names)):
            marks += pyramid(
                WATCHER, CAMERA, there[2][i], there[1][i], thing="motion", role="third", size=1.1, dash="dash"
            )
    if control:
        marks += _control("space", held, seen)
    return marks


def _control(panel: str, held: Held, seen: Callable[[Array], Array]) -> list[AnyMark]:
    """Draw what is known: a filled triangle for all of a point, a ring for its position, a bar for its height."""
    marks: list[AnyMark] = []
    for number, role in held.roles.items():
        if role == "none":
            continue
        at = seen(held.given[number - 1 : number])
        label = f"{number} " + {"full": "X Y Z", "position": "X Y", "height": "Z"}[role]
        marker: Marker = MARKERS[role]
        #: "triangle", "position": "square", "height": "plus"}[role]
        marks.append(
            Points(panel=panel, thing="control", role="truth", xy=at, size=13, label=label, marker=marker)
        )
    if held.params.distance:
        marks.append(
            Line(
                panel=panel, thing="control", role="truth", xy=seen(held.given[[0, 2]]), width=3.0, dash="dot"
            )
        )
    return marks


def _flat(points: Array) -> Array:
    return np.asarray(points)[:, :2]


def plan_marks(held: Held, control: bool, ellipses: bool) -> list[AnyMark]:
    """Draw the adjusted points from above with their ellipses, and the control with its error."""
    points = np.asarray(held.adjustment.block.points)
    marks: list[AnyMark] = [
        Line(
            panel="plan",
            thing="truth",
            role="truth",
            xy=_flat(_net(POINTS_XYZ)),
            width=1.0,
            dash="dot",
            truth=True,
        ),
        Line(panel="plan", thing="block", role="estimate", xy=_flat(_net(points)), width=1.4),
        Points(panel="plan", thing="block", role="estimate", xy=_flat(points), size=5.0),
    ]
    for k in range(len(points) if ellipses else 0):
        covariance = held.covariances[k][:2, :2]
        if np.isfinite(covariance).all():
            outline = np.clip(
                error_ellipse(covariance) * held.params.exaggeration, -LARGEST_DRAWN, LARGEST_DRAWN
            )
            marks.append(Polygon(panel="plan", thing="ellipses", role="third", xy=points[k, :2] + outline, fill=0.14,
                                 width=1.6, answer=True))  # fmt: skip
    if control:
        marks += _control("plan", held, _flat)
    for k, (x, y) in enumerate(_flat(points)):
        if k + 1 not in held.roles or held.roles[k + 1] == "none":
            marks.append(
                Words(panel="plan", role="muted", at=(float(x), float(y)), text=str(k + 1), anchor="bottom")
            )
    return marks


def spectrum_marks(held: Held) -> list[AnyMark]:
    """Draw the eigenvalues of the normal matrix: those of the free motions lie at the bottom, where rounding is."""
    height = np.log10(held.spectrum)
    at = np.stack([np.arange(1, len(height) + 1), height], axis=1)
    open_ = len(height) - held.defect
    return [
        Points(panel="spectrum", thing="block", role="estimate", xy=at[:open_], size=6.0),
        Points(panel="spectrum", thing="motion", role="third", xy=at[open_:], size=9.0, marker="diamond"),
    ]


def photo_marks(held: Held, setting: Setting, ghost: bool) -> list[AnyMark]:
    """Show two photos: images of the block, and of the moved block on top of them."""
    block = held.adjustment.block
    marks: list[AnyMark] = []
    there = moved(held) if ghost else None
    picture = photo_or_simulated(setting)[0] if held.params.photo else None
    for i in (0, 1):
        panel = f"photo_{i + 1}"
        if picture is not None:
            ground = Plane.centred(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, -1.0, 0]), 9.0, picture)
            pixels = photograph(CAMERA, block.rotations[i], block.centres[i], ground, picture, columns=300)
            marks.append(Picture(panel=panel, pixels=pixels, extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)))
        here = images(np.asarray(block.points), block.centres[i], block.rotations[i])
        marks.append(Points(panel=panel, thing="block", role="estimate", xy=here, size=6.0))
        if there is not None:
            again = images(there[0], there[1][i], there[2][i])
            marks.append(
                Points(panel=panel, thing="motion", role="third", xy=again, size=13.0, marker="ring")
            )
    return marks


def images(points: Array, centre: Array, rotation: Array) -> Array:
    """Return where points (n, 3) appear in a photo, float64 (n, 2), px."""
    return pixel_from_ray(CAMERA, (points - centre) @ rotation.T)


def largest_change(held: Held) -> float:
    """Return how far the free motion moves any image point, px."""
    there, block = moved(held), held.adjustment.block
    if there is None:
        return float("nan")
    return max(
        float(np.abs(images(there[0], there[1][i], there[2][i])
                     - images(np.asarray(block.points), block.centres[i], block.rotations[i])).max())
        for i in range(len(block.names))
    )  # fmt: skip


def handle_marks(held: Held) -> list[Handle]:
    """Return the handles: the moved block in space, the given place of point 1 in plan."""
    p = held.params
    handles: list[Handle] = []
    if held.shown is not None:
        point, seen, motion = np.asarray(held.adjustment.block.points)[TAKEN], WATCHER.seen, held.shown
        ends = seen(np.concatenate([motion.of(a).apply(point[None]) for a in (-1.0, p.amount, 1.0)]))
        way = ends[2] - ends[0]
        length = max(float(way @ way), 1.0)

        def slid(x: float, y: float) -> dict[str, float]:
            return {"amount": float(2.0 * ((np.array([x, y]) - ends[0]) @ way) / length - 1.0)}

        handles.append(
            Handle(panel="space", name="amount", thing="motion", label="Free motion", role="third", freedom="turn",
                   at=(float(ends[1, 0]), float(ends[1, 1])), parameters=("amount",), move=slid,
                   nudge=(float(way[0]) / 25.0, float(way[1]) / 25.0))
        )  # fmt: skip
    x, y = POINTS_XYZ[0, :2]
    handles.append(
        Handle(panel="plan", name="control_1", thing="control", label="Given place of point 1", role="truth",
               at=(float(x) + p.wrong_x * 1e-3, float(y) + p.wrong_y * 1e-3), parameters=("wrong_x", "wrong_y"),
               move=lambda u, v: {"wrong_x": (u - x) * 1e3, "wrong_y": (v - y) * 1e3}, nudge=(0.02, 0.02))
    )  # fmt: skip
    return handles
