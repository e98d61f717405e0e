"""Pictures of the simulator of the adjustment step by step: photo, plan, matrices, step, trace."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphos_core.adjustment.bundle.adjust import Method
from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.data.record import Array
from graphos_didactic.scene import AnyMark, Dash, Handle, Line, Picture, Points, Words
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.adjustment.four_photos import CAMERA, CENTRES, HEIGHT, POINTS_XYZ, WIDTH
from graphos_didactic.simulators.adjustment.steps_model import POWERS, Iteration
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

PHOTOS_COLOUR, POINTS_COLOUR, BOTH_COLOUR = (11, 92, 173), (179, 64, 10), (138, 63, 124)
PAPER = (247, 247, 247)


def photo_marks(run: Iteration, setting: Setting, step: bool) -> list[AnyMark]:
    """Show photo 1: measured, projected from the present scene, and from where your step leads."""
    measured, here = run.measured(0), run.images(run.scene, 0)
    marks: list[AnyMark] = []
    if run.params.photo:
        picture = photo_or_simulated(setting)[0]
        ground = Plane.centred(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, -1.0, 0]), 9.0, picture)
        pixels = photograph(
            CAMERA, run.scene.rotations[0], run.scene.centres[0], ground, picture, columns=340
        )
        marks.append(Picture(panel="photo", pixels=pixels, extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)))
    for a, b in zip(measured, here, strict=True):
        marks.append(
            Line(panel="photo", thing="residuals", role="error", xy=np.stack([b, a]), width=1.4, arrow=True)
        )
    marks += [
        Points(panel="photo", thing="measured", role="truth", xy=measured, size=8.0, marker="cross"),
        Points(panel="photo", thing="now", role="estimate", xy=here, size=7.0),
    ]
    if step and run.mine is not None:
        there = run.images(run.mine.scene, 0)
        marks.append(
            Points(panel="photo", thing="step", role="third", xy=there, size=10.0, marker="ring", answer=True)
        )
    return marks


def plan_marks(run: Iteration, step: bool, path: bool) -> list[AnyMark]:
    """Draw centres and points from above: true, now, where your step leads, and the way of photo 1 so far."""
    scene = run.scene
    known = ~run.problem.layout.free_point
    marks: list[AnyMark] = [
        Points(
            panel="plan", thing="truth", role="truth", xy=CENTRES[:, :2], size=10, marker="square", truth=True
        ),
        Points(
            panel="plan",
            thing="truth",
            role="truth",
            xy=POINTS_XYZ[:, :2],
            size=8,
            marker="cross",
            truth=True,
        ),
        Points(panel="plan", thing="now", role="estimate", xy=scene.points[~known, :2], size=6.0),
        Points(
            panel="plan",
            thing="known",
            role="neutral",
            xy=scene.points[known, :2],
            size=11,
            marker="triangle",
        ),
        Points(panel="plan", thing="now", role="estimate", xy=scene.centres[1:, :2], size=9, marker="square"),
    ]
    for i in range(1, 4):
        x, y = scene.centres[i, :2]
        marks.append(
            Words(
                panel="plan", role="estimate", at=(float(x), float(y)), text=f"photo {i + 1}", anchor="left"
            )
        )
    if path:
        way = np.stack([s.centres[0, :2] for s in run.scenes])
        marks += [
            Line(panel="plan", thing="trace", role="muted", xy=way, width=1.4, dash="dot"),
            Points(panel="plan", thing="trace", role="muted", xy=way, size=4.0),
        ]
    x, y = scene.centres[0, :2]
    marks += [
        Points(panel="plan", thing="now", role="first", xy=scene.centres[:1, :2], size=10, marker="square"),
        Words(
            panel="plan", thing="now", role="first", at=(float(x), float(y)), text="photo 1", anchor="left"
        ),
    ]
    if step and run.mine is not None:
        marks += _step_in_plan(scene, run.mine.scene)
    return marks


def _step_in_plan(scene: Scene, there: Scene) -> list[AnyMark]:
    ends = [np.stack([a[:2], b[:2]]) for a, b in zip(scene.centres, there.centres, strict=True)]
    ends += [np.stack([a[:2], b[:2]]) for a, b in zip(scene.points, there.points, strict=True)]
    return [Line(panel="plan", thing="step", role="third", xy=way, width=1.8, arrow=True, answer=True)
            for way in ends if float(np.hypot(*(way[1] - way[0]))) > 0.02]  # fmt: skip


def jacobian_marks(run: Iteration) -> list[AnyMark]:
    """Draw which unknowns each observation depends on: photos blue, points orange; darker is stronger."""
    values, u = run.jacobian, run.problem.unknowns
    colours = np.where(np.arange(values.shape[1])[:, None] < u, PHOTOS_COLOUR, POINTS_COLOUR)
    return _matrix("jacobian", "jacobian", values, np.broadcast_to(colours, (*values.shape, 3)), (u,), ())


def normal_marks(run: Iteration) -> list[AnyMark]:
    """Draw the normal matrix: photos with photos, points with points, and what joins them."""
    values, u = run.normal, run.problem.unknowns
    photo = np.arange(len(values)) < u
    colours = np.where(photo[:, None, None] & photo[None, :, None], PHOTOS_COLOUR, BOTH_COLOUR)
    colours = np.where(~photo[:, None, None] & ~photo[None, :, None], POINTS_COLOUR, colours)
    return _matrix("normal", "normal", values, colours, (u,), (u,))


def schur_marks(run: Iteration) -> list[AnyMark]:
    """Draw the reduced matrix: what was there before blue, what came in with the points violet."""
    values, u = run.reduced, run.problem.unknowns
    before = np.abs(run.normal[:u, :u]) > 0
    colours = np.where(before[..., None], PHOTOS_COLOUR, BOTH_COLOUR)
    return _matrix("schur", "schur", values, colours, (), ())


def _matrix(panel: str, thing: str, values: Array, colours: Array, columns: tuple[int, ...], rows: tuple[int, ...]) -> list[AnyMark]:  # fmt: skip
    """Draw a matrix as a picture: an entry is as strong as its logarithm, against its diagonal or its column."""
    size = np.abs(values)
    largest = np.maximum(size.max(axis=0, keepdims=True), 1e-300)
    if values.shape[0] == values.shape[1]:
        root = np.sqrt(np.maximum(size.diagonal(), 1e-300))
        largest = np.outer(root, root)
    strength = np.where(
        size > 0, np.clip(1.0 + np.log10(np.maximum(size / largest, 1e-4)) / 4.0, 0.15, 1.0), 0.0
    )
    paper = np.array(PAPER, dtype=float)
    pixels = (paper + strength[..., None] * (colours - paper)).round().astype(np.uint8)
    height, width = values.shape
    scale = max(1, 480 // max(height, width))
    pixels = np.repeat(np.repeat(pixels, scale, axis=0), scale, axis=1)
    extent = (-0.5, -0.5, width - 0.5, height - 0.5)
    marks: list[AnyMark] = [Picture(panel=panel, thing=thing, pixels=pixels, extent=extent)]
    for x in columns:
        marks.append(
            Line(panel=panel, role="muted", xy=np.array([[x - 0.5, -1.0], [x - 0.5, height]]), width=1.2)
        )
    for y in rows:
        marks.append(
            Line(panel=panel, role="muted", xy=np.array([[-1.0, y - 0.5], [width, y - 0.5]]), width=1.2)
        )
    return marks


def step_marks(run: Iteration) -> list[AnyMark]:
    """Draw the cost after a step of every damping, the cost before it, and where your step stands."""
    curve = np.log10(np.maximum(run.curve, 1e-12))
    good = np.isfinite(curve)
    here = float(np.log10(max(run.cost, 1e-12)))
    marks: list[AnyMark] = [
        Line(panel="step", thing="now", role="estimate", dash="dash", width=1.4, label="before",
             xy=np.array([[POWERS[0], here], [POWERS[-1], here]])),
        Line(panel="step", thing="step", role="third", width=2.2, label="after", answer=True,
             xy=np.stack([POWERS, np.where(good, curve, 99.0)], axis=1)),
    ]  # fmt: skip
    if run.mine is not None:
        at = np.array([[run.params.damping, float(np.log10(max(run.mine.cost, 1e-12)))]])
        marks.append(
            Points(panel="step", thing="step", role="third", xy=at, marker="diamond", size=11, answer=True)
        )
    return marks


NAMES: Mapping[Method, tuple[str, Dash]] = {
    "levenberg-marquardt": ("Marquardt", "solid"),
    "gauss-newton": ("Gauss–Newton", "dash"),
    "powell": ("dogleg", "dot"),
}
"""Label and dash of every method."""
STEERS: Mapping[Method, str] = {
    "levenberg-marquardt": "λ", "gauss-newton": "step share", "powell": "radius",
}  # fmt: skip
"""What each method steers with."""


def trace_marks(run: Iteration) -> list[AnyMark]:
    """Draw the cost of every iteration by every method, and what the chosen one steers with; refused steps are crosses."""
    chosen, marks = run.params.method, []
    for method, (label, dash) in NAMES.items():
        mine = method == chosen
        records = run.solutions[method].iterations
        cost = np.array([[r.iteration, np.log10(max(r.cost, 1e-12))] for r in records])
        marks.append(
            Line(panel="trace", thing="trace" if mine else "others", role="estimate" if mine else "muted", xy=cost,
                 width=2.4 if mine else 1.2, dash=dash, label=label, answer=True)
        )  # fmt: skip
    records = run.solution.iterations
    cost = np.array([[r.iteration, np.log10(max(r.cost, 1e-12))] for r in records])
    steering = np.array([[r.iteration, np.log10(max(r.damping, 1e-15))] for r in records])
    accepted = np.array([r.accepted for r in records])
    return [
        *marks,
        Points(panel="trace", thing="trace", role="estimate", xy=cost[accepted], size=6.5, answer=True),
        Points(panel="trace", thing="refused", role="error", xy=cost[~accepted], size=11, marker="cross", answer=True),
        Line(panel="trace", thing="damping", role="neutral", dash="dashdot", xy=steering, width=1.4,
             label=STEERS[chosen], answer=True),
    ]  # fmt: skip


def handle_marks(run: Iteration, low: float, bottom: float) -> list[Handle]:
    """Return the handles: start of photo 1 in plan, damping of your step, iteration."""
    p = run.params
    x, y = CENTRES[0, :2]
    return [
        Handle(panel="plan", name="start", thing="start", label="Photo 1 at the start", role="first",
               at=(float(x) + p.start_x, float(y) + p.start_y), parameters=("start_x", "start_y"),
               move=lambda u, v: {"start_x": u - x, "start_y": v - y}, nudge=(0.1, 0.1)),
        Handle(panel="step", name="damping", thing="step", label="Damping of your step", role="third", freedom="x",
               at=(p.damping, low), parameters=("damping",), move=lambda u, _: {"damping": u}, nudge=(0.25, 0.0)),
        Handle(panel="trace", name="iteration", thing="trace", label="Iteration", role="estimate", freedom="x",
               at=(float(max(p.iteration, 0)), bottom), parameters=("iteration",),
               move=lambda u, _: {"iteration": max(u, 0.0)}, nudge=(1.0, 0.0)),
    ]  # fmt: skip
