"""The section on the cameras."""

from __future__ import annotations

from typing import Any

from graphos_core.data import Adjustment
from graphos_core.number_format import UNKNOWN, format_number, format_value
from graphos_core.report.camera_pictures import (
    correlation_picture,
    profile_picture,
    symbol,
    uncertainty_picture,
)
from graphos_core.report.page import Paragraph, Part, Section, Table
from graphos_core.report.photo_pictures import sensor_picture
from graphos_core.text import Text

MOST_CAMERAS = 8
"""So many cameras get pictures of their own: with one calibration per photo there are as many as photos."""


def cameras_section(report: dict[str, Any], adjustment: Adjustment) -> Section:
    """Parameters with σ and significance, correlations, distortion, uncertainty, mean residuals over the sensor."""
    parts: list[Part] = []
    for index, camera in enumerate(report["cameras"]):
        label = camera["label"] or Text("Camera {n}", n=index + 1)
        parts += [_parameters(camera, label), *_reasons(camera), *_remarks(camera)]
        if index < MOST_CAMERAS:
            parts += _pictures(camera, label)
            averaged = sensor_picture(adjustment, index)
            if averaged is not None:
                parts.append(averaged)
    if len(report["cameras"]) > MOST_CAMERAS:
        parts.append(
            Paragraph(Text("Pictures are shown of the first {n} cameras.", n=MOST_CAMERAS), soft=True)
        )
    return Section("cameras", Text("Cameras"), "adjustment/self-calibration", parts)


def _parameters(camera: dict[str, Any], label: str) -> Table:
    tested = any(p["t"] is not None for p in camera["parameters"])
    heads = ["Parameter", "Symbol", "Unit", "Value ± σ"]
    heads += ["t", "significant", "largest correlation"] if tested else []
    rows = []
    for p in camera["parameters"]:
        held = "" if p["sigma"] else "\u2002held fixed"
        row = [
            p["label"],
            symbol(p["symbol"]),
            p["unit"] or "–",
            format_value(p["value"], p["sigma"], digits=6) + held,
        ]
        if tested:
            row += _test(p)
        rows.append(row)
    pitch = camera["pixel_pitch_mm"]
    sensor = "" if not pitch else Text(", pixel {p} mm, f = {f} mm", p=format_number(pitch, digits=3),
                                       f=format_number(pitch * camera["focal_px"], digits=5))  # fmt: skip
    before = "" if not camera["pre_corrections"] else Text(
        " Fixed pre-corrections: {names}.", names=", ".join(camera["pre_corrections"]))  # fmt: skip
    note = Text("Model: {model} ({direction}), {width} × {height} px{sensor}. Principal distance: {source}.{before}",
                model=camera["model_label"], direction=camera["direction"], width=camera["width"],
                height=camera["height"], sensor=sensor, before=before, source=str(camera["focal_source"]).rstrip(".") or "given",
                )  # fmt: skip
    if tested:
        note = Text("{note} t: |value − tested value| / σ, where the tested value is 0, of the principal distance and "
                    "point the start value; significant above {limit}.", note=note,
                    limit=format_number(next(p["limit"] for p in camera["parameters"] if p["t"] is not None), digits=3),
                    )  # fmt: skip
    return Table(heads, rows, left=3, title=label, note=note)


def _reasons(camera: dict[str, Any]) -> list[Part]:
    held = [f"{p['label']}: {p['reason']}" for p in camera["parameters"] if not p["sigma"] and p["reason"]]
    return [Paragraph(Text("Held fixed. {reasons}", reasons=" ".join(held)), soft=True)] if held else []


def _test(p: dict[str, Any]) -> list[str]:
    if p["t"] is None:
        return [UNKNOWN] * 3
    correlation = UNKNOWN
    if p["correlated_with"]:
        correlation = (
            f"{format_number(100.0 * p['correlation'], digits=3)}\u2009% with {p['correlated_with']}"
        )
    return [format_number(p["t"], digits=3), "yes" if p["significant"] else "no", correlation]


def _remarks(camera: dict[str, Any]) -> list[Part]:
    remarks: list[Part] = []
    if camera["focal_estimated"]:
        remarks.append(Paragraph(Text(
            "The principal distance is an estimate that no adjustment improved: sizes and angles depend on it."),
            strong=True))  # fmt: skip
    idle = [p["label"].lower() for p in camera["parameters"] if p["significant"] is False]
    if idle:
        remarks.append(Paragraph(Text(
            "Not significant: {names}. Each could be held fixed without making the fit worse.", names=", ".join(idle))))  # fmt: skip
    return remarks


def _pictures(camera: dict[str, Any], label: str) -> list[Part]:
    parts: list[Part] = []
    if camera["correlations"]:
        parts.append(correlation_picture(camera["correlations"], label))
    if camera.get("profile"):
        parts.append(profile_picture(camera["profile"], label))
    if camera.get("projection_uncertainty"):
        parts.append(
            uncertainty_picture(camera["projection_uncertainty"], camera["width"], camera["height"], label)
        )
    return parts
