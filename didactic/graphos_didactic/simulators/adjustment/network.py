"""Network for self-calibration: what tilt, roll and depth do to the camera's parameters."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.bundle.covariance import cofactors
from graphos_core.adjustment.bundle.problem import make_problem
from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.geometry.rotation import look_at
from graphos_core.simulation.model import theoretical_model
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Role, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.adjustment.network_drawing import (
    growth_marks,
    handle_marks,
    matrix_marks,
    photo_marks,
    plan_marks,
    section_marks,
    space_marks,
)
from graphos_didactic.simulators.adjustment.network_model import HEIGHT, WIDTH, Network
from graphos_didactic.simulators.adjustment.network_params import FEWEST, LESSON, MOST, NetworkParams
from graphos_didactic.simulators.adjustment.network_tasks import PREDICTION, network_task
from graphos_didactic.simulators.observed_space import space_panel

THINGS = {
    "upright": "photos taken upright",
    "rolled": "photos that are rolled",
    "targets": "targets, whose places are unknown",
    "known": "known targets: they give place, direction and scale",
    "photos": "number of photos",
    "f_z": "principal distance f, and the height Z of photo 1",
    "x0_phi": "principal point x₀, and the tilt φ of photo 1",
    "x0_p1": "principal point x₀, and the decentring distortion p₁",
    "correlations": "correlations: red positive, blue negative",
}
STEPS = (
    Step("Photos", "A ring of photos sees the field. Only three targets are known."),
    Step(
        "Correlations", "The engine's covariance: what can be exchanged for what, without a photo noticing."
    ),
    Step("More photos", "Rings with more photos of the same kind: standard deviations fall, but slowly."),
)
PRESETS = (
    Preset("upright", "Upright and steep", "f and Z imitate each other, x₀ and φ too.",
           {"tilt": 5.0, "roll": 0.0, "depth": 0.2}),
    Preset("convergent", "Convergent", "Tilted photos separate f from Z; x₀ and φ stay together.",
           {"tilt": 40.0, "roll": 0.0, "depth": 0.2}),
    Preset("rolled", "Convergent and rolled", "Roll separates the principal point from the tilts.",
           {"tilt": 40.0, "roll": 90.0, "depth": 0.2}),
    Preset("field", "Deep field", "Depth does what tilt does: a good test field has both.",
           {"tilt": 25.0, "roll": 90.0, "depth": 1.5, "photos": 8}),
    Preset("flat", "Parallel, flat", "A plane from straight above: f and Z cannot be told apart at all.",
           {"tilt": 0.0, "roll": 0.0, "depth": 0.0}, "degenerate"),
    Preset("photo", "With a photo", "What a rolled camera sees of a photo on the field.",
           {"tilt": 30.0, "roll": 90.0, "photo": True, "shown": 2}, "photo"),
)  # fmt: skip


@simulator(
    room="adjustment",
    name="network",
    title="Network for self-calibration",
    summary="Why a camera is calibrated with tilted and rolled photos of a deep field.",
    first="Drag the arrow of photo 2 in the plan: roll frees the principal point.",
    source="Fraser 1997, Digital camera self-calibration; Luhmann et al. 2020, chapter 7",
    engine=(
        adjust_block, make_problem, cofactors, theoretical_model, look_at, pixel_from_ray, ray_from_pixel,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=network_task,
    learn=LESSON,
    place=65,
)  # fmt: skip
def network(params: NetworkParams, setting: Setting) -> Scene:
    """Show the network in space, plan and section, the correlations, what each photo adds, and the numbers."""
    net = Network(params)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    top = _top(net)
    marks: list[AnyMark] = [*space_marks(net), *plan_marks(net), *section_marks(net)]
    if last >= 1:
        marks += matrix_marks(net)
    if last >= 2:
        marks += growth_marks(net, top)
    if params.photo:
        marks += photo_marks(net, setting)
    marks += [*handle_marks(net, top), *_sheet(net)]
    return Scene(panels=_panels(net, top), marks=tuple(marks), things=THINGS, says=_says(net))


def _top(net: Network) -> float:
    """Return the top of the curve's axis, px: a round number above the effects of the network."""
    drawn = [net.effects.get(name, 0.0) for name in ("focal_px", "x0", "p1")]
    goal = 2.2 * max((value for value in drawn if np.isfinite(value)), default=10.0)
    candidates = [m * 10.0**e for e in range(-2, 4) for m in (1, 2, 5)]
    return next((c for c in candidates if c >= goal), candidates[-1])


