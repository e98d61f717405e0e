"""Tie points of other programs: image points and which of them show the same object point.

- ``table``: CSV ``point,photo,x [px],y [px]``.
- ``colmap``: a folder with a feature file per photo (``PHOTO.txt``: position, scale, orientation, 128 descriptor values)
  and ``matches.txt``, as COLMAP's ``feature_importer`` and ``matches_importer`` take them; or its ``database.db``.
- ``micmac``: a folder ``Homol`` with ``PastisA/B.txt`` per pair, four numbers per line; text, not ``.dat``.
- ``bundler``: the view lists of a bundle file, read only: written together with the orientation.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from graphos_core.errors import UserError
from graphos_core.exchange.bundler import read_bundler
from graphos_core.exchange.text_files import bad_line, finite, not_such, read_lines
from graphos_core.exchange.tie_point_records import TiePoints, from_observations
from graphos_core.exchange.tie_points_colmap import (
    read_colmap_database,
    read_colmap_points,
    write_colmap_points,
)
from graphos_core.exchange.tie_points_micmac import PREFIX, read_micmac_points, write_micmac_points
from graphos_core.params import unknown_name
from graphos_core.store import write_text

__all__ = ["TIE_POINT_FORMATS", "TiePoints", "from_observations", "read_tie_points", "write_tie_points"]

TIE_POINT_FORMATS = {
    "table": "CSV: point, photo, x, y in px",
    "colmap": "COLMAP feature files with matches.txt; reads database.db",
    "micmac": "MicMac Homol folder, text",
    "bundler": "Bundler bundle.out (only read)",
}
"""Formats by name."""


def read_tie_points(path: Path, name: str = "") -> TiePoints:
    """Read tie points; `name` empty to recognise the format.

    Raises
    ------
    UserError
        When the file or folder cannot be read, with the line.
    """
    name = name or _guess(path)
    if name == "table":
        return _read_table(path)
    if name == "micmac":
        return read_micmac_points(path)
    if name == "bundler":
        block = read_bundler(path).block
        return from_observations(block.names, block.obs_point, block.obs_photo, block.obs_xy, block.colours)
    if name == "colmap":
        database = path / "database.db" if path.is_dir() else path
        return read_colmap_database(database) if database.is_file() else read_colmap_points(path)
    raise UserError(unknown_name(name, list(TIE_POINT_FORMATS), "tie point format"))


def _guess(path: Path) -> str:
    if path.is_dir():
        return "micmac" if any(p.is_dir() and p.name.startswith(PREFIX) for p in path.iterdir()) else "colmap"
    if path.suffix == ".db":
        return "colmap"
    return "bundler" if path.suffix == ".out" else "table"


def write_tie_points(points: TiePoints, path: Path, name: str) -> tuple[Path, ...]:
    """Write tie points; the files written.

    Raises
    ------
    UserError
        When a file cannot be written, or the format is only read.
    """
    if name == "table":
        return _write_table(points, path)
    if name == "micmac":
        return write_micmac_points(points, path)
    if name == "colmap":
        return write_colmap_points(points, path)
    if name == "bundler":
        raise UserError(
            "Bundler keeps tie points inside its bundle file.", "They are written together with the orientation.",
            "Use graphos convert orientation … --to bundler.",
        )  # fmt: skip
    raise UserError(unknown_name(name, list(TIE_POINT_FORMATS), "tie point format"))


def _read_table(path: Path) -> TiePoints:
    lines = read_lines(path)
    rows = list(csv.reader(io.StringIO("\n".join(lines))))
    head = [cell.casefold().split("[")[0].strip() for cell in rows[0]] if rows else []
    if not {"point", "photo", "x", "y"} <= set(head):
        raise not_such(
            path, "a table of tie points", "Its first line must name the columns point, photo, x, y."
        )
    at = [head.index(name) for name in ("point", "photo", "x", "y")]
    numbers: dict[str, int] = {}
    photos: dict[str, int] = {}
    point, photo, xy = [], [], []
    for n, row in enumerate(rows[1:], 2):
        if not any(row) or row[0].startswith("#"):
            continue
        try:
            name, where, x, y = (row[i].strip() for i in at)
            xy.append(finite([x, y]))
        except (IndexError, ValueError):
            raise bad_line(path, n, ",".join(row), "point, photo and two numbers") from None
        point.append(numbers.setdefault(name, len(numbers)))
        photo.append(photos.setdefault(where, len(photos)))
    return from_observations(
        tuple(photos), np.array(point, dtype=int), np.array(photo, dtype=int), np.array(xy).reshape(-1, 2)
    )


def _write_table(points: TiePoints, path: Path) -> tuple[Path, ...]:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["point", "photo", "x [px]", "y [px]"])
    t = points.tracks
    for track, photo, (x, y) in zip(t.track.tolist(), t.photo.tolist(), t.xy.tolist(), strict=True):
        writer.writerow([track, points.photos[photo], repr(x), repr(y)])
    write_text(path, out.getvalue())
    return (path,)
