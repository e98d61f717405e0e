"""Coplanarity: base and two rays in one plane, the essential matrix by eight and by five points, its four solutions."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.geometry.eight_point import coplanarity as coplanarity_of_rays
from graphos_core.geometry.eight_point import decompose_essential, longuet_higgins
from graphos_core.geometry.epipolar import (
    epipolar_lines,
    essential_from_relative,
    fundamental_from_essential,
    line_distances,
)
from graphos_core.geometry.relative_orientation import depths, relative_orientation
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
from graphos_didactic.simulators.adjustment.coplanarity_model import (
    FOLDS,
    HEIGHT,
    WIDTH,
    TwoPhotos,
    errors_of_folds,
)
from graphos_didactic.simulators.adjustment.coplanarity_params import CoplanarityParams
from graphos_didactic.simulators.adjustment.coplanarity_space import (
    LOOKS,
    four_marks,
    space_handles,
    space_marks,
)
from graphos_didactic.simulators.adjustment.coplanarity_tasks import PREDICTION, coplanarity_task
from graphos_didactic.simulators.format_edges import line_in_format
from graphos_didactic.simulators.observed_space import space_panel
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

TALL = 12.0
"""End of the axis of errors, degrees."""
THINGS = {
    "camera_a": "camera A",
    "camera_b": "camera B",
    "base": "base: from one projection centre to the other",
    "ray_a": "ray of point 1 from camera A, and how camera B sees it: the epipolar line",
    "ray_b": "ray of point 1 from camera B, and its measurement in photo B",
    "plane": "plane of the base and the ray of A: coplanar rays lie in it",
    "gap": "gap between both rays of point 1",
    "points": "points on the wall, their images and intersections",
    "wall": "the folded wall",
    "eight": "eight points, linear (Longuet-Higgins)",
    "five": "five points and consensus, refined with all",
}
STEPS = (
    Step("Two rays", "Point 1 is measured in both photos: two rays that should meet."),
    Step("One plane", "They meet only if both rays and the base lie in one plane: the volume is zero."),
    Step(
        "Eight points", "The condition is linear in the nine elements of E: eight points give it up to scale."
    ),
    Step(
        "Five points",
        "E has only five unknowns; using that, five points suffice and a flat object does no harm.",
    ),
    Step("Four solutions", "E gives four rotations and bases; only one puts the points before both cameras."),
    Step("All depths", "How far off the base is for every depth of the object, by eight and by five points."),
)
PRESETS = (
    Preset("convergent", "Convergent pair", "Both solutions are good: the object has depth.", {}),
    Preset("normal", "Normal case", "Parallel axes, base along the rows.",
           {"base_y": 0.0, "base_z": 0.0, "turn": 0.0, "tilt": 0.0, "base_x": 1.5}),
    Preset("blunder", "Point 1 is wrong", "One mistake ruins the eight-point solution; consensus leaves it out.",
           {"off_x": 60.0, "off_y": 130.0}),
    Preset("flat", "Flat object", "All points in one plane: eight points have more than one solution.",
           {"fold": 0.0}, "degenerate"),
    Preset("no_base", "No base", "The camera was only turned: every direction of the base fits.",
           {"base_x": 0.0, "base_y": 0.0, "base_z": 0.0, "turn": -8.0}, "degenerate"),
    Preset("photo", "With a photo", "A photo on the folded wall, seen by both cameras.",
           {"photo": True, "fold": 1.5}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="coplanarity",
    title="Coplanarity and essential matrix",
    summary="How two photos orient each other: base and rays in one plane, eight or five points, four solutions.",
    first="Drag point 1 in photo B along its line, then off it: the rays part.",
    source="Longuet-Higgins 1981; Nistér 2004; Hartley and Zisserman 2004, sections 9.6 and 11.7.3",
    engine=(
        coplanarity_of_rays, longuet_higgins, decompose_essential, relative_orientation, depths,
        essential_from_relative, fundamental_from_essential, epipolar_lines, line_distances, angle_between,
        look_at, pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=coplanarity_task,
    learn="adjustment/coplanarity",
    place=30,
)  # fmt: skip
def coplanarity(params: CoplanarityParams, setting: Setting) -> Scene:
    """Show the pair in space, both photos, the four solutions, the errors for every depth, and the numbers."""
    pair = TwoPhotos(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks = [*space_marks(pair, last), *_photos(pair, setting, last)]
    if last >= 4:
        marks += four_marks(pair)
    if last >= 5:
        marks += _curves(pair)
    marks += [*space_handles(pair), *_handles(pair, last), *_sheet(pair, last)]
    return Scene(panels=_panels(pair), marks=tuple(marks), things=THINGS, says=_says(pair, last))


def _panels(pair: TwoPhotos) -> tuple[Panel, ...]:
    across, down = (-0.5, WIDTH - 0.5), (-0.5, HEIGHT - 0.5)
    return (
        space_panel("In space", (0.0, 0.0, 0.36, 0.44)),
        Panel(name="photo_a", title="Photo A", rect=(0.36, 0.0, 0.32, 0.44), x_range=across, y_range=down,
              kind="picture", equal=True, y_down=True),
        Panel(name="photo_b", title="Photo B", rect=(0.68, 0.0, 0.32, 0.44), x_range=across, y_range=down,
              kind="picture", equal=True, y_down=True),
        Panel(name="four", title="Four solutions, from above", rect=(0.0, 0.44, 0.36, 0.56), kind="picture",
              x_range=(-1.0, 3.0), y_range=(-3.0, 1.0), equal=True),
        Panel(name="folds", title="Every depth of the object", rect=(0.36, 0.44, 0.28, 0.56), x_range=(-0.1, 4.1),
              y_range=(0.0, TALL), x_label="depth of the object [m]", y_label="error of the base's direction [°]",
              legend="top right"),
        Panel(name="numbers", title="Numbers", rect=(0.64, 0.44, 0.36, 0.56), kind="sheet"),
    )  # fmt: skip


def _photos(pair: TwoPhotos, setting: Setting, last: int) -> list[AnyMark]:
    marks: list[AnyMark] = []
    if pair.params.photo:
        marks += _pictures(pair, setting)
    for i, (name, role, _) in enumerate(LOOKS):
        panel, pixels = f"photo_{name}", pair.pixels[i]
        if not pair.params.photo:
            wall = (pair.wall.outline() - pair.centres[i]) @ pair.rotations[i].T
            marks.append(
                Line(panel=panel, thing="wall", role="muted", xy=pixel_from_ray(pair.camera, wall), width=1.0)
            )
        if last >= 2:
            marks.append(Points(panel=panel, thing="points", role="neutral", xy=pixels[1:][pair.used[1:]], marker="plus",
                                size=8))  # fmt: skip
        marks.append(
            Points(
                panel=panel, thing=f"ray_{name}", role=role, xy=pixels[:1], marker="ring", size=16, label="1"
            )
        )
    if last >= 1 and pair.line is not None:
        ends = line_in_format(pair.line, pair.camera)
        if ends is not None:
            marks.append(Line(panel="photo_b", thing="ray_a", role="first", xy=ends, width=2.2))
        foot = pair.pixels[1, 0] - (pair.line[:2] @ pair.pixels[1, 0] + pair.line[2]) * pair.line[:2]
        gap = np.stack([pair.pixels[1, 0], foot])
        marks.append(Line(panel="photo_b", thing="gap", role="error", xy=gap, width=3.0))
    if last >= 1 and pair.line is None:
        marks.append(
            Words(
                panel="photo_b", role="error", at=(WIDTH / 2, 60.0), anchor="centre", text="no epipolar line"
            )
        )
    true = pair.true_pixels[1, :1]
    if np.isfinite(true).all():
        marks.append(
            Points(
                panel="photo_b", thing="ray_b", role="truth", xy=true, marker="diamond", size=8, truth=True
            )
        )
    return marks


def _pictures(pair: TwoPhotos, setting: Setting) -> list[AnyMark]:
    """Return what both cameras see of a photo on the two halves of the wall."""
    picture, _ = photo_or_simulated(setting)
    marks: list[AnyMark] = []
    for i, (name, _, _) in enumerate(LOOKS):
        seen = pair.wall.photographed(pair.camera, pair.rotations[i], pair.centres[i], picture, 300)
        marks.append(Picture(panel=f"photo_{name}", thing="wall", pixels=seen,
                             extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)))  # fmt: skip
    return marks


def _curves(pair: TwoPhotos) -> list[AnyMark]:
    errors, depth = errors_of_folds(pair.params), pair.params.fold
    marks: list[AnyMark] = [
        Line(panel="folds", thing="eight", role="second", label="8 points, linear", dash="dash", width=2.2,
             xy=np.stack([FOLDS, errors[:, 0]], axis=1), answer=True),
        Line(panel="folds", thing="five", role="first", label="5 points", width=2.2,
             xy=np.stack([FOLDS, errors[:, 1]], axis=1), answer=True),
        Line(panel="folds", thing="wall", role="muted", dash="dot", xy=np.array([[depth, 0.0], [depth, TALL]])),
    ]  # fmt: skip
    for thing, role, value in zip(("eight", "five"), ("second", "first"), _now(pair), strict=True):
        if np.isfinite(value):
            at = np.array([[depth, min(value, TALL)]])
            marks.append(Points(panel="folds", thing=thing, role="second" if role == "second" else "first", xy=at,
                                marker="diamond", size=11, answer=True))  # fmt: skip
    refused = FOLDS[~np.isfinite(errors[:, 0])]
    if len(refused):
        marks.append(
            Words(
                panel="folds",
                role="second",
                at=(refused[0], 0.55 * TALL),
                text="8 points: refused",
                answer=True,
            )
        )
    return marks


def _now(pair: TwoPhotos) -> tuple[float, float]:
    return pair.errors(pair.by_eight)[0], pair.errors(pair.by_five)[0]


def _handles(pair: TwoPhotos, last: int) -> list[AnyMark]:
    place, p = pair.pixels[1, 0], pair.params
    marks: list[AnyMark] = []
    if np.isfinite(place).all():
        marks.append(
            Handle(panel="photo_b", name="point", thing="ray_b", label="Point 1 in photo B", role="second",
                   at=(float(place[0]), float(place[1])), parameters=("off_x", "off_y"), nudge=(5.0, 5.0),
                   move=lambda x, y: {"off_x": p.off_x + x - float(place[0]), "off_y": p.off_y + y - float(place[1])})
        )  # fmt: skip
    if last >= 5:
        marks.append(
            Handle(panel="folds", name="fold", thing="wall", label="Depth of the object", role="accent", freedom="x",
                   at=(p.fold, 0.68 * TALL), parameters=("fold",), nudge=(0.1, 0.0), move=lambda x, _: {"fold": x})
        )  # fmt: skip
    return marks


def _sheet(pair: TwoPhotos, last: int) -> list[AnyMark]:
    marks: list[AnyMark] = [Number(thing="base", label="Base", value=pair.base, unit="m")]
    if last >= 1:
        marks += [
            Formula(
                thing="plane",
                tex=r"\mathbf{b}\cdot(\mathbf{a}\times\mathbf{b}') = \mathbf{y}_B^T\,\mathbf{E}\,\mathbf{y}_A = 0",
            ),
            Number(
                thing="plane",
                label="Volume of base and rays",
                value=1e3 * pair.volume,
                unit="·10⁻³",
                truth=True,
            ),
            Number(
                thing="gap", label="Point 1 from its line", value=pair.miss, unit="px", role="error", digits=1
            ),
        ]
    if last >= 3:
        rows = tuple(
            tuple(f"{value + 0.0:.3f}".replace("-", "−") for value in np.round(row, 3))
            for row in pair.essential
        )
        marks.append(Matrix(thing="five", label="E =", rows=rows))
    if last >= 2:
        marks += _singular_values(pair, last)
    for thing, label, found in (("eight", "8 points", pair.by_eight), ("five", "5 points", pair.by_five))[
        : max(last - 1, 0)
    ]:
        base, turn = pair.errors(found)
        marks += [
            Number(thing=thing, label=f"Error of the base, {label}", value=base, unit="°", role="error", truth=True, answer=True),
            Number(thing=thing, label=f"Error of the rotation, {label}", value=turn, unit="°", role="error", truth=True,
                   answer=True),
        ]  # fmt: skip
    return marks


def _singular_values(pair: TwoPhotos, last: int) -> list[AnyMark]:
    marks: list[AnyMark] = []
    for thing, name, matrix in (
        ("eight", "8 points", pair.linear.linear),
        ("five", "5 points", pair.essential),
    )[: last - 1]:
        values = np.linalg.svd(matrix / max(float(np.linalg.norm(matrix)), 1e-12), compute_uv=False)
        shown = ", ".join(f"{value:.3f}" for value in values)
        marks.append(Sentence(thing=thing, text=f"σ of E, {name}: {shown}"))
    return marks


def _says(pair: TwoPhotos, last: int) -> str:
    if pair.base < 1e-9:
        return "Without a base any two rays to the same point are coplanar with anything: nothing can be found but the rotation."
    if last < 2:
        nearest = pair.nearest()
        if nearest is None:
            return "The rays of point 1 are parallel."
        gap = 1e3 * float(np.linalg.norm(nearest[1] - nearest[0]))
        return f"The rays of point 1 pass each other at {gap:.1f} mm; base {pair.base:.2f} m."
    eight, five = _now(pair)
    if pair.used.sum() < 8:
        return f"Only {int(pair.used.sum())} points lie in both photos."
    if not pair.linear:
        return f"Eight points fail: {pair.linear.reason}. Five points give the base within {five:.1f}°."
    if last == 2:
        return f"Eight points give the direction of the base within {eight:.1f}°."
    return f"The base is {eight:.1f}° off by eight points, {five:.1f}° by five; point 1 is {pair.miss:.1f} px from its line."
