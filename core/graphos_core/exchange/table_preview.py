"""Tables of points from spreadsheets and strangers' files: a guess of their format that a person can correct.

Where `graphos_core.exchange.control` is strict, this reads what it can and names every line it cannot.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from graphos_core.exchange.control_sheet import ROLES, UNKNOWN, Role, SheetPoint, Triple
from graphos_core.exchange.control_tables import COLUMNS, LENGTHS
from graphos_core.text import Text

DELIMITERS = {",": "comma", ";": "semicolon", "\t": "tab", " ": "blanks"}
FIELDS = {
    "name": COLUMNS["name"], "x": COLUMNS["x"], "y": COLUMNS["y"], "z": COLUMNS["z"],
    "sx": ("sx", "sigma x", "σx", "sigma east", "std x"), "sy": ("sy", "sigma y", "σy", "sigma north", "std y"),
    "sz": ("sz", "sigma z", "σz", "sigma height", "std z"), "sigma": ("sigma", "σ", "std", "accuracy"),
    "role": COLUMNS["role"],
}  # fmt: skip
"""What a column can be, and what its header may say."""

ROLE_WORDS: Mapping[str, Role] = {
    "": "control", "control point": "control", "gcp": "control", "check point": "check", "checkpoint": "check",
    **{role: role for role in ROLES},
}  # fmt: skip


@dataclass(frozen=True)
class TableFormat:
    """How a table is written.

    Attributes
    ----------
    delimiter : str
        A key of `DELIMITERS`.
    decimal : {".", ","}
    skip : int
        Lines before the first point.
    columns : mapping
        Column of each field of `FIELDS` that there is.
    unit : str
        Of the coordinates and standard deviations, a key of `LENGTHS`.
    """

    delimiter: str = ","
    decimal: str = "."
    skip: int = 0
    columns: Mapping[str, int] = field(default_factory=dict)
    unit: str = "m"


@dataclass(frozen=True)
class BadLine:
    """A line that is no point: its number from 1, and why."""

    line: int
    why: str


def guess(text: str) -> TableFormat:
    """Return the format that fits a text best: delimiter, decimal sign, header and columns."""
    lines = [line for line in text.splitlines() if line.strip()][:200]
    delimiter = max(DELIMITERS, key=lambda d: _fitness(lines, d))
    body = [cell for line in lines for cell in split(line, delimiter)]
    commas = sum(bool(re.fullmatch(r"[-+]?\d+,\d+", cell)) for cell in body)
    points = sum(bool(re.fullmatch(r"[-+]?\d+\.\d+", cell)) for cell in body)
    found = TableFormat(delimiter, "," if delimiter != "," and commas > points else ".")
    rows = cells(text, found)
    numbers = [sum(math.isfinite(number(cell, found.decimal)) for cell in row) for row in rows]
    first = next((i for i, count in enumerate(numbers) if count >= min(3, max(numbers, default=0)) > 0), 0)
    columns, unit = _columns(rows[:first], rows[first] if rows else [], found.decimal)
    return replace(found, skip=first, columns=columns, unit=unit)


def strange_units(text: str, table: TableFormat) -> str:
    """Return what a header says of units that are not that of the table, such as ``"y [ft]"``; else nothing."""
    units = _header_units(text, table)
    return ", ".join(
        f"{column} [{units[column]}]" for column in "xyz" if units.get(column, table.unit) != table.unit
    )


def _header_units(text: str, table: TableFormat) -> dict[str, str]:
    """Return the units that a header says, by field."""
    units: dict[str, str] = {}
    for row in cells(text, table)[: table.skip]:
        for name in FIELDS:
            title, unit = title_and_unit(_cell(row, table, name))
            if unit and title in FIELDS[name]:
                units[name] = unit
    return units


def split(line: str, delimiter: str) -> list[str]:
    """Return the cells of a line without the blanks round them."""
    if delimiter == " ":
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]


def cells(text: str, table: TableFormat) -> list[list[str]]:
    """Return the cells of every line, empty lines included, so that numbers of lines stay."""
    return [split(line, table.delimiter) for line in text.splitlines()]


def number(text: str, decimal: str) -> float:
    """Return a cell as a number; NaN where it is none."""
    plain = text.replace("\u202f", "").replace("\u2009", "").replace("\u00a0", "").replace("\u2212", "-")
    if decimal == ",":
        plain = plain.replace(".", "").replace(",", ".") if re.fullmatch(r"[-+]?[\d.]+,\d+", plain) else plain
    try:
        value = float(plain)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def read_points(text: str, table: TableFormat) -> tuple[list[SheetPoint], list[BadLine]]:
    """Return the points of a text, and the lines that are none with the reason."""
    points: list[SheetPoint] = []
    bad: list[BadLine] = []
    names: set[str] = set()
    own = {name: LENGTHS[unit] for name, unit in _header_units(text, table).items() if unit in LENGTHS}
    for line, row in enumerate(cells(text, table), 1):
        if line <= table.skip or not any(row) or row[0].startswith("#"):
            continue
        found = _point(row, table, own)
        if isinstance(found, str):
            bad.append(BadLine(line, found))
        elif found.name in names:
            bad.append(BadLine(line, Text("the point {name} occurs twice", name=found.name)))
        else:
            names.add(found.name)
            points.append(found)
    return points, bad


def _point(row: Sequence[str], table: TableFormat, own: Mapping[str, float]) -> SheetPoint | str:
    """Return the point of a row, or what is wrong with it; standard deviations may have units of their `own`."""
    name = _cell(row, table, "name")
    if not name:
        return "the name of the point is missing"
    factor = LENGTHS[table.unit]
    xyz = list(UNKNOWN)
    for axis, column in enumerate("xyz"):
        cell = _cell(row, table, column)
        xyz[axis] = number(cell, table.decimal) * factor
        if cell and not math.isfinite(xyz[axis]):
            return Text("{column} is “{text}”, not a number", column=column, text=cell[:40])
    if not any(math.isfinite(v) for v in xyz):
        return "there are no coordinates"
    for column in ("sx", "sy", "sz", "sigma"):
        cell = _cell(row, table, column)
        if cell and not number(cell, table.decimal) >= 0.0:
            return Text("{column} is “{text}”, not a standard deviation", column=column, text=cell[:40])
    role = ROLE_WORDS.get(_cell(row, table, "role").casefold())
    if role is None:
        return Text(
            "the role “{role}” is neither control, check nor off", role=_cell(row, table, "role")[:40]
        )
    return SheetPoint(name, (xyz[0], xyz[1], xyz[2]), _sigma(row, table, own), role)


def _sigma(row: Sequence[str], table: TableFormat, own: Mapping[str, float]) -> Triple:
    values = {
        column: number(_cell(row, table, column), table.decimal) * own.get(column, LENGTHS[table.unit])
        for column in ("sx", "sy", "sz", "sigma")
    }
    sx, sy, sz = (values[c] if math.isfinite(values[c]) else values["sigma"] for c in ("sx", "sy", "sz"))
    return sx, sy, sz


def _cell(row: Sequence[str], table: TableFormat, column: str) -> str:
    index = table.columns.get(column, -1)
    return row[index] if 0 <= index < len(row) else ""


def _fitness(lines: Sequence[str], delimiter: str) -> tuple[int, int]:
    """Return how many lines have the commonest number of cells, if that is three or more, and that number."""
    counts = [len(split(line, delimiter)) for line in lines]
    wide = [count for count in counts if count >= 3]
    commonest = max(set(wide), key=wide.count, default=0)
    return counts.count(commonest) if wide else 0, -abs(commonest - 4)


def _columns(head: Sequence[Sequence[str]], first: Sequence[str], decimal: str) -> tuple[dict[str, int], str]:
    """Return the columns and the unit that a header says, else name, x, y, z in this order."""
    for row in reversed(head):
        found: dict[str, int] = {}
        unit = "m"
        for index, cell in enumerate(row):
            title, cell_unit = title_and_unit(cell)
            name = next((f for f, words in FIELDS.items() if title in words and f not in found), "")
            if name:
                found[name] = index
                unit = cell_unit if name in "xyz" and cell_unit in LENGTHS else unit
        if len(found) >= 3:
            return found, unit
    order = ["name", "x", "y", "z", "sx", "sy", "sz"]
    numeric = 1
    while numeric < min(len(first), len(order)) and math.isfinite(number(first[numeric], decimal)):
        numeric += 1
    return {name: i for i, name in enumerate(order[: max(numeric, 4)])}, "m"


def title_and_unit(cell: str) -> tuple[str, str]:
    """Split ``"X [mm]"`` or ``"x_m"`` into name and unit."""
    text = cell.strip().casefold().replace("_", " ")
    match = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\])]*)\s*[\])]", text)
    if match:
        return match[1].strip(), match[2].strip()
    name, _, unit = text.rpartition(" ")
    return (name, unit) if name and unit in LENGTHS else (text, "")
