"""The tables in a control point file: header, units, separator, rows with their line numbers."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from graphos_core.errors import UserError
from graphos_core.text import Text

LARGEST = 50_000_000
"""Largest file that is read, bytes."""

COLUMNS = {
    "name": ("name", "id", "point", "point name", "point id", "label", "marker", "nr", "number", "target"),
    "x": ("x", "east", "easting", "e", "u", "column", "col"),
    "y": ("y", "north", "northing", "n", "v", "row"),
    "z": ("z", "height", "h", "altitude", "elevation", "up"),
    "role": ("role", "type", "use"),
    "sx": ("sx", "sigma x", "sigmax", "std x", "σx", "σ x", "accuracy x"),
    "sy": ("sy", "sigma y", "sigmay", "std y", "σy", "σ y", "accuracy y"),
    "sz": ("sz", "sigma z", "sigmaz", "std z", "σz", "σ z", "accuracy z"),
    "sigma": ("sigma", "σ", "std", "accuracy"),
    "photo": ("photo", "image", "picture", "file", "filename", "photo name", "image name"),
}
"""Names a column may have in the header."""

LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "dm": 1e-1, "km": 1e3}
"""Factor to metres."""

PIXELS = {"px": 1.0, "pixel": 1.0}
"""Factor to pixels."""

UNITS = {**LENGTHS, **PIXELS, "": 1.0, "-": 1.0}
"""Factor to metres or pixels."""


@dataclass(frozen=True)
class Row:
    """One row: its line in the file and its cells."""

    line: int
    cells: list[str]


@dataclass
class Table:
    """Rows under one header.

    Attributes
    ----------
    file : str
        Name of the file.
    columns : dict of str to int
        Position of each known column.
    factors : dict of str to float
        What numbers of a column are multiplied by.
    decimal_comma : bool
        Whether numbers may have a comma instead of a point.
    rows : list of Row
    """

    file: str
    columns: dict[str, int]
    factors: dict[str, float]
    decimal_comma: bool
    rows: list[Row] = field(default_factory=list)

    @property
    def measurements(self) -> bool:
        """Whether these are image measurements."""
        return "photo" in self.columns

    @property
    def units(self) -> dict[str, float]:
        """Units the coordinates of this kind of table may have."""
        return PIXELS if self.measurements else LENGTHS

    def text(self, row: Row, column: str) -> str:
        """Return a cell without blanks around it; empty where the table or the row has none."""
        index = self.columns.get(column)
        return row.cells[index].strip() if index is not None and index < len(row.cells) else ""

    def has(self, row: Row, column: str) -> bool:
        """Say whether the table has the column and the row a cell there, empty or not."""
        return column in self.columns and self.columns[column] < len(row.cells)

    def optional(self, row: Row, column: str) -> float:
        """Return a cell as a number in metres or pixels, NaN where there is none or it is empty.

        Raises
        ------
        UserError
            When it is something else than a finite number.
        """
        return self.number(row, column) if self.text(row, column) else math.nan

    def number(self, row: Row, column: str) -> float:
        """Return a cell as a number in metres or pixels.

        Raises
        ------
        UserError
            When it is not a finite number, naming the line.
        """
        text = self.text(row, column)
        try:
            value = float(text.replace(",", ".") if self.decimal_comma else text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            why = Text("{column} is “{text}”, not a number", column=column, text=text[:40])
            raise bad_line(self, row, why if text else Text("{column} is missing", column=column))
        return value * self.factors.get(column, 1.0)


def read_tables(path: Path) -> list[Table]:
    """Read the tables of a file.

    Raises
    ------
    UserError
        When the file cannot be read, has no header, or a header lacks a column.
    """
    text = _read(path)
    tables: list[Table] = []
    separator = ","
    for number, line in enumerate(text.splitlines(), start=1):
        line = re.split(r"(?:^|\s)#", line, maxsplit=1)[0]  # P#1 is a name
        if not line.strip(" ,;\t"):
            continue
        guess = (
            max(";\t,", key=line.count)
            if not tables or _header(line, max(";\t,", key=line.count))
            else separator
        )
        found = _header(line, guess)
        if found is not None:
            separator = guess
            table = Table(path.name, *found, decimal_comma=separator != ",")
            missing = [c for c in (("name", "x", "y") if table.measurements else ("name", "x", "y", "z"))
                       if c not in table.columns]  # fmt: skip
            if missing:
                raise bad_line(
                    table,
                    Row(number, []),
                    Text("the header has no column {names}", names=" and no column ".join(missing)),
                )
            _check_units(table, number, _cells(line, guess))
            tables.append(table)
            continue
        if not tables:
            raise UserError(
                Text("{name} could not be read as control points.", name=path.name),
                Text("Line {line} is not a header: “{text}”.", line=number, text=line.strip()[:60]),
                "The first line must name the columns: name,x,y,z,role, or photo,name,x,y for measurements.",
            )
        row = Row(number, _cells(line, separator))
        if tables[-1].rows or not _take_units(tables[-1], row):
            tables[-1].rows.append(row)
    return tables


def _check_units(table: Table, line: int, header: list[str]) -> None:
    """Refuse coordinates in a unit that is unknown, or of the other kind of table: never a silent factor."""
    for column in "xyz":
        unit = _title(header[table.columns[column]])[1] if column in table.columns else ""
        if unit and unit not in table.units:
            valid = ", ".join(table.units)
            why = Text("the unit of {column} is “{unit}”, needs one of: {valid}", column=column, unit=unit[:20],
                       valid=valid)  # fmt: skip
            raise bad_line(table, Row(line, []), why)


def bad_line(table: Table, row: Row, why: str) -> UserError:
    """Say what is wrong with a line."""
    return UserError(
        Text("{name}, line {line}, could not be read.", name=table.file, line=row.line),
        Text("There {why}.", why=why),
        "Correct the line; the columns are name, x, y, z, role, or photo, name, x, y for measurements.",
    )


def _read(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST:
            raise UserError(
                Text("{name} could not be read as control points.", name=path.name),
                "It is larger than 50 MB.",
                "Choose the text file with the control points.",
            )
        return path.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError as problem:
        raise UserError(
            Text("The control point file {name} could not be read.", name=path.name),
            Text("The system says: {why}.", why=problem.strerror or str(problem)),
            "Check the path.",
        ) from problem


def _cells(line: str, separator: str) -> list[str]:
    return next(csv.reader([line], delimiter=separator), [])


def _header(line: str, separator: str) -> tuple[dict[str, int], dict[str, float]] | None:
    """Return the columns and their factors if the line is a header."""
    columns: dict[str, int] = {}
    factors: dict[str, float] = {}
    for i, cell in enumerate(_cells(line, separator)):
        title, unit = _title(cell)
        for column, names in COLUMNS.items():
            if title in names and column not in columns:
                columns[column] = i
                factors[column] = UNITS.get(unit, 1.0)
                break
    return (columns, factors) if len(columns) >= 3 else None


def _title(cell: str) -> tuple[str, str]:
    """Split ``"X [mm]"``, ``"x (m)"`` or ``"x_px"`` into name and unit."""
    text = cell.strip().casefold().replace("_", " ")
    match = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\])]*)\s*[\])]", text)
    if match:
        return match[1].strip(), match[2].strip()
    name, _, unit = text.rpartition(" ")
    return (name, unit) if name and unit in UNITS else (text, "")


def _take_units(table: Table, row: Row) -> bool:
    """Take a row of units directly below the header; say whether it was one."""
    units = {c: table.text(row, c).strip("[]() ").casefold() for c in "xyz" if c in table.columns}
    if not all(unit in table.units for unit in units.values()):
        return False
    table.factors.update({column: table.units[unit] for column, unit in units.items()})
    return True
