"""Collinearity and direct linear transformation: centre, image point and object point on one line; eleven parameters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.geometry.dlt import decompose_projection, direct_linear_transformation
from graphos_core.geometry.resection import space_resection
from graphos_core.geometry.rotation import angle_between, look_at
from graphos_didactic.scene import (
    AnyMark,
    Formula,
    Handle,
    Line,
    Matrix,
    Number,
    Panel,
    Picture,
    Points,
    Scene,
    Sentence,
    Words,
)
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.collinearity_model import (
    FOLDS,
    HEIGHT,
    WIDTH,
    X0,
    CollinearityParams,
    ControlPhoto,
    errors_of_folds,
)
from graphos_didactic.simulators.adjustment.collinearity_tasks import PREDICTION, collinearity_task
from graphos_didactic.simulators.observed_space import (
    Observer,
    format_corners,
    on_screen,
    pyramid,
    space_panel,
)
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

TALL = 1.2
"""End of the axis of errors, m."""
SCREEN = 1.1
"""The photo is drawn this far before its projection centre, m."""
THINGS = {
    "camera": "the camera where it really stands",
    "ray": "ray of point 1: projection centre, image point and object point",
    "points": "control points and their measured images",
    "residuals": "residuals of the DLT: projected − measured, drawn longer",
    "linear": "camera from the eleven parameters (DLT)",
    "resection": "camera from space resection, interior orientation known",
    "wall": "the folded wall that carries the control",
}
STEPS = (
    Step("One ray", "Projection centre, image point and object point lie on one straight line."),
    Step("Control", "Every point with known coordinates gives two such equations."),
    Step(
        "Eleven parameters",
        "Multiplied out, they are linear in eleven numbers: six points give them at once.",
    ),
    Step(
        "The camera", "The eleven numbers hold where the camera stood, how it was turned, and its interior."
    ),
    Step("Every depth", "How far off the camera is for every depth of the control."),
)
PRESETS = (
    Preset("deep", "Deep control", "The wall is folded: the eleven parameters are well determined.", {}),
    Preset("level", "Level camera", "The camera looks along Y: x = x₀ + f · (X − X₀) / (Y − Y₀).",
           {"aim": "ahead", "x": 0.4, "y": -1.0, "z": 0.2}),
    Preset("thin", "Thin control", "Residuals as small as ever, the camera far off: compare both rows of errors.",
           {"fold": 0.2}),
    Preset("flat", "Coplanar control", "All control in one plane: the DLT has no solution, resection has.",
           {"fold": 0.0}, "degenerate"),
    Preset("blunder", "One wrong point", "A mistake in point 1 spreads over all residuals.",
           {"off_x": 45.0, "off_y": -30.0, "exaggeration": 6}),
    Preset("photo", "With a photo", "A photo on the folded wall.", {"photo": True, "fold": 1.5}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="collinearity",
    title="Collinearity and DLT",
    summary="How a point gets into the photo, and how eleven numbers find the camera from control points.",
    first="Drag the camera: the ray of point 1 stays straight, its image moves.",
    source="Abdel-Aziz and Karara 1971; Kraus 2007, Photogrammetry, sections 2.1 and 4.3; Hartley and Zisserman 2004, 7.1",
    engine=(
        direct_linear_transformation, decompose_projection, space_resection, look_at, angle_between,
        pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=collinearity_task,
    learn="adjustment/collinearity",
    place=20,
)  # fmt: skip
def collinearity(params: CollinearityParams, setting: Setting) -> Scene:
    """Show the camera and its control, the photo with residuals, the errors for every depth, and the numbers."""
    photo = ControlPhoto(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks = [*_space(photo, last), *_photo(photo, setting, last)]
    if last >= 4:
        marks += _curves(photo)
    marks += [*_handles(photo, last), *_sheet(photo, last)]
    return Scene(panels=_panels(photo), marks=tuple(marks), things=THINGS, says=_says(photo, last))


def _panels(photo: ControlPhoto) -> tuple[Panel, ...]:
    across, down = (-0.5, WIDTH - 0.5), (-0.5, HEIGHT - 0.5)
    return (
        space_panel("In space", (0.0, 0.0, 0.44, 0.53)),
        Panel(name="photo", title=f"The photo · residuals {photo.params.exaggeration}× too long", kind="picture",
              rect=(0.44, 0.0, 0.56, 0.53), x_range=across, y_range=down, equal=True, y_down=True),
        Panel(name="folds", title="Every depth of the control", rect=(0.0, 0.53, 0.44, 0.47), x_range=(-0.1, 4.1),
              y_range=(0.0, TALL), x_label="depth of the control [m]", y_label="error of the centre [m]",
              legend="top right"),
        Panel(name="numbers", title="Numbers", rect=(0.44, 0.53, 0.56, 0.47), kind="sheet"),
    )  # fmt: skip


def _observer(photo: ControlPhoto) -> Observer:
    return Observer(np.array([0.2, 2.4, 0.0]), 13.0, photo.params.orbit, 28.0, 560.0)


def _space(photo: ControlPhoto, last: int) -> list[AnyMark]:
    view = _observer(photo)
    marks: list[AnyMark] = [
        Line(panel="space", thing="wall", role="muted", xy=view.seen(photo.wall.outline()), width=1.2)
    ]
    if last >= 1:
        marks.append(Points(panel="space", thing="points", role="neutral", xy=view.seen(photo.points[1:]), marker="plus",
                            size=7))  # fmt: skip
    marks += pyramid(
        view, photo.camera, photo.rotation, photo.centre, thing="camera", role="first", size=SCREEN, label="C"
    )
    line = np.stack([photo.centre, photo.points[0]])
    image = on_screen(photo.camera, photo.rotation, photo.centre, photo.true_pixels[:1], SCREEN)
    marks += [
        Line(panel="space", thing="ray", role="accent", xy=view.seen(line), width=2.2),
        Points(
            panel="space",
            thing="ray",
            role="accent",
            xy=view.seen(image),
            marker="diamond",
            size=10,
            label="p",
        ),
        Points(
            panel="space",
            thing="ray",
            role="truth",
            xy=view.seen(photo.points[:1]),
            marker="circle",
            size=10,
            label="1",
        ),
    ]
    if last >= 3:
        marks += _found(photo, view)
    return marks


def _found(photo: ControlPhoto, view: Observer) -> list[AnyMark]:
    """Return the cameras that were found, as outlines."""
    marks: list[AnyMark] = []
    if photo.decomposed:
        screen = on_screen(photo.camera, photo.decomposed.rotation, photo.decomposed.centre,
                           format_corners(photo.camera), SCREEN)  # fmt: skip
        edges = np.full((12, 3), np.nan)
        edges[0::3], edges[1::3] = photo.decomposed.centre, screen
        for xy in (np.concatenate([screen, screen[:1]]), edges):
            marks.append(
                Line(panel="space", thing="linear", role="second", xy=view.seen(xy), dash="dash", answer=True)
            )
    if photo.resection:
        marks.append(Points(panel="space", thing="resection", role="third", xy=view.seen(photo.resection.centre[None]),
                            marker="ring", size=15, answer=True))  # fmt: skip
    return marks


def _photo(photo: ControlPhoto, setting: Setting, last: int) -> list[AnyMark]:
    marks: list[AnyMark] = []
    if photo.params.photo:
        picture, _ = photo_or_simulated(setting)
        seen = photo.wall.photographed(photo.camera, photo.rotation, photo.centre, picture, 400)
        extent = (-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
        marks.append(Picture(panel="photo", thing="wall", pixels=seen, extent=extent))
    else:
        wall = pixel_from_ray(photo.camera, (photo.wall.outline() - photo.centre) @ photo.rotation.T)
        marks.append(Line(panel="photo", thing="wall", role="muted", xy=wall, width=1.0))
    middle = photo.camera.values[1:3]
    marks.append(
        Points(panel="photo", role="muted", xy=middle[None], marker="plus", size=12, label="principal point")
    )
    if last >= 1:
        marks.append(
            Points(
                panel="photo",
                thing="points",
                role="neutral",
                xy=photo.pixels[photo.used],
                marker="plus",
                size=9,
            )
        )
    if last >= 2 and photo.linear:
        start = photo.pixels[photo.used]
        ends = np.full((3 * len(start), 2), np.nan)
        ends[0::3], ends[1::3] = start, start + photo.params.exaggeration * photo.linear.residuals
        marks.append(Line(panel="photo", thing="residuals", role="error", xy=ends, width=2.4, answer=True))
    if np.isfinite(photo.true_pixels[0]).all():
        marks.append(Points(panel="photo", thing="ray", role="accent", xy=photo.true_pixels[:1], marker="diamond", size=10,
                            label="p", answer=True))  # fmt: skip
    if photo.used.sum() < 6:
        marks.append(Words(panel="photo", role="error", at=(WIDTH / 2, 60.0), anchor="centre",
                           text=f"only {int(photo.used.sum())} control points in the photo"))  # fmt: skip
    return marks


def _curves(photo: ControlPhoto) -> list[AnyMark]:
    errors, depth = errors_of_folds(photo.params), photo.params.fold
    linear, resection = photo.centre_errors
    marks: list[AnyMark] = [
        Line(panel="folds", thing="linear", role="second", label="DLT, 11 unknowns", dash="dash", width=2.2,
             xy=np.stack([FOLDS, errors[:, 0]], axis=1), answer=True),
        Line(panel="folds", thing="resection", role="third", label="resection, 6 unknowns", width=2.2,
             xy=np.stack([FOLDS, errors[:, 1]], axis=1), answer=True),
        Line(panel="folds", thing="wall", role="muted", dash="dot", xy=np.array([[depth, 0.0], [depth, TALL]])),
    ]  # fmt: skip
    if np.isfinite(linear):
        at = np.array([[depth, min(linear, TALL)]])
        marks.append(
            Points(
                panel="folds", thing="linear", role="second", xy=at, marker="diamond", size=11, answer=True
            )
        )
    if np.isfinite(resection):
        at = np.array([[depth, min(resection, TALL)]])
        marks.append(
            Points(
                panel="folds", thing="resection", role="third", xy=at, marker="square", size=9, answer=True
            )
        )
    return marks


def _handles(photo: ControlPhoto, last: int) -> list[AnyMark]:
    view, p = _observer(photo), photo.params
    at = view.seen(photo.centre[None])[0]

    def move(x: float, y: float) -> Mapping[str, float]:
        place = view.on_plane(photo.centre, np.array([0.0, 0.0, 1.0]), x, y)
        return {} if place is None else {"x": float(place[0]), "y": float(place[1])}

    marks: list[AnyMark] = [
        Handle(panel="space", name="camera", thing="camera", label="Camera", role="first", at=(float(at[0]), float(at[1])),
               parameters=("x", "y"), move=move, nudge=(4.0, 4.0)),
        view.orbit_handle(),
    ]  # fmt: skip
    place = photo.pixels[0]
    if last >= 1 and np.isfinite(place).all():
        marks.append(
            Handle(panel="photo", name="point", thing="points", label="Measured point 1", role="second", answer=True,
                   at=(float(place[0]), float(place[1])), parameters=("off_x", "off_y"), nudge=(5.0, 5.0),
                   move=lambda x, y: {"off_x": p.off_x + x - float(place[0]), "off_y": p.off_y + y - float(place[1])})
        )  # fmt: skip
    if last >= 4:
        marks.append(
            Handle(panel="folds", name="fold", thing="wall", label="Depth of the control", role="accent", freedom="x",
                   at=(p.fold, 0.62 * TALL), parameters=("fold",), nudge=(0.1, 0.0), move=lambda x, _: {"fold": x})
        )  # fmt: skip
    return marks


def _sheet(photo: ControlPhoto, last: int) -> list[AnyMark]:
    x, _, z = photo.in_camera[0]
    f, pixel = photo.params.focal_px, photo.true_pixels[0, 0]
    marks: list[AnyMark] = [
        Formula(thing="ray", tex=r"x = x_0 + f\,\dfrac{\mathbf{r}_1(\mathbf{X}-\mathbf{C})}{\mathbf{r}_3(\mathbf{X}-\mathbf{C})}"
                rf" = {X0:.1f} + {f:.0f}\cdot\dfrac{{{x:.2f}}}{{{z:.2f}}} = {pixel:.1f}\,\mathrm{{px}}", answer=True),
        Number(thing="ray", label="Depth of point 1", value=float(z), unit="m", truth=True),
    ]  # fmt: skip
    if last >= 2:
        marks += _eleven(photo)
    if last >= 3:
        linear, resection = photo.centre_errors
        marks += [
            *_interior(photo),
            Number(thing="linear", label="Error of the centre, DLT", value=1e3 * linear, unit="mm", digits=0, role="error",
                   truth=True, answer=True),
            Number(thing="linear", label="Error of the rotation, DLT", value=photo.turn_error, unit="°", role="error",
                   truth=True, answer=True),
            Number(thing="resection", label="Error of the centre, resection", value=1e3 * resection, unit="mm", digits=0,
                   role="error", truth=True, answer=True),
        ]  # fmt: skip
    return marks


def _eleven(photo: ControlPhoto) -> list[AnyMark]:
    if not photo.linear:
        return [Sentence(thing="linear", role="error", text=f"No DLT: {photo.linear.reason}.", answer=True)]
    values = [*photo.linear.coefficients.tolist(), 1.0]
    shown = [f"{value:.4f}" if i >= 8 else f"{value:.1f}" for i, value in enumerate(values)]
    rows = tuple(tuple(text.replace("-", "−") for text in shown[4 * i : 4 * i + 4]) for i in range(3))
    redundancy = 2 * int(photo.used.sum()) - 11
    return [
        Matrix(thing="linear", label="L =", rows=rows, answer=True),
        Number(thing="residuals", label=f"RMS residual, redundancy {redundancy}", value=photo.linear.rms_px, unit="px",
               answer=True),
    ]  # fmt: skip


def _interior(photo: ControlPhoto) -> list[AnyMark]:
    if not photo.decomposed:
        return []
    k, f = photo.decomposed.interior, photo.params.focal_px
    return [
        Number(thing="linear", label="f in x from DLT", value=float(k[0, 0]), unit="px", digits=0, answer=True),
        Number(thing="linear", label="f in y from DLT", value=float(k[1, 1]), unit="px", digits=0, answer=True),
        Number(thing="linear", label="Error of f in x", value=float(k[0, 0] - f), unit="px", digits=1, role="error",
               truth=True, answer=True),
    ]  # fmt: skip


def _says(photo: ControlPhoto, last: int) -> str:
    if last < 2:
        x, depth = photo.true_pixels[0, 0], photo.in_camera[0, 2]
        return f"Point 1 lies {depth:.2f} m before the camera and appears at x = {x:.1f} px.".replace(
            "-", "−"
        )
    linear, resection = photo.centre_errors
    if last == 2 and photo.linear:
        count = int(photo.used.sum())
        return f"{count} points leave residuals of {photo.linear.rms_px:.2f} px (RMS)."
    if not photo.linear:
        if np.isfinite(resection):
            return f"No DLT: {photo.linear.reason}; resection with known interior is {1e3 * resection:.0f} mm off."
        return f"No DLT: {photo.linear.reason}."
    return (
        f"RMS residual {photo.linear.rms_px:.2f} px; the DLT puts the camera {1e3 * linear:.0f} mm off, resection "
        f"{1e3 * resection:.0f} mm."
    )
