"""PhotoModeler exports as the Damped Bundle Adjustment Toolbox (DBAT) ships them.

A project is an export file (``…-pmexport.txt``: interior orientation in mm, exterior orientations, object points) and
a table of measured points (``…-2dpts.txt``, px with x right and y down). Only cameras without distortion are read.

Both use camera coordinates with the corner of the format as origin: the millimetres of the principal point divided by
the pixel size have the same origin as the measured pixels. The corner of the top-left pixel is at (0, 0) there, at
(−0.5, −0.5) here.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

from graphos_core.data import Array, Block, Control
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import Parts, Read
from graphos_core.exchange.camera_texts import read_photomodeler_camera
from graphos_core.exchange.dbat_case import PIXEL_ORIGIN, DbatCamera, DbatCase, Measured, assemble
from graphos_core.exchange.dbat_tables import read_table
from graphos_core.geometry.rotation import matrix_from_opk
from graphos_core.text import Text


def read_photomodeler(export: str | Path, measured: str | Path) -> Block:
    """Read an export and its table of measured points as an oriented block.

    Parameters
    ----------
    export : str or Path
        ``…-pmexport.txt``.
    measured : str or Path
        ``…-2dpts.txt``.

    Returns
    -------
    Block
        With one ``"pinhole"`` camera. `Block.point_track` holds the identifiers of the object points.

    Raises
    ------
    UserError
        When a file is not such an export, or its camera has distortion.
    """
    try:
        lines = _lines(Path(export))
        camera = _camera(lines).without_distortion()
        names, rotations, centres = _stations(lines)
        identifiers, points = _points(lines)
        photo, point, xy = _measured(Path(measured), identifiers)
    except (OSError, ValueError, IndexError, KeyError) as problem:
        raise UserError(
            f"{Path(export).name} and {Path(measured).name} cannot be read.",
            f"They are not an export of PhotoModeler with its table of measured points: {problem}.",
            "Give the files …-pmexport.txt and …-2dpts.txt of one project.",
        ) from problem
    n, p = len(names), len(points)
    order = np.lexsort((photo, point))
    return Block(
        cameras=(camera,), names=names, camera_of_photo=np.zeros(n, dtype=np.int32), oriented=np.ones(n, dtype=bool),
        rotations=rotations, centres=centres, points=points, colours=np.full((p, 3), 128, dtype=np.uint8),
        point_track=identifiers.astype(np.int32), obs_photo=photo[order].astype(np.int32),
        obs_point=point[order].astype(np.int32), obs_xy=xy[order], unit="m",
    )  # fmt: skip


def read_photomodeler_export(path: Path) -> Read:
    """Read an export with its camera, distortion included, its orientations, object points and measured points.

    Raises
    ------
    UserError
        When the file is not such an export.
    """
    source = read_photomodeler_camera(path)
    parts = Parts(unit="m")
    try:
        lines = _lines(path)
        camera = parts.add_camera(source)
        for name, rotation, centre in zip(*_stations(lines), strict=True):
            parts.add_photo(name, camera, rotation, centre)
        identifiers, points = _points(lines)
        place = {int(key): i for i, key in enumerate(identifiers)}
        parts.points = points.tolist()
        marks = _marks(lines)
        for key, photo, (x, y) in zip(marks.point, marks.photo, marks.xy.tolist(), strict=True):
            if int(key) in place and 0 <= photo < len(parts.names):
                parts.observations.append((place[int(key)], int(photo), x, y))
    except (OSError, ValueError, IndexError, KeyError) as problem:
        raise UserError(
            Text("{name} cannot be read.", name=path.name),
            Text("It is not a text export of PhotoModeler: {why}.", why=problem),
            "Give the file …-pmexport.txt.",
        ) from problem
    return parts.read()


def read_photomodeler_case(export: str | Path, control: str | Path) -> DbatCase:
    """Read an export and a table of control points as an adjustment case, with PhotoModeler's values as start.

    As DBAT does, the table is shifted into the export's frame by the mean difference of the control points;
    `Control.origin` leads back.

    Parameters
    ----------
    export : str or Path
        ``…-pmexport.txt``; its list of measured points with their σ is read.
    control : str or Path
        ``identifier, name, X, Y, Z`` and, for weighted control, ``σX, σY, σZ``.

    Raises
    ------
    UserError
        When a file is not such an export or table, or the camera has distortion.
    """
    export, control = Path(export), Path(control)
    try:
        lines = _lines(export)
        camera = _camera(lines)
        names, rotations, centres = _stations(lines)
        identifiers, points = _points(lines)
        table = read_table(control, _columns(control))
        keys = table.numbers["id"].astype(int)
        place = {int(key): i for i, key in enumerate(identifiers)}
        there = np.array([int(key) in place for key in keys])
        given = table.columns("x", "y", "z")
        origin = np.mean(given[there] - points[[place[int(key)] for key in keys[there]]], axis=0)
        sigma = table.columns("sx", "sy", "sz") if "sx" in table.numbers else np.zeros_like(given)
        return assemble(
            export.name.removesuffix("-pmexport.txt"), camera, names, _marks(lines),
            Control(names=tuple(str(key) for key in keys), xyz=given - origin,
                    check=np.zeros(len(keys), dtype=bool), origin=origin),
            table.words["label"], sigma, start=(rotations, centres),
        )  # fmt: skip
    except (OSError, ValueError, IndexError, KeyError) as problem:
        raise UserError(
            Text("{name} and {other} cannot be read.", name=export.name, other=control.name),
            Text("They are not an export of PhotoModeler with its control points: {why}.", why=problem),
            "Give the files …-pmexport.txt and ctrlpts-….txt of one project.",
        ) from problem


def _columns(path: Path) -> str:
    """Return the columns of a control point table: its header names more than the fixed one has."""
    rows = [line for line in path.read_text(encoding="utf-8", errors="replace").splitlines()
            if line.strip() and not line.lstrip().startswith("#")]  # fmt: skip
    return "id,label,x,y,z,sx,sy,sz" if rows and rows[0].count(",") == 7 else "id,label,x,y,z"


def _marks(lines: list[list[str]]) -> Measured:
    """Read "photo identifier x y σx σy" lines; smart points are printed with σ 0, which counts as 1 px in DBAT."""
    rows = [[float(word) for word in line] for line in lines[5:]
            if len(line) == 6 and line[1].isdigit() and all("." in word for word in line[2:])]  # fmt: skip
    marks = np.array(rows).reshape(-1, 6)
    sigma = np.where(marks[:, 4] > 0, marks[:, 4], 1.0)
    return Measured(
        marks[:, 1].astype(np.int64), marks[:, 0].astype(np.int64), marks[:, 2:4] - PIXEL_ORIGIN, sigma
    )


def _lines(export: Path) -> list[list[str]]:
    return [line.split() for line in export.read_text(encoding="utf-8", errors="replace").splitlines()]


def _camera(lines: list[list[str]]) -> DbatCamera:
    width, height = (int(word) for word in lines[1][2:4])
    c, x0, y0, format_width, _, *distortion = (float(word) for word in lines[3])
    if any(distortion):
        raise ValueError("its camera has distortion, which this reader does not convert")
    return DbatCamera(
        width=width, height=height, pitch_mm=format_width / width, constant_mm=c,
        principal_mm=np.array([x0, y0]), k=np.zeros(3), p=np.zeros(2), model=1, name="PhotoModeler export",
    )  # fmt: skip


def _stations(lines: list[list[str]]) -> tuple[tuple[str, ...], Array, Array]:
    """Read "index path" lines, each followed by X, Y, Z, kappa, phi, omega in degrees."""
    names: list[str] = []
    rotations, centres = [], []
    for line, following in pairwise(lines[5:]):
        if len(line) == 2 and line[0] == str(len(names)) and len(following) == 7:
            x, y, z, kappa, phi, omega = (float(word) for word in following[1:])
            names.append(line[1].replace("\\", "/").rsplit("/", 1)[-1])
            rotations.append(matrix_from_opk(*np.radians([omega, phi, kappa])))
            centres.append([x, y, z])
    if not names:
        raise ValueError("no photo found")
    return tuple(names), np.array(rotations), np.array(centres)


def _points(lines: list[list[str]]) -> tuple[Array, Array]:
    """Read "identifier X Y Z σX σY σZ" lines at the end; the list stands there twice."""
    found = {
        int(line[0]): [float(word) for word in line[1:4]]
        for line in lines[5:]
        if len(line) == 7 and line[0].isdigit() and "." in line[1] and len(line[1].rsplit(".", 1)[1]) == 5
    }
    identifiers = np.array(sorted(found))
    return identifiers, np.array([found[key] for key in identifiers])


def _measured(path: Path, identifiers: Array) -> tuple[Array, Array, Array]:
    place = {int(key): i for i, key in enumerate(identifiers)}
    photo, point, xy = [], [], []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        words = line.split(",")
        if len(words) < 4 or not words[0].strip().isdigit():
            continue
        point.append(place[int(words[0])])
        photo.append(int(words[1]) - 1)
        xy.append([float(words[2]) - PIXEL_ORIGIN, float(words[3]) - PIXEL_ORIGIN])
    return np.array(photo), np.array(point), np.array(xy)
