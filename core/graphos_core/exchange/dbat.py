"""PhotoModeler exports as the Damped Bundle Adjustment Toolbox (DBAT) ships them, and the angles of its reports.

A project is an export file (``…-pmexport.txt``: interior orientation in mm, exterior orientations, object points) and
a table of measured points (``…-2dpts.txt``, px with x right and y down). Only cameras without distortion are read.

Both use camera coordinates with the corner of the format as origin: the millimetres of the principal point divided by
the pixel size have the same origin as the measured pixels. The corner of the top-left pixel is at (0, 0) there, at
(−0.5, −0.5) here.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from graphos_core.data import Array, Block, Camera
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import matrix_from_opk

PIXEL_ORIGIN = 0.5
"""Position of the centre of the top-left pixel in PhotoModeler's pixel coordinates."""


@dataclass(frozen=True)
class Station:
    """An exterior orientation as a report prints it.

    Attributes
    ----------
    photo : str
    opk : float64 (3,)
        Omega, phi, kappa, radians.
    sigma_opk : float64 (3,)
        Their standard deviations, radians.
    centre, sigma_centre : float64 (3,)
        Projection centre and its standard deviations, in the object unit.
    """

    photo: str
    opk: Array
    sigma_opk: Array
    centre: Array
    sigma_centre: Array


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
        lines = [
            line.split() for line in Path(export).read_text(encoding="utf-8", errors="replace").splitlines()
        ]
        camera = _camera(lines)
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


def read_stations(report: str | Path) -> tuple[Station, ...]:
    """Read the exterior orientations with their standard deviations from a DBAT report.

    Raises
    ------
    UserError
        When the report prints none.
    """
    text = Path(report).read_text(encoding="utf-8", errors="replace")
    found = []
    for part in re.split(r"\n\s+Photo \d+: ", text)[1:]:
        pairs = re.findall(r"(Omega|Phi|Kappa|Xc|Yc|Zc):\s+Value:\s+(\S+) \w+\s+Deviation: (\S+) \w+", part)[
            :6
        ]
        if len(pairs) < 6:
            continue
        value = np.array([float(pair[1]) for pair in pairs])
        sigma = np.array([float(pair[2]) for pair in pairs])
        found.append(Station(
            part.split("\n", 1)[0].strip(), np.radians(value[:3]), np.radians(sigma[:3]), value[3:], sigma[3:]
        ))  # fmt: skip
    if not found:
        raise UserError(f"{Path(report).name} prints no exterior orientations.", todo="Give a DBAT report.")
    return tuple(found)


def _camera(lines: list[list[str]]) -> Camera:
    width, height = (int(word) for word in lines[1][2:4])
    c, x0, y0, format_width, format_height, *distortion = (float(word) for word in lines[3])
    if any(distortion):
        raise ValueError("its camera has distortion, which this reader does not convert")
    pitch = format_width / width
    values = np.array([c / pitch, x0 / pitch - PIXEL_ORIGIN, y0 / (format_height / height) - PIXEL_ORIGIN])
    return Camera(
        model="pinhole", width=width, height=height, values=values, pixel_pitch_mm=pitch,
        focal_source="PhotoModeler export",
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
