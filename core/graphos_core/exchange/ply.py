"""PLY (Polygon File Format, Turk 1994): point clouds and triangle meshes.

Written as ``binary_little_endian`` with double coordinates, so large coordinates keep their millimetres; read in all
three encodings. A comment ``unit`` in the header says what a coordinate of 1 means.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from graphos_core.data import Array, Cloud, Mesh
from graphos_core.errors import UserError
from graphos_core.exchange.ply_header import Element, Header, read_header
from graphos_core.store import write_bytes
from graphos_core.text import Text

MAX_CORNERS = 64
"""Largest number of corners of a face that is read."""


def write_ply_cloud(
    path: Path,
    points: Array,
    colours: Array | None = None,
    normals: Array | None = None,
    *,
    unit: str = "model units",
    comments: Sequence[str] = (),
) -> None:
    """Write a point cloud, complete or not at all.

    Parameters
    ----------
    path : Path
    points : float64 (n, 3)
    colours : uint8 (n, 3), optional
        RGB.
    normals : float32 (n, 3), optional
    unit : str
        Unit of the coordinates, written as a comment.
    comments : sequence of str
        Further comments, one line each.

    Raises
    ------
    UserError
        When the file cannot be written.
    """
    fields: list[tuple[str, str, Array]] = [(axis, "<f8", points[:, i]) for i, axis in enumerate("xyz")]
    if normals is not None and len(normals):
        fields += [(name, "<f4", normals[:, i]) for i, name in enumerate(("nx", "ny", "nz"))]
    if colours is not None and len(colours):
        fields += [(name, "u1", colours[:, i]) for i, name in enumerate(("red", "green", "blue"))]
    vertices = np.empty(len(points), dtype=[(name, kind) for name, kind, _ in fields])
    for name, _, values in fields:
        vertices[name] = values
    header = [*_preamble(unit, comments), *_vertex_lines(vertices), "end_header", ""]
    write_bytes(path, "\n".join(header).encode() + vertices.tobytes())


def write_ply_mesh(path: Path, mesh: Mesh, *, comments: Sequence[str] = ()) -> None:
    """Write a triangle mesh, complete or not at all.

    Raises
    ------
    UserError
        When the file cannot be written.
    """
    vertices = np.empty(len(mesh.vertices), dtype=[(axis, "<f8") for axis in "xyz"])
    for i, axis in enumerate("xyz"):
        vertices[axis] = mesh.vertices[:, i]
    faces = np.empty(len(mesh.triangles), dtype=[("count", "u1"), ("corners", "<i4", (3,))])
    faces["count"], faces["corners"] = 3, mesh.triangles
    header = [
        *_preamble(mesh.unit, comments), *_vertex_lines(vertices),
        f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", "",
    ]  # fmt: skip
    write_bytes(path, "\n".join(header).encode() + vertices.tobytes() + faces.tobytes())


def read_ply(path: Path) -> Cloud | Mesh:
    """Read a cloud, or a mesh when the file has faces; polygons become fans of triangles.

    The unit is read from a comment ``unit …`` and is ``"model units"`` where there is none.

    Raises
    ------
    UserError
        When the file cannot be read, is not PLY, is cut off, or contradicts itself.
    """
    try:
        content = path.read_bytes()
    except OSError as problem:
        raise UserError(
            Text("{name} could not be read.", name=path.name),
            Text("The system says: {why}.", why=problem.strerror or str(problem)),
            "Choose another file.",
        ) from problem
    header = read_header(content, path.name)
    if header.encoding == "ascii":
        tables = _read_text(content[header.size :], header, path.name)
    else:
        tables = _read_binary(content, header, path.name)
    vertices = tables["vertex"]
    points = _columns(vertices, ("x", "y", "z"), np.float64)
    assert points is not None
    finite = np.isfinite(points).all(axis=1)
    if len(tables.get("face", ())):
        if not finite.all():
            raise _refused(path.name, "a vertex has a coordinate that is not a number")
        return Mesh(
            vertices=points, triangles=_triangles(tables["face"], len(points), path.name), unit=header.unit
        )
    points, vertices = points[finite], vertices[finite]  # scanners write NaN for "no return"
    colours = _columns(vertices, ("red", "green", "blue"), np.float64)
    if colours is None:
        colours = np.full((len(points), 3), 255.0)
    elif np.issubdtype(vertices["red"].dtype, np.floating):
        colours = colours * 255.0
    normals = _columns(vertices, ("nx", "ny", "nz"), np.float32)
    return Cloud(
        points=points,
        colours=np.clip(np.nan_to_num(colours), 0, 255).astype(np.uint8),
        normals=np.zeros((0, 3), dtype=np.float32) if normals is None else normals,
        views=np.zeros(0, dtype=np.uint8),
        unit=header.unit,
    )


def _preamble(unit: str, comments: Sequence[str]) -> list[str]:
    lines = ["ply", "format binary_little_endian 1.0", "comment made by GRAPHOS-Py", f"comment unit {unit}"]
    return lines + ["comment " + " ".join(text.split()) for text in comments]


def _vertex_lines(vertices: Array) -> list[str]:
    kinds = {"<f8": "double", "<f4": "float", "|u1": "uchar"}
    assert vertices.dtype.names is not None
    lines = [f"property {kinds[vertices.dtype[name].str]} {name}" for name in vertices.dtype.names]
    return [f"element vertex {len(vertices)}", *lines]


def _columns(table: Array, names: tuple[str, ...], kind: type) -> Array | None:
    if not set(names) <= set(table.dtype.names or ()):
        return None
    return np.column_stack([table[name] for name in names]).astype(kind)


def _read_binary(content: bytes, header: Header, name: str) -> dict[str, Array]:
    order = "<" if header.encoding == "binary_little_endian" else ">"
    position, tables = header.size, {}
    for element in header.elements:
        if not element.has_list:
            kind = np.dtype([(p.name, order + p.kind) for p in element.properties])
            if element.count * kind.itemsize > len(content) - position:
                raise _cut_off(name, element)
            tables[element.name] = np.frombuffer(content, kind, element.count, position)
            position += element.count * kind.itemsize
        else:
            tables[element.name], position = _read_lists(content, position, element, order, name)
    return tables


def _read_lists(content: bytes, position: int, element: Element, order: str, name: str) -> tuple[Array, int]:
    """Read an element with lists; quickly when every list has as many entries as the first."""
    if element.count == 0:
        return np.zeros(0, dtype=[("corners", "O")]), position
    smallest = sum(np.dtype(p.count_kind or p.kind).itemsize for p in element.properties)
    if element.count * smallest > len(content) - position:
        raise _cut_off(name, element)
    first, _ = _one_row(content, position, element, order, name)
    fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
    for prop, value in zip(element.properties, first, strict=True):
        if prop.count_kind:
            fields.append((f"{prop.name} count", order + prop.count_kind))
            fields.append((prop.name, order + prop.kind, (len(value),)))
        else:
            fields.append((prop.name, order + prop.kind))
    kind = np.dtype(fields)
    if element.count * kind.itemsize <= len(content) - position:
        table = np.frombuffer(content, kind, element.count, position)
        lists = [(p.name, len(v)) for p, v in zip(element.properties, first, strict=True) if p.count_kind]
        if all((table[f"{n} count"] == length).all() for n, length in lists):
            return table, position + element.count * kind.itemsize
    rows = []
    for _ in range(element.count):
        row, position = _one_row(content, position, element, order, name)
        rows.append(tuple(row))
    return _rows(rows, element), position


def _one_row(
    content: bytes, position: int, element: Element, order: str, name: str
) -> tuple[list[Array], int]:
    row = []
    for prop in element.properties:
        length = 1
        if prop.count_kind:
            count_kind = np.dtype(order + prop.count_kind)
            if position + count_kind.itemsize > len(content):
                raise _cut_off(name, element)
            length = int(np.frombuffer(content, count_kind, 1, position)[0])
            position += count_kind.itemsize
        kind = np.dtype(order + prop.kind)
        if not 0 <= length <= MAX_CORNERS:
            raise _refused(
                name,
                Text(
                    "a list in the element {name} says it has {length} entries",
                    name=element.name,
                    length=length,
                ),
            )
        if position + length * kind.itemsize > len(content):
            raise _cut_off(name, element)
        row.append(np.frombuffer(content, kind, length, position))
        position += length * kind.itemsize
    return row, position


def _rows(rows: list[tuple[Array, ...]], element: Element) -> Array:
    table = np.empty(len(rows), dtype=[(p.name, "O") for p in element.properties])
    for i, row in enumerate(rows):
        table[i] = row
    return table


def _read_text(content: bytes, header: Header, name: str) -> dict[str, Array]:
    lines = [line for line in content.decode("ascii", "replace").splitlines() if line.strip()]
    position, tables = 0, {}
    for element in header.elements:
        mine = lines[position : position + element.count]
        if len(mine) < element.count:
            raise _cut_off(name, element)
        position += element.count
        try:
            tables[element.name] = _text_table(mine, element)
        except (ValueError, IndexError, OverflowError):
            raise _refused(
                name,
                Text("a line of the element {name} is not made of numbers as declared", name=element.name),
            ) from None
    return tables


def _text_table(lines: list[str], element: Element) -> Array:
    if not element.has_list:
        values = np.array([line.split() for line in lines], dtype=np.float64)
        values = values.reshape(len(lines), -1)[:, : len(element.properties)]
        table = np.empty(len(lines), dtype=[(p.name, p.kind) for p in element.properties])
        for i, prop in enumerate(element.properties):
            kind = np.dtype(prop.kind)
            if kind.kind != "f":
                limits = np.iinfo(kind)
                if not ((values[:, i] >= limits.min) & (values[:, i] <= limits.max)).all():
                    raise ValueError(prop.name)
            table[prop.name] = values[:, i]
        return table
    rows = []
    for line in lines:
        words, row = line.split(), []
        for prop in element.properties:
            length = int(words.pop(0)) if prop.count_kind else 1
            if not 0 <= length <= len(words):
                raise ValueError(line)
            row.append(np.array([float(word) for word in words[:length]]))
            del words[:length]
        rows.append(tuple(row))
    return _rows(rows, element)


def _triangles(faces: Array, vertices: int, name: str) -> Array:
    names = faces.dtype.names or ()
    lists = next((n for n in ("vertex_indices", "vertex_index") if n in names), None)
    if lists is None:
        raise _refused(name, "its faces have no list of vertices")
    corners = faces[lists]
    if corners.dtype != object:
        fans = [corners[:, [0, i, i + 1]] for i in range(1, corners.shape[1] - 1)]
        triangles = np.stack(fans, axis=1).reshape(-1, 3) if fans else np.zeros((0, 3))
    else:
        found = [[c[0], c[i], c[i + 1]] for c in corners for i in range(1, len(c) - 1)]
        triangles = np.array(found, dtype=np.float64).reshape(-1, 3)
    if not ((triangles >= 0) & (triangles < vertices)).all():  # not a number fails too
        raise _refused(
            name, Text("a face refers to a vertex that does not exist; there are {count}", count=vertices)
        )
    return triangles.astype(np.int32)


def _cut_off(name: str, element: Element) -> UserError:
    return _refused(
        name, Text("it ends before its {count} {name} elements do", count=element.count, name=element.name)
    )


def _refused(name: str, why: str) -> UserError:
    return UserError(
        Text("{name} could not be read as PLY.", name=name),
        Text("The file is damaged or not as its header says: {why}.", why=why),
        "Export it again, or choose another file.",
    )
