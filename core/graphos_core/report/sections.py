"""The page of a report: problems first, then section by section from the figures and the adjusted block."""

from __future__ import annotations

from typing import Any

from graphos_core.number_format import format_number, format_value
from graphos_core.pipeline import Pipeline
from graphos_core.report.adjustment_sections import adjustment_section, points_section, residuals_section
from graphos_core.report.camera_sections import cameras_section
from graphos_core.report.control_sections import (
    check_section,
    control_section,
    known_section,
    statement_section,
)
from graphos_core.report.page import Page, Paragraph, Part, Picture, Problem, Section, Table, rows_of
from graphos_core.report.photo_sections import photos_section
from graphos_core.report.reliability_sections import reliability_section
from graphos_core.text import Text

STATISTICS = {
    "count": "points",
    "mean": "mean",
    "std": "standard deviation",
    "rmse": "RMSE",
    "median": "median",
    "nmad": "NMAD",
    "q68": "68.3 % of |d|",
    "q95": "95 % of |d|",
}


def report_html(report: dict[str, Any], pipeline: Pipeline) -> str:
    """Return the page for a report from `graphos_core.report.build_report`."""
    return report_page(report, pipeline).html()


def report_page(report: dict[str, Any], pipeline: Pipeline) -> Page:
    """Return the page: a section is left out where nothing of it was computed."""
    adjusted = pipeline.result("adjustment")
    sections: list[Section | None] = [_overview(report, pipeline)]
    if adjusted is not None:
        adjustment, (given, _) = adjusted.adjustment, pipeline.project.control()
        sections += [
            statement_section(report), adjustment_section(report, adjustment), cameras_section(report, adjustment),
            photos_section(report, adjustment), points_section(report, adjustment),
            residuals_section(report, adjustment), reliability_section(report, adjustment),
            control_section(report, adjustment, given), check_section(report), known_section(report),
        ]  # fmt: skip
    sections += [_quality(report, pipeline), _products(report), _machine(report), _recipe(pipeline)]
    return Page(
        title=report["project"],
        subtitle=Text(
            "Photogrammetry report · GRAPHOS-Py {version} · {made} · seed {seed} · data {data}", seed=report["seed"],
            version=report["version"], made=report["made"], data=report["data_hash"],
        ),
        problems=[_problem(p) for p in report["problems"]],
        tiles=_tiles(report),
        sections=[s for s in sections if s is not None and s.parts],
        no_problem=Text("No problem was found.") if report["orientation"]
        else Text("Nothing was adjusted yet: there is nothing to judge."),
    )  # fmt: skip


def _problem(found: dict[str, Any]) -> Problem:
    text = " ".join(part for part in (found["what"], found["why"]) if part)
    items = found["items"]
    if items and not all(item in text for item in items[:5]):
        more = Text(" and {n} more", n=len(items) - 5) if len(items) > 5 else ""
        text += " " + Text("Concerned: {names}{more}.", names=", ".join(items[:5]), more=more)
    return Problem(found["severity"], text, found["todo"], found["learn"])


def _tiles(report: dict[str, Any]) -> list[tuple[str, str]]:
    images, orientation, dense = report["images"], report["orientation"], report["dense"]
    tiles = [(f"{images['oriented']} of {images['total']}", "photos oriented")]
    if orientation:
        tiles.append(
            (format_value(orientation["sigma0_px"], unit="px", digits=3), "sigma0 of an image coordinate")
        )
        tiles.append((format_value(orientation["reprojection_rms_px"], unit="px", digits=3),
                      "reprojection RMS per coordinate"))  # fmt: skip
        tiles.append((format_value(orientation["points"]), "object points"))
    if report["check"]:
        worst = format_value(1000.0 * max(report["check"]["rms_m"]), unit="mm", digits=3)
        tiles.append((worst, "check points, RMS in the worst axis"))
    if dense["points"]:
        tiles.append((format_value(dense["points"]), "points of the dense cloud"))
    return tiles


def _overview(report: dict[str, Any], pipeline: Pipeline) -> Section | None:
    from graphos_core.report.model_picture import overview

    image, caption = overview(pipeline)
    parts: list[Part] = []
    if image:
        parts.append(Picture(Text("The model with the cameras"), image=image, caption=caption))
    missing = [*report["images"]["not_oriented"], *report["images"]["unusable"]]
    if missing:
        rows = [(f["name"], f["reason"]) for f in missing]
        parts.append(Table(("Photo", "Reason"), rows, left=2, title=Text("Photos that are not used")))
    return Section("model", Text("The model"), "", parts)


def _quality(report: dict[str, Any], pipeline: Pipeline) -> Section | None:
    from graphos_core.report.residual_pictures import distance_histogram

    found = report["quality"]
    if not found:
        return None
    parts: list[Part] = []
    if found["comparison"]:
        c = found["comparison"]
        scale, unit = (1000.0, "mm") if c["unit"] == "m" else (1.0, c["unit"])
        rows = []
        for key, label in STATISTICS.items():
            value = c["statistics"].get(key)
            shown = (
                format_number(int(value)) if key == "count" and value is not None
                else format_value(None if value is None else scale * value, unit=unit, digits=3)
            )  # fmt: skip
            rows.append((label, shown))
        parts.append(Table(("", ""), rows, title=Text("Against the reference"), note=c["definition"]))
        parts.append(distance_histogram(scale * pipeline.result("quality").comparison.distances, unit))
    figures = [row for row in (_figure(name, figure) for name, figure in found["figures"].items()) if row]
    if figures:
        parts.append(Table(("Figure", "Value", "Definition"), figures, last_text=True,
                           title=Text("Internal figures")))  # fmt: skip
    parts += [Paragraph(line) for line in found["advice"]]
    return Section("quality", Text("Quality of the surface"), "quality/distances", parts)


def _figure(name: str, figure: Any) -> tuple[str, str, str] | None:
    if not (isinstance(figure, dict) and "value" in figure):
        return None
    value = figure["value"]
    shown = figure.get("reason") or "–"
    if isinstance(value, (int, float)):
        shown = format_value(value, figure.get("sigma"), figure.get("unit", ""), digits=3)
    return str(figure.get("label", name)), shown, str(figure.get("definition", ""))


def _products(report: dict[str, Any]) -> Section:
    dense = report["dense"]
    parts: list[Part] = [
        Table(("File", "What"), [(p["file"], p["what"]) for p in report["products"]], left=2)
    ]
    if dense["points"]:
        parts.insert(0, Paragraph(Text(
            "The dense cloud has {points} points, fused from {maps} depth maps.", points=format_number(dense["points"]),
            maps=dense["depth_maps"])))  # fmt: skip
    return Section("products", Text("Products"), "", parts)


def _machine(report: dict[str, Any]) -> Section:
    memory = report["peak_memory_mb"]
    rows = rows_of([
        *((stage, f"{seconds:.1f}\u2009s") for stage, seconds in report["timings_s"].items()),
        ("peak memory", "not told by this system" if memory is None else f"{memory:.0f}\u2009MB"),
    ])  # fmt: skip
    return Section("machine", Text("Time and machine"), "", [Table(("", ""), rows)])


def _recipe(pipeline: Pipeline) -> Section:
    return Section("recipe", Text("Recipe"), "", [Paragraph(pipeline.recipe.to_toml(), kind="code")])
