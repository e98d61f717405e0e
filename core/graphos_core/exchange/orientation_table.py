"""Tables of projection centres and angles: a guess of their format that a person can correct, reading and writing.

One row per photo: name, X, Y, Z, three angles. What a table does not say (unit and order of the angles, unit of the
coordinates) is guessed with a reason, which a dialog shows beside each setting.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from graphos_core.data import Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.attitudes import ORDERS, UNITS, angles_from_rotation, rotation_from_angles
from graphos_core.exchange.block_parts import Parts, Read, Written
from graphos_core.exchange.control_tables import LENGTHS
from graphos_core.exchange.table_preview import BadLine, TableFormat, cells, guess, number
from graphos_core.exchange.text_files import read_bytes
from graphos_core.store import write_text
from graphos_core.text import Text

NAMES = (
    "name",
    "photo",
    "image",
    "label",
    "file",
    "filename",
    "photo name",
    "image name",
    "id",
    "photo id",
    "#label",
)
POSITION = {
    "x": ("x", "east", "easting", "e", "x0", "xc", "x/longitude", "x/east", "xo"),
    "y": ("y", "north", "northing", "n", "y0", "yc", "y/latitude", "y/north", "yo"),
    "z": ("z", "height", "h", "altitude", "elevation", "z0", "zc", "z/altitude", "z/height", "zo"),
}
ANGLES = {
    "omega": ("omega", "ω", "om", "o", "w"), "phi": ("phi", "φ", "ph", "p"), "kappa": ("kappa", "κ", "ka", "k"),
    "yaw": ("yaw", "heading"), "pitch": ("pitch",), "roll": ("roll",),
}  # fmt: skip
"""What a header may call each column."""

UNIT_WORDS = {"deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg", "gon": "gon", "grad": "gon", "g": "gon",
              "rad": "rad", "radian": "rad", "radians": "rad"}  # fmt: skip


@dataclass(frozen=True)
class OrientationTableFormat:
    """How a table of orientations is written.

    Attributes
    ----------
    table : TableFormat
        Delimiter, decimal sign, lines before the first photo, unit of the coordinates; its `columns` hold ``name``,
        ``x``, ``y``, ``z`` and ``a``, ``b``, ``c``: the three angles in the sequence of `order`.
    order : str
        A key of `graphos_core.exchange.attitudes.ORDERS`.
    angle_unit : {"deg", "gon", "rad"}
    crs : str
        Coordinate system of the positions, such as ``"EPSG:25832"``; empty for a local one. It is kept, not applied.
    reasons : mapping of str to str
        Why each setting was guessed: keys ``delimiter``, ``columns``, ``order``, ``angle_unit``, ``unit``.
    """

    table: TableFormat = field(default_factory=TableFormat)
    order: str = "omega phi kappa"
    angle_unit: str = "deg"
    crs: str = ""
    reasons: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class OrientationRow:
    """One photo of a table: position in metres, angles in radians."""

    name: str
    xyz: tuple[float, float, float]
    angles: tuple[float, float, float]


@dataclass(frozen=True)
class Preview:
    """What a format makes of a text: cells of the first lines, photos that were read, lines that were not."""

    cells: tuple[tuple[str, ...], ...]
    rows: tuple[OrientationRow, ...]
    bad: tuple[BadLine, ...]


def guess_orientations(text: str) -> OrientationTableFormat:
    """Return the format that fits a text best, with a reason for each setting."""
    table = guess(text)
    grid = cells(text, table)
    head = next((row for row in reversed(grid[: table.skip]) if sum(map(bool, row)) >= 4), [])
    columns, order, unit, length, why = _from_header(head)
    if len(columns) < 7:
        first = grid[table.skip] if table.skip < len(grid) else []
        shift = 0 if (first and not math.isfinite(number(first[0], table.decimal))) or len(first) == 7 else -1
        columns = {key: i + shift for i, key in enumerate(("name", "x", "y", "z", "a", "b", "c"))}
        columns = {key: i for key, i in columns.items() if i >= 0}
        why["columns"] = "The header names no columns: taken as name, X, Y, Z and three angles in this order."
        why["order"] = "Nothing says which angles these are: omega, phi, kappa is the usual order."
    found = OrientationTableFormat(replace(table, columns=columns, unit=length or "m"), order, unit or "deg")
    if not unit:
        unit, why["angle_unit"] = _guess_unit(text, found)
    why["unit"] = (
        Text("The header says {unit}.", unit=length) if length else "Nothing says another unit than metres."
    )
    why["delimiter"] = "Most lines have the same number of cells with it."
    return replace(found, angle_unit=unit, reasons=why)


def _from_header(head: Sequence[str]) -> tuple[dict[str, int], str, str, str, dict[str, str]]:
    """Return columns, angle order, angle unit, length unit and reasons that a header gives."""
    known: dict[str, int] = {}
    unit = length = ""
    for index, cell in enumerate(head):
        title, said = _title(cell)
        for key, words in {"name": NAMES, **POSITION, **ANGLES}.items():
            if title in words and key not in known:
                known[key] = index
                if key in ANGLES and said in UNIT_WORDS:
                    unit = UNIT_WORDS[said]
                if key in POSITION and said in LENGTHS:
                    length = said
                break
    three: list[str] = [key for key in ("yaw", "pitch", "roll") if key in known]
    if len(three) == 3:
        order = "yaw pitch roll"
    else:
        three = [key for key in ("omega", "phi", "kappa") if key in known]
        order = "omega phi kappa"
        if len(three) == 3 and known["phi"] < known["omega"]:
            order, three = "phi omega kappa", ["phi", "omega", "kappa"]
    columns: dict[str, int] = {key: known[key] for key in ("name", "x", "y", "z") if key in known}
    columns.update({letter: known[key] for letter, key in zip("abc", three, strict=False)})
    why: dict[str, str] = {}
    if len(columns) == 7:
        why["columns"] = "The header names them."
        why["order"] = Text("The header names {angles}.", angles=", ".join(three))
    if unit:
        why["angle_unit"] = Text("The header says {unit}.", unit=unit)
    return columns, order, unit, length, why


def _title(cell: str) -> tuple[str, str]:
    """Split ``"Omega [gon]"``, ``"kappa_deg"`` or ``"phi (rad)"`` into name and unit."""
    text = cell.strip().strip("#").strip().casefold().replace("_", " ")
    match = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\])]*)\s*[\])]", text)
    if match:
        return match[1].strip(), match[2].strip()
    name, _, unit = text.rpartition(" ")
    return (name, unit) if name and (unit in UNIT_WORDS or unit in LENGTHS) else (text, "")


def _guess_unit(text: str, found: OrientationTableFormat) -> tuple[str, str]:
    """Guess the unit of the angles from their size; the unit and the reason."""
    rows, _ = _rows(text, replace(found, angle_unit="rad"))
    largest = max((abs(a) for row in rows for a in row.angles), default=0.0)
    if largest > 360.0:
        return "gon", Text("An angle is {a:.1f}: more than 360, less than 400.", a=largest)
    if largest > 2 * math.pi + 1e-6:
        return "deg", Text(
            "The largest angle is {a:.1f}: degrees or gon; nothing tells them apart.", a=largest
        )
    return "rad", Text("No angle is larger than {a:.3f}: within 2π.", a=largest)


def preview(text: str, form: OrientationTableFormat, lines: int = 20) -> Preview:
    """Return what a format makes of a text."""
    rows, bad = _rows(text, form)
    shown = cells(text, form.table)[:lines]
    return Preview(tuple(tuple(row) for row in shown), tuple(rows), tuple(bad))


def _rows(text: str, form: OrientationTableFormat) -> tuple[list[OrientationRow], list[BadLine]]:
    rows: list[OrientationRow] = []
    bad: list[BadLine] = []
    seen: set[str] = set()
    length, angle = LENGTHS[form.table.unit], UNITS[form.angle_unit]
    for line, row in enumerate(cells(text, form.table), 1):
        if line <= form.table.skip or not any(row) or row[0].startswith("#"):
            continue
        name = _cell(row, form, "name") or f"{len(rows) + 1}"
        values = [number(_cell(row, form, key), form.table.decimal) for key in "xyzabc"]
        wrong = next((key for key, v in zip(("X", "Y", "Z", "angle 1", "angle 2", "angle 3"), values, strict=True)
                      if not math.isfinite(v)), "")  # fmt: skip
        if wrong:
            bad.append(BadLine(line, Text("{column} is not a number", column=wrong)))
        elif name in seen:
            bad.append(BadLine(line, Text("the photo {name} occurs twice", name=name)))
        else:
            seen.add(name)
            x, y, z = (v * length for v in values[:3])
            a, b, c = (v * angle for v in values[3:])
            rows.append(OrientationRow(name, (x, y, z), (a, b, c)))
    return rows, bad


def _cell(row: Sequence[str], form: OrientationTableFormat, key: str) -> str:
    index = form.table.columns.get(key, -1)
    return row[index] if 0 <= index < len(row) else ""


def read_orientation_table(path: Path, camera: Camera, form: OrientationTableFormat | None = None) -> Read:
    """Read a table; all photos have the camera given.

    Parameters
    ----------
    path : Path
    camera : Camera
    form : OrientationTableFormat or None
        None to guess it; the guesses are then among the remarks.

    Raises
    ------
    UserError
        When the file cannot be read or has no photo.
    """
    text = read_bytes(path).decode("utf-8-sig", errors="replace")
    used = guess_orientations(text) if form is None else form
    rows, bad = _rows(text, used)
    if not rows:
        why = Text("Line {line}: {why}.", line=bad[0].line, why=bad[0].why) if bad else "It has no lines."
        raise UserError(
            Text("{name} holds no orientations.", name=path.name), why,
            "The columns are name, X, Y, Z and three angles; set them in the preview.",
        )  # fmt: skip
    parts = Parts(cameras=[camera], unit="m")
    for row in rows:
        parts.add_photo(row.name, 0, rotation_from_angles(*row.angles, used.order), np.array(row.xyz))
    if form is None:
        parts.remarks.append(Text(
            "Taken as {order} in {unit}. {why}", order=used.order, unit=used.angle_unit,
            why=used.reasons.get("angle_unit", ""),
        ))  # fmt: skip
    parts.remarks += [Text("Line {line} was left out: {why}.", line=b.line, why=b.why) for b in bad]
    return parts.read()


def write_orientation_table(
    block: Block, path: Path, *, order: str = "omega phi kappa", angle_unit: str = "deg"
) -> Written:
    """Write the oriented photos of a block as CSV with a header that names units.

    Raises
    ------
    UserError
        When the file cannot be written.
    """
    unit = "m" if block.unit == "m" else "model"
    first, second, third = order.split()
    out = [
        f"photo,x [{unit}],y [{unit}],z [{unit}],{first} [{angle_unit}],{second} [{angle_unit}],{third} [{angle_unit}]"
    ]
    for photo in np.flatnonzero(block.oriented).tolist():
        angles = [a / UNITS[angle_unit] for a in angles_from_rotation(block.rotations[photo], order)]
        name = block.names[photo]
        quoted = '"' + name.replace('"', '""') + '"' if any(c in name for c in ',"') else name
        numbers = [*block.centres[photo], *angles]
        out.append(",".join([quoted, *(repr(float(v)) for v in numbers)]))
    write_text(path, "\n".join(out) + "\n")
    remarks = (
        Text("Angles: {order}, {what}.", order=order, what=ORDERS[order]),
        "Cameras and points are not part of the table.",
    )
    return Written((path,), remarks)
