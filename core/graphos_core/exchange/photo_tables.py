"""Positions and attitudes of photos: tables, and what photos say themselves (EXIF)."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

from graphos_core.data import Array, PhotoSet
from graphos_core.errors import UserError
from graphos_core.exchange.coordinates import local_tangent_frame
from graphos_core.geometry.rotation import matrix_from_opk
from graphos_core.project_file import inside
from graphos_core.text import Text

SIGMAS = ("sx", "sy", "sz")


def read_positions(
    beside: Path, source: str, origin: Array, photos: PhotoSet
) -> tuple[tuple[str, ...], Array, Array]:
    """Return the photos, their positions (k, 3) in m less `origin`, and standard deviations (k, 3), NaN where unknown.

    Parameters
    ----------
    beside : Path
        The file that names the table; the table stands in its folder.
    source : str
        ``"photos"``, or the name of a table ``photo,x,y,z[,sx,sy,sz]``.
    origin : float64 (3,)
    photos : PhotoSet
    """
    if source == "photos":
        return _from_photos(photos)
    names, columns = _table(inside(beside.parent, source), ("x", "y", "z"), SIGMAS)
    wrong = np.flatnonzero((columns[:, 3:] <= 0).any(axis=1))
    if len(wrong):
        raise UserError(Text("{name} cannot be used.", name=source),
                        Text("A standard deviation of {photo} is not above 0.", photo=names[wrong[0]]),
                        "Give standard deviations in m, or leave the cell empty.", learn="adjustment/gnss")  # fmt: skip
    return names, columns[:, :3] - origin, columns[:, 3:]


def _from_photos(photos: PhotoSet) -> tuple[tuple[str, ...], Array, Array]:
    """Return EXIF positions in a frame east, north, up at their mean."""
    known = [p for p in photos.photos if p.exif.latitude_deg is not None and p.exif.longitude_deg is not None
             and math.isfinite(p.exif.latitude_deg + p.exif.longitude_deg + (p.exif.altitude_m or 0.0))]  # fmt: skip
    known = [
        p for p in known if p.exif.altitude_m is not None
    ] or known  # a missing height is not the height 0
    if not known:
        raise UserError("The photos say no positions.", "None of them has GNSS coordinates in its EXIF.",
                        "Give a table of positions, or take the section [gnss] out.", learn="adjustment/gnss")  # fmt: skip
    degrees = np.array([[p.exif.latitude_deg, p.exif.longitude_deg, p.exif.altitude_m or 0.0] for p in known])
    xyz = local_tangent_frame(degrees.mean(axis=0)).from_geographic(degrees)
    return tuple(p.name for p in known), xyz, np.full(xyz.shape, np.nan)


def read_attitudes(beside: Path, source: str) -> tuple[tuple[str, ...], Array]:
    """Return the photos and ``body_from_world`` (k, 3, 3) of a table ``photo,omega,phi,kappa`` in degrees.

    The axes of the body are those of a camera: x right, y down, z forward where the boresight is the identity.
    """
    names, columns = _table(inside(beside.parent, source), ("omega", "phi", "kappa"), ())
    return names, np.array([matrix_from_opk(*np.radians(row)) for row in columns])


def _table(path: Path, needed: tuple[str, ...], optional: tuple[str, ...]) -> tuple[tuple[str, ...], Array]:
    """Read a table with a header; optional columns that are missing become NaN."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as problem:
        why = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        raise UserError(Text("The table {name} could not be read.", name=path.name),
                        Text("The system says: {why}.", why=why), "Check its name and that it is a text file.") from problem  # fmt: skip
    lines = [
        (i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")
    ]
    if not lines:
        raise UserError(Text("The table {name} is empty.", name=path.name))
    delimiter = max(",;\t", key=lines[0][1].count)
    header = [cell.strip().casefold() for cell in next(csv.reader([lines[0][1]], delimiter=delimiter))]
    missing = [name for name in ("photo", *needed) if name not in header]
    if missing:
        raise UserError(Text("The table {name} has no column {column}.", name=path.name, column=missing[0]),
                        Text("Its header is “{header}”.", header=lines[0][1][:80]),
                        Text("Name the columns: photo, {columns}.", columns=", ".join((*needed, *optional))))  # fmt: skip
    names, rows = [], []
    for number, line in lines[1:]:
        cells = next(csv.reader([line], delimiter=delimiter))
        row = dict(zip(header, (cell.strip() for cell in cells), strict=False))
        name = row.get("photo", "")
        if not name or name in names:
            raise _bad_line(path, number, Text("the photo {name} occurs twice", name=name) if name
                            else Text("the name of the photo is missing"))  # fmt: skip
        names.append(name)
        rows.append([_number(path, number, row.get(c, ""), c) for c in needed]
                    + [_number(path, number, row[c], c) if row.get(c) else math.nan for c in optional])  # fmt: skip
    return tuple(names), np.array(rows, dtype=np.float64).reshape(-1, len(needed) + len(optional))


def _number(path: Path, line: int, text: str, column: str) -> float:
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _bad_line(path, line, Text("{column} is “{text}”, not a number", column=column, text=text[:40]))
    return value


def _bad_line(path: Path, line: int, why: str) -> UserError:
    return UserError(Text("{name}, line {line}, could not be read.", name=path.name, line=line),
                     Text("There {why}.", why=why), "Correct the line.")  # fmt: skip
