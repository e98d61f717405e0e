"""Epipolar geometry: two cameras and a point, each of which can be dragged."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data.record import Array
from graphos_core.geometry.epipolar import (
    epipolar_curve,
    epipolar_lines,
    epipoles,
    fundamental_from_cameras,
    line_distances,
)
from graphos_core.geometry.rotation import look_at
from graphos_didactic.scene import (
    AnyMark,
    Formula,
    Line,
    Matrix,
    Number,
    Panel,
    Picture,
    Points,
    Polygon,
    Role,
    Scene,
    Sentence,
    Words,
)
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.features.epipolar_handles import handle_marks
from graphos_didactic.simulators.features.epipolar_model import (
    FAR,
    HEIGHT,
    NEAR,
    WALL_Y,
    WIDTH,
    EpipolarParams,
    TwoCameras,
)
from graphos_didactic.simulators.features.epipolar_space import space_marks
from graphos_didactic.simulators.features.epipolar_tasks import PREDICTION, epipolar_task
from graphos_didactic.simulators.format_edges import line_in_format
from graphos_didactic.simulators.observed_space import space_panel
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

WALL_WIDTH = 10.0
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
ROLES: tuple[Role, Role] = ("first", "second")
THINGS = {
    "camera_a": "camera A",
    "camera_b": "camera B",
    "point": "the point P and its true images",
    "ray": "the ray of camera A, and how camera B sees it: the epipolar line",
    "plane": "epipolar plane: both projection centres and the point",
    "epipole": "epipoles: where each camera sees the other",
    "measured": "measured partner in photo B, with its error",
    "pencil": "epipolar lines of other points: all meet in the epipole",
    "guess": "your guess",
    "wall": "the wall",
}
STEPS = (
    Step("Ray", "Photo A alone: the point lies somewhere on the ray, at an unknown depth."),
    Step("Line", "Camera B sees that ray as a line: the partner can lie only there."),
    Step("Plane", "Ray and both projection centres span the epipolar plane; it cuts each photo in a line."),
    Step("Epipoles", "All these planes contain the base, so all lines meet where the other camera is seen."),
)
PRESETS = (
    Preset("convergent", "Convergent", "Two cameras look at the same point from the side.", {}),
    Preset("normal", "Normal case", "Parallel axes, base along the rows: the lines are the rows.",
           {"a_x": -1.5, "b_x": 1.5, "a_y": -6.0, "b_y": -6.0, "b_z": 0.0, "a_turn": 0.0, "b_turn": 0.0}),
    Preset("forward", "Forward motion", "B stands before A: the epipole is in the photo, depth there is lost.",
           {"a_x": -0.3, "b_x": 0.1, "a_y": -8.0, "b_y": -4.5, "b_z": 0.1, "a_turn": 0.0, "b_turn": 0.0}),
    Preset("rotation", "Pure rotation", "No base: no plane, no line, no depth.",
           {"a_x": 0.0, "b_x": 0.0, "a_y": -6.0, "b_y": -6.0, "b_z": 0.0, "a_turn": 8.0, "b_turn": -8.0},
           "degenerate"),
    Preset("base_line", "Point on the base line", "P lies on the line through both cameras: every line is right.",
           {"a_x": -1.0, "a_y": -8.0, "b_x": 0.0, "b_y": -4.0, "b_z": 0.25, "p_x": 1.0, "p_y": 0.0,
            "p_z": 0.5, "a_turn": 8.0, "b_turn": 8.0}, "degenerate"),
    Preset("photo", "On a photo", "P lies on the wall: look for the same detail on the line in photo B.",
           {"p_x": 0.6, "p_y": WALL_Y, "p_z": 1.0, "photo": True}, "photo"),
)  # fmt: skip


@simulator(
    room="features",
    name="epipolar",
    title="Epipolar geometry",
    summary="Why the partner of a point lies on a line in the other photo, and when it does not.",
    first="Drag the point in photo B: it can only slide along the line. That is its depth.",
    source="Hartley and Zisserman 2004, Multiple View Geometry, chapter 9",
    engine=(
        fundamental_from_cameras, epipolar_lines, epipoles, epipolar_curve, line_distances, look_at,
        pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=epipolar_task,
    learn="features/epipolar",
)  # fmt: skip
def epipolar(params: EpipolarParams, setting: Setting) -> Scene:
    """Show the plan, the space, both photos with points, lines and epipoles, the depths and the numbers."""
    both = TwoCameras(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [*_photos(both, setting), *_plan(both), *space_marks(both, last), *_images(both)]
    if last >= 3:
        marks += _pencil(both)
    if last >= 2:
        marks += _plane(both)
    if last >= 1:
        marks += [*_line(both), *_depths(both)]
    marks += [*handle_marks(both), *_sheet(both)]
    return Scene(panels=_panels(both), marks=tuple(marks), things=THINGS, says=_says(both))


def _panels(both: TwoCameras) -> tuple[Panel, ...]:
    across, down = (-0.5, WIDTH - 0.5), (-0.5, HEIGHT - 0.5)
    curve = _curve(both)
    low, high = (float(curve[:, 1].min()), float(curve[:, 1].max())) if len(curve) > 1 else (0.0, 1.0)
    return (
        Panel(name="plan", title="Plan", rect=(0.0, 0.0, 0.27, 0.60), x_range=(-6.4, 6.4), y_range=(-9.6, 5.2),
              x_label="x [m]", y_label="y [m]", equal=True),
        Panel(name="photo_a", title="Photo A", rect=(0.27, 0.0, 0.365, 0.47), x_range=across, y_range=down,
              kind="picture", equal=True, y_down=True),
        Panel(name="photo_b", title="Photo B", rect=(0.635, 0.0, 0.365, 0.47), x_range=across, y_range=down,
              kind="picture", equal=True, y_down=True),
        space_panel("In space", (0.0, 0.60, 0.27, 0.40)),
        Panel(name="depths", title="Depth along the line", rect=(0.27, 0.47, 0.33, 0.53), x_range=(0.0, 20.0),
              y_range=(low - 20, high + 20), x_label="depth in camera A [m]", y_label="x in photo B [px]"),
        Panel(name="numbers", title="Numbers", rect=(0.60, 0.47, 0.40, 0.53), kind="sheet"),
    )  # fmt: skip


def _photos(both: TwoCameras, setting: Setting) -> list[AnyMark]:
    if not both.params.photo:
        return []
    picture, _ = photo_or_simulated(setting)
    wall = Plane.centred(
        np.array([0.0, WALL_Y, 0.0]), np.array([1.0, 0, 0]), np.array([0, 0, -1.0]), WALL_WIDTH, picture
    )
    extent = (-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
    return [
        Picture(panel=f"photo_{name}", extent=extent, thing="wall",
                pixels=photograph(both.camera, both.rotations[i], both.centres[i], wall, picture, columns=400))
        for i, name in enumerate("ab")
    ]  # fmt: skip


def _plan(both: TwoCameras) -> list[AnyMark]:
    wall = np.array([[-WALL_WIDTH / 2, WALL_Y], [WALL_WIDTH / 2, WALL_Y]])
    marks: list[AnyMark] = [
        Line(panel="plan", thing="wall", role="muted", xy=wall, width=4.0),
        Words(panel="plan", role="muted", at=(-WALL_WIDTH / 2, WALL_Y + 0.5), text="wall"),
    ]
    edge = np.array([[-0.5, (HEIGHT - 1) / 2], [WIDTH - 0.5, (HEIGHT - 1) / 2]])
    for i, name in enumerate("ab"):
        rays = ray_from_pixel(both.camera, edge) @ both.rotations[i]
        frustum = np.concatenate([both.centres[i][None], both.centres[i] + 1.6 * rays])[:, :2]
        marks.append(Polygon(panel="plan", thing=f"camera_{name}", role=ROLES[i], xy=frustum, fill=0.22,
                             dash="solid" if i == 0 else "dash"))  # fmt: skip
    if both.depth > 0:
        ray = np.stack([both.centres[0], both.on_ray(both.pixels[0], 30.0)])[:, :2]
        marks.append(Line(panel="plan", thing="ray", role="first", xy=ray, width=2.0))
    return marks


def _images(both: TwoCameras) -> list[AnyMark]:
    marks: list[AnyMark] = []
    if np.isfinite(both.pixels[0]).all():
        marks.append(Points(panel="photo_a", thing="point", role="first", xy=both.pixels[:1], marker="ring",
                            size=15, label="P"))  # fmt: skip
    if np.isfinite(both.pixels[1]).all():
        marks += [
            Points(panel="photo_b", thing="point", role="truth", xy=both.pixels[1:], marker="ring", size=15,
                   label="P", truth=True, answer=True),
            Points(panel="photo_b", thing="measured", role="error", xy=both.measured[None], marker="cross",
                   size=14, label="measured", answer=True),
        ]  # fmt: skip
    return marks


def _line(both: TwoCameras) -> list[AnyMark]:
    if both.line is None:
        return [_no_line(both)]
    ends = line_in_format(both.line, both.camera)
    if ends is None:
        return [Words(panel="photo_b", role="error", at=(WIDTH / 2, 60.0), anchor="centre", answer=True,
                      text="the line passes outside photo B")]  # fmt: skip
    foot = both.measured - (both.line[:2] @ both.measured + both.line[2]) * both.line[:2]
    return [
        Line(panel="photo_b", thing="ray", role="first", xy=ends, width=2.4, answer=True),
        Line(panel="photo_b", thing="measured", role="error", xy=np.stack([both.measured, foot]), dash="dot",
             width=2.0, answer=True),
    ]  # fmt: skip


def _no_line(both: TwoCameras) -> Words:
    text = "P on the base line: every line through the epipole" if both.on_base_line else "no base: no line"
    return Words(panel="photo_b", role="error", at=(WIDTH / 2, 60.0), anchor="centre", text=text, answer=True)


def _curve(both: TwoCameras) -> Array:
    """Return depth and x in photo B, (n, 2), of the drawn part of the ray that photo B shows."""
    if both.line is None or not np.isfinite(both.pixels[0]).all():
        return np.empty((0, 2))
    depths = np.geomspace(NEAR, FAR, 160)
    seen = both.images_of_depths(depths)
    inside = np.all((seen >= -0.5) & (seen <= (WIDTH - 0.5, HEIGHT - 0.5)), axis=1)
    return np.stack([depths[inside], seen[inside, 0]], axis=1)


def _depths(both: TwoCameras) -> list[AnyMark]:
    curve = _curve(both)
    if len(curve) < 2 or not np.isfinite(both.pixels[1]).all():
        return []
    here = np.array([[both.depth, both.pixels[1, 0]]])
    return [
        Line(panel="depths", thing="ray", role="first", xy=curve, width=2.2, answer=True),
        Points(panel="depths", thing="point", role="truth", xy=here, marker="diamond", size=10, answer=True),
    ]


def _plane(both: TwoCameras) -> list[AnyMark]:
    corners = np.stack([both.centres[0], both.centres[1], both.point])[:, :2]
    marks: list[AnyMark] = [
        Polygon(panel="plan", thing="plane", role="third", xy=corners, fill=0.12, width=1.2, dash="dashdot"),
    ]
    back = None
    if both.line is not None and np.isfinite(both.pixels[1]).all():
        back = line_in_format(epipolar_lines(both.fundamental, both.pixels[1:], into_a=True)[0], both.camera)
    if back is not None:
        marks.append(Line(panel="photo_a", thing="plane", role="third", xy=back, dash="dashdot", width=2.0))
    return marks


def _pencil(both: TwoCameras) -> list[AnyMark]:
    marks: list[AnyMark] = []
    for height in np.linspace(0.05, 0.95, 7) * HEIGHT:
        line = both.line_in_b(np.array([0.5 * WIDTH, height]))
        ends = line_in_format(line, both.camera) if line is not None else None
        if ends is not None:
            marks.append(Line(panel="photo_b", thing="pencil", role="third", xy=ends, width=1.0, dash="dash",
                              answer=True))  # fmt: skip
    for i, (name, epipole) in enumerate(zip("ab", both.epipoles, strict=True)):
        if epipole is not None and np.all((epipole > 0) & (epipole < (WIDTH, HEIGHT))):
            marks.append(Points(panel=f"photo_{name}", thing="epipole", role=ROLES[1 - i], xy=epipole[None],
                                marker="square", size=12, label=f"epipole {name.upper()}", answer=i == 1))  # fmt: skip
    return marks


def _sheet(both: TwoCameras) -> list[AnyMark]:
    scaled = both.fundamental / (np.abs(both.fundamental).max() or 1.0)
    rows = tuple(tuple(_power(float(value)) for value in row) for row in scaled)
    marks: list[AnyMark] = [
        Number(thing="camera_b", label="Base", value=both.base, unit="m"),
        Number(
            thing="point", label="Depth in camera A", value=both.depth, unit="m", truth=True, role="truth"
        ),
        Formula(tex=r"\mathbf{x}_B^T\;\mathbf{F}\;\mathbf{x}_A = 0", thing="ray"),
        Matrix(thing="plane", label="F =", rows=rows),
    ]
    for name, epipole in zip("AB", both.epipoles, strict=True):
        marks.append(Sentence(thing="epipole", text=_epipole_text(name, epipole), answer=name == "B"))
    marks.append(
        Number(thing="measured", label="Measured partner from line", value=both.miss, unit="px", digits=1,
               role="error", answer=True)
    )  # fmt: skip
    error = both.measured - both.pixels[1]
    if np.isfinite(error).all():
        marks += [
            Number(thing="measured", label=f"Error in {axis} (measured − true)", value=float(value), unit="px",
                   digits=1, role="error", truth=True, answer=True)
            for axis, value in zip("xy", error, strict=True)
        ]  # fmt: skip
    return marks


def _power(value: float) -> str:
    if abs(value) < 1e-12:
        return "0"
    exponent = int(np.floor(np.log10(abs(value))))
    text = (
        f"{value:.3f}"
        if exponent >= -2
        else f"{value / 10.0**exponent:.1f}·10{str(exponent).translate(RAISED)}"
    )
    return text.replace("-", "−")


def _epipole_text(name: str, epipole: Array | None) -> str:
    if epipole is None:
        return f"Epipole in {name}: none or at infinity"
    where = "in the photo" if np.all((epipole > 0) & (epipole < (WIDTH, HEIGHT))) else "outside"
    return f"Epipole in {name}: ({epipole[0]:.0f}, {epipole[1]:.0f}) px, {where}".replace("-", "−")


def _says(both: TwoCameras) -> str:
    if not both.fundamental.any():
        return "The base is 0 m: both photos show the same rays, so there is no line and no depth."
    if not np.isfinite(both.pixels).all():
        return "The point lies behind a camera."
    if both.on_base_line:
        return "The point lies on the base line: any line through the epipole would do, its depth is lost."
    slope = float(np.degrees(np.arctan2(-both.line[0], both.line[1]))) if both.line is not None else 0.0
    slope = (slope + 90.0) % 180.0 - 90.0
    return (
        f"Base {both.base:.2f} m: the partner of P lies on a line tilted by {slope:.0f}° in photo B; "
        f"the measured one is {both.miss:.1f} px beside it."
    ).replace("-", "−")
