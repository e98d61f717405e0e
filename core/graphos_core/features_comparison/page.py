"""A comparison of algorithms for people: its page, the lines for the terminal, and the table as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from graphos_core.calibration_pictures import png_bytes, svg_url
from graphos_core.features_comparison.figures import bars, curves
from graphos_core.features_comparison.measures import CELL_PX, REPEATED_PX, RIGHT_PX
from graphos_core.features_comparison.records import FeatureComparison, Row
from graphos_core.number_format import UNKNOWN, format_number
from graphos_core.report.page import Page, Paragraph, Part, Picture, Problem, Section, Table
from graphos_core.run_comparison.page import table_lines
from graphos_core.store import write_bytes, write_text
from graphos_core.text import Text

COLUMNS = (
    ("algorithm", "algorithm"), ("keypoints", "key points"), ("time_s", "time s"), ("matches", "matches"),
    ("verified", "verified"), ("inlier_share", "inlier share"), ("coverage", "coverage"), ("mean_rays", "rays"),
    ("correct_3px", "correct"), ("correct_cells_2px", "correct, per cell"), ("repeatability", "repeatability"),
    ("precision", "precision"), ("matching_score", "matching score"),
)  # fmt: skip
"""Key and heading of the columns of the table."""

TRUTH = ("correct_3px", "correct_cells_2px", "repeatability", "precision", "matching_score")
"""Columns that need truth."""


def comparison_page(comparison: FeatureComparison) -> Page:
    """Return the page of a comparison, which `Page.html` writes."""
    return Page(
        title=Text("Algorithms compared on {n} photos", n=len(comparison.photos)),
        subtitle=Text("Detectors, descriptors and matchers · {names}", names=", ".join(comparison.photos)),
        problems=[Problem("info", text) for text in remarks(comparison)],
        tiles=_tiles(comparison),
        sections=_sections(comparison),
        no_problem=Text("Every algorithm ran, and the truth is known."),
    )


def remarks(comparison: FeatureComparison) -> list[str]:
    """Return what must be known to read the figures: what failed, why truth is missing, what was left out."""
    failed = [Text("{name} could not be run: {why}", name=r.algorithm, why=r.failure)
              for r in comparison.rows if r.failure]  # fmt: skip
    return [*failed, *([comparison.no_truth] if comparison.no_truth else []), *comparison.notes]


def columns(comparison: FeatureComparison) -> list[tuple[str, str]]:
    """Return key and heading of the columns that hold something."""
    return [c for c in COLUMNS if comparison.homography is not None or c[0] not in TRUTH]


def cells(row: Row, keys: Sequence[str]) -> list[str]:
    """Return a row of the table as finished texts."""
    digits = {"time_s": 3, "mean_rays": 3, "keypoints": 9, "matches": 9, "verified": 9}
    found = []
    for key in keys:
        value = getattr(row, key)
        missing = value is None or (row.failure and key != "algorithm")
        shown = value if isinstance(value, str) else format_number(value, digits=digits.get(key, 3))
        found.append(UNKNOWN if missing else shown)
    return found


def _sections(comparison: FeatureComparison) -> tuple[Section, ...]:
    keys = [key for key, _ in columns(comparison)]
    table = Table(
        [heading for _, heading in columns(comparison)],
        [cells(row, keys) for row in comparison.rows],
    )
    parts: list[Part] = [table]
    if any(not row.failure for row in comparison.rows):
        alt = Text("Key points, matches, shares and seconds of each algorithm as bars")
        parts.append(Picture(alt, image=svg_url(bars(comparison))))
    sections = [Section("table", Text("What each algorithm gave"), "features/comparing", parts)]
    if comparison.curves:
        sections.append(_against(comparison))
    changed = [
        (row.algorithm, name, value) for row in comparison.rows for name, value in row.parameters.items()
    ]
    if changed:
        table = Table(("Row", "Parameter", "Value"), changed, left=3)
        sections.append(Section("set", Text("What was set"), "", [table]))
    return tuple(sections)


def _against(comparison: FeatureComparison) -> Section:
    text = Text(
        "The first photo, reduced, was matched with changed versions of itself, so that the truth is known exactly. A point "
        "counts as repeated within {repeated} px, a match as right within {right} px, once per cell of {cell} px.",
        repeated=REPEATED_PX, right=RIGHT_PX, cell=CELL_PX,
    )  # fmt: skip
    picture = Picture(
        Text("Repeatability and matching score of each algorithm against growing disturbance"),
        image=svg_url(curves(comparison)),
    )
    return Section(
        "against", Text("Against viewpoint, scale, rotation, blur, noise and light"), "features/comparing",
        [Paragraph(text), picture],
    )  # fmt: skip


def _tiles(comparison: FeatureComparison) -> list[tuple[str, str]]:
    rows = [row for row in comparison.rows if not row.failure]
    if not rows:
        return []
    most, quick = max(rows, key=lambda r: r.verified), min(rows, key=lambda r: r.time_s)
    tiles: list[tuple[str, str]] = [(most.algorithm, Text("most verified matches: {n}", n=format_number(most.verified, digits=9))),
             (quick.algorithm, Text("quickest: {s} s", s=format_number(quick.time_s, digits=2)))]  # fmt: skip
    if comparison.homography is not None:
        right = max(rows, key=lambda r: r.correct_cells_2px or 0)
        tiles.append((right.algorithm, Text("most correct places: {n}", n=format_number(right.correct_cells_2px, digits=9))))  # fmt: skip
    return tiles


def comparison_text(comparison: FeatureComparison) -> str:
    """Return the comparison as lines for the terminal."""
    keys = [key for key, _ in columns(comparison)]
    table = Table([h for _, h in columns(comparison)], [cells(row, keys) for row in comparison.rows])
    return "\n".join([*table_lines(table), "", *remarks(comparison)]).rstrip()


def comparison_csv(comparison: FeatureComparison) -> str:
    """Return every figure of every row as a table with commas; empty where a figure is not known."""
    heads = [key for key, _ in COLUMNS]
    more = ["detection_s", "matching_s", "verification_s", "photos_connected", "parameters", "failure"]
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow([*heads, *more])
    for row in comparison.rows:
        values = ["" if (v := getattr(row, key)) is None else v for key in heads]
        seconds = [row.seconds.get(part, "") for part in ("detection", "matching", "verification")]
        parameters = "; ".join(f"{name}={value}" for name, value in row.parameters.items())
        writer.writerow([*values, *seconds, row.photos_connected, parameters, row.failure])
    return buffer.getvalue()


def curves_csv(comparison: FeatureComparison) -> str:
    """Return the curves as a table with commas: one line per algorithm, disturbance and level."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(
        ["algorithm", "disturbance", "level", "repeatability", "matching_score", "correct_cells_2px"]
    )
    for c in comparison.curves:
        for level, repeated, score, correct in zip(
            c.levels, c.repeatability, c.matching_score, c.correct, strict=True
        ):
            writer.writerow([c.algorithm, c.disturbance, level, repeated, score, correct])
    return buffer.getvalue()


