"""Trifocal tensor: a point measured in two photos is transferred to the third, by lines and by the tensor."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data.record import Array
from graphos_core.geometry.dlt import compose_projection
from graphos_core.geometry.eight_point import longuet_higgins
from graphos_core.geometry.epipolar import (
    epipolar_lines,
    essential_from_relative,
    fundamental_from_essential,
    line_transfer,
    relative_orientation,
)
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.trifocal import (
    fundamentals,
    linear_trifocal,
    transfer_points,
    trifocal_from_projections,
)
from graphos_didactic.scene import (
    AnyMark,
    Dash,
    Formula,
    Handle,
    Line,
    Marker,
    Matrix,
    Number,
    Panel,
    Picture,
    Points,
    Role,
    Scene,
    Words,
)
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.trifocal_model import (
    HEIGHT,
    HEIGHTS,
    WALL_Y,
    WIDTH,
    ThreePhotos,
    TrifocalParams,
)
from graphos_didactic.simulators.adjustment.trifocal_space import plan_marks, space_marks, view_of
from graphos_didactic.simulators.adjustment.trifocal_tasks import PREDICTION, lines_in_c, trifocal_task
from graphos_didactic.simulators.format_edges import line_in_format
from graphos_didactic.simulators.observed_space import space_panel
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

TALL = 80.0
"""End of the axis of errors, px."""
LOOKS: tuple[tuple[str, Role, Dash], ...] = (
    ("a", "first", "solid"),
    ("b", "second", "dash"),
    ("c", "third", "dot"),
)
THINGS = {
    "camera_a": "camera A, its ray, and how the others see it: the epipolar line",
    "camera_b": "camera B, its ray, and how camera C sees it: the epipolar line",
    "camera_c": "camera C",
    "point": "the point P and its images",
    "plane": "trifocal plane: the plane of the three projection centres",
    "lines": "P in photo C by the intersection of two epipolar lines",
    "tensor": "P in photo C by the trifocal tensor",
    "across": "line in photo B across the epipolar line: what the tensor takes along",
    "height": "height of the point",
    "guess": "your mark",
    "wall": "the wall",
}
STEPS = (
    Step("Photo A", "Its ray is seen in photo C as a line: P lies on it."),
    Step("Photo B", "Its ray gives a second line: P lies where both meet, if they meet."),
    Step("Tensor", "The tensor takes a point of A and a line through the point of B to one point of C."),
    Step("Trifocal plane", "In the plane of the three centres both lines are one; only the tensor goes on."),
    Step("All heights", "The median error in photo C for every height of P, of many repeated measurements."),
)
PRESETS = (
    Preset("above", "Above the plane", "P lies above the plane of the three centres: the lines meet at an angle.", {}),
    Preset("high", "Camera C raised", "The trifocal plane tilts, the lines cross at a wide angle.", {"c_z": 1.6, "p_z": 0.4}),
    Preset("points", "Tensor from points", "Tensor and lines come from twenty points with errors.", {"source": "points"}),
    Preset("in_plane", "In the trifocal plane", "P lies in the plane of the three centres: both epipolar lines are one.",
           {"p_z": 0.0}, "degenerate"),
    Preset("on_line", "Centres on a line", "Three centres on one line: the lines of any point are one line.",
           {"a_x": -3.0, "a_y": -4.0, "b_x": 0.0, "b_y": -4.0, "c_x": 3.0, "c_y": -4.0}, "degenerate"),
    Preset("photo", "With a photo", "A photo on the wall behind the point.", {"photo": True, "c_z": 0.8}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="trifocal",
    title="Trifocal tensor",
    summary="What two photos tell about the third, and where epipolar lines fail but the tensor does not.",
    first="Drag the height of P through 0: the two lines in photo C fall together.",
    source="Hartley and Zisserman 2004, Multiple View Geometry, sections 15.1 and 15.3",
    engine=(
        trifocal_from_projections, transfer_points, linear_trifocal, fundamentals, line_transfer, longuet_higgins,
        compose_projection, essential_from_relative, relative_orientation, fundamental_from_essential,
        epipolar_lines, look_at, pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=trifocal_task,
    learn="adjustment/trifocal",
    place=50,
)  # fmt: skip
def trifocal(params: TrifocalParams, setting: Setting) -> Scene:
    """Show the plan, the space, three photos with lines and transfers, the errors of all heights and the numbers."""
    photos = ThreePhotos(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks = [
        *plan_marks(photos, last),
        *space_marks(photos, last),
        *_pictures(photos, setting),
        *_images(photos, last),
    ]
    if last >= 4:
        marks += _curves(photos)
    marks += [*_handles(photos, last), *_sheet(photos, last)]
    return Scene(panels=_panels(), marks=tuple(marks), things=THINGS, says=_says(photos, last))


def _panels() -> tuple[Panel, ...]:
    across, down = (-0.5, WIDTH - 0.5), (-0.5, HEIGHT - 0.5)
    photos = tuple(
        Panel(name=f"photo_{name}", title=f"Photo {name.upper()}", rect=rect, kind="picture", x_range=across,
              y_range=down, equal=True, y_down=True)
        for name, rect in (("a", (0.27, 0.0, 0.21, 0.36)), ("b", (0.48, 0.0, 0.21, 0.36)), ("c", (0.69, 0.0, 0.31, 0.36)))
    )  # fmt: skip
    return (
        Panel(name="plan", title="Plan", rect=(0.0, 0.0, 0.27, 0.58), x_range=(-5.2, 5.2), y_range=(-6.6, 6.6),
              x_label="x [m]", y_label="y [m]", equal=True),
        *photos,
        space_panel("In space", (0.0, 0.58, 0.27, 0.42)),
        Panel(name="heights", title="Every height of the point", rect=(0.27, 0.36, 0.37, 0.64), x_range=(-1.65, 1.65),
              y_range=(0.0, TALL), x_label="height of P [m]", y_label="median error in photo C [px]", legend="top right"),
        Panel(name="numbers", title="Numbers", rect=(0.64, 0.36, 0.36, 0.64), kind="sheet"),
    )  # fmt: skip


def _pictures(photos: ThreePhotos, setting: Setting) -> list[AnyMark]:
    if not photos.params.photo:
        return []
    picture, _ = photo_or_simulated(setting)
    wall = Plane.centred(
        np.array([0.0, WALL_Y, 0.0]), np.array([1.0, 0, 0]), np.array([0, 0, -1.0]), 9.0, picture
    )
    extent = (-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
    return [
        Picture(panel=f"photo_{name}", extent=extent, thing="wall",
                pixels=photograph(photos.camera, photos.rotations[i], photos.centres[i], wall, picture, columns=300))
        for i, (name, _, _) in enumerate(LOOKS)
    ]  # fmt: skip


def _images(photos: ThreePhotos, last: int) -> list[AnyMark]:
    marks: list[AnyMark] = []
    for i, (name, role, _) in enumerate(LOOKS[:2]):
        if i <= last and np.isfinite(photos.measured[i]).all():
            marks.append(Points(panel=f"photo_{name}", thing="point", role=role, xy=photos.measured[i][None],
                                marker="ring", size=15, label="P"))  # fmt: skip
    if last >= 1:
        marks += _line_in_b(photos, last)
    lines = lines_in_c(photos)
    for i, (name, role, dash) in enumerate(LOOKS[:2]):
        ends = line_in_format(lines[i], photos.camera) if i <= last and np.isfinite(lines[i]).all() else None
        if ends is not None:
            marks.append(
                Line(panel="photo_c", thing=f"camera_{name}", role=role, xy=ends, width=2.4, dash=dash)
            )
    if np.isfinite(photos.pixels[2]).all():
        marks.append(Points(panel="photo_c", thing="point", role="truth", xy=photos.pixels[2:], marker="ring", size=17,
                            label="P", truth=True, answer=True))  # fmt: skip
    looks: tuple[tuple[str, Role, Marker], ...] = (
        ("lines", "error", "cross"),
        ("tensor", "accent", "diamond"),
    )
    for k, ((thing, role, marker), xy) in enumerate(zip(looks, photos.found, strict=True)):
        if last >= k + 1 and np.isfinite(xy).all() and np.abs(xy).max() < 5000:
            marks.append(
                Points(
                    panel="photo_c", thing=thing, role=role, xy=xy[None], marker=marker, size=12, answer=True
                )
            )
    if not np.isfinite(lines).all():
        marks.append(
            Words(
                panel="photo_c", role="error", at=(WIDTH / 2, 60.0), anchor="centre", text="no epipolar line"
            )
        )
    return marks


def _line_in_b(photos: ThreePhotos, last: int) -> list[AnyMark]:
    """Return the epipolar line of A in photo B and, with the tensor, the line across it."""
    if not photos.into_b.any():
        return []
    matrix = fundamental_from_essential(photos.into_b, photos.camera, photos.camera)
    line = epipolar_lines(matrix, photos.measured[:1])[0]
    marks: list[AnyMark] = []
    ends = line_in_format(line, photos.camera) if np.isfinite(line).all() else None
    if ends is not None:
        marks.append(Line(panel="photo_b", thing="camera_a", role="first", xy=ends, width=2.0))
        if last >= 2:
            reach = 170.0 * np.stack([line[:2], -line[:2]])
            marks.append(Line(panel="photo_b", thing="across", role="accent", xy=photos.measured[1] + reach, width=2.4,
                              dash="dashdot"))  # fmt: skip
    return marks


def _curves(photos: ThreePhotos) -> list[AnyMark]:
    errors, here = photos.errors_of_heights(), photos.params.p_z
    marks: list[AnyMark] = [
        Line(panel="heights", thing="lines", role="error", label="two epipolar lines", dash="dash", width=2.2,
             xy=np.stack([HEIGHTS, errors[:, 0]], axis=1), answer=True),
        Line(panel="heights", thing="tensor", role="accent", label="trifocal tensor", width=2.4,
             xy=np.stack([HEIGHTS, errors[:, 1]], axis=1), answer=True),
        Line(panel="heights", thing="height", role="muted", dash="dot", xy=np.array([[here, 0.0], [here, TALL]])),
    ]  # fmt: skip
    height = photos.height_in_plane
    if abs(height) <= HEIGHTS[-1]:
        marks.append(Words(panel="heights", thing="plane", role="third", at=(height, 0.66 * TALL), anchor="right",
                           text="trifocal plane", answer=True))  # fmt: skip
    return marks


def _handles(photos: ThreePhotos, last: int) -> list[AnyMark]:
    p = photos.params
    marks: list[AnyMark] = [
        Handle(panel="plan", name=f"camera_{name}", thing=f"camera_{name}", label=f"Camera {name.upper()}", role=role,
               at=(float(photos.centres[i, 0]), float(photos.centres[i, 1])), parameters=(f"{name}_x", f"{name}_y"),
               nudge=(0.1, 0.1), move=lambda x, y, n=name: {f"{n}_x": x, f"{n}_y": y})  # type: ignore[misc]
        for i, (name, role, _) in enumerate(LOOKS)
    ]  # fmt: skip
    marks += [
        Handle(panel="plan", name="point", thing="point", label="Point P", role="truth", at=(p.p_x, p.p_y),
               parameters=("p_x", "p_y"), nudge=(0.1, 0.1), move=lambda x, y: {"p_x": x, "p_y": y}),
        view_of(photos).orbit_handle(),
    ]  # fmt: skip
    if last >= 4:
        marks.append(Handle(panel="heights", name="height", thing="height", label="Height of P", role="truth", freedom="x",
                            at=(p.p_z, 0.5 * TALL), parameters=("p_z",), nudge=(0.05, 0.0),
                            move=lambda x, _: {"p_z": x}))  # fmt: skip
    if p.guessing:
        marks.append(Handle(panel="photo_c", name="guess", thing="guess", label="Your mark", role="accent",
                            at=(p.guess_x, p.guess_y), parameters=("guess_x", "guess_y"), nudge=(4.0, 4.0),
                            move=lambda x, y: {"guess_x": x, "guess_y": y}))  # fmt: skip
    return marks


def _sheet(photos: ThreePhotos, last: int) -> list[AnyMark]:
    marks: list[AnyMark] = [
        Number(
            thing="plane", label="P above the trifocal plane", value=photos.above_plane, unit="m", truth=True
        ),
    ]
    if last >= 1:
        marks.append(
            Formula(
                thing="lines",
                tex=r"\mathbf{x}_C \sim (\mathbf{F}_{CA}\,\mathbf{x}_A)\times(\mathbf{F}_{CB}\,\mathbf{x}_B)",
            )
        )
    if last >= 2:
        marks.append(Formula(thing="tensor", tex=r"x_C^k = \sum_{i,j}\; x_A^i\; l_j\; T_i^{jk}"))
        for i, plate in enumerate(photos.tensor):
            marks.append(Matrix(thing="tensor", label=f"T{'₁₂₃'[i]} =", rows=_rows(plate)))
    by_lines, by_tensor = photos.errors
    if last >= 1:
        marks.append(Number(thing="lines", label="Error in C by lines", value=by_lines if by_lines < 1e5 else float("nan"),
                            unit="px", digits=1, role="error", truth=True, answer=True))  # fmt: skip
    if last >= 2:
        marks.append(Number(thing="tensor", label="Error in C by the tensor", value=by_tensor, unit="px", digits=1,
                            role="error", truth=True, answer=True))  # fmt: skip
    return marks


def _rows(plate: Array) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(f"{value + 0.0:.3f}".replace("-", "−") for value in row) for row in np.round(plate, 3))


def _says(photos: ThreePhotos, last: int) -> str:
    if not np.isfinite(photos.pixels).all():
        return "The point lies behind a camera."
    by_lines, by_tensor = photos.errors
    if last == 0:
        return f"Camera A sees P at ({photos.measured[0, 0]:.0f}, {photos.measured[0, 1]:.0f}) px: one line in photo C."
    if not photos.tensor.any():
        return "The tensor is not determined by these points."
    shown = f"{by_lines:.1f} px" if by_lines < 9999 else "beyond all measure"
    if last == 1:
        return f"Both lines meet {shown} from where P appears in photo C."
    side = "above" if photos.above_plane >= 0 else "below"
    where = f"P lies {abs(photos.above_plane):.2f} m {side} the trifocal plane"
    if photos.plane is None:
        where = "The centres lie on one line"
    return f"{where}: off in photo C by {shown} with lines, {by_tensor:.1f} px with the tensor."
