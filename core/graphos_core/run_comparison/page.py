"""A comparison for people: the sections of its page, and the same as lines for the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from graphos_core.number_format import UNKNOWN, format_number, format_value
from graphos_core.report.page import Page, Paragraph, Part, Problem, Section, Table
from graphos_core.run_comparison.records import (
    CameraParameterDifference,
    Comparison,
    NumberDifference,
    PhotoDifference,
)
from graphos_core.text import Text


def comparison_page(c: Comparison) -> Page:
    """Return the page of a comparison, which `Page.html` writes."""
    return Page(
        title=Text("{a} against {b}", a=c.a, b=c.b),
        subtitle=Text("Comparison of two adjustments · differences are B − A · A: {a} · B: {b}", a=c.a, b=c.b),
        problems=[Problem("info", note) for note in c.notes],
        tiles=_tiles(c),
        sections=comparison_sections(c),
        no_problem=Text("Both converged and adjusted the same number of observations."),
    )  # fmt: skip


def comparison_sections(c: Comparison) -> tuple[Section, ...]:
    """Return the sections: what it comes to, recipe, figures, cameras, photos, object points, check points."""
    return (
        Section("meaning", Text("What it comes to"), "", [Paragraph(line) for line in c.statement]),
        Section("recipe", Text("What was done differently"), "", _recipe(c)),
        Section("figures", Text("Figures"), "adjustment/comparing-runs", (_numbers(c),)),
        Section("cameras", Text("Cameras"), "adjustment/significance", _cameras(c)),
        Section("photos", Text("Photos"), "adjustment/orientation", _photos(c)),
        Section("points", Text("Object points"), "adjustment/intersection", _points(c)),
        Section("check", Text("Check points"), "adjustment/check-points", _check(c)),
    )


def comparison_text(c: Comparison) -> str:
    """Return the comparison as lines for the terminal."""
    lines = [f"A  {c.a}", f"B  {c.b}", *c.notes]
    for section in comparison_sections(c):
        lines += ["", str(section.title)]
        for part in section.parts:
            if isinstance(part, Paragraph) and not part.soft:
                lines.append(f"  {part.text}")
            elif isinstance(part, Table):
                lines += [f"  {line}" for line in table_lines(part)]
    return "\n".join(lines)


def table_lines(table: Table) -> list[str]:
    """Return a table as aligned lines of text."""
    columns = len(table.heads) - table.last_text  # definitions are for the page
    rows = [list(table.heads)[:columns]] if any(table.heads) else []
    rows += [list(row)[:columns] for row in table.rows]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))] if rows else []
    lines = [str(table.title)] if table.title else []
    for row in rows:
        cells = [
            cell.ljust(w) if i < table.left else cell.rjust(w)
            for i, (cell, w) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(cells).rstrip())
    return lines


def _tiles(c: Comparison) -> list[tuple[str, str]]:
    found = {n.key: n for n in c.numbers}
    tiles = []
    for key, digits in (("sigma0_px", 3), ("rms_px", 3)):
        n = found[key]
        tiles.append((f"{_number(n.a, digits)} → {_number(n.b, digits)}{_unit(n.unit)}", n.label))
    changed = sum(1 for row in c.cameras if row.significant)
    tiles.append((str(len(c.recipe)), "parameters of the recipe differ"))
    tiles.append((str(changed), "camera parameters differ significantly"))
    return tiles


def _recipe(c: Comparison) -> Sequence[Part]:
    if not c.recipe:
        return (
            Paragraph(Text("The recipes agree in every choice and parameter, as far as they are known.")),
        )
    rows = [
        (d.where, d.label, _setting(d.a, d.unit), _setting(d.b, d.unit)) for d in c.recipe
    ]  # fmt: skip
    return (Table(("Where", "Parameter", "A", "B"), rows, left=4),)


def _setting(value: Any, unit: str) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value}{_unit(unit)}"


def _numbers(c: Comparison) -> Table:
    rows = [
        (n.label, n.unit, _number(n.a), _number(n.b), _delta(n), n.better.upper(), n.definition) for n in c.numbers
    ]  # fmt: skip
    return Table(("", "Unit", "A", "B", "B − A", "better", "Definition"), rows, left=2, last_text=True)


def _delta(n: NumberDifference) -> str:
    if n.a is None or n.b is None or not (math.isfinite(n.a) and math.isfinite(n.b)):
        return UNKNOWN
    return _signed(n.b - n.a)


def _cameras(c: Comparison) -> Sequence[Part]:
    parts: list[Part] = []
    for calibration in c.calibrations:
        rows = [_camera_row(r) for r in c.cameras if r.camera == calibration.camera]
        parts.append(Table(
            ("Parameter", "Unit", "A ± σ", "B ± σ", "B − A ± σ", "significant"), rows, left=2, title=calibration.camera,
            note=Text(
                "σ of the difference: √(σ_A² + σ_B²), as if both were independent; they share observations, so this is "
                "on the safe side. Significant: more than 1.96 σ (5 % error probability)."),
        ))  # fmt: skip
        parts.append(Paragraph(Text(
            "Over the format the two calibrations image the same rays {rms} apart (root mean square; at most {most}), "
            "after the rotation between the camera frames that fits best.",
            rms=format_value(calibration.rms_px, unit="px", digits=3),
            most=format_value(calibration.largest_px, unit="px", digits=3),
        )))  # fmt: skip
    return parts


def _camera_row(r: CameraParameterDifference) -> tuple[str, ...]:
    verdict = UNKNOWN if r.significant is None else "yes" if r.significant else "no"
    return (
        f"{r.label} {r.symbol.replace('_', '')}", r.unit, _held(r.a, r.sigma_a), _held(r.b, r.sigma_b),
        UNKNOWN if r.difference is None else format_value(r.difference, r.sigma, digits=3), verdict,
    )  # fmt: skip


def _held(value: float | None, sigma: float | None) -> str:
    if value is None:
        return "not in the model"
    return format_value(value, sigma, digits=6) + ("" if sigma else " fixed")


def _photos(c: Comparison) -> Sequence[Part]:
    parts: list[Part] = [Paragraph(c.frame.how)]
    if c.frame.moved:
        parts.append(Paragraph(Text(
            "The similarity: scale {scale}, rotation {turn}, shift {shift}.",
            scale=format_value(c.frame.scale, digits=8), turn=format_value(c.frame.rotation_deg, unit="°", digits=3),
            shift=format_value(c.frame.shift, unit=c.frame.unit, digits=3)), soft=True))  # fmt: skip
    for names, label in ((c.only_a, c.a), (c.only_b, c.b)):
        if names:
            parts.append(Paragraph(Text("Only in {label}: {names}.", label=label, names=", ".join(names))))
    heads = ("Photo", *(f"Δ{axis} {c.frame.unit}" for axis in "XYZ"), "largest σ", "rotation °", "points A", "points B",
             "RMS A px", "RMS B px")  # fmt: skip
    parts.append(Table(heads, [_photo_row(p) for p in c.photos], note=Text(
        "Δ: of the projection centre. σ: √(σ_A² + σ_B²), as if both were independent; errors that both share, such as those "
        "of the control, are in it, so it is on the safe side.")))  # fmt: skip
    return parts


def _photo_row(p: PhotoDifference) -> tuple[str, ...]:
    moved = [*(_number(d, 3) for d in p.centre), _number(max(p.sigma_centre), 2)]
    return (
        p.name, *moved, _number(p.rotation_deg, 3), format_number(p.observations_a), format_number(p.observations_b),
        _number(p.rms_a_px, 3), _number(p.rms_b_px, 3),
    )  # fmt: skip


def _points(c: Comparison) -> Sequence[Part]:
    p, unit = c.points, c.frame.unit
    if not p.common:
        return (Paragraph(Text("The two have no object point in common.")),)
    rows = [
        ("Points in both, only in A, only in B",
         f"{format_number(p.common)}, {format_number(p.only_a)}, {format_number(p.only_b)}"),
        *((f"RMS of Δ{axis}", format_value(v, unit=unit, digits=3)) for axis, v in zip("XYZ", p.rms, strict=True)),
        ("Distance B from A: median", format_value(p.median, unit=unit, digits=3)),
        ("Distance B from A: 95 % within", format_value(p.q95, unit=unit, digits=3)),
        ("Distance B from A: largest", format_value(p.largest, unit=unit, digits=3)),
        ("Median σ per coordinate in A", format_value(p.sigma_a, unit=unit, digits=3)),
        ("Median σ per coordinate in B", format_value(p.sigma_b, unit=unit, digits=3)),
    ]  # fmt: skip
    note = Text(
        "Points are recognised by an image measurement that both have. σ: from the covariance, precision."
    )
    return (Table(("", ""), rows, note=note),)


def _check(c: Comparison) -> Sequence[Part]:
    if c.check.rms_a is None and c.check.rms_b is None:
        return (
            Paragraph(Text("Neither has check points: nothing independent says which of the two is right.")),
        )
    rows = []
    for label, count, rms in (("A", c.check.count_a, c.check.rms_a), ("B", c.check.count_b, c.check.rms_b)):
        cells = [_number(1000 * v, 3) for v in rms] if rms else [UNKNOWN] * 3
        rows.append((label, format_number(count), *cells))
    note = Text(
        "Root mean square per axis of computed − given. Check points took no part: they measure accuracy."
    )
    return (Table(("", "points", "X mm", "Y mm", "Z mm"), rows, note=note),)


def _number(value: float | None, digits: int = 5) -> str:
    return format_number(value, digits=digits)


def _signed(value: float) -> str:
    shown = format_number(value, digits=4)
    return f"+{shown}" if value > 0 else shown


def _unit(unit: str) -> str:
    return f"\u2009{unit}" if unit else ""
