"""Base and intersection angle: how two cameras' places decide how well a point is fixed."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data.record import Array
from graphos_core.geometry.intersection_precision import (
    error_ellipse,
    intersection_angle,
    intersection_precision,
    normal_case_sigma_z,
)
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.triangulation import triangulate
from graphos_didactic.scene import (
    AnyMark,
    Formula,
    Handle,
    Line,
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
from graphos_didactic.simulators.adjustment.intersection_model import (
    HEIGHT,
    REACH,
    WIDTH,
    IntersectionParams,
    Pair,
    sigmas_of_bases,
    with_base,
)
from graphos_didactic.simulators.adjustment.intersection_tasks import PREDICTION, intersection_task
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

RATIOS = np.linspace(0.02, 1.6, 64)
"""Base/height ratios of the curve."""
FAR = 1e3
"""An undetermined direction is drawn this long, m."""
THINGS = {
    "camera_a": "camera A and its rays",
    "camera_b": "camera B and its rays",
    "base": "base: distance of the two projection centres",
    "angle": "intersection angle of the two rays",
    "point": "the point: truth",
    "ellipse": "error ellipse from the engine's covariance, 95 %",
    "draws": "points intersected from noisy measurements",
    "sigma_x": "σ_X: across the rays",
    "sigma_z": "σ_Z: along the rays",
}
STEPS = (
    Step("Two rays", "Each camera sees the point along one ray; the rays meet in it."),
    Step("Noise", "A measurement is not exact: each ray could lie anywhere in a narrow wedge."),
    Step("Intersect", "Measured again and again, the rays meet in a cloud of points."),
    Step("Covariance", "The engine predicts that cloud without drawing it: the error ellipse."),
    Step("All bases", "The same covariance for every base gives the curve of σ_Z."),
)
PRESETS = (
    Preset("classic", "Normal case", "Parallel axes, base a third of the height.",
           {"aim": "down", "a_x": -1.6, "b_x": 1.6}),
    Preset("short", "Short base", "Two neighbouring frames of a video: the ellipse is a needle.",
           {"a_x": -0.3, "b_x": 0.3}),
    Preset("right_angle", "Right angle", "Rays at 90°: depth is as good as position.",
           {"a_x": -6.0, "b_x": 6.0, "a_z": 6.0, "b_z": 6.0}),
    Preset("no_base", "No base", "Both photos from one place: the depth is not determined at all.",
           {"a_x": 0.0, "b_x": 0.0}, "degenerate"),
    Preset("over", "Point on the base line", "Both cameras exactly above the point: two rays, one line.",
           {"a_x": 0.0, "b_x": 0.0, "a_z": 6.0, "b_z": 12.0}, "degenerate"),
    Preset("photo", "With photos", "What both cameras see of a photo that lies on the ground.",
           {"photo": True, "aim": "down", "a_x": -1.2, "b_x": 1.2, "a_z": 8.0, "b_z": 8.0}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="intersection",
    title="Base and intersection angle",
    summary="How the places of two cameras decide how precisely a point is known.",
    first="Drag camera B away from camera A and watch the ellipse shrink.",
    source="Kraus 2007, Photogrammetry, normal case; Luhmann et al. 2020, Close-Range Photogrammetry, chapter 4",
    engine=(
        intersection_precision, intersection_angle, normal_case_sigma_z, error_ellipse, triangulate, look_at,
        pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=intersection_task,
    learn="adjustment/intersection",
    place=40,
)  # fmt: skip
def intersection(params: IntersectionParams, setting: Setting) -> Scene:
    """Show a section through both cameras, the point's errors enlarged, the σ curve and the numbers."""
    pair = Pair(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = [*_rays(pair), *_base(pair)]
    if last >= 1:
        marks += _wedges(pair)
    if last >= 2:
        marks += _draws(pair)
    if last >= 3:
        marks += _ellipses(pair)
    if last >= 4:
        marks += _curve(pair)
    marks += [*_point(), *_handles(pair), *_sheet(pair)]
    if params.photo:
        marks += _photos(pair, setting)
    return Scene(panels=_panels(pair), marks=tuple(marks), things=THINGS, says=_says(pair))


def _panels(pair: Pair) -> tuple[Panel, ...]:
    spread = _spread(pair)
    top = max(float(pair.centres[:, 2].max()) + 1.6, 8.0)
    section = 0.60 if pair.params.photo else 1.0
    panels = [
        Panel(name="section", title=f"Section · errors drawn {pair.params.exaggeration}× too large",
              rect=(0.0, 0.0, 0.47, section), x_range=(-REACH - 0.6, REACH + 0.6), y_range=(-2.6, top),
              x_label="X [m]", y_label="Z [m]", equal=True),
        Panel(name="zoom", title="At the point", rect=(0.47, 0.0, 0.27, 0.56),
              x_range=(-spread, spread), y_range=(-spread, spread), x_label="X [mm]", y_label="Z [mm]",
              equal=True),
        Panel(name="numbers", title="Numbers", rect=(0.74, 0.0, 0.26, 0.56), kind="sheet"),
        Panel(name="curve", title="Every base", rect=(0.47, 0.56, 0.53, 0.44), x_range=(0.0, 1.6),
              y_range=(0.0, _curve_top(pair)), x_label="horizontal base / height", y_label="σ [mm]",
              legend="top right"),
    ]  # fmt: skip
    if pair.params.photo:
        for i, name in enumerate("AB"):
            panels.append(
                Panel(name=f"photo_{name.lower()}", title=f"Photo {name}", rect=(0.235 * i, 0.60, 0.235, 0.40),
                      kind="picture", x_range=(-0.5, WIDTH - 0.5), y_range=(-0.5, HEIGHT - 0.5), equal=True,
                      y_down=True)
            )  # fmt: skip
    return tuple(panels)


def _spread(pair: Pair) -> float:
    """Half the width of the zoom, mm: a round number, so that small changes do not rescale it."""
    largest = float(pair.precision.sigmas[0]) * 1e3 if pair.precision.determined else 100.0
    candidates = [m * 10.0**e for e in range(-2, 6) for m in (1, 2, 5)]
    return next((c for c in candidates if c >= 2.9 * largest), candidates[-1])


def _curve_top(pair: Pair) -> float:
    """Top of the curve's axis, mm: its value at a base of a fifth of the height."""
    return 1e3 * float(sigmas_of_bases(pair.params, np.array([0.18 * pair.height]))[0, 1])


def _rays(pair: Pair) -> list[AnyMark]:
    marks: list[AnyMark] = []
    for i, name in enumerate("ab"):
        role: Role = "first" if i == 0 else "second"
        centre = pair.centres[i, [0, 2]]
        marks += [
            Line(panel="section", thing=f"camera_{name}", role=role, xy=np.stack([centre, np.zeros(2)]),
                 dash="solid" if i == 0 else "dash", width=1.8),
            Polygon(panel="section", thing=f"camera_{name}", role=role, xy=_frustum(pair, i), fill=0.25),
        ]  # fmt: skip
        if not pair.in_photo[i]:
            marks.append(Words(panel="section", role="error", at=(centre[0], centre[1] - 2.0), anchor="centre",
                               text=f"point outside photo {name.upper()}"))  # fmt: skip
    return marks


def _frustum(pair: Pair, i: int) -> Array:
    """Return a camera seen from the side: projection centre and the edges of its format, by its own rays."""
    edge = np.array([[-0.5, (HEIGHT - 1) / 2], [WIDTH - 0.5, (HEIGHT - 1) / 2]])
    rays = ray_from_pixel(pair.camera, edge) @ pair.rotations[i]
    corners = pair.centres[i] + 1.3 * rays
    return np.concatenate([pair.centres[i][None], corners])[:, [0, 2]]


def _base(pair: Pair) -> list[AnyMark]:
    ends = pair.centres[:, [0, 2]]
    towards = [np.arctan2(z, x) for x, z in ends]
    arc = np.linspace(towards[0], towards[1], 24)
    bow = np.stack([np.cos(arc), np.sin(arc)], axis=1) * 2.2
    middle = ends.mean(axis=0)
    degrees = np.degrees(pair.angle)
    return [
        Line(panel="section", thing="base", role="neutral", xy=ends, dash="dashdot", width=1.2),
        Words(panel="section", thing="base", role="neutral", at=(middle[0], middle[1] + 0.55), anchor="centre",
              text=f"B = {pair.base:.2f} m"),
        Line(panel="section", thing="angle", role="third", xy=bow, width=1.6),
        Words(panel="section", thing="angle", role="third", anchor="left", text=f"{degrees:.1f}°",
              at=(float(bow[:, 0].max()) + 0.3, float(bow[np.argmax(bow[:, 0]), 1]))),
        Line(panel="section", role="muted", width=1.0, xy=np.array([[-50.0, 0.0], [50.0, 0.0]])),
        Words(panel="section", role="muted", at=(-REACH, -0.3), text="ground"),
    ]  # fmt: skip


def _wedges(pair: Pair) -> list[AnyMark]:
    """Show where each ray lies with 95 % probability, enlarged: by the camera's own rays."""
    marks: list[AnyMark] = []
    wide = 1.96 * pair.params.sigma_px * pair.params.exaggeration
    for i, name in enumerate("ab"):
        edges = pair.pixels[i] + np.array([[-wide, 0.0], [wide, 0.0]])
        rays = ray_from_pixel(pair.camera, edges) @ pair.rotations[i]
        far = pair.centres[i] + rays * 1.25 * float(np.linalg.norm(pair.centres[i]))
        wedge = np.concatenate([pair.centres[i][None], far])[:, [0, 2]]
        marks.append(Polygon(panel="section", thing=f"camera_{name}", role="first" if i == 0 else "second",
                             xy=wedge, fill=0.13, width=0.6, dash="dot"))  # fmt: skip
    return marks


def _draws(pair: Pair) -> list[AnyMark]:
    xz = pair.estimates[:, [0, 2]]
    if not len(xz):
        return []
    return [
        Points(panel="zoom", thing="draws", role="estimate", xy=xz * 1e3, size=4.5, answer=True),
        Points(panel="section", thing="draws", role="estimate", xy=xz * pair.params.exaggeration, size=3.5,
               answer=True),
    ]  # fmt: skip


def _ellipses(pair: Pair) -> list[AnyMark]:
    covariance = pair.precision.covariance[np.ix_([0, 2], [0, 2])]
    if np.isfinite(covariance).all():
        outline = error_ellipse(covariance)
    else:  # a strip along the direction that is not determined
        along = pair.precision.directions[0, [0, 2]]
        aside = np.array([-along[1], along[0]]) * 1.96 * float(pair.precision.sigmas[-1])
        outline = np.array(
            [-FAR * along - aside, -FAR * along + aside, FAR * along + aside, FAR * along - aside]
        )
    drawn = outline * pair.params.exaggeration
    return [
        Polygon(panel="zoom", thing="ellipse", role="third", xy=outline * 1e3, fill=0.12, width=2.0,
                answer=True),
        Polygon(panel="section", thing="ellipse", role="third", xy=drawn, fill=0.3, width=2.0, answer=True),
    ]  # fmt: skip


def _point() -> list[AnyMark]:
    zero = np.zeros((1, 2))
    return [
        Points(panel="section", thing="point", role="truth", xy=zero, marker="cross", size=11, label="P",
               truth=True),
        Points(panel="zoom", thing="point", role="truth", xy=zero, marker="cross", size=13, label="truth",
               truth=True),
    ]  # fmt: skip


def _curve(pair: Pair) -> list[AnyMark]:
    sigmas = 1e3 * sigmas_of_bases(pair.params, RATIOS * pair.height)
    ratio, here = pair.span / pair.height, pair.precision.sigma_xyz * 1e3
    marks: list[AnyMark] = [
        Line(panel="curve", thing="sigma_z", role="third", label="σ_Z, in depth", width=2.4, answer=True,
             xy=np.stack([RATIOS, sigmas[:, 1]], axis=1)),
        Line(panel="curve", thing="sigma_x", role="neutral", label="σ_X, across", dash="dash", answer=True,
             xy=np.stack([RATIOS, sigmas[:, 0]], axis=1)),
        Line(panel="curve", thing="base", role="muted", dash="dot", xy=np.array([[ratio, 0.0], [ratio, 1e6]])),
    ]  # fmt: skip
    if np.isfinite(here[2]):
        at = np.array([[ratio, here[2]]])
        marks.append(Points(panel="curve", thing="sigma_z", role="third", xy=at, marker="diamond", size=11,
                            answer=True))  # fmt: skip
    return marks


def _handles(pair: Pair) -> list[AnyMark]:
    p, height = pair.params, pair.height
    marks: list[AnyMark] = []
    for name, role, x, z in (("a", "first", p.a_x, p.a_z), ("b", "second", p.b_x, p.b_z)):
        marks.append(
            Handle(panel="section", name=f"camera_{name}", thing=f"camera_{name}", label=f"Camera {name.upper()}",
                   role="first" if role == "first" else "second", at=(x, z),
                   parameters=(f"{name}_x", f"{name}_z"),
                   move=lambda x, z, n=name: {f"{n}_x": x, f"{n}_z": z},  # type: ignore[misc]
                   nudge=(0.1, 0.1))
        )  # fmt: skip

    def base(ratio: float, _: float) -> dict[str, float]:
        sheet = with_base(p, max(ratio, 0.0) * height)
        return {"a_x": sheet.a_x, "b_x": sheet.b_x}

    ratio = pair.span / height
    marks.append(
        Handle(panel="curve", name="base", thing="base", label="Base", role="accent", freedom="x",
               at=(ratio, 0.06 * _curve_top(pair)), parameters=("a_x", "b_x"), move=base, nudge=(0.02, 0.0))
    )  # fmt: skip
    return marks


def _sheet(pair: Pair) -> list[AnyMark]:
    p, sigma = pair.params, pair.precision.sigma_xyz * 1e3
    book = normal_case_sigma_z(pair.height, pair.base, p.focal_px, p.sigma_px) * 1e3
    marks: list[AnyMark] = [
        Number(thing="base", label="Base B", value=pair.base, unit="m"),
        Number(thing="base", label="B / H", value=pair.base / pair.height, unit=""),
        Number(thing="angle", label="Intersection angle", value=float(np.degrees(pair.angle)), unit="°",
               role="third", digits=1),
        Number(thing="sigma_x", label="σ_X", value=float(sigma[0]), unit="mm", answer=True),
        Number(thing="sigma_z", label="σ_Z", value=float(sigma[2]), unit="mm", role="third", answer=True),
        Formula(thing="ellipse", tex=r"\mathbf{C} = \sigma^2\,(\mathbf{A}^T\mathbf{A})^{-1}", answer=True),
        Sentence(text="Rule of thumb for parallel axes", role="muted"),
        Formula(thing="sigma_z", tex=r"\sigma_Z \approx \sqrt{2}\cdot\dfrac{H}{B}\cdot\dfrac{H}{f}\cdot\sigma"),
        Formula(thing="sigma_z", answer=True, tex=_live_formula(pair, book)),
    ]  # fmt: skip
    if len(pair.estimates):
        first = pair.estimates[0] * 1e3
        marks += [
            Number(thing="draws", label="One error in X", value=float(first[0]), unit="mm", truth=True,
                   role="estimate", answer=True),
            Number(thing="draws", label="One error in Z", value=float(first[2]), unit="mm", truth=True,
                   role="estimate", answer=True),
        ]  # fmt: skip
    return marks


def _live_formula(pair: Pair, book: float) -> str:
    p = pair.params
    if not np.isfinite(book):
        return rf"= \sqrt{{2}}\cdot\dfrac{{{pair.height:.1f}}}{{0}}\cdots\;\rightarrow\;\infty"
    return (
        rf"= \sqrt{{2}}\cdot\dfrac{{{pair.height:.1f}}}{{{pair.base:.2f}}}\cdot"
        rf"\dfrac{{{pair.height:.1f}}}{{{p.focal_px:.0f}}}\cdot{p.sigma_px:.2f} = {book:.1f}\,\mathrm{{mm}}"
    )


def _photos(pair: Pair, setting: Setting) -> list[AnyMark]:
    picture, _ = photo_or_simulated(setting)
    ground = Plane.centred(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, -1.0, 0]), 9.0, picture)
    marks: list[AnyMark] = []
    for i, name in enumerate("ab"):
        seen = photograph(pair.camera, pair.rotations[i], pair.centres[i], ground, picture, columns=240)
        marks += [
            Picture(panel=f"photo_{name}", pixels=seen, extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)),
            Points(panel=f"photo_{name}", thing=f"camera_{name}", role="first" if i == 0 else "second",
                   xy=pair.pixels[i][None], marker="ring", size=16, label="P"),
        ]  # fmt: skip
    return marks


def _says(pair: Pair) -> str:
    sigma = pair.precision.sigma_xyz * 1e3
    angle = float(np.degrees(pair.angle))
    if not np.isfinite(sigma[2]):
        return f"Base {pair.base:.2f} m, angle {angle:.1f}°: the rays do not fix the depth."
    ratio = sigma[2] / sigma[0]
    return f"Base {pair.base:.2f} m, angle {angle:.1f}°: the depth is {ratio:.1f} times less certain than the position."
