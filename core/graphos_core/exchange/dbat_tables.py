"""The tables of a DBAT script: comma-separated numbers whose columns the script names, ``#`` starts a comment."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.text import Text

LARGEST = 100_000_000
"""Largest file that is read, bytes."""

WORDS = ("label", "path")
"""Columns that hold text."""


@dataclass(frozen=True)
class DbatTable:
    """Columns by name: float64 (n,), or a tuple of str for those in `WORDS`."""

    numbers: dict[str, Array]
    words: dict[str, tuple[str, ...]]

    def __len__(self) -> int:
        return len(next(iter(self.numbers.values()), ()))

    def columns(self, *names: str) -> Array:
        """Return columns side by side (n, k)."""
        return np.column_stack([self.numbers[name] for name in names])


def read_table(path: Path, columns: str) -> DbatTable:
    """Read a table whose columns are named like ``"id,label,x,y,z,sxyz"``.

    Raises
    ------
    UserError
        When it cannot be read; for a bad line with its number.
    """
    names = [name.strip().casefold() for name in columns.split(",")]
    rows: list[list[str]] = []
    lines: list[int] = []
    for number, line in enumerate(_text(path).splitlines(), start=1):
        line = line.split("#", 1)[0]
        if not line.strip():
            continue
        cells = [cell.strip() for cell in line.split(",")]
        if len(cells) != len(names):
            raise _bad(
                path,
                number,
                Text("It has {count} columns, expected {names}.", count=len(cells), names=columns),
            )
        rows.append(cells)
        lines.append(number)
    numbers: dict[str, Array] = {}
    words: dict[str, tuple[str, ...]] = {}
    for i, name in enumerate(names):
        cells = [row[i] for row in rows]
        if name in WORDS:
            words[name] = tuple(cells)
        else:
            numbers[name] = np.array(
                [_number(path, line, cell) for line, cell in zip(lines, cells, strict=True)]
            )
    return DbatTable(numbers, words)


def _number(path: Path, line: int, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _bad(path, line, Text("“{cell}” is not a number.", cell=cell[:40]))
    return value


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST:
            raise UserError(
                Text("{name} is larger than 100 MB.", name=path.name), todo="Give the table itself."
            )
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as problem:
        raise UserError(
            Text("{name} could not be read.", name=path.name),
            problem.strerror or str(problem),
            "Check the path.",
        ) from problem


def _bad(path: Path, line: int, why: str) -> UserError:
    return UserError(
        Text("{name}, line {line}, could not be read.", name=path.name, line=line), why, "Correct the line."
    )
