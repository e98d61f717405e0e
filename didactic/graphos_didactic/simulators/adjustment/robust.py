"""Robust weights and RANSAC: nine rays to one point, any of which can be dragged away."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.robust import RobustFunction
from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.geometry.consensus import samples_needed
from graphos_core.geometry.intersection_precision import image_derivatives, intersection_precision
from graphos_core.geometry.rotation import look_at
from graphos_core.geometry.triangulation import ray_distances_px, triangulate
from graphos_didactic.scene import (
    AnyMark,
    Dash,
    Formula,
    Line,
    Number,
    Panel,
    Points,
    Polygon,
    Role,
    Scene,
    Sentence,
    Words,
)
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.robust_drawing import (
    FARTHEST,
    HIGHEST,
    function_marks,
    landscape_marks,
    photo_marks,
    vote_marks,
)
from graphos_didactic.simulators.adjustment.robust_handles import ENLARGED, handle_marks
from graphos_didactic.simulators.adjustment.robust_model import (
    CAMERA,
    CENTRES,
    DISTANCE,
    HEIGHT,
    REACH_MM,
    ROTATIONS,
    WIDTH,
    Bundle,
    aimed_at,
    mm,
)
from graphos_didactic.simulators.adjustment.robust_params import LESSON, MOST_DRAWS, RAYS, RobustParams
from graphos_didactic.simulators.adjustment.robust_tasks import PREDICTION, robust_task

THINGS = {
    **{f"ray_{k}": f"ray of photo {k}" for k in range(1, RAYS + 1)},
    "point": "the point: truth",
    "least_squares": "least squares: every ray counts in full",
    "robust": "robust estimate, and the way to it",
    "valley": "lines of equal cost: the estimate goes downhill",
    "samples": "samples of two rays: where they intersect, and how many rays agree",
    "best": "best sample so far",
    "needed": "how many draws are needed",
    "function": "the robust function",
}
STEPS = (
    Step("Rays", "Nine photos see one point. A blunder sends a ray past it."),
    Step("Least squares", "Every ray counts in full: the squares make the wrong one count most."),
    Step("Weights", "Residuals from there give first weights; the point is computed again."),
    Step("Again and again", "Residuals, weights, point: until nothing moves. It ends in the nearest valley."),
    Step("RANSAC", "The other way round: two rays give a point, all others vote for it or not."),
)
PRESETS = (
    Preset("one", "One wrong ray", "Huber limits its pull; the rest stays.", {}),
    Preset("squares", "Least squares", "One wrong ray pulls the point, and all residuals look bad.",
           {"function": "none"}),
    Preset("three", "Three wrong rays", "Each wrong in its own way: they do not agree on anything.",
           {"function": "cauchy", "scale": 2.0, "ray_2": -35.0, "ray_5": 30.0, "ray_7": 40.0}),
    Preset("valley", "Wrong valley", "Four rays agree on another point. Begin with the best sample instead.",
           {"function": "tukey", "scale": 5.0, "draws": 30, "ray_7": 0.0, **aimed_at(60.0, 40.0, (2, 3, 6, 8))}),
    Preset("majority", "Wrong majority", "Five of nine agree on another point: nothing helps any more.",
           {"function": "geman-mcclure", "scale": 4.0, "start": "ransac", "draws": 30, "ray_7": 0.0,
            **aimed_at(-70.0, -60.0, (2, 4, 5, 7, 8))}, "degenerate"),
    Preset("photo", "With a photo", "The measured place in photo 7: drag it over the picture.",
           {"photo": True, "shown": 7}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="robust",
    title="Robust weights and RANSAC",
    summary="How an adjustment resists wrong observations, and where it breaks down.",
    first="Drag the end of any ray: least squares follows it, the robust estimate does not.",
    source="Huber 1981, Robust Statistics; Fischler and Bolles 1981; Triggs et al. 2000, section 3",
    engine=(
        RobustFunction, triangulate, ray_distances_px, intersection_precision,
        image_derivatives, samples_needed, look_at, pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=robust_task,
    learn=LESSON,
    place=85,
)  # fmt: skip
def robust(params: RobustParams, setting: Setting) -> Scene:
    """Show the section, the valley of the cost round the point, the robust function, the votes and the numbers."""
    bundle = Bundle(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = []
    if last >= 2:
        marks += landscape_marks(bundle)
    marks += [*_rays(bundle), *_zoomed_rays(bundle, last)]
    if last >= 4:
        marks += vote_marks(bundle)
    if last >= 2:
        marks += [*function_marks(bundle, bundle.path[min(1, len(bundle.path) - 1) if last == 2 else -1])]
        marks += _path(bundle, last)
    if last >= 1:
        marks += _estimate(bundle, "least_squares")
    if last >= 3:
        marks += _estimate(bundle, "robust")
    if params.photo:
        marks += photo_marks(bundle, setting)
    marks += [*_truth(), *handle_marks(bundle), *_sheet(bundle)]
    return Scene(panels=_panels(params), marks=tuple(marks), things=THINGS, says=_says(bundle))


def _panels(params: RobustParams) -> tuple[Panel, ...]:
    part = 0.24
    panels = [
        Panel(name="section", title="Section · rays", rect=(0.0, 0.0, 0.30, 0.33), x_range=(-10.0, 10.0),
              y_range=(-1.5, 11.5), x_label="X [m]", y_label="Z [m]", equal=True),
        Panel(name="votes", title="RANSAC · votes of every sample", rect=(0.0, 0.33, 0.30, 0.29),
              x_range=(0.0, MOST_DRAWS + 1.0), y_range=(0.0, RAYS + 0.6), x_label="sample",
              y_label="rays that agree"),
        Panel(name="zoom", title="At the point · lines of equal cost", rect=(0.30, 0.0, 0.42, 0.62),
              x_range=(-REACH_MM, REACH_MM), y_range=(-REACH_MM, REACH_MM), x_label="X [mm]", y_label="Z [mm]",
              equal=True),
        Panel(name="rho", title="Cost ρ", rect=(0.0, 0.62, part, 0.38), x_range=(0.0, FARTHEST),
              y_range=(0.0, HIGHEST["rho"]), x_label="|v| [σ]", y_label="ρ"),
        Panel(name="psi", title="Pull ψ = w·v", rect=(part, 0.62, part, 0.38), x_range=(0.0, FARTHEST),
              y_range=(0.0, HIGHEST["psi"]), x_label="|v| [σ]", y_label="ψ [σ]"),
        Panel(name="weight", title="Weight w", rect=(2 * part, 0.62, part, 0.38), x_range=(0.0, FARTHEST),
              y_range=(0.0, HIGHEST["weight"]), x_label="|v| [σ]", y_label="w"),
        Panel(name="numbers", title="Numbers", rect=(0.72, 0.0, 0.28, 0.66 if params.photo else 1.0),
              kind="sheet"),
    ]  # fmt: skip
    if params.photo:
        panels.append(
            Panel(name="picture", title=f"Photo {params.shown} · error drawn {ENLARGED:.0f}×",
                  rect=(0.72, 0.66, 0.28, 0.34), kind="picture", x_range=(-0.5, WIDTH - 0.5),
                  y_range=(-0.5, HEIGHT - 0.5), equal=True, y_down=True)
        )  # fmt: skip
    return tuple(panels)


def _rays(bundle: Bundle) -> list[AnyMark]:
    marks: list[AnyMark] = [
        Line(panel="section", role="muted", width=1.0, xy=np.array([[-50.0, 0.0], [50.0, 0.0]])),
    ]
    edge = np.array([[-0.5, (HEIGHT - 1) / 2], [WIDTH - 0.5, (HEIGHT - 1) / 2]])
    directions = ray_from_pixel(CAMERA, bundle.pixels)
    for k in range(RAYS):
        role = _role(bundle, k)
        centre, way = CENTRES[k], directions[k] @ ROTATIONS[k]
        ray = np.stack([centre, centre + 1.12 * DISTANCE * way])[:, [0, 2]]
        frustum = np.concatenate([centre[None], centre + 0.8 * ray_from_pixel(CAMERA, edge) @ ROTATIONS[k]])
        at = centre[[0, 2]] * 1.09
        marks += [
            Line(panel="section", thing=f"ray_{k + 1}", role=role, xy=ray, dash=_dash(bundle, k), width=1.3),
            Polygon(panel="section", thing=f"ray_{k + 1}", role=role, xy=frustum[:, [0, 2]], fill=0.25, width=1.0),
            Words(panel="section", thing=f"ray_{k + 1}", role=role, at=(float(at[0]), float(at[1])), text=str(k + 1),
                  anchor="centre"),
        ]  # fmt: skip
    return marks


def _role(bundle: Bundle, k: int) -> Role:
    return "neutral" if bundle.good[k] else "second"


def _dash(bundle: Bundle, k: int) -> Dash:
    return "solid" if bundle.good[k] else "dash"


def _zoomed_rays(bundle: Bundle, last: int) -> list[AnyMark]:
    """Draw each ray near the point, as wide as its weight."""
    marks: list[AnyMark] = []
    weights = bundle.robust.weights if last >= 3 else np.ones(RAYS)
    heaviest = max(float(weights.max()), 1e-12)
    directions = ray_from_pixel(CAMERA, bundle.pixels)
    for k in range(RAYS):
        way = directions[k] @ ROTATIONS[k]
        near = CENTRES[k] + way * DISTANCE
        ends = mm(np.stack([near - 0.4 * way, near + 0.4 * way]))
        width = 0.7 + 1.5 * float(np.sqrt(weights[k] / heaviest))
        marks.append(Line(panel="zoom", thing=f"ray_{k + 1}", role=_role(bundle, k), xy=ends, width=width,
                          dash=_dash(bundle, k)))  # fmt: skip
    return marks


def _estimate(bundle: Bundle, thing: str) -> list[AnyMark]:
    """Mark one of the two estimates in the zoom."""
    robustly = thing == "robust"
    at = mm(bundle.robust.point if robustly else bundle.least_squares)
    role: Role = "estimate" if robustly else "error"
    place = (float(at[0]), float(at[1]))
    return [
        Points(panel="zoom", thing=thing, role=role, xy=at[None], marker="diamond" if robustly else "square", size=12,
               answer=robustly),
        Words(panel="zoom", thing=thing, role=role, at=place, text="robust" if robustly else "least squares",
              anchor="top" if robustly else "left", answer=robustly),
    ]  # fmt: skip


def _path(bundle: Bundle, last: int) -> list[AnyMark]:
    states = bundle.path[:2] if last == 2 else bundle.path
    way = mm(np.stack([state.point for state in states]))
    return [
        Line(panel="zoom", thing="robust", role="estimate", xy=way, width=2.2, answer=True),
        Points(panel="zoom", thing="robust", role="estimate", xy=way[1:], size=5.0, answer=True),
    ]


def _truth() -> list[AnyMark]:
    zero = np.zeros((1, 2))
    return [
        Points(
            panel="section",
            thing="point",
            role="truth",
            xy=zero,
            marker="cross",
            size=11,
            label="P",
            truth=True,
        ),
        Points(panel="zoom", thing="point", role="truth", xy=zero, marker="cross", size=13, truth=True),
        Words(
            panel="zoom", thing="point", role="truth", at=(0.0, 0.0), text="truth", anchor="right", truth=True
        ),
    ]


def _sheet(bundle: Bundle) -> list[AnyMark]:
    p, fit = bundle.params, bundle.robust
    off_squares = float(np.linalg.norm(mm(bundle.least_squares)))
    off = float(np.linalg.norm(mm(fit.point)))
    votes = int(bundle.votes[bundle.best])
    lost = [str(k + 1) for k in range(RAYS) if fit.weights[k] < 0.5 * fit.weights.max()]
    return [
        Sentence(text=f"Weights: {bundle.function.label}", heading=True, thing="function"),
        Formula(thing="function", tex=rf"s = v^2/\sigma^2 \qquad \rho(s) = {bundle.function.rho}"),
        Formula(thing="function", tex=rf"w(s) = \rho'(s) = {bundle.function.weight}"),
        Sentence(text=bundle.function.effect, role="muted", thing="function"),
        Number(thing="robust", label="Reweighted", value=len(bundle.path) - 1, unit="times", digits=0,
               role="estimate"),
        Number(thing="robust", label="Rays with half the weight or less", value=len(lost), unit=f"of {RAYS}", digits=0,
               role="estimate", answer=True),
        Number(thing="least_squares", label="Error of least squares", value=off_squares, unit="mm", digits=1,
               role="error", truth=True),
        Number(thing="robust", label="Error of robust estimate", value=off, unit="mm", digits=1, role="estimate",
               truth=True, answer=True),
        Sentence(text="Search by samples", heading=True, thing="samples"),
        Number(thing="best", label="Votes of the best sample", value=votes, unit=f"of {RAYS}", digits=0,
               role="third"),
        Number(thing="best", label="Error of RANSAC", value=float(np.linalg.norm(mm(bundle.sampled))), unit="mm",
               digits=1, role="third", truth=True),
        Formula(thing="needed", tex=r"n \geq \dfrac{\ln(1 - p)}{\ln(1 - w^s)}"),
        Formula(thing="needed", tex=_needed_formula(votes, p.confidence, bundle.needed)),
        Sentence(thing="needed", role="muted", text=_needed_sentence(bundle)),
    ]  # fmt: skip


def _needed_formula(votes: int, confidence: float, needed: float) -> str:
    right = f"{needed:.0f}" if np.isfinite(needed) else r"\infty"
    return (
        rf"n \geq \dfrac{{\ln(1 - {confidence:.3f})}}{{\ln(1 - ({votes}/{RAYS})^2)}} \;\rightarrow\; {right}"
    )


def _needed_sentence(bundle: Bundle) -> str:
    drawn = bundle.params.draws
    if drawn >= bundle.needed:
        return f"{drawn} samples are drawn: enough for this share of good rays."
    return (
        f"{drawn} samples are drawn: {bundle.needed - drawn:.0f} more are needed for this share of good rays."
    )


def _says(bundle: Bundle) -> str:
    wrong = int((~bundle.good).sum())
    off_squares, off = (float(np.linalg.norm(mm(x))) for x in (bundle.least_squares, bundle.robust.point))
    rays = f"{wrong} of {RAYS} rays {'is' if wrong == 1 else 'are'} wrong"
    plain = f"{rays}: least squares misses the point by {off_squares:.1f} mm"
    return (
        f"{plain}."
        if bundle.params.function == "none"
        else f"{plain}, {bundle.function.label} by {off:.1f} mm."
    )
