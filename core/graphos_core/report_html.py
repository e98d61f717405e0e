"""The report as one self-contained HTML page: problems first, then pictures and tables. Everything is escaped."""

from __future__ import annotations

from importlib import resources
from typing import Any

import jinja2

from graphos_core.number_format import format_value
from graphos_core.pipeline import Pipeline
from graphos_core.report_pictures import report_pictures
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
    template = resources.files("graphos_resources").joinpath("report/report.html.j2").read_text("utf-8")
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters["number"] = format_value
    return environment.from_string(template).render(
        r=report,
        problems=report["warnings"]
        + [f"{f['name']}: {f['reason']}" for f in report["images"]["not_oriented"]],
        tiles=_tiles(report),
        pictures=report_pictures(pipeline),
        comparison=_comparison(report["quality"]),
        figures=_figures(report["quality"]),
        cameras=[_camera(camera) for camera in report["cameras"]],
        photo_heads=_photo_heads(report["orientation"]),
        photos=[_photo(photo) for photo in (report["orientation"] or {"photos": []})["photos"]],
        control=_control(report["georeferencing"]),
        times=_times(report),
        recipe=pipeline.recipe.to_toml(),
    )


def _tiles(report: dict[str, Any]) -> list[dict[str, str]]:
    images, orientation, dense = report["images"], report["orientation"], report["dense"]
    tiles = [{"label": "photos oriented", "value": f"{images['oriented']} of {images['total']}"}]
    if orientation:
        rms = format_value(orientation["reprojection_rms_px"], unit="px", digits=3)
        tiles.append({"label": "reprojection RMS per coordinate", "value": rms})
        tiles.append({"label": "object points", "value": format_value(orientation["points"])})
    if dense["points"]:
        tiles.append({"label": "points of the dense cloud", "value": format_value(dense["points"])})
    if report["georeferencing"] and report["georeferencing"]["check_rms_m"] is not None:
        value = format_value(1000 * report["georeferencing"]["check_rms_m"], unit="mm", digits=3)
        tiles.append({"label": "check points, RMS per coordinate", "value": value})
    return tiles


def _comparison(quality: dict[str, Any] | None) -> list[dict[str, str]]:
    if not quality or not quality["comparison"]:
        return []
    found = quality["comparison"]
    scale, unit = (1000.0, "mm") if found["unit"] == "m" else (1.0, found["unit"])
    rows = []
    for key, label in STATISTICS.items():
        value = found["statistics"].get(key)
        shown = (
            format_value(int(value)) if key == "count" and value is not None
            else format_value(None if value is None else scale * value, unit=unit, digits=3)
        )  # fmt: skip
        rows.append({"label": label, "value": shown})
    return rows


def _figures(quality: dict[str, Any] | None) -> list[dict[str, str]]:
    if not quality:
        return []
    rows = []
    for name, figure in quality["figures"].items():
        if isinstance(figure, dict) and "value" in figure:
            value, sigma = figure["value"], figure.get("sigma")
            shown = figure.get("reason") or "–"
            if isinstance(value, (int, float)):
                shown = format_value(value, sigma, figure.get("unit", ""), digits=3)
            rows.append({"label": figure.get("label", name), "value": shown})
    return rows


def _camera(camera: dict[str, Any]) -> dict[str, Any]:
    source = camera["focal_source"]
    estimated = " Principal distance ESTIMATED." if camera["focal_estimated"] else ""
    return {
        "label": camera["label"] or "Camera",
        "line": f"Model {camera['model']}, {camera['width']} × {camera['height']} px. {source}{estimated}",
        "rows": [
            {
                "label": p["label"],
                "symbol": p["symbol"].replace("_", ""),
                "value": format_value(p["value"], p["sigma"], p["unit"], digits=6)
                + ("" if p["sigma"] else " (held fixed)"),
            }
            for p in camera["parameters"]
        ],
    }


def _photo_heads(orientation: dict[str, Any] | None) -> list[str]:
    unit = orientation["unit"] if orientation else ""
    return [
        f"X ± σ {unit}",
        f"Y ± σ {unit}",
        f"Z ± σ {unit}",
        "ω ± σ °",
        "φ ± σ °",
        "κ ± σ °",
        "points",
        "RMS px",
    ]


def _photo(photo: dict[str, Any]) -> list[str]:
    cells = [photo["name"]]
    for value, sigma in zip(photo["centre"], photo["sigma_centre"], strict=True):
        cells.append(format_value(value, sigma))
    sigma = max(photo["sigma_rotation_deg"])
    cells += [format_value(angle, sigma) for angle in photo["omega_phi_kappa_deg"]]
    rms = photo["rms_px"]
    return [*cells, format_value(photo["observations"]), "–" if rms is None else f"{rms:.2f}"]


def _control(found: dict[str, Any] | None) -> dict[str, Any] | None:
    if not found or not found["points"]:
        return None
    line = Text("Placed by a similarity: {method}.", method=found["method"])
    for label, key in (("control", "rms_m"), ("check", "check_rms_m")):
        if found[key] is not None:
            line = Text("{line} RMS per coordinate of {label} points: {mm}.", line=line, label=label,
                        mm=format_value(1000 * found[key], unit="mm", digits=3))  # fmt: skip
    return {
        "line": line,
        "rows": [
            {"name": p["name"], "role": "check" if p["check"] else "control",
             "cells": [_millimetres(v) for v in p["residual_m"]]}
            for p in found["points"]
        ],
    }  # fmt: skip


def _times(report: dict[str, Any]) -> list[dict[str, str]]:
    rows = [{"label": stage, "value": f"{seconds:.1f} s"} for stage, seconds in report["timings_s"].items()]
    memory = report["peak_memory_mb"]
    return [
        *rows,
        {
            "label": "peak memory",
            "value": "not told by this system" if memory is None else f"{memory:.0f} MB",
        },
    ]


def _millimetres(metres: float | None) -> str:
    return "–" if metres is None else f"{1000 * metres:.2f}".replace("-", "−")
