"""Pictures of the simulator of robust weights: valley of the cost, robust function, votes, photo."""

from __future__ import annotations

import contourpy
import numpy as np

from graphos_core.adjustment.bundle.robust import ROBUST
from graphos_core.cameras import ray_from_pixel
from graphos_core.data.record import Array
from graphos_didactic.scene import AnyMark, Bars, Line, Picture, Points, Role
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.adjustment.robust_model import (
    CAMERA,
    CENTRES,
    GRID,
    HEIGHT,
    ROTATIONS,
    WIDTH,
    Bundle,
    Fit,
    mm,
)
from graphos_didactic.simulators.adjustment.robust_params import RAYS
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

LEVELS = 9
"""Lines of equal cost."""
BESIDE_LABEL = 3.0
"""Residuals beyond this many σ get their ray's number."""
FARTHEST = 12.0
"""Largest residual in the pictures of the function, σ."""
HIGHEST = {"rho": 40.0, "psi": 10.0, "weight": 1.15}
"""Tops of the pictures of the function."""
CURVE = np.linspace(0.0, 1.2 * FARTHEST, 145)


def landscape_marks(bundle: Bundle) -> list[AnyMark]:
    """Draw lines of equal cost round the point; closer lines are steeper slopes."""
    cost = bundle.landscape
    low, high = float(cost.min()), float(cost.max())
    lines = contourpy.contour_generator(GRID, GRID, cost)
    marks: list[AnyMark] = []
    for part in (np.arange(LEVELS) + 0.3) / LEVELS:
        level = low + (high - low) * part**2
        pieces = [
            piece for found in lines.lines(level) for piece in (np.asarray(found), np.full((1, 2), np.nan))
        ]
        if pieces:
            marks.append(Line(panel="zoom", thing="valley", role="muted",
                              xy=np.concatenate(pieces[:-1]), width=0.7))  # fmt: skip
    return marks


def function_marks(bundle: Bundle, fit: Fit) -> list[AnyMark]:
    """Draw ρ, ψ and w of the chosen function beside those of least squares, and where the rays stand."""
    p = bundle.params
    found, plain = (f(CURVE**2, p.scale) for f in (bundle.function, ROBUST["none"]))
    marks: list[AnyMark] = []
    for panel, here, squares in (
        ("rho", found[0], plain[0]),
        ("psi", found[1] * CURVE, plain[1] * CURVE),
        ("weight", found[1], plain[1]),
    ):
        marks += [
            Line(panel=panel, thing="least_squares", role="error", dash="dash", width=1.2,
                 xy=np.stack([CURVE, squares], axis=1)),
            Line(panel=panel, thing="function", role="estimate", width=2.2, xy=np.stack([CURVE, here], axis=1)),
            Line(panel=panel, thing="function", role="muted", dash="dot", width=1.0,
                 xy=np.array([[p.scale, 0.0], [p.scale, 1e3]])),
        ]  # fmt: skip
    rho, _ = bundle.function((fit.residuals / p.sigma_px) ** 2, p.scale)
    for k in range(RAYS):
        size = float(abs(fit.residuals[k]) / p.sigma_px)
        heights = {"rho": float(rho[k]), "psi": float(fit.weights[k]) * size, "weight": float(fit.weights[k])}
        for panel, height in heights.items():
            marks.append(_standing(panel, k, size, height, bundle))
    return marks


def _standing(panel: str, k: int, size: float, height: float, bundle: Bundle) -> Points:
    """Mark a ray on the curve; a residual beyond the picture stands at its edge."""
    role: Role = "neutral" if bundle.good[k] else "second"
    label = str(k + 1) if size > BESIDE_LABEL else ""
    at = np.array([[min(size, 0.97 * FARTHEST), min(height, 0.97 * HIGHEST[panel])]])
    return Points(panel=panel, thing=f"ray_{k + 1}", role=role, xy=at, label=label, size=8.0, answer=True,
                  marker="circle" if bundle.good[k] else "triangle")  # fmt: skip


def vote_marks(bundle: Bundle) -> list[AnyMark]:
    """Draw the votes of every sample, and where the samples lie in the zoom."""
    votes, best = bundle.votes.astype(float), bundle.best
    edges = np.arange(len(votes) + 1) + 0.5
    mark = np.array([best + 0.5, best + 1.5])
    marks: list[AnyMark] = [
        Points(panel="zoom", thing="samples", role="third", xy=mm(bundle.sample_points), marker="plus", size=7.0),
        Points(panel="zoom", thing="best", role="third", xy=mm(bundle.sample_points[best])[None], marker="ring",
               size=15.0),
        Bars(panel="votes", thing="samples", role="third", edges=edges, heights=votes, fill=0.35),
        Bars(panel="votes", thing="best", role="third", edges=mark, heights=votes[best : best + 1], fill=0.9),
    ]  # fmt: skip
    for i in bundle.samples[best] + 1:
        marks.append(_vote_line(int(i), bundle))
    if np.isfinite(bundle.needed):
        marks.append(Line(panel="votes", thing="needed", role="accent", dash="dash", width=1.6,
                          xy=np.array([[bundle.needed, 0.0], [bundle.needed, 99.0]])))  # fmt: skip
    return marks


def _vote_line(ray: int, bundle: Bundle) -> Line:
    """Draw a ray of the best sample once more, in the colour of the samples."""
    way = ray_from_pixel(CAMERA, bundle.pixels[ray - 1 : ray])[0] @ ROTATIONS[ray - 1]
    near = CENTRES[ray - 1] + way * np.linalg.norm(CENTRES[ray - 1])
    return Line(panel="zoom", thing="best", role="third", dash="dot", width=1.6,
                xy=mm(np.stack([near - 0.4 * way, near + 0.4 * way])))  # fmt: skip


def photo_marks(bundle: Bundle, setting: Setting) -> list[AnyMark]:
    """Show what one camera sees of a photo that lies on the ground, with the true and the measured place."""
    k = bundle.params.shown - 1
    picture, _ = photo_or_simulated(setting)
    ground = Plane.centred(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, -1.0, 0]), 9.0, picture)
    pixels = photograph(CAMERA, ROTATIONS[k], CENTRES[k], ground, picture, columns=360)
    middle: Array = np.array([[(WIDTH - 1) / 2, (HEIGHT - 1) / 2]])
    return [
        Picture(panel="picture", pixels=pixels, extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)),
        Points(panel="picture", thing="point", role="truth", xy=middle, marker="cross", size=12,
               truth=True),
    ]  # fmt: skip
