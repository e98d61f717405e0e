"""The header of a PLY file."""

from __future__ import annotations

from dataclasses import dataclass

from graphos_core.errors import UserError
from graphos_core.text import Text

MAX_HEADER = 65536
"""Longest header that is read, bytes."""

MAX_ELEMENTS = 2_000_000_000
"""Largest number of elements a header may announce."""

KINDS = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
"""numpy kind of each PLY type."""


@dataclass(frozen=True)
class Property:
    """One property; `count_kind` is the type of the length of a list and empty for a single number."""

    name: str
    kind: str
    count_kind: str = ""


@dataclass(frozen=True)
class Element:
    """One element: its name, how often it occurs, and its properties."""

    name: str
    count: int
    properties: tuple[Property, ...]

    @property
    def has_list(self) -> bool:
        """Whether any property is a list."""
        return any(prop.count_kind for prop in self.properties)


@dataclass(frozen=True)
class Header:
    """What the header says; `size` is its length in bytes."""

    encoding: str
    elements: tuple[Element, ...]
    unit: str
    size: int


def read_header(content: bytes, name: str) -> Header:
    """Read the header of a PLY file.

    Raises
    ------
    UserError
        With the first thing that is wrong.
    """
    lines, size = _header_lines(content, name)
    encoding, unit = "", "model units"
    elements: list[tuple[str, int, list[Property]]] = []
    for number, line in enumerate(lines[1:], start=2):
        words = line.split()
        try:
            if not words or words[0] == "obj_info":
                continue
            if words[0] == "comment":
                if len(words) > 2 and words[1] == "unit":
                    unit = " ".join(words[2:])[:40]
            elif words[0] == "format":
                encoding = words[1]
            elif words[0] == "element":
                elements.append((words[1], int(words[2]), []))
                if not 0 <= elements[-1][1] <= MAX_ELEMENTS:
                    raise ValueError(line)
            elif words[0] == "property":
                elements[-1][2].append(_property(words))
            else:
                raise ValueError(line)
        except (ValueError, KeyError, IndexError):
            raise bad_header(name, Text("line {number} is “{line}”", number=number, line=line[:60])) from None
    if encoding not in ("ascii", "binary_little_endian", "binary_big_endian"):
        raise bad_header(
            name, Text("its format is “{it}”", it=encoding[:40]) if encoding else Text("it names no format")
        )
    found = tuple(Element(n, count, tuple(properties)) for n, count, properties in elements)
    _check_elements(found, name)
    return Header(encoding, found, unit, size)


def _header_lines(content: bytes, name: str) -> tuple[list[str], int]:
    if not content.startswith((b"ply\n", b"ply\r")):
        raise bad_header(name, "it does not begin with “ply”")
    end = content.find(b"end_header", 0, MAX_HEADER)
    newline = content.find(b"\n", end, end + 16) if end >= 0 else -1
    if newline < 0 and end >= 0:
        newline = content.find(b"\r", end, end + 16)
    if newline < 0:
        raise bad_header(name, "it has no end")
    return content[:end].decode("utf-8", "replace").splitlines(), newline + 1


def _property(words: list[str]) -> Property:
    if words[1] == "list":
        if KINDS[words[2]].startswith("f"):
            raise ValueError(words[2])
        return Property(words[4], KINDS[words[3]], KINDS[words[2]])
    return Property(words[2], KINDS[words[1]])


def _check_elements(elements: tuple[Element, ...], name: str) -> None:
    names = [element.name for element in elements]
    if len(set(names)) != len(names):
        raise bad_header(name, "an element occurs twice")
    for element in elements:
        properties = [prop.name for prop in element.properties]
        if len(set(properties)) != len(properties):
            raise bad_header(name, Text("a property of {name} occurs twice", name=element.name))
        if not properties:
            raise bad_header(name, Text("the element {name} has no properties", name=element.name))
    vertex = next((element for element in elements if element.name == "vertex"), None)
    if vertex is None or vertex.has_list or not {"x", "y", "z"} <= {p.name for p in vertex.properties}:
        raise bad_header(name, "it has no vertices with x, y and z")


def bad_header(name: str, why: str) -> UserError:
    """Say that a file is not readable PLY."""
    return UserError(
        Text("{name} could not be read as PLY.", name=name),
        Text("Its header is not that of a PLY file: {why}.", why=why),
        "Choose another file, or export it again as PLY.",
    )
