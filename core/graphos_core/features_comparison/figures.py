"""Pictures of a comparison: bars per algorithm, curves per disturbance. By matplotlib, without a screen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphos_core.features_comparison.disturbances import DISTURBANCES
from graphos_core.features_comparison.records import Curve, FeatureComparison, Row

COLOURS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#8a93a0", "#a6761d")
"""Of Okabe and Ito (2008), which people with a colour vision deficiency can tell apart."""
MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
LEGEND_BELOW = -0.3
"""Inches from the axis to the legend."""
LINES = ("-", "--", "-.", ":")


@dataclass(frozen=True)
class Look:
    """Colours of paper and ink."""

    ink: str
    paper: str
    grid: str
    soft: str


LIGHT = Look("#1d2430", "#ffffff", "#dfe3e9", "#8a93a0")
DARK = Look("#e7e9ec", "#15171b", "#323843", "#8a93a0")


def bars(comparison: FeatureComparison, look: Look = LIGHT) -> Any:
    """Return the figure of the rows: key points, matches, shares and time, one line per algorithm."""
    rows = [row for row in comparison.rows if not row.failure]
    truth = comparison.homography is not None
    figure = _figure(11.0, 1.35 + 0.42 * max(1, len(rows)), look)
    figure.get_layout_engine().set(wspace=0.05)
    panels = figure.subplots(1, 4, sharey=True, gridspec_kw={"width_ratios": (1.0, 1.35, 1.35, 1.15)})
    place = np.arange(len(rows))[::-1]
    photos = max(1, len(comparison.photos))
    _bar(panels[0], place, [row.keypoints / photos for row in rows], COLOURS[6], "key points per photo")
    _matches(panels[1], place, rows, truth)
    _shares(panels[2], place, rows, truth)
    _times(panels[3], place, rows)
    panels[0].set_yticks(place, [row.algorithm for row in rows])
    titles = ("Key points per photo", "Matches", "Shares", "Seconds")
    for panel, title in zip(panels, titles, strict=True):
        _dress(panel, look, title)
        panel.grid(axis="x", color=look.grid)
        panel.tick_params(axis="y", length=0)
        panel.set_ylim(-0.7, len(rows) - 0.3)
    for panel in panels[1:]:
        _legend(panel, look)
    return figure


def curves(comparison: FeatureComparison, look: Look = LIGHT) -> Any:
    """Return the figure against disturbances: repeatability above, matching score below, one column for each."""
    names = [n for n in DISTURBANCES if any(c.disturbance == n for c in comparison.curves)]
    labels = list(dict.fromkeys(c.algorithm for c in comparison.curves))
    figure = _figure(1.0 + 2.35 * max(2, len(names)), 5.4 + 0.22 * ((len(labels) - 1) // 6), look)
    panels = figure.subplots(2, len(names), sharey=True, squeeze=False)
    for column, name in enumerate(names):
        about = DISTURBANCES[name]
        for curve in (c for c in comparison.curves if c.disturbance == name):
            _line(panels[0, column], curve, curve.repeatability, labels)
            _line(panels[1, column], curve, curve.matching_score, labels)
        _dress(panels[0, column], look, about.label)
        _dress(panels[1, column], look, "")
        panels[1, column].set_xlabel(about.unit, color=look.ink, fontsize=9)
        for panel in panels[:, column]:
            panel.grid(color=look.grid)
            panel.set_ylim(-0.02, 1.02)
            if name == "light":
                panel.invert_xaxis()
    panels[0, 0].set_ylabel("repeatability", color=look.ink, fontsize=9)
    panels[1, 0].set_ylabel("matching score", color=look.ink, fontsize=9)
    handles, texts = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside lower center", ncols=min(6, len(texts)), frameon=False,
                  labelcolor=look.ink, fontsize=9)  # fmt: skip
    return figure


def _figure(width: float, height: float, look: Look) -> Any:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained", facecolor=look.paper)


def _bar(panel: Any, place: Any, values: Sequence[float], colour: str, label: str, **more: Any) -> None:
    panel.barh(place, values, height=0.55, color=colour, label=label, **more)


def _matches(panel: Any, place: Any, rows: Sequence[Row], truth: bool) -> None:
    panel.barh(
        place, [r.matches for r in rows], height=0.62, color=COLOURS[4], alpha=0.45, label="candidates"
    )
    panel.barh(place, [r.verified for r in rows], height=0.42, color=COLOURS[0], label="verified")
    if truth:
        panel.plot([r.correct_cells_2px or 0 for r in rows], place, "D", color=COLOURS[1], markersize=6,
                   label="correct, per 2 px cell")  # fmt: skip


def _shares(panel: Any, place: Any, rows: Sequence[Row], truth: bool) -> None:
    kinds = [("inlier_share", "verified of candidates", 0), ("coverage", "coverage", 2)]
    if truth:
        kinds += [("repeatability", "repeatability", 3), ("precision", "precision", 1)]
    for key, label, k in kinds:
        known = [(v, p) for r, p in zip(rows, place, strict=True) if (v := getattr(r, key)) is not None]
        panel.plot(
            [v for v, _ in known],
            [p for _, p in known],
            MARKS[k],
            color=COLOURS[k],
            markersize=7,
            label=label,
        )
    panel.set_xlim(-0.03, 1.03)


def _times(panel: Any, place: Any, rows: Sequence[Row]) -> None:
    left = np.zeros(len(rows))
    for part, colour, hatch in (("detection", COLOURS[2], ""), ("matching", COLOURS[0], "//"),
                                ("verification", COLOURS[1], "..")):  # fmt: skip
        values = np.array([r.seconds.get(part, 0.0) for r in rows])
        panel.barh(place, values, left=left, height=0.55, color=colour, label=part, hatch=hatch, edgecolor="white",
                   linewidth=0.0)  # fmt: skip
        left += values


def _line(panel: Any, curve: Curve, values: Sequence[float], labels: Sequence[str]) -> None:
    k = labels.index(curve.algorithm)
    panel.plot(
        curve.levels, values, color=COLOURS[k % len(COLOURS)],
        marker=MARKS[k % len(MARKS)], linestyle=LINES[k // len(COLOURS) % len(LINES)], markersize=4.5, linewidth=1.4,
        label=curve.algorithm,
    )  # fmt: skip


def _dress(panel: Any, look: Look, title: str) -> None:
    panel.set_title(title, color=look.ink, fontsize=10, loc="left")
    panel.set_facecolor(look.paper)
    panel.set_axisbelow(True)
    panel.tick_params(colors=look.ink, labelsize=9)
    panel.ticklabel_format(axis="x", style="plain", useOffset=False)
    for side in ("top", "right"):
        panel.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        panel.spines[side].set_color(look.soft)


def _legend(panel: Any, look: Look) -> None:
    """Put the legend below the numbers of the axis, however high the panel is."""
    from matplotlib.transforms import ScaledTranslation

    below = panel.transAxes + ScaledTranslation(0.0, LEGEND_BELOW, panel.figure.dpi_scale_trans)
    panel.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=below, ncols=2, frameon=False, fontsize=8,
        labelcolor=look.ink, handlelength=1.2, columnspacing=1.0, borderaxespad=0.0,
    )  # fmt: skip
