"""The section on reliability: how well observations control each other, and which stand out."""

from __future__ import annotations

from typing import Any

from graphos_core.data import Adjustment
from graphos_core.number_format import UNKNOWN, format_number, format_value, group_thousands
from graphos_core.report.page import Paragraph, Part, Pictures, Section, Table, rows_of
from graphos_core.report.residual_pictures import redundancy_histogram, w_histogram
from graphos_core.text import Text


def reliability_section(report: dict[str, Any], adjustment: Adjustment) -> Section | None:
    """Redundancy numbers, test statistics, minimal detectable bias; left out where it was not computed."""
    found = report["reliability"]
    if not found:
        return None
    percent = format_number(100.0 * found["alpha"], digits=2)
    parts: list[Part] = [
        Paragraph(Text(
            "{n} of {tested} coordinates have |w| above {critical} (error probability {alpha} %); chance alone makes about "
            "{expected}.", n=format_number(found["beyond_critical"]), tested=format_number(found["tested"]),
            critical=format_number(found["critical"], digits=3), alpha=percent,
            expected=format_number(round(found["expected_beyond"])))),
        Pictures((redundancy_histogram(adjustment), w_histogram(adjustment)), per_row=2),
        _figures(found),
        _suspects(found["suspects"], found["unit"]),
    ]  # fmt: skip
    return Section("reliability", Text("Reliability"), "adjustment/minimal-detectable-bias", parts)


def _figures(found: dict[str, Any]) -> Table:
    r, mdb, effect = found["redundancy_numbers"], found["mdb_px"], found["effect"]
    scale, unit = (1000.0, "mm") if found["unit"] == "m" else (1.0, found["unit"])

    def effect_of(key: str) -> str:
        return format_value(None if effect[key] is None else scale * effect[key], unit=unit, digits=2)

    rows = rows_of([
        (Text("Redundancy numbers: mean, least"),
         f"{_two(r['mean'])}, {_two(r['least'])}"),
        (Text("Coordinates hardly controlled (r below 0.1)"), format_number(found["weakly_controlled"])),
        (Text("Minimal detectable bias: median, 95 % below"),
         f"{format_value(mdb['median'], unit='px', digits=2)}, {format_value(mdb['q95'], unit='px', digits=2)}"),
        (Text("Its effect on the object point: median, 95 % below"), f"{effect_of('median')}, {effect_of('q95')}"),
    ])  # fmt: skip
    return Table(("", ""), rows, note=Text(
        "Redundancy number r: share of an error of the observation that shows in its own residual. Minimal detectable "
        "bias: δ0 σ / √r, the smallest error the test finds with the power {power} % at the error probability {alpha} % "
        "(δ0 = {delta0}). Effect: how far such an unnoticed error moves the object point.",
        power=format_number(100.0 * found["power"], digits=2), alpha=format_number(100.0 * found["alpha"], digits=2),
        delta0=format_number(found["delta0"], digits=3)))  # fmt: skip


def _suspects(rows: list[dict[str, Any]], unit: str) -> Table:
    heads = ("Photo", "Point", "coordinate", "position px", "residual px", "w", "τ", "r", "MDB px", "effect")
    scale, shown = (1000.0, "mm") if unit == "m" else (1.0, unit)
    cells = [
        (s["photo"], s["point"], s["coordinate"],
         f"{format_number(round(s['position_px'][0]))}, {format_number(round(s['position_px'][1]))}",
         format_number(s["residual_px"], digits=3), _two(s["w"]), _two(s["tau"]),
         _two(s["redundancy_number"]), format_number(s["mdb_px"], digits=2),
         format_value(None if s["effect"] is None else scale * s["effect"], unit=shown, digits=2))
        for s in rows
    ]  # fmt: skip
    return Table(heads, cells, left=3, title=Text("Largest standardised residuals"), note=Text(
        "w: v / (σ √r) with the a priori σ (Baarda). τ: the same with the a posteriori sigma0 (Pope). The worst first; "
        "remove one, adjust again, and look again: one blunder spreads over its neighbours."))  # fmt: skip


def _two(value: float | None) -> str:
    """Return a number without unit with two decimals."""
    return UNKNOWN if value is None else group_thousands(f"{value:.2f}")
