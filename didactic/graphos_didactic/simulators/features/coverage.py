"""Coverage of the format: what it does to the calibration of the camera when points are only in a part of it."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.bundle.covariance import cofactors
from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.features.coverage import coverage
from graphos_core.features.detectors.sift import sift
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.features.coverage_drawing import (
    MOST,
    SYMBOLS,
    format_marks,
    growth_marks,
    handle_marks,
    image_marks,
    radius_marks,
)
from graphos_didactic.simulators.features.coverage_model import HALF_DIAGONAL, NAMES, RADII, Covered, even
from graphos_didactic.simulators.features.coverage_params import (
    HEIGHT,
    LESSON,
    WIDTH,
    CoverageSimulatorParams,
)
from graphos_didactic.simulators.features.coverage_tasks import PREDICTION, coverage_task

THINGS = {
    "points": "matched points of all four photos, one upon the other",
    "cells": "cells with at least one point",
    "hull": "convex hull of the points",
    "reach": "radius of the outermost point",
    "format": "the rings' share of the format",
    "even": "as many points, spread over the whole format",
    "image": "uncertainty of where the camera puts a given ray",
    "focal_px": "principal distance f",
    "x0": "principal point, x₀",
    "y0": "principal point, y₀",
    "k1": "radial distortion k₁",
    "k2": "radial distortion k₂",
}
STEPS = (
    Step("Points", "The matched points of all photos, laid upon each other on the format."),
    Step("Coverage", "Three measures: occupied cells, convex hull, share of the points in each ring."),
    Step(
        "Precision",
        "The engine's covariance: what these points say about the camera, and how little outside.",
    ),
    Step("Truth", "One calibration with noisy measurements: its true error grows where the points end."),
)
CORNERS = {
    "a_x": 14.0,
    "a_y": 16.0,
    "b_x": 86.0,
    "b_y": 16.0,
    "c_x": 14.0,
    "c_y": 84.0,
    "d_x": 86.0,
    "d_y": 84.0,
}
PRESETS = (
    Preset("middle", "In the middle", "All points in the middle: distortion is extrapolated to the corners.", {}),
    Preset("corners", "Four corners", "As many points, moved to the corners: all standard deviations fall.", CORNERS),
    Preset("even", "Whole format", "Spread over the whole format: the assistant is content.",
           {"a_x": 25.0, "a_y": 25.0, "b_x": 75.0, "b_y": 25.0, "c_x": 25.0, "c_y": 75.0, "d_x": 75.0, "d_y": 75.0,
            "spread": 55.0}),
    Preset("side", "One side", "Points on the left only: the hull is large enough to deceive, the principal point is not.",
           {"a_x": 14.0, "a_y": 16.0, "b_x": 40.0, "b_y": 36.0, "c_x": 14.0, "c_y": 84.0, "d_x": 40.0, "d_y": 64.0}),
    Preset("spot", "One spot", "All points at one place of the format: the camera is not determined at all.",
           {"a_x": 50.0, "a_y": 50.0, "b_x": 50.0, "b_y": 50.0, "c_x": 50.0, "c_y": 50.0, "d_x": 50.0, "d_y": 50.0,
            "spread": 1.0}, "degenerate"),
    Preset("photo", "On a photo", "Points are where the photo has features: drag a group to where there are none.",
           {**CORNERS, "spread": 24.0, "source": "photo"}, "photo"),
)  # fmt: skip


@simulator(
    room="features",
    name="coverage",
    title="Coverage of the format",
    summary="Why matched points must reach the corners: what they do not cover, the calibration extrapolates.",
    first="Drag the four groups of points into the corners and watch the bars fall.",
    source="González-Aguilera et al. 2018 (GRAPHOS); Luhmann et al. 2020, section 7.3",
    engine=(coverage, adjust_block, cofactors, sift, pixel_from_ray, ray_from_pixel),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=coverage_task,
    learn=LESSON,
    place=60,
)
def coverage_of_the_format(params: CoverageSimulatorParams, setting: Setting) -> Scene:
    """Show the points on the format, their radii, the standard deviations, and the uncertainty of the image."""
    seen = Covered(params, setting)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    marks: list[AnyMark] = format_marks(seen, last)
    if last >= 1:
        marks += radius_marks(seen)
    if last >= 2:
        marks += [*growth_marks(seen), *image_marks(seen, last)]
    marks += [*handle_marks(seen), *_sheet(seen, last)]
    return Scene(panels=_panels(seen), marks=tuple(marks), things=THINGS, says=_says(seen, last))


def _panels(seen: Covered) -> tuple[Panel, ...]:
    top = float(np.max([100 * seen.coverage.radial_share.max(), 100 * seen.coverage.radial_area.max()]))
    limit = 7.0 * float(even(seen.params.points, seen.params.sigma_px)[1][-1])
    return (
        Panel(name="format", title="Matched points of all photos on the format", rect=(0.0, 0.0, 0.50, 0.58),
              kind="picture", x_range=(-0.5, WIDTH - 0.5), y_range=(-0.5, HEIGHT - 0.5), equal=True, y_down=True),
        Panel(name="radii", title="By radius", rect=(0.0, 0.58, 0.25, 0.42), x_range=(0.0, HALF_DIAGONAL),
              y_range=(0.0, 1.45 * top), x_label="radius [px]", y_label="share [%]", legend="top left"),
        Panel(name="growth", title="σ by that of even coverage", rect=(0.25, 0.58, 0.25, 0.42), kind="picture",
              x_range=(-0.9, len(NAMES) - 0.4), y_range=(-1.3, MOST + 0.9), y_label="factor"),
        Panel(name="image", title="Uncertainty of the image", rect=(0.50, 0.0, 0.24, 1.0), x_range=(0.0, float(RADII[-1])),
              y_range=(0.0, limit), x_label="radius [px]", y_label="where a given ray is imaged [px]", legend="top left"),
        Panel(name="numbers", title="Numbers", rect=(0.74, 0.0, 0.26, 1.0), kind="sheet"),
    )  # fmt: skip


def _sheet(seen: Covered, last: int) -> list[AnyMark]:
    found = seen.coverage
    marks: list[AnyMark] = [
        Number(thing="points", label="Points of all photos", value=found.points, unit="", digits=0)
    ]
    if last >= 1:
        marks += [
            Number(thing="cells", label="Occupied cells", value=100 * found.occupied_share, unit="%", digits=0,
                   role="truth", answer=True),
            Number(thing="hull", label="Convex hull", value=100 * found.hull_share, unit="%", digits=0, role="second",
                   answer=True),
            Number(thing="reach", label="Outermost point", value=100 * found.reach, unit="% of the half diagonal",
                   digits=0, role="third"),
            Sentence(thing="cells", role="error" if found.alert else "truth", answer=True,
                     text=("⚠ " + found.advice) if found.alert else "✓ More than two thirds are covered."),
        ]  # fmt: skip
    if last < 2:
        return marks
    marks += [
        Sentence(text="One standard deviation", heading=True),
        Formula(
            thing="image",
            tex=r"\sigma_p = \sigma\,\sqrt{q_{pp}},\quad \mathbf{Q} = (\mathbf{A}^T\mathbf{A})^{-1}",
        ),
    ]
    for name, sigma in zip(NAMES, seen.sigmas, strict=True):
        small = name.startswith("k")
        marks.append(Number(thing=name, label=f"σ of {SYMBOLS[name]}", value=1e3 * sigma if small else sigma,
                            unit="· 10⁻³" if small else "px", answer=True,
                            role="error" if small else "estimate"))  # fmt: skip
    marks.append(Number(thing="image", label="σ of the image in the corner", value=float(seen.image_sigmas[-1]), unit="px",
                        role="accent", answer=True))  # fmt: skip
    if last >= 3:
        marks += [
            Sentence(text="Estimate − true", heading=True, truth=True, answer=True),
            Number(thing="focal_px", label="Error of f", value=seen.error("focal_px"), unit="px", role="truth", truth=True,
                   answer=True),
            Number(thing="x0", label="Error of x₀", value=seen.error("x0"), unit="px", role="truth", truth=True, answer=True),
            Number(thing="image", label="Error in the corner", value=float(seen.image_errors[-1]), unit="px", role="truth",
                   truth=True, answer=True),
        ]  # fmt: skip
    return marks


def _says(seen: Covered, last: int) -> str:
    found = seen.coverage
    shares = f"{100 * found.occupied_share:.0f} % of the cells, hull {100 * found.hull_share:.0f} %"
    if last < 2:
        return f"{found.points} matched points cover {shares} of the format."
    if not np.isfinite(seen.image_sigmas[-1]):
        return f"{found.points} points cover {shares} of the format: they do not determine the camera."
    return (
        f"{shares} of the format: in the corner the image is known to {seen.image_sigmas[-1]:.2f} px, with even coverage "
        f"to {even(seen.params.points, seen.params.sigma_px)[1][-1]:.2f} px."
    )
