"""Sections on control, check points, other knowledge, and the closing statement."""

from __future__ import annotations

import math
from typing import Any

from graphos_core.data import Adjustment, Array, Control
from graphos_core.number_format import UNKNOWN, format_number, group_thousands
from graphos_core.report.control_pictures import plan_picture
from graphos_core.report.page import Paragraph, Part, Section, Table
from graphos_core.text import Text


def statement_section(report: dict[str, Any]) -> Section | None:
    """Precision against accuracy."""
    found = report["statement"]
    if not found:
        return None
    verdict = {
        "confirmed": Text("Check points confirm the stated precision."),
        "optimistic": Text("The stated precision is too optimistic."),
        "cautious": Text("The stated precision is too cautious."),
        "not checked": Text("Precision is known, accuracy is not."),
    }[found["verdict"]]
    parts = [Paragraph(verdict, strong=True), Paragraph(found["precision"]), Paragraph(found["accuracy"])]
    return Section("statement", Text("Precision against accuracy"), "adjustment/check-points", parts)


def control_section(report: dict[str, Any], adjustment: Adjustment, given: Control | None) -> Section | None:
    """Residuals of the control that took part, and where they lie; `given` tells places of points without a name."""
    found = report["control"]
    if not found:
        return None
    weighted = found["how"] == "weighted observations"
    heads = ["Point", *(f"Δ{axis} mm" for axis in "XYZ")]
    heads += (
        [f"{name}{axis}{unit}" for name, unit in (("σ", " mm"), ("w ", "")) for axis in "XYZ"]
        if weighted
        else []
    )
    d = _decimals(found["rms_m"])
    rows = [
        (p["name"], *_mm(p["residual_m"], d), *((*_mm(p["sigma_m"], d), *_cells(p["w"])) if weighted else ()))
        for p in found["points"]
    ]
    rows.append(("RMS", *_mm(found["rms_m"], d), *([""] * (len(heads) - 4))))
    note = Text("Δ: computed − given. RMS per axis.")
    if weighted:
        note = Text(
            "{note} σ: a priori, of the given coordinate. w: standardised residual (Baarda).", note=note
        )
        line = Text("{n} control points take part as weighted observations.", n=found["count"])
    elif found["how"] == "held fixed":
        line = Text(
            "{n} control points are held fixed: they have no residuals and are no observations.",
            n=found["count"],
        )
    else:
        line = Text("The block was placed by a similarity on {n} control points; their residuals do not show the "
                    "accuracy of the block.", n=found["count"])  # fmt: skip
    parts: list[Part] = [Paragraph(line), Table(heads, rows, note=note)]
    picture = plan_picture(adjustment.block, _positions(adjustment, given), _residuals(report))
    if picture is not None:
        parts.append(picture)
    return Section("control", Text("Control points"), "adjustment/control-points", parts)


def check_section(report: dict[str, Any]) -> Section | None:
    """Check points: accuracy, apart from everything that comes from the covariance."""
    found = report["check"]
    if not found:
        return None
    known = any(v is not None for v in found["predicted_m"])
    d = _decimals(found["rms_m"])
    rows = []
    for p in found["points"]:
        cells = _mm(p["residual_m"], d)
        if known:
            cells = [f"{v} ± {s}" for v, s in zip(cells, _mm(p["sigma_m"], d), strict=True)]
        rows.append((p["name"], p["role"], *cells, *(_cells(p["normalised"]) if known else ())))
    blank = [""] * 3 if known else []
    rows.append((Text("RMS: accuracy"), "", *_mm(found["rms_m"], d), *blank))
    rows.append((Text("Mean"), "", *_mm(found["mean_m"], d), *blank))
    if known:
        rows.append((Text("Expected from σ: precision"), "", *_mm(found["predicted_m"], d), *blank))
    heads = ("Point", "Role", *(f"Δ{axis}{' ± σ' if known else ''} mm" for axis in "XYZ"),
             *((f"Δ/σ {axis}" for axis in "XYZ") if known else ()))  # fmt: skip
    note = Text(
        "Δ: computed − given; check points took no part in the adjustment, so Δ is accuracy. σ: of the computed "
        "coordinate, from the covariance, so it is precision; Δ/σ also counts the standard deviation of the given "
        "coordinate. A mean far from 0 is a shift, a tilt or a bend of the block. "
        "Role “placed”: the point placed the block by the similarity, so it shows less than the whole error."
    )  # fmt: skip
    return Section(
        "check", Text("Check points"), "adjustment/check-points", [Table(heads, rows, left=2, note=note)]
    )


def known_section(report: dict[str, Any]) -> Section | None:
    """Distances, projection centres, attitudes, shapes, rigs: every observation of every other group."""
    parts: list[Part] = []
    for g in report["known"]:
        heads = ("Observation", "observed", "residual", "σ a priori", "r", "w", "MDB")
        rows = [
            (o["label"], format_number(o["observed"], digits=7), format_number(o["residual"], digits=3),
             format_number(o["sigma"], digits=3), format_number(o["redundancy_number"], digits=2),
             format_number(o["w"], digits=3), format_number(o["mdb"], digits=3))
            for o in g["observations"]
        ]  # fmt: skip
        unit = Text(" All values in {unit}.", unit=g["unit"]) if g["unit"] else ""
        more = (
            Text(" The first {n} of {all} are listed.", n=g["listed"], all=g["count"])
            if g["listed"] < g["count"]
            else ""
        )
        parts.append(Table(heads, rows, title=g["kind"].capitalize(), note=Text(
            "Residual: adjusted − observed. r: redundancy number. w: standardised residual. MDB: minimal detectable "
            "bias.{unit}{more}", unit=unit, more=more)))  # fmt: skip
    return (
        Section("known", Text("Distances and other knowledge"), "adjustment/scale-bars", parts)
        if parts
        else None
    )


def _positions(adjustment: Adjustment, given: Control | None) -> dict[str, Array]:
    """Return where the named points are in the block's frame, by name: computed, else as given."""
    block = adjustment.block
    found = {} if given is None or block.unit != "m" else dict(zip(given.names, given.xyz, strict=True))
    return found | {name: block.points[i] for i, name in enumerate(adjustment.point_names) if name}


def _residuals(report: dict[str, Any]) -> list[tuple[str, list[Any], bool]]:
    control = [(p["name"], p["residual_m"], False) for p in report["control"]["points"]]
    check = [(p["name"], p["residual_m"], True) for p in (report["check"] or {"points": []})["points"]]
    return control + check


def _mm(values: list[float | None] | None, decimals: int = 2) -> list[str]:
    """Return metres as millimetres, all with the same decimals."""
    return [
        UNKNOWN if v is None else group_thousands(f"{1000.0 * v:.{decimals}f}") for v in values or [None] * 3
    ]


def _decimals(rms: list[float | None]) -> int:
    """Return the decimals of millimetres that show three digits of the largest RMS, 1 to 5."""
    largest = max((v for v in rms if v), default=1e-3)
    return min(5, max(1, 2 - math.floor(math.log10(1000.0 * largest))))


def _cells(values: list[float | None] | None) -> list[str]:
    """Return numbers without unit with two decimals."""
    return [UNKNOWN if v is None else group_thousands(f"{v:.2f}") for v in values or [None] * 3]
