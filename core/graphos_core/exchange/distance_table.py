"""Known distances as a text table beside the control points: ``control_distances.csv``.

Columns ``from, to, distance`` and optionally ``sigma`` and ``role`` (scale or check); lengths in metres unless a unit
stands behind the column's name. The ends are measured points, or two photos (distance of their projection centres).
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from pathlib import Path

from graphos_core.data import KnownDistance
from graphos_core.errors import UserError
from graphos_core.exchange.control_tables import LARGEST, LENGTHS
from graphos_core.exchange.table_preview import guess, number, split, title_and_unit
from graphos_core.text import Text

FILE = "control_distances.csv"
COLUMNS = {
    "from": ("from", "a", "point a", "start"), "to": ("to", "b", "point b", "end"),
    "distance": ("distance", "length", "d"), "sigma": ("sigma", "σ", "std"), "role": ("role", "use"),
}  # fmt: skip


def distances_text(distances: Iterable[KnownDistance]) -> str:
    """Return the table of known distances."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["from", "to", "distance [m]", "sigma [m]", "role"])
    for d in distances:
        sigma = "" if d.sigma is None else f"{d.sigma:.9g}"
        writer.writerow([d.a, d.b, f"{d.metres:.12g}", sigma, "check" if d.check else "scale"])
    return out.getvalue()


def read_distances(path: Path) -> tuple[KnownDistance, ...]:
    """Read known distances; none where there is no such file.

    Raises
    ------
    UserError
        When it cannot be read, or for the first bad line with its number.
    """
    if not path.is_file():
        return ()
    try:
        if path.stat().st_size > LARGEST:
            raise UserError(
                Text("{name} is larger than 50 MB.", name=path.name), todo="Choose a table of distances."
            )
        text = path.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError as problem:
        raise UserError(Text("{name} could not be read.", name=path.name), str(problem)) from problem
    lines = [
        (i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")
    ]
    if not lines:
        return ()
    table = guess(text)
    header = split(lines[0][1], table.delimiter)
    columns, factors = _header(header)
    units = [title_and_unit(header[columns[name]])[1] for name in ("distance", "sigma") if name in columns]
    missing = [name for name in ("from", "to", "distance") if name not in columns]
    if missing:
        raise _bad(path, lines[0][0], Text("the header has no column {names}", names=", ".join(missing)))
    unit = next((u for u in units if u and u not in LENGTHS), "")
    if unit:
        raise _bad(path, lines[0][0], Text("the unit is “{unit}”, needs one of: {valid}", unit=unit[:20],
                                           valid=", ".join(LENGTHS)))  # fmt: skip
    found = []
    for line, row in lines[1:]:
        cells = split(row, table.delimiter)
        values = {name: cells[i] if i < len(cells) else "" for name, i in columns.items()}
        found.append(_distance(path, line, values, factors, table.decimal))
    return tuple(found)


def _header(cells: list[str]) -> tuple[dict[str, int], dict[str, float]]:
    columns: dict[str, int] = {}
    factors: dict[str, float] = {}
    for i, cell in enumerate(cells):
        title, unit = title_and_unit(cell)
        for name, words in COLUMNS.items():
            if title in words and name not in columns:
                columns[name], factors[name] = i, LENGTHS.get(unit, 1.0)
    return columns, factors


def _distance(
    path: Path, line: int, cells: dict[str, str], factors: dict[str, float], decimal: str
) -> KnownDistance:
    a, b, role = cells["from"], cells["to"], cells.get("role", "").casefold()
    metres = number(cells["distance"], decimal) * factors["distance"]
    sigma = number(cells.get("sigma", ""), decimal) * factors.get("sigma", 1.0)
    if not a or not b or a == b:
        raise _bad(path, line, "two different ends are needed")
    if not metres > 0:
        raise _bad(
            path, line, Text("the distance is “{text}”, needs more than 0", text=cells["distance"][:40])
        )
    if cells.get("sigma", "") and not sigma >= 0:
        raise _bad(path, line, Text("sigma is “{text}”, needs 0 or more", text=cells["sigma"][:40]))
    if role not in ("", "scale", "check", "control"):
        raise _bad(path, line, Text("the role “{role}” is neither scale nor check", role=role[:40]))
    return KnownDistance(
        a=a, b=b, metres=metres, sigma=sigma if math.isfinite(sigma) else None, check=role == "check"
    )


def _bad(path: Path, line: int, why: str) -> UserError:
    return UserError(
        Text("{name}, line {line}, could not be read.", name=path.name, line=line),
        Text("There {why}.", why=why),
        "Correct the line; the columns are from, to, distance, sigma, role.",
    )
