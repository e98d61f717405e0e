"""Control points and their image measurements as text tables (CSV).

Control points: columns ``name, x, y, z`` and optionally ``role`` (control, check or off) and standard deviations ``sx,
sy, sz`` or one ``sigma``; an empty coordinate is unknown, σ = 0 holds a point fixed. Measurements: columns ``photo,
name, x, y`` and optionally ``sigma`` in pixels, the centre of the top-left pixel being (0, 0). A comment ``# crs:
EPSG:25832`` names the coordinate system; geographic coordinates (x longitude, y latitude, degrees) are turned into a
local frame east, north, up. Measurements stand in a file beside the first,
``control.csv`` and ``control_measurements.csv``, or in the same file under a header of their own. Columns are
separated by comma, semicolon or tab; ``#`` starts a comment; a unit may stand behind a column's name, ``x [mm]``, or
in a row of units below the header.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from graphos_core.data import Array, Control, ControlObservations
from graphos_core.exchange.control_tables import Row, Table, bad_line, read_tables
from graphos_core.exchange.coordinates import metric_coordinates
from graphos_core.text import Text

FAR_M = 1e4
"""Coordinates beyond this are shifted to a local origin, m."""

LARGEST_M = 1e10
"""Larger coordinates are mistakes."""

ROLES = {
    "": "control", "control": "control", "control point": "control", "gcp": "control", "check": "check",
    "check point": "check", "checkpoint": "check", "check-point": "check", "off": "off", "unused": "off",
}  # fmt: skip
"""What a word in the column ``role`` means."""

SIGMAS = ("sx", "sy", "sz")


def read_control(path: Path) -> tuple[Control | None, ControlObservations | None]:
    """Read control points and their measurements.

    Coordinates beyond 10 km are shifted to a local origin, `Control.origin`. A measured point without coordinates
    is kept with coordinates NaN, as a check point: it can be the end of a known distance.

    Parameters
    ----------
    path : Path
        File of the control points; ``<stem>_measurements`` with the same ending is read too where it exists.

    Returns
    -------
    Control or None
    ControlObservations or None
        None where there are none.

    Raises
    ------
    UserError
        When a file cannot be read, or for the first bad line with its number.
    """
    tables = read_tables(path)
    beside = path.with_name(f"{path.stem}_measurements{path.suffix}")
    if beside.is_file():
        tables += read_tables(beside)
    points = [(table, row) for table in tables if not table.measurements for row in table.rows]
    measurements = [(table, row) for table in tables if table.measurements for row in table.rows]
    names: dict[str, int] = {}
    xyz, sigma, roles = [], [], []
    for table, row in points:
        name = _named(table, row)
        if name in names:
            raise bad_line(table, row, Text("the point {name} occurs twice", name=name))
        names[name] = len(names)
        xyz.append(_coordinates(table, row))
        sigma.append(_sigmas(table, row))
        roles.append(_role(table, row))
    observations = _measurements(measurements, names)
    while len(xyz) < len(names):  # measured, but without coordinates
        xyz.append([np.nan] * 3)
        sigma.append([np.nan] * 3)
        roles.append("check")
    if not names:
        return None, None
    crs = _crs(path)
    coordinates, frame = metric_coordinates(np.array(xyz, dtype=np.float64).reshape(-1, 3), crs)
    origin = local_origin(coordinates)
    spread = np.array(sigma, dtype=np.float64).reshape(-1, 3)
    control = Control(
        names=tuple(names), xyz=coordinates - origin, check=np.array([role == "check" for role in roles]),
        origin=origin, sigma=spread if np.isfinite(spread).any() else None,
        off=np.array([role == "off" for role in roles]) if "off" in roles else None,
        crs=crs if frame is None else "",
    )  # fmt: skip
    return control, observations


def _coordinates(table: Table, row: Row) -> list[float]:
    """Return X, Y, Z; an empty cell is an unknown coordinate, a missing one an error, as is a point without any."""
    empty = [axis for axis in "xyz" if table.has(row, axis) and not table.text(row, axis)]
    if len(empty) == 3:
        raise bad_line(table, row, "all three coordinates are empty")
    xyz = [np.nan if axis in empty else table.number(row, axis) for axis in "xyz"]
    if np.nanmax(np.abs(xyz)) > LARGEST_M:
        raise bad_line(table, row, Text("a coordinate is larger than {largest:g} m", largest=LARGEST_M))
    return xyz


def _sigmas(table: Table, row: Row) -> list[float]:
    every = table.optional(row, "sigma")
    values = [table.optional(row, column) for column in SIGMAS]
    values = [every if np.isnan(value) else value for value in values]
    if any(value < 0 for value in values):
        raise bad_line(table, row, "a standard deviation is negative")
    return values


def _crs(path: Path) -> str:
    """Return the coordinate system that a comment ``# crs: …`` names, or nothing."""
    for line in path.read_text(encoding="utf-8-sig", errors="replace").splitlines():
        text = line.strip().casefold()
        if text.startswith("#") and text.lstrip("# ").startswith("crs:"):
            return line.partition(":")[2].strip()
    return ""


def local_origin(xyz: Array) -> Array:
    """Return a round local origin (3,) for coordinates (n, 3) in m; 0 on axes where all are small."""
    known = xyz[np.isfinite(xyz).all(axis=1)]
    if not len(known):
        return np.zeros(3)
    far = np.abs(known).max(axis=0) > FAR_M
    return np.where(far, np.round(known.mean(axis=0), -2), 0.0)


def _measurements(rows: list[tuple[Table, Row]], names: dict[str, int]) -> ControlObservations | None:
    """Collect the measurements; points that have no coordinates are added to `names`."""
    if not rows:
        return None
    point, photo, xy, sigma = [], [], [], []
    seen: set[tuple[str, str]] = set()
    for table, row in rows:
        name, where = _named(table, row), table.text(row, "photo").replace("\\", "/")
        if not where:
            raise bad_line(table, row, "the name of the photo is missing")
        if (name, where) in seen:
            raise bad_line(table, row, Text("{name} is measured twice in {photo}", name=name, photo=where))
        seen.add((name, where))
        point.append(names.setdefault(name, len(names)))
        photo.append(where)
        xy.append([table.number(row, axis) for axis in "xy"])
        sigma.append(table.optional(row, "sigma"))
        if sigma[-1] <= 0:
            raise bad_line(table, row, "the standard deviation is not above 0")
    return ControlObservations(
        point=np.array(point, dtype=np.int32), photo=tuple(photo), xy=np.array(xy, dtype=np.float64),
        sigma_px=np.array(sigma) if np.isfinite(sigma).any() else None,
    )  # fmt: skip


def _named(table: Table, row: Row) -> str:
    name = table.text(row, "name")
    if not name:
        raise bad_line(table, row, "the name of the point is missing")
    return name


def _role(table: Table, row: Row) -> str:
    role = table.text(row, "role").casefold()
    if role not in ROLES:
        raise bad_line(
            table, row, Text("the role “{role}” is neither control, check nor off", role=role[:40])
        )
    return ROLES[role]
