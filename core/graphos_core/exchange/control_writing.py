"""Writing control points and measurements as `graphos_core.exchange.control` reads them, inside a project only."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from graphos_core.data import KnownDistance
from graphos_core.exchange import distance_table
from graphos_core.exchange.control_sheet import ControlSheet
from graphos_core.store import write_bytes, write_text

POINTS, MARKS = "control.csv", "control_measurements.csv"
EARLIER = "earlier"
"""Folder of the project in which versions of the files are kept."""


def control_text(sheet: ControlSheet) -> str:
    """Return the table of control points; a point whose coordinates are all unknown is told by its measurements."""
    with_sigma = any(math.isfinite(v) for point in sheet.points for v in point.sigma)
    header = [
        "name",
        "x [m]",
        "y [m]",
        "z [m]",
        *(("sx [m]", "sy [m]", "sz [m]") if with_sigma else ()),
        "role",
    ]
    rows = [
        [p.name, *map(_metres, p.xyz), *(map(_metres, p.sigma) if with_sigma else ()), p.role]
        for p in sheet.points
        if p.known
    ]
    crs = f"# crs: {sheet.crs}\n" if sheet.crs else ""
    return crs + _csv(header, rows)


def measurements_text(sheet: ControlSheet) -> str:
    """Return the table of measurements, sorted by photo and point."""
    with_sigma = any(math.isfinite(mark.sigma_px) for mark in sheet.marks.values())
    rows = [
        [photo, name, f"{m.x:.4f}", f"{m.y:.4f}", *([_number(m.sigma_px)] if with_sigma else ())]
        for (name, photo), m in sorted(sheet.marks.items(), key=lambda item: (item[0][1], item[0][0]))
    ]
    return _csv(["photo", "name", "x [px]", "y [px]", *(["sigma [px]"] if with_sigma else ())], rows)


def write_sheet(folder: Path, sheet: ControlSheet) -> None:
    """Write ``control.csv``, ``control_measurements.csv`` and, where there are or were any, ``control_distances.csv``.

    Each is written atomically, into a project folder.

    Raises
    ------
    UserError
        When the folder cannot be written.
    """
    known = [
        KnownDistance(
            a=d.a, b=d.b, metres=d.metres, sigma=d.sigma if math.isfinite(d.sigma) else None, check=d.check
        )
        for d in sheet.distances
    ]
    if known or (folder / distance_table.FILE).is_file():
        write_text(folder / distance_table.FILE, distance_table.distances_text(known))
    write_text(folder / MARKS, measurements_text(sheet))
    write_text(folder / POINTS, control_text(sheet))


def keep_version(folder: Path) -> Path | None:
    """Copy the present control files into the next numbered folder of ``earlier``; None where nothing is new.

    Raises
    ------
    UserError
        When the folder cannot be written.
    """
    files = {
        name: (folder / name).read_bytes()
        for name in (POINTS, MARKS, distance_table.FILE)
        if (folder / name).is_file()
    }
    kept = sorted(path for path in (folder / EARLIER).glob("[0-9][0-9][0-9][0-9]") if path.is_dir())
    last = {path.name: path.read_bytes() for path in kept[-1].iterdir()} if kept else {}
    if not files or files == last:
        return None
    target = folder / EARLIER / f"{int(kept[-1].name) + 1 if kept else 1:04d}"
    for name, content in files.items():
        write_bytes(target / name, content)
    return target


def _csv(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return out.getvalue()


def _metres(value: float) -> str:
    """Write to the nanometre, as short as that is; empty for an unknown value."""
    if not math.isfinite(value):
        return ""
    text = f"{value:.9f}".rstrip("0")
    return text + "0" if text.endswith(".") else text


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else ""