def _panels(net: Network, top: float) -> tuple[Panel, ...]:
    size = len(net.names) + 6
    panels = [
        space_panel("The network", (0.0, 0.0, 0.44, 0.55)),
        Panel(name="plan", title="From above", rect=(0.0, 0.55, 0.22, 0.45), x_range=(-4.2, 4.2),
              y_range=(-4.6, 4.6), x_label="X [m]", y_label="Y [m]", equal=True),
        Panel(name="section", title="From the side", rect=(0.22, 0.55, 0.22, 0.45), x_range=(-3.1, 5.1),
              y_range=(-1.0, 6.4), x_label="X [m]", y_label="Z [m]", equal=True),
        Panel(name="matrix", title="Correlations · camera and photo 1", rect=(0.44, 0.0, 0.30, 0.58), kind="picture",
              x_range=(-1.6, size - 0.4), y_range=(-1.6, size - 0.4), equal=True, y_down=True),
        Panel(name="growth", title="What photos add", rect=(0.44, 0.58, 0.30, 0.42),
              x_range=(FEWEST - 0.4, MOST + 0.4), y_range=(0.0, top), x_label="photos of the ring",
              y_label="1 σ at the corner [px]", legend="top right"),
        Panel(name="numbers", title="Numbers", rect=(0.74, 0.0, 0.26, 0.66 if net.params.photo else 1.0),
              kind="sheet"),
    ]  # fmt: skip
    if net.params.photo:
        shown = min(net.params.shown, net.params.photos)
        panels.append(Panel(name="picture", title=f"Photo {shown}", rect=(0.74, 0.66, 0.26, 0.34), kind="picture",
                            x_range=(-0.5, WIDTH - 0.5), y_range=(-0.5, HEIGHT - 0.5), equal=True, y_down=True))  # fmt: skip
    return tuple(panels)


def _sheet(net: Network) -> list[AnyMark]:
    pairs: list[tuple[str, Role, str, float]] = [
        ("f_z", "estimate", "ρ of f and Z", net.correlation("focal_px", 5)),
        ("x0_phi", "error", "ρ of x₀ and φ", net.correlation("x0", 1)),
        ("x0_p1", "third", "ρ of x₀ and p₁", net.correlation("x0", b="p1")),
    ]
    marks: list[AnyMark] = [
        Formula(thing="correlations", tex=r"\rho_{ij} = \dfrac{C_{ij}}{\sigma_i\,\sigma_j}"),
        Sentence(text="Correlations", heading=True),
        *(Number(thing=t, role=r, label=label, value=v, unit="", answer=True) for t, r, label, v in pairs
          if t != "x0_p1" or "p1" in net.names),
        Sentence(text="One standard deviation", heading=True),
    ]  # fmt: skip
    rows: list[tuple[str, str, str, Role]] = [
        ("focal_px", "f", "f_z", "estimate"), ("x0", "x₀", "x0_phi", "error"), ("y0", "y₀", "x0_phi", "error"),
    ]  # fmt: skip
    for name, symbol, thing, role in rows:
        marks.append(
            Number(
                thing=thing, role=role, label=f"σ of {symbol}", value=net.sigmas[name], unit="px", answer=True
            )
        )
    for name, symbol in (("k1", "k₁"), ("p1", "p₁")):
        if name in net.names:
            marks.append(Number(thing="x0_p1" if name == "p1" else "", role="third" if name == "p1" else "neutral",
                                label=f"1 σ of {symbol} at the corner", value=net.effects[name], unit="px", answer=True))  # fmt: skip
    marks.append(Sentence(text="This adjustment", heading=True))
    for name, symbol, thing, role in rows[:2]:
        marks.append(Number(thing=thing, role=role, label=f"Error of {symbol} (estimate − true)", value=net.error(name),
                            unit="px", truth=True, answer=True))  # fmt: skip
    marks.append(Number(label="Image points", value=len(net.model.obs_xy), unit="", digits=0))
    return marks


def _says(net: Network) -> str:
    if not np.isfinite(net.effects["focal_px"]):
        return "The photos do not determine the principal distance: with the distance of the camera it can grow freely."
    sigma, other = net.sigmas["focal_px"], net.correlation("focal_px", 5)
    return (
        f"Tilt {net.params.tilt:.0f}°, roll {net.params.roll:.0f}°, depth {net.params.depth:.1f} m: σ of f is "
        f"{sigma:.2f} px, of x₀ {net.sigmas['x0']:.2f} px; f and Z are correlated by {other:.2f}."
    ).replace("-", "−")
