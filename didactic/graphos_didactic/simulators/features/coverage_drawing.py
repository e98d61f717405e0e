"""Pictures of the simulator of the coverage: the format, the radii, the growth, the uncertainty of the image."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_didactic.scene import AnyMark, Bars, Handle, Line, Picture, Points, Polygon, Words
from graphos_didactic.simulators.features.coverage_model import (
    HALF_DIAGONAL,
    NAMES,
    RADII,
    Covered,
    even,
)
from graphos_didactic.simulators.features.coverage_params import GROUPS, HEIGHT, WIDTH
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

SYMBOLS = {"focal_px": "f", "x0": "x₀", "y0": "y₀", "k1": "k₁", "k2": "k₂"}
MOST = 10.0
"""Largest factor that is drawn."""


def format_marks(seen: Covered, last: int) -> list[AnyMark]:
    """Draw the format with the points of all photos; with their cells and hull from the second step on."""
    marks: list[AnyMark] = []
    if seen.params.source == "photo":
        picture, _ = photo_or_simulated(seen.setting)
        marks.append(Picture(panel="format", pixels=picture, extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)))
    if last >= 1:
        marks += _cells(seen)
        if len(seen.coverage.hull) > 2:
            marks.append(Polygon(panel="format", thing="hull", role="second", xy=seen.coverage.hull, fill=0.0,
                                 width=2.4, dash="dash", answer=True))  # fmt: skip
        reach = seen.coverage.reach * HALF_DIAGONAL
        around = np.linspace(0, 2 * np.pi, 73)
        middle = np.array([(WIDTH - 1) / 2, (HEIGHT - 1) / 2])
        circle = middle + reach * np.stack([np.cos(around), np.sin(around)], axis=1)
        marks.append(Line(panel="format", thing="reach", role="third", xy=circle, dash="dot", width=1.8))
    marks.append(Points(panel="format", thing="points", role="first", xy=seen.xy, size=4.5))
    return marks


def _cells(seen: Covered) -> list[AnyMark]:
    counts = seen.coverage.counts
    rows, columns = counts.shape
    across, down = WIDTH / columns, HEIGHT / rows
    marks: list[AnyMark] = []
    for i, j in zip(*np.nonzero(counts), strict=True):
        left, top = j * across - 0.5, i * down - 0.5
        box = np.array([[left, top], [left + across, top], [left + across, top + down], [left, top + down]])
        marks.append(
            Polygon(panel="format", thing="cells", role="truth", xy=box, fill=0.22, width=0.8, answer=True)
        )
    return marks


def radius_marks(seen: Covered) -> list[AnyMark]:
    """Draw the share of the points in each ring beside the share of the format."""
    found = seen.coverage
    reach = found.reach * HALF_DIAGONAL
    return [
        Bars(panel="radii", thing="format", role="neutral", edges=found.radii, heights=100 * found.radial_area, fill=0.25,
             label="of the format"),
        Bars(panel="radii", thing="points", role="first", edges=found.radii, heights=100 * found.radial_share, fill=0.5,
             label="of the points", answer=True),
        Line(panel="radii", thing="reach", role="third", xy=np.array([[reach, 0.0], [reach, 100.0]]), dash="dot",
             width=1.8, label="outermost point"),
    ]  # fmt: skip


def factors(seen: Covered) -> Array:
    """Return each standard deviation by that of as many points over the whole format, float64 (5,)."""
    return np.asarray(seen.sigmas / even(seen.params.points, seen.params.sigma_px)[0])


def growth_marks(seen: Covered) -> list[AnyMark]:
    """Draw how many times larger each standard deviation is than with even coverage."""
    found = factors(seen)
    ends = np.array([-0.45, len(NAMES) - 0.4])
    marks: list[AnyMark] = []
    for level in (0.0, 1.0, 5.0, 10.0):
        row = np.stack([ends, np.full(2, level)], axis=1)
        thing = "even" if level == 1.0 else ""
        marks += [
            Line(panel="growth", thing=thing, role="muted" if level <= 1.0 else "grid", xy=row, width=1.4,
                 dash="dash" if level == 1.0 else "solid"),
            Words(panel="growth", role="muted", at=(-0.45, level), anchor="right", text=f"{level:.0f}"),
        ]  # fmt: skip
    for i, (name, factor) in enumerate(zip(NAMES, found, strict=True)):
        height = min(factor, MOST) if np.isfinite(factor) else MOST
        text = f"{factor:.1f}×" if np.isfinite(factor) else "∞"
        marks += [
            Bars(panel="growth", thing=name, role="estimate" if i < 3 else "error", edges=np.array([i - 0.32, i + 0.32]),
                 heights=np.array([height]), fill=0.6, answer=True),
            Words(panel="growth", role="text", at=(float(i), height), anchor="bottom", text=text, answer=True),
            Words(panel="growth", role="text", at=(float(i), -0.1), anchor="top", text=SYMBOLS[name]),
        ]  # fmt: skip
    return marks


def image_marks(seen: Covered, last: int) -> list[AnyMark]:
    """Draw the uncertainty of the image by radius, with that of even coverage and the error of this calibration."""
    reach = seen.coverage.reach * HALF_DIAGONAL
    best = even(seen.params.points, seen.params.sigma_px)[1]
    marks: list[AnyMark] = [
        Line(panel="image", thing="even", role="muted", xy=np.stack([RADII, best], axis=1), dash="dash", width=1.6,
             label="σ, even coverage"),
        Line(panel="image", thing="reach", role="third", xy=np.array([[reach, 0.0], [reach, 1e4]]), dash="dot",
             width=1.8, label="outermost point"),
    ]  # fmt: skip
    if np.isfinite(seen.image_sigmas).all():
        marks.append(Line(panel="image", thing="image", role="accent", xy=np.stack([RADII, seen.image_sigmas], axis=1),
                          width=2.6, label="σ, these points", answer=True))  # fmt: skip
    if last >= 3 and np.isfinite(seen.image_errors).all():
        marks.append(Line(panel="image", thing="image", role="truth", xy=np.stack([RADII, seen.image_errors], axis=1),
                          dash="dashdot", width=1.8, label="true error", truth=True, answer=True))  # fmt: skip
    return marks


def handle_marks(seen: Covered) -> list[AnyMark]:
    """Return the handles: the middles of the groups, and their size."""
    marks: list[AnyMark] = []
    around = np.linspace(0, 2 * np.pi, 33)[:-1]
    ring = max(seen.radius, 60.0) * np.stack([np.cos(around), np.sin(around)], axis=1)
    for group, middle in zip(GROUPS, seen.middles, strict=True):
        marks.append(
            Handle(panel="format", name=group, thing="points", label=f"Group {group.upper()}", role="first",
                   at=(float(middle[0]), float(middle[1])), parameters=(f"{group}_x", f"{group}_y"), nudge=(30.0, 20.0),
                   grip=middle + ring,
                   move=lambda x, y, g=group: {  # type: ignore[misc]
                       f"{g}_x": 100.0 * x / (WIDTH - 1), f"{g}_y": 100.0 * y / (HEIGHT - 1)})
        )  # fmt: skip
    edge = seen.middles[0] - (seen.radius, 0.0)
    marks.append(
        Handle(panel="format", name="spread", thing="points", label="Size of the groups", role="second", freedom="slide",
               at=(float(np.clip(edge[0], 25.0, WIDTH - 25.0)), float(seen.middles[0][1])), parameters=("spread",),
               nudge=(-40.0, 0.0), move=lambda x, _: {"spread": 100.0 * (seen.middles[0][0] - x) / HALF_DIAGONAL})
    )  # fmt: skip
    return marks
