"""Reading strangers' text and XML files: limits, finite numbers, and sentences that name the file and the line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError

import numpy as np

from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.text import Text

LARGEST = 1_000_000_000
"""Largest file that is read, bytes."""


def read_bytes(path: Path) -> bytes:
    """Read a whole file.

    Raises
    ------
    UserError
        When it cannot be read or is larger than 1 GB.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise UserError(Text("{name} is larger than 1 GB.", name=path.name), todo="Give a smaller file.")
        return path.read_bytes()
    except OSError as problem:
        raise UserError(
            Text("{name} could not be read.", name=path.name),
            Text("The system says: {why}.", why=problem.strerror or str(problem)),
            "Check the path.",
        ) from problem


def read_lines(path: Path) -> list[str]:
    """Read a text file as lines, UTF-8 with or without mark."""
    return read_bytes(path).decode("utf-8-sig", errors="replace").splitlines()


def bad_line(path: Path, number: int, line: str, expected: str) -> UserError:
    """Say that a line is not as the format has it."""
    return UserError(
        Text("{name} could not be read.", name=path.name),
        Text(
            "Line {number} is “{line}”, expected {what}.",
            number=number,
            line=line.strip()[:60],
            what=expected,
        ),
        "Export the file again, or correct the line.",
    )


def not_such(path: Path, what: str, why: str) -> UserError:
    """Say that a file is not of the expected kind."""
    return UserError(
        Text("{name} is not {what}.", name=path.name, what=what),
        why,
        "Choose the file, or the format it has.",
    )


def finite(words: Sequence[str]) -> list[float]:
    """Return words as finite numbers.

    Raises
    ------
    ValueError
        For a word that is no finite number.
    """
    values = [float(word) for word in words]
    if not all(math.isfinite(value) for value in values):
        raise ValueError("a number is not finite")
    return values


class Lines:
    """The lines of a text file, taken one after another; comments and empty lines are passed over."""

    def __init__(self, path: Path, comment: str = "#") -> None:
        self.path = path
        self._lines = [(n, text) for n, text in enumerate(read_lines(path), 1)
                       if text.strip() and not text.lstrip().startswith(comment)]  # fmt: skip
        self._next = 0

    def take(self, what: str) -> list[str]:
        """Return the words of the next line."""
        if self._next >= len(self._lines):
            raise UserError(
                Text("{name} could not be read.", name=self.path.name),
                Text("It ends where {what} should stand.", what=what),
                "The file is cut off: export it again.",
            )
        self._next += 1
        return self._lines[self._next - 1][1].split()

    def more(self) -> bool:
        """Return whether there is another line."""
        return self._next < len(self._lines)

    def numbers(self, count: int, what: str) -> list[float]:
        """Return the next line as `count` finite numbers, or more."""
        words = self.take(what)
        try:
            if len(words) < count:
                raise ValueError("too few")
            return finite(words)
        except ValueError:
            raise self.wrong(what) from None

    def wrong(self, what: str) -> UserError:
        """Say that the line taken last is not as expected."""
        number, text = self._lines[max(self._next - 1, 0)]
        return bad_line(self.path, number, text, what)


def parse_xml(path: Path, what: str) -> Element:
    """Return the root of an XML file; entities and external references are refused.

    Raises
    ------
    UserError
        When it cannot be read or is not plain XML.
    """
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    content = read_bytes(path)
    try:
        root: Element = fromstring(content)
    except (ParseError, DefusedXmlException, ValueError, LookupError) as problem:
        raise not_such(path, what, Text("It is not plain XML: {why}.", why=problem)) from problem
    return root


def xml_text(element: Element, tag: str) -> str:
    """Return the text of the first element of that name below; empty where there is none."""
    found = element.find(tag)
    return (found.text or "").strip() if found is not None else ""


def xml_numbers(path: Path, element: Element, tag: str, count: int) -> Array:
    """Return `count` finite numbers from the text of the first element of that name.

    Raises
    ------
    UserError
        When there are others.
    """
    text = xml_text(element, tag)
    try:
        values = finite(text.split())
    except ValueError:
        values = []
    if len(values) != count:
        raise UserError(
            Text("{name} could not be read.", name=path.name),
            Text("<{tag}> is “{text}”, expected {count} numbers.", tag=tag, text=text[:60], count=count),
            "Export the file again.",
        )
    return np.array(values)
