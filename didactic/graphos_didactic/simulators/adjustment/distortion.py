"""Lens distortion: a grid and profiles that can be pulled, Gaussian and balanced, for every camera model."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.cameras.chain import without_distortion
from graphos_core.cameras.profile import (
    balanced_profile,
    decentring_profile,
    distortion_grid,
    largest_effects,
    radial_profile,
)
from graphos_core.data.record import Array
from graphos_didactic.scene import (
    AnyMark,
    Formula,
    Line,
    Number,
    Panel,
    Picture,
    Points,
    Scene,
    Sentence,
    Words,
)
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.distortion_handles import drawn, handle_marks
from graphos_didactic.simulators.adjustment.distortion_model import CORNER, GROUPS, RADII, Lens
from graphos_didactic.simulators.adjustment.distortion_params import HEIGHT, WIDTH, DistortionParams
from graphos_didactic.simulators.adjustment.distortion_tasks import PREDICTION, distortion_task
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

ANGLES = np.radians(np.linspace(0.0, 100.0, 101))
"""Angles off the axis at which the projection is shown."""
TALL_PX = 4000.0
THINGS = {
    "ideal": "grid without distortion",
    "grid": "the grid as this lens images it",
    "truth": "the lens that is really there",
    "radial": "Gaussian radial distortion: f as it is",
    "balanced": "balanced radial distortion: a changed f takes part of it",
    "decentring": "decentring: largest sideways displacement",
    "zero": "radius at which the balanced distortion is zero",
    "effects": "largest displacement over the format by each term",
    "projection": "from the angle off the axis to the distance in the photo",
    "photo": "a photo through this lens",
}
STEPS = (
    Step("Ideal", "Without distortion straight lines stay straight: the image of a plane grid is a grid."),
    Step("Radial", "Points move towards the centre or away from it: barrel or cushion."),
    Step("Decentring", "A lens element off the axis: points on one side move more than on the other."),
    Step("Affinity", "Pixels that are not square and axes not at right angles: rare in digital cameras."),
    Step("Profiles", "The radial part as a curve: with f as it is, and balanced by another f."),
)
PRESETS = (
    Preset("barrel", "Barrel", "A normal lens: radial terms, a little decentring.", {}),
    Preset("cushion", "Cushion", "A long lens: points move outwards.",
           {"k1": 0.12, "k2": 0.02, "p1": 0.0, "p2": 0.0, "b1": 0.0, "b2": 0.0}),
    Preset("decentring", "Decentring only", "The grid leans to one side; a shift of the distortion centre does much the same.",
           {"k1": 0.0, "k2": 0.0, "p1": 0.008, "p2": -0.003, "b1": 0.0, "b2": 0.0}),
    Preset("fisheye", "Fish-eye", "Equisolid-angle projection: more than 180° on one sensor.",
           {"model": "fisheye_equisolid", "focal_px": 1000.0, "k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0, "b1": 0.0, "b2": 0.0}),
    Preset("folded", "Polynomial folds", "Too strong a barrel: the polynomial turns back, two rays share one pixel.",
           {"k1": -0.5, "k2": 0.0, "p1": 0.0, "p2": 0.0, "b1": 0.0, "b2": 0.0, "focal_px": 2000.0, "exaggeration": 1},
           "degenerate"),
    Preset("photo", "With a photo", "A photo through this lens.",
           {"photo": True, "exaggeration": 1, "k1": -0.3, "k2": 0.08}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="distortion",
    title="Lens distortion",
    summary="What each coefficient does to the grid and to the profile, and what f has to do with it.",
    first="Pull a corner of the grid, then the curve of the profile.",
    source="Brown 1971; Fraser 1997; Wester-Ebbinghaus 1981; Luhmann et al. 2020, Close-Range Photogrammetry, section 3.3",
    engine=(
        distortion_grid, radial_profile, balanced_profile, decentring_profile, largest_effects, without_distortion,
        pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=distortion_task,
    learn="adjustment/distortion",
    place=60,
)  # fmt: skip
def distortion(params: DistortionParams, setting: Setting) -> Scene:
    """Show the bent grid, the profiles, the share of each term, the projection and the numbers."""
    last = len(STEPS) - 1 if setting.step is None else setting.step
    lens = Lens(params, min(last + 1, len(GROUPS)))
    marks: list[AnyMark] = [*_grid(lens, setting), *_effects(lens), *_projection(lens)]
    if last >= 4:
        marks += _profiles(lens)
    marks += [*handle_marks(lens, last), *_sheet(lens, last)]
    return Scene(panels=_panels(lens, last), marks=tuple(marks), things=THINGS, says=_says(lens, last))


def _panels(lens: Lens, last: int) -> tuple[Panel, ...]:
    tall = _tall(lens) if last >= 4 else 100.0
    effects = lens.effects
    return (
        Panel(name="grid", title=_title(lens), kind="picture",
              rect=(0.0, 0.0, 0.56, 0.60), x_range=(-420.0, WIDTH + 420.0), y_range=(-320.0, HEIGHT + 320.0), equal=True,
              y_down=True),
        Panel(name="profile", title="Profiles", rect=(0.56, 0.0, 0.44, 0.52), x_range=(0.0, CORNER), y_range=(-tall, tall),
              x_label="distance from the principal point [px]", y_label="displacement [px]", legend="bottom left"),
        Panel(name="effects", title="Largest effect of each term", rect=(0.0, 0.60, 0.27, 0.40),
              x_range=(0.0, 1.12 * max([*effects.values(), 1.0])), y_range=(-0.95, max(len(effects), 3) - 0.5),
              x_label="px", y_down=True),
        Panel(name="projection", title="From angle to photo", rect=(0.27, 0.60, 0.29, 0.40), x_range=(0.0, 100.0),
              y_range=(0.0, TALL_PX), x_label="angle off the axis [°]", y_label="distance in the photo [px]",
              legend="bottom right"),
        Panel(name="numbers", title="Numbers", rect=(0.56, 0.52, 0.44, 0.48), kind="sheet"),
    )  # fmt: skip


def _title(lens: Lens) -> str:
    if lens.model.wide:
        return "Straight lines, as this lens images them"
    return f"Grid · distortion drawn {lens.times}× too large" if lens.times > 1 else "Grid"


def _tall(lens: Lens) -> float:
    """Return the end of the axis of displacements, px: a round number."""
    curves = [lens.gaussian.displacement_px, lens.balanced.displacement_px, lens.decentring.displacement_px]
    largest = max(float(np.nanmax(np.abs(curve))) for curve in curves)
    candidates = [m * 10.0**e for e in range(1, 5) for m in (1, 2, 5)]
    return next((c for c in candidates if c > 1.15 * largest), candidates[-1])


def _grid(lens: Lens, setting: Setting) -> list[AnyMark]:
    marks: list[AnyMark] = []
    if lens.params.photo:
        marks.append(_picture(lens, setting))
    ideal, shown = lens.grid.ideal_px, drawn(lens)
    marks += [
        Line(panel="grid", thing="ideal", role="muted", xy=_lines(ideal), width=0.7),
        Line(panel="grid", thing="grid", role="first", xy=_lines(shown), width=1.8),
    ]
    if not lens.model.wide:
        bent = ideal + lens.times * (lens.true_grid.measured_px - ideal)
        marks.append(
            Points(
                panel="grid",
                thing="truth",
                role="truth",
                xy=bent[::3, ::3].reshape(-1, 2),
                marker="ring",
                size=9,
            )
        )
    return marks


def _lines(nodes: Array) -> Array:
    """Return rows and columns of nodes (r, c, 2) as one polyline, parts separated by a row of NaN."""
    gap = np.full((1, 2), np.nan)
    parts = [part for line in (*nodes, *nodes.transpose(1, 0, 2)) for part in (line, gap)]
    return np.concatenate(parts)


def _picture(lens: Lens, setting: Setting) -> AnyMark:
    picture, _ = photo_or_simulated(setting)
    width = WIDTH / lens.params.focal_px
    plane = Plane.centred(np.array([0.0, 0.0, 1.0]), np.eye(3)[0], np.eye(3)[1], width, picture)
    seen = photograph(lens.camera, np.eye(3), np.zeros(3), plane, picture, columns=240)
    return Picture(panel="grid", thing="photo", pixels=seen, extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5))


def _profiles(lens: Lens) -> list[AnyMark]:
    zero = np.array([[lens.params.zero_px, -1e5], [lens.params.zero_px, 1e5]])
    marks: list[AnyMark] = [
        Line(panel="profile", role="muted", xy=np.array([[0.0, 0.0], [CORNER, 0.0]]), width=1.0),
        Line(panel="profile", thing="zero", role="muted", xy=zero, width=1.0, dash="dot"),
    ]
    if not lens.model.wide:
        curve = np.stack([RADII, radial_profile(lens.truth, radius_px=RADII).displacement_px], axis=1)
        marks.append(
            Points(
                panel="profile",
                thing="truth",
                role="truth",
                xy=curve[6::6],
                marker="ring",
                size=8,
                truth=True,
            )
        )
    rows = (("radial", "first", "solid", "Gaussian", lens.gaussian), ("balanced", "second", "dash", "balanced", lens.balanced),
            ("decentring", "third", "dot", "decentring", lens.decentring))  # fmt: skip
    for thing, role, dash, label, profile in rows:
        xy = np.stack([profile.radius_px, profile.displacement_px], axis=1)
        marks.append(Line(panel="profile", thing=thing, role=role, dash=dash, label=label, xy=xy, width=2.2))  # type: ignore[arg-type]
    return marks


def _effects(lens: Lens) -> list[AnyMark]:
    marks: list[AnyMark] = []
    for row, (name, effect) in enumerate(lens.effects.items()):
        symbol = name.translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))
        marks += [
            Line(
                panel="effects",
                thing="effects",
                role="first",
                xy=np.array([[0.0, row], [effect, row]]),
                width=5.0,
            ),
            Words(
                panel="effects",
                thing="effects",
                role="text",
                at=(0.0, row - 0.5),
                text=f"{symbol}  {effect:.1f} px",
            ),
        ]
    if not marks:
        marks.append(Words(panel="effects", role="muted", at=(0.0, 1.0), text="no distortion"))
    return marks


def _projection(lens: Lens) -> list[AnyMark]:
    angles = ANGLES if lens.model.wide else ANGLES[np.radians(75.0) > ANGLES]
    seen = lens.image_radius(lens.camera, angles)
    central = lens.params.focal_px * np.tan(ANGLES[np.radians(88.0) > ANGLES])
    edge = np.array([[0.0, CORNER], [100.0, CORNER]])
    return [
        Line(panel="projection", role="muted", xy=edge, width=1.0, dash="dashdot"),
        Words(panel="projection", role="muted", at=(50.0, CORNER + 170), anchor="centre", text="corner of the format"),
        Line(panel="projection", thing="ideal", role="neutral", label="f tan θ", dash="dash", width=1.6,
             xy=np.stack([np.degrees(ANGLES[: len(central)]), central], axis=1)),
        Line(panel="projection", thing="projection", role="first", label="this lens", width=2.2,
             xy=np.stack([np.degrees(angles), seen], axis=1)),
    ]  # fmt: skip


def _sheet(lens: Lens, last: int) -> list[AnyMark]:
    marks: list[AnyMark] = [
        Sentence(thing="grid", text=f"{lens.model.label}, {lens.model.direction}", heading=True)
    ]
    marks += [Formula(thing="grid", tex=part) for part in lens.model.formula.split(r",\quad ")[:2]]
    if last >= 4:
        left = lens.balanced.displacement_px
        marks += [
            Number(thing="radial", label="In the corner, Gaussian", value=float(lens.gaussian.displacement_px[-1]), unit="px",
                   digits=1),
            Number(thing="balanced", label="Largest left, balanced", value=float(np.nanmax(np.abs(left))), unit="px", digits=1),
            Number(thing="balanced", label="f, Gaussian", value=lens.params.focal_px, unit="px", digits=1),
            Number(thing="balanced", label="f, balanced", value=lens.balanced.focal_px, unit="px", digits=1),
        ]  # fmt: skip
    if not lens.model.wide:
        marks += [
            Number(thing="truth", label="From the real lens (RMS)", value=lens.rms_px, unit="px", digits=1, role="error",
                   truth=True, answer=True),
            Number(thing="truth", label="From the real lens, largest", value=float(lens.off_px.max()), unit="px", digits=1,
                   role="error", truth=True, answer=True),
        ]  # fmt: skip
    return marks


def _says(lens: Lens, last: int) -> str:
    inside = lens.gaussian.displacement_px
    steps = np.diff(lens.gaussian.radius_px + inside)
    if np.isfinite(steps).all() and (steps <= 0).any():
        radius = float(lens.gaussian.radius_px[int(np.argmax(steps <= 0))])
        return f"The polynomial turns back at {radius:.0f} px from the principal point: beyond, two rays share one pixel."
    if lens.model.wide:
        side = float(lens.image_radius(lens.camera, np.array([np.pi / 2]))[0])
        return (
            f"A ray 90° off the axis lies {side:.0f} px from the principal point; f tan θ has no image of it."
        )
    corner = f"{inside[-1]:.0f}".replace("-", "−")
    if last < 4:
        return f"{lens.model.label}: the corner moves by {corner} px towards or away from the middle."
    return (
        f"{lens.model.label}: the corner moves by {corner} px; with f = {lens.balanced.focal_px:.0f} px at most "
        f"{np.nanmax(np.abs(lens.balanced.displacement_px)):.0f} px is left to distortion."
    )