def write_comparison(comparison: FeatureComparison, folder: Path) -> list[Path]:
    """Write ``comparison.json, .csv, .html, .png, .svg`` and, with disturbances, ``disturbances.*``; return the paths.

    Raises
    ------
    UserError
        When the folder cannot be written.
    """
    import json

    data = json.dumps(comparison.to_dict(), indent=1, ensure_ascii=False, allow_nan=False)
    texts = {"comparison.json": data, "comparison.csv": comparison_csv(comparison),
             "comparison.html": comparison_page(comparison).html()}  # fmt: skip
    figures = {"comparison": bars(comparison)} if any(not r.failure for r in comparison.rows) else {}
    if comparison.curves:
        texts["disturbances.csv"] = curves_csv(comparison)
        figures["disturbances"] = curves(comparison)
    for name, text in texts.items():
        write_text(folder / name, text)
    for name, figure in figures.items():
        write_bytes(folder / f"{name}.svg", _svg(figure))
        write_bytes(folder / f"{name}.png", png_bytes(figure, dpi=150))
    return [folder / n for n in (*texts, *(f"{f}.{e}" for f in figures for e in ("svg", "png")))]


def _svg(figure: object) -> bytes:
    import base64

    return base64.b64decode(svg_url(figure).partition(",")[2])
