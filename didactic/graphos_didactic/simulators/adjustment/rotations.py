"""Rotations: omega, phi, kappa against one turn about one axis; order, gimbal lock, and a photo that can be turned."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data.record import Array
from graphos_core.geometry.rotation import (
    angle_between,
    matrix_from_opk,
    matrix_from_turns,
    opk_from_matrix,
    quaternion_from_matrix,
    shortest_turn,
    turn_axes,
    turns_from_matrix,
    vector_from_matrix,
)
from graphos_didactic.scene import (
    AnyMark,
    Dash,
    Formula,
    Handle,
    Line,
    Matrix,
    Number,
    Panel,
    Picture,
    Points,
    Role,
    Scene,
    Sentence,
    Words,
)
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.rotations_model import (
    HEIGHT,
    MARKS,
    WIDTH,
    RotationsParams,
    TurnedPhoto,
    with_frame,
)
from graphos_didactic.simulators.adjustment.rotations_space import rings, space_handles, space_marks
from graphos_didactic.simulators.adjustment.rotations_tasks import PREDICTION, rotations_task
from graphos_didactic.simulators.observed_space import ground_lines, space_panel
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

TURNS: Mapping[str, tuple[str, str, Role, Dash]] = {
    "x": ("omega", "ω", "first", "solid"), "y": ("phi", "φ", "second", "dash"),
    "z": ("kappa", "κ", "third", "dot"),
}  # fmt: skip
"""Thing, sign, colour and dash of the turn about each axis."""
PARTS = np.linspace(0.0, 1.0, 61)
THINGS = {
    "omega": "turn ω about the x axis, and what it carries: the ring",
    "phi": "turn φ about the y axis, and what it carries: the ring",
    "kappa": "turn κ about the z axis, and what it carries: the photo's plane",
    "frame": "the photo and its axes: x right, y up, z backward",
    "truth": "the photo as it was really taken",
    "marks": "marks on the ground, and their images",
    "axis": "the one axis about which a single turn does it all",
    "way": "the photo on its shortest way from level to here",
    "ground": "the ground",
}
STEPS = (
    Step("First turn", "About an axis that stands still: the outer ring turns."),
    Step("Second turn", "About an axis that the first turn has carried along: the middle ring."),
    Step("Third turn", "About an axis that both have carried along: the photo in its own plane."),
    Step("One turn", "Any orientation can be reached by a single turn about a single axis (Euler)."),
    Step("On the way", "On that shortest way the three angles change unevenly, near gimbal lock wildly."),
)
PRESETS = (
    Preset("tilted", "Tilted aerial photo", "Three moderate turns: drag a tip of the axes.", {}),
    Preset("vertical", "Vertical photo", "ω and φ are zero, the photo looks straight down: order hardly matters.",
           {"omega": 0.0, "phi": 0.0, "kappa": 40.0}),
    Preset("terrestrial", "Terrestrial photo", "ω = 90°: the camera looks at the horizon.",
           {"omega": 90.0, "phi": 0.0, "kappa": 0.0, "orbit": -60.0}),
    Preset("reversed", "Reversed order", "The same angles as in the first situation, the turns the other way round.",
           {"order": "zyx"}),
    Preset("gimbal", "Gimbal lock", "φ = 90°: both outer rings lie in one plane, ω and κ turn about one axis.",
           {"omega": 30.0, "phi": 90.0, "kappa": 20.0, "orbit": -40.0}, "degenerate"),
    Preset("photo", "With a photo", "What the turned camera sees of a photo on the ground.",
           {"photo": True, "omega": 12.0, "phi": -10.0, "kappa": 20.0}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="rotations",
    title="Rotations",
    summary="Three turns or one: omega, phi, kappa, their order, gimbal lock, axis and quaternion.",
    first="Drag the tip of an axis of the photo; watch the three angles follow.",
    source="Kraus 2007, Photogrammetry, section 2.1.2; Diebel 2006, Representing attitude, sections 5, 6 and 8",
    engine=(
        matrix_from_turns, turns_from_matrix, turn_axes, shortest_turn, matrix_from_opk, opk_from_matrix,
        vector_from_matrix, quaternion_from_matrix, angle_between, pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=rotations_task,
    learn="adjustment/rotations",
    place=10,
)  # fmt: skip
def rotations(params: RotationsParams, setting: Setting) -> Scene:
    """Show the photo on its three rings, what it sees, the angles on the shortest way and the numbers."""
    last = len(STEPS) - 1 if setting.step is None else setting.step
    photo = TurnedPhoto(params, min(last + 1, 3))
    marks = [*space_marks(photo, last), *rings(photo, TURNS), *_seen(photo, setting)]
    if last >= 4:
        marks += _way(photo)
    marks += space_handles(photo, last)
    if last >= 2:
        marks += _mark_handle(photo)
    marks += _sheet(photo, last)
    return Scene(panels=_panels(photo), marks=tuple(marks), things=THINGS, says=_says(photo))


def _panels(photo: TurnedPhoto) -> tuple[Panel, ...]:
    order = " → ".join(TURNS[axis][1] for axis in photo.params.order)
    across, down = (-0.5, WIDTH - 0.5), (-0.5, HEIGHT - 0.5)
    return (
        space_panel(f"The photo on three rings · {order}", (0.0, 0.0, 0.47, 0.62), 200.0),
        Panel(name="photo", title="What it sees", rect=(0.47, 0.0, 0.53, 0.53), kind="picture", equal=True,
              y_down=True, x_range=across, y_range=down),
        Panel(name="way", title="Angles on the shortest way from level to here", rect=(0.0, 0.62, 0.47, 0.38),
              x_range=(0.0, 1.0), y_range=(-_tall(photo), _tall(photo)),
              x_label="part of the way", y_label="angle [°]", legend="top left"),
        Panel(name="numbers", title="Numbers", rect=(0.47, 0.53, 0.53, 0.47), kind="sheet"),
    )  # fmt: skip


def _tall(photo: TurnedPhoto) -> float:
    """Return the end of the axis of angles, degrees."""
    largest = float(np.abs(photo.on_the_way(PARTS)[1]).max())
    return next(high for high in (48.0, 95.0, 190.0) if largest < high)


def _seen(photo: TurnedPhoto, setting: Setting) -> list[AnyMark]:
    """Return the ground, the marks and the places where the marks really appeared."""
    marks: list[AnyMark] = []
    if photo.params.photo:
        picture, _ = photo_or_simulated(setting)
        right, down = np.array([1.0, 0, 0]), np.array([0, -1.0, 0])
        ground = Plane.centred(np.zeros(3), right, down, 5.2, picture)
        extent = (-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
        pixels = photograph(photo.camera, photo.rotation, photo.centre, ground, picture, columns=400)
        marks.append(Picture(panel="photo", thing="ground", extent=extent, pixels=pixels))
    else:
        grid = [photo.image(photo.rotation, line) for line in ground_lines(8.0, 1.0)]
        xy = np.concatenate([np.concatenate([line, np.full((1, 2), np.nan)]) for line in grid])
        marks.append(Line(panel="photo", thing="ground", role="muted", xy=xy, width=0.6))
    now, true = photo.image(photo.rotation, MARKS), photo.image(photo.true_rotation, MARKS)
    for i, (here, there) in enumerate(zip(now, true, strict=True)):
        if np.isfinite([here, there]).all():
            gap = np.stack([here, there])
            marks.append(Line(panel="photo", thing="marks", role="error", xy=gap, dash="dot", width=2.0))
        if _inside(there):
            marks.append(Points(panel="photo", thing="marks", role="truth", xy=there[None], marker="ring", size=22,
                                label="" if i else "true place of 1"))  # fmt: skip
        if _inside(here):
            marks.append(Points(panel="photo", thing="marks", role="estimate", xy=here[None], marker="cross",
                                size=13, label=f"{i + 1}"))  # fmt: skip
    if not any(_inside(here) for here in now):
        marks.append(Words(panel="photo", role="error", at=(WIDTH / 2, 80.0), anchor="centre",
                           text="no mark lies in the photo"))  # fmt: skip
    return marks


def _inside(xy: Array) -> bool:
    return bool(np.all((xy >= 0) & (xy <= (WIDTH - 1, HEIGHT - 1))))


def _mark_handle(photo: TurnedPhoto) -> list[AnyMark]:
    """Return the handle that pulls the image of mark 5: the photo follows by the smallest turn."""
    at = photo.image(photo.rotation, MARKS[4:])[0]
    if not np.isfinite(at).all():
        return []
    before = ray_from_pixel(photo.camera, at[None])[0]

    def pull(x: float, y: float) -> Mapping[str, float]:
        place = np.clip([[x, y]], -WIDTH, 2 * WIDTH)
        turn = shortest_turn(before, ray_from_pixel(photo.camera, place)[0])
        frame = photo.frame @ np.diag([1.0, -1.0, -1.0]) @ turn.T @ np.diag([1.0, -1.0, -1.0])
        return with_frame(photo.params, frame)

    return [Handle(panel="photo", name="mark", thing="marks", label="Image of mark 5", role="estimate",
                   at=(float(at[0]), float(at[1])), parameters=("omega", "phi", "kappa"), move=pull,
                   nudge=(10.0, 10.0))]  # fmt: skip


def _way(photo: TurnedPhoto) -> list[AnyMark]:
    _, angles = photo.on_the_way(PARTS)
    marks: list[AnyMark] = []
    for n, axis in enumerate(photo.params.order):
        thing, sign, role, dash = TURNS[axis]
        curve = np.stack([PARTS, angles[:, n]], axis=1)
        jumps = np.flatnonzero(np.abs(np.diff(angles[:, n])) > 180.0) + 1
        curve = np.insert(curve, jumps, np.nan, axis=0)
        marks.append(Line(panel="way", thing=thing, role=role, xy=curve, label=sign, dash=dash, width=2.2))
    part = photo.params.part
    marks += [
        Line(panel="way", thing="way", role="muted", xy=np.array([[part, -200.0], [part, 200.0]]), width=1.2),
        Handle(panel="way", name="part", thing="way", label="Part of the way", role="accent", freedom="x",
               at=(part, 0.0), parameters=("part",), nudge=(0.02, 0.0), move=lambda x, _: {"part": x}),
    ]  # fmt: skip
    return marks


def _sheet(photo: TurnedPhoto, last: int) -> list[AnyMark]:
    letters = {"x": r"\omega", "y": r"\varphi", "z": r"\kappa"}
    product = r"\;".join(rf"\mathbf{{R}}_{axis}({letters[axis]})" for axis in photo.params.order)
    rows = tuple(
        tuple(f"{round(value, 3) + 0.0:.3f}".replace("-", "−") for value in row) for row in photo.frame
    )
    marks: list[AnyMark] = [
        *(Number(thing=TURNS[axis][0], label=f"{TURNS[axis][1]} of this orientation", value=float(value), unit="°",
                 digits=1, role=TURNS[axis][2]) for axis, value in zip("xyz", photo.opk, strict=True)),
        Formula(thing="frame", tex=rf"\mathbf{{R}} = {product}"),
        Matrix(thing="frame", label="R =", rows=rows),
        Number(thing="phi", label="Axes apart (1: right angles, 0: lock)", value=photo.independence, unit=""),
    ]  # fmt: skip
    if last >= 3:
        axis, angle = photo.one_turn
        w, x, y, z = photo.quaternion
        shown = f"Axis ({axis[0]:.2f}, {axis[1]:.2f}, {axis[2]:.2f})"
        marks += [
            Number(thing="axis", label="One turn by", value=angle, unit="°", digits=1),
            Sentence(thing="axis", text=shown.replace("-", "−")),
            Sentence(thing="axis", text=f"Quaternion ({w:.3f}; {x:.3f}, {y:.3f}, {z:.3f})".replace("-", "−")),
            Number(thing="frame", label="From the reversed order", value=photo.reversed_turn, unit="°", digits=1,
                   answer=True),
        ]  # fmt: skip
    marks.append(Number(thing="truth", label="Error: one turn from the truth", value=photo.error, unit="°", digits=1,
                        role="error", truth=True,
            answer=True))  # fmt: skip
    return marks


def _says(photo: TurnedPhoto) -> str:
    if photo.independence < 0.02:
        total = photo.angles[0] + np.sign(photo.angles[1]) * photo.angles[2]
        signs = TURNS[photo.params.order[0]][1], TURNS[photo.params.order[2]][1]
        sign = "+" if photo.angles[1] > 0 else "−"
        return (
            f"Gimbal lock: {signs[0]} and {signs[1]} turn about the same axis; only {signs[0]} {sign} {signs[1]} = "
            f"{np.degrees(total):.0f}° counts."
        ).replace("-", "−")
    _, angle = photo.one_turn
    return (
        f"One turn by {angle:.1f}° does what the three turns do; in reverse order they end {photo.reversed_turn:.1f}° "
        "away."
    )
