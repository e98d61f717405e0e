"""Sections on the adjustment as a whole, the object points, and the residuals."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.data import Adjustment
from graphos_core.number_format import format_number, format_value
from graphos_core.quality.internal import widest_angles
from graphos_core.report.adjustment_figures import REDUNDANCY, RMS_PX, SIGMA0, SIGMA0_PX
from graphos_core.report.page import Paragraph, Part, Pictures, Section, Table, rows_of
from graphos_core.report.point_figures import rays_per_point
from graphos_core.report.residual_pictures import (
    angle_histogram,
    convergence_picture,
    counts_picture,
    quantile_plot,
    residual_histogram,
)
from graphos_core.text import Text


def adjustment_section(report: dict[str, Any], adjustment: Adjustment) -> Section:
    """Return what was adjusted, how well it fits, and what is missing."""
    o = report["orientation"]
    rows = [
        (Text("sigma0, without unit"), format_number(o["sigma0"], digits=4), SIGMA0),
        (Text("sigma0 of an image coordinate"), format_value(o["sigma0_px"], unit="px", digits=4), SIGMA0_PX),
        (Text("Prior standard deviation"), format_value(o["prior_px"], unit="px", digits=4),
         Text("A priori, of an image coordinate of unit weight.")),
        (Text("Reprojection RMS"), format_value(o["reprojection_rms_px"], unit="px", digits=4), RMS_PX),
        (Text("Image points"), format_number(o["observations"]), Text("Two coordinates each.")),
        (Text("Observations"), format_number(o["scalar_observations"]), Text("Scalars of all groups.")),
        (Text("Unknowns"), format_number(o["unknowns"]), Text("Datum defect not subtracted.")),
        (Text("Redundancy"), format_number(o["redundancy"]), REDUNDANCY),
        (Text("Object points"), format_number(o["points"]), ""),
        (Text("Rays per object point"), format_number(o["mean_rays_per_point"], digits=3), Text("Mean.")),
    ]  # fmt: skip
    parts: list[Part] = [
        _convergence(o),
        Paragraph(Text("Datum: {datum}.", datum=str(o["datum"]).rstrip("."))),
    ]
    parts.append(Table(("Figure", "Value", "Definition"), rows, last_text=True))
    if o["global_test"]:
        parts.append(Paragraph(_global_test(o["global_test"], o["redundancy"])))
    if o["groups"]:
        parts.append(_groups(o["groups"]))
    if o["extras"]:
        extras = [(e["name"], format_value(e["value"], e["sigma"], e["unit"])) for e in o["extras"]]
        parts.append(Table((Text("Unknown"), Text("Value ± σ")), extras, title=Text("Further unknowns")))
    picture = convergence_picture(adjustment)
    if picture is not None:
        parts.append(picture)
    if report["left_out"]:
        lines = "; ".join(f"{p['part'].lower()} ({p['reason']})" for p in report["left_out"])
        parts.append(Paragraph(Text("Not shown: {parts}.", parts=lines), soft=True))
    return Section("adjustment", Text("Adjustment"), "adjustment/sigma0", parts)


def _convergence(o: dict[str, Any]) -> Paragraph:
    if o["converged"]:
        return Paragraph(
            Text("Converged after {n} iterations ({why}).", n=o["iterations"], why=o["stop_reason"])
        )
    text = Text("Not converged after {n} iterations: {why}.", n=o["iterations"], why=o["stop_reason"])
    return Paragraph(text, strong=True)


def _global_test(test: dict[str, Any], redundancy: int) -> str:
    words = {
        "value": format_number(test["statistic"], digits=5), "low": format_number(test["lower"], digits=5),
        "high": format_number(test["upper"], digits=5), "alpha": format_number(100.0 * test["alpha"], digits=2),
        "r": format_number(redundancy),
    }  # fmt: skip
    if test["passed"]:
        return Text("Global test passed: vᵀPv = {value} lies between {low} and {high} (χ² with {r} degrees of freedom, "
                    "error probability {alpha} %): the a priori standard deviations and the model fit the observations.",
                    **words)  # fmt: skip
    if test["statistic"] < test["lower"]:
        return Text("Global test not passed: vᵀPv = {value} is below {low} (χ², {r} degrees of freedom, {alpha} %): the "
                    "observations are better than their a priori standard deviations say.", **words)  # fmt: skip
    return Text("Global test not passed: vᵀPv = {value} is above {high} (χ², {r} degrees of freedom, {alpha} %): the a "
                "priori standard deviations are too small, or blunders or systematic errors remain.",
                **words)  # fmt: skip


def _groups(groups: list[dict[str, Any]]) -> Table:
    heads = (
        "Observations",
        "unit",
        "number",
        "redundancy",
        "σ0 of the group",
        "RMS of residuals",
        "factor on σ",
    )
    rows = [
        (g["kind"], g["unit"] or "–", format_number(g["count"]), format_number(g["redundancy"], digits=5),
         format_number(g["sigma0"], digits=3), format_number(g["rms"], digits=3), format_number(g["factor"], digits=3))
        for g in groups
    ]  # fmt: skip
    return Table(heads, rows, left=2, title=Text("Groups of observations"), note=Text(
        "σ0 of a group: √(vᵀPv / r) over its observations, r the sum of their redundancy numbers; 1 when their a priori "
        "standard deviations are right. RMS per scalar. Factor: by how much variance component estimation multiplied "
        "the a priori standard deviations; 1 without it."))  # fmt: skip


def points_section(report: dict[str, Any], adjustment: Adjustment) -> Section:
    """Rays, intersection angles and precision of the object points."""
    found = report["object_points"]
    rays = rays_per_point(adjustment)
    numbers, counts = np.unique(rays, return_counts=True)
    parts: list[Part] = []
    if len(rays):
        angles = np.degrees(widest_angles(adjustment.block))
        parts.append(Pictures(
            (counts_picture(numbers, counts, Text("rays per object point")), angle_histogram(angles)), per_row=2))  # fmt: skip
    if found["sigma"]:
        parts.append(_precision(found))
    if found["undetermined"]:
        parts.append(Paragraph(Text(
            "{n} object points are not determined by their rays and have no standard deviation.",
            n=format_number(found["undetermined"]))))  # fmt: skip
    two = found["rays"].get("2", 0)
    if two:
        parts.append(Paragraph(Text(
            "{share} % of the object points have two rays only: an error along the epipolar line goes unnoticed there.",
            share=format_number(100.0 * two / max(found["count"], 1), digits=2)), soft=True))  # fmt: skip
    return Section("points", Text("Object points"), "adjustment/intersection", parts)


def _precision(found: dict[str, Any]) -> Table:
    scale, unit = (1000.0, "mm") if found["unit"] == "m" else (1.0, found["unit"])
    keys = (("median", "median"), ("rms", "RMS"), ("q95", "95 % below"), ("largest", "largest"))
    rows = [
        (f"σ{axis.upper()}", *(format_number(scale * found["sigma"][axis][key], digits=2) for key, _ in keys))
        for axis in "xyz"
    ]
    heads = (Text("Precision"), *(f"{label} {unit}" for _, label in keys))
    return Table(heads, rows, note=Text(
        "Standard deviations of the {n} object points from the covariance, relative to the datum. They are precision: "
        "errors common to the whole block are not in them.", n=format_number(found["sigma"]["x"]["count"])))  # fmt: skip


def residuals_section(report: dict[str, Any], adjustment: Adjustment) -> Section | None:
    """Whether the noise is normal."""
    found = report["residuals"]
    if not found:
        return None
    n = max(found["count"] // 2, 1)
    means = [
        format_value(m, s / n**0.5, "px") for m, s in zip(found["mean_px"], found["std_px"], strict=True)
    ]
    px = [format_value(v, unit="px", digits=3) for v in found["std_px"]]
    rows = rows_of([
        (Text("Mean ± its standard error, of x; of y"), "; ".join(means)),
        (Text("Standard deviation of x; of y"), "; ".join(px)),
        (Text("NMAD of all coordinates"), format_value(found["nmad_px"], unit="px", digits=3)),
        (Text("Largest coordinate, longest vector"),
         f"{format_value(found['largest_px'], unit='px', digits=3)}, "
         f"{format_value(found['longest_px'], unit='px', digits=3)}"),
        (Text("Observations the robust function took weight from"), format_number(found["down_weighted"])),
        (Text("Excess kurtosis of the standardised residuals"), format_number(found["kurtosis_excess"], digits=3)),
        (Text("Correlation with normal quantiles"), format_number(found["normal_correlation"], digits=4)),
    ])  # fmt: skip
    note = Text(
        "NMAD: 1.4826 · median(|v − median(v)|), the standard deviation of normal noise that blunders do not reach. Excess "
        "kurtosis: 0 for normal noise, positive for heavy tails. Correlation with normal quantiles (Filliben 1975): 1 for "
        "normal noise. Residuals are projected − measured.")  # fmt: skip
    parts: list[Part] = [residual_histogram(adjustment.residuals), Table(("", ""), rows, note=note),
                         quantile_plot(adjustment)]  # fmt: skip
    return Section("residuals", Text("Residuals"), "adjustment/robust", parts)
