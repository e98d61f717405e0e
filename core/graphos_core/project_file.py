"""The file ``project.toml``: what a project knows beside its photos; read as data that may come from a stranger."""

from __future__ import annotations

import math
import os
import shutil
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from graphos_core import __version__
from graphos_core.cameras.lens import LENSES
from graphos_core.errors import ParamError, UserError
from graphos_core.params import unknown_name
from graphos_core.store import cannot_write, write_text
from graphos_core.text import Text

SCHEMA = 1
FILE = "project.toml"
KNOWN = "known.toml"
"""What is known of the object beside control points, see `graphos_core.exchange.known`."""


@dataclass(frozen=True)
class Settings:
    """What a project knows beside its photos and its recipe.

    Attributes
    ----------
    name : str
    photos : str
        Photo folder, relative to the project folder, with forward slashes.
    files : tuple of str
        Names of the photos when the project was last opened.
    excluded : tuple of str
        Photos the person switched off.
    seed : int
    focal_px : float or None
        Principal distance given by the person, px.
    principal_point : tuple of float or None
        Principal point given by the person, px.
    lens : str
        Kind of lens the photos were taken with, see `graphos_core.cameras.lens`.
    control : str
        Control point file inside the project folder, or empty.
    distance : tuple (str, str, float) or None
        Two point names and their distance in metres.
    reference : str
        Reference cloud or mesh for quality control, relative to the project folder, or empty.
    calibration : str
        Calibration file inside the project folder, or empty.
    orientation : str
        Key of the given orientation kept in the project's store, or empty.
    """

    name: str
    photos: str
    files: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()
    seed: int = 0
    focal_px: float | None = None
    principal_point: tuple[float, float] | None = None
    lens: str = "perspective"
    control: str = ""
    distance: tuple[str, str, float] | None = None
    reference: str = ""
    calibration: str = ""
    orientation: str = ""


def relative_path(path: Path, start: Path) -> str:
    """Return `path` relative to `start` with forward slashes, absolute only from another drive."""
    try:
        return Path(os.path.relpath(path.resolve(), start.resolve())).as_posix()
    except ValueError:  # another drive on Windows
        return path.resolve().as_posix()


def resolved(folder: Path, relative: str) -> Path:
    """Return the path that a project file names relative to its folder."""
    return Path(os.path.normpath(folder / relative))


def inside(folder: Path, name: str) -> Path:
    """Return a path inside the project folder, refusing one that leaves it."""
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise UserError(
            Text("The project names a file outside its folder: {name}.", name=name),
            "A project may come from a stranger, so such paths are refused.",
            "Put the file into the project folder and name it again.",
        )
    return path


def copy_control(source: Path, folder: Path) -> str:
    """Copy a control point file and its measurements into the project folder; return its name there."""
    if not source.is_file():
        raise UserError(
            Text("The control point file {name} does not exist.", name=source), todo="Check the path."
        )
    pairs = [(source, "control" + source.suffix.lower())]
    beside = source.with_name(f"{source.stem}_measurements{source.suffix}")
    if beside.is_file():
        pairs.append((beside, "control_measurements" + source.suffix.lower()))
    else:  # measurements of an earlier control file belong to that file
        (folder / f"control_measurements{source.suffix.lower()}").unlink(missing_ok=True)
    for origin, name in pairs:
        if origin.resolve() != (folder / name).resolve():
            try:
                shutil.copyfile(origin, folder / name)
            except OSError as problem:
                raise cannot_write(folder / name, problem) from problem
    return pairs[0][1]


def copy_known(source: Path, folder: Path) -> None:
    """Copy what a project knows beside control points to another one: distances, ``known.toml``, tables, masks.

    What the other one has already stays.
    """
    from graphos_core.exchange.distance_table import FILE as DISTANCES
    from graphos_core.exchange.known import known_tables

    masks = (source / "masks.toml", *sorted((source / "masks").glob("*.png")))
    for path in (source / DISTANCES, source / KNOWN, *known_tables(source / KNOWN), *masks):
        if not path.is_file() or not path.resolve().is_relative_to(source.resolve()):
            continue
        copy = folder / path.resolve().relative_to(source.resolve())
        if not copy.exists():
            try:
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, copy)
            except OSError as problem:
                raise cannot_write(copy, problem) from problem


def copy_calibration(source: Path, folder: Path) -> str:
    """Copy a calibration file into the project folder, refusing one that cannot be read; return its name there."""
    from graphos_core.exchange.calibration_file import read_calibration

    read_calibration(source)
    name = "calibration.toml"
    if source.resolve() != (folder / name).resolve():
        try:
            shutil.copyfile(source, folder / name)
        except OSError as problem:
            raise cannot_write(folder / name, problem) from problem
    return name


def check_settings(settings: Settings) -> None:
    """Refuse values that make no sense."""
    if settings.focal_px is not None and not 1.0 <= settings.focal_px <= 1e6:
        raise ParamError(
            "focal_px", Text("Principal distance: {v} px, needs 1 to 1000000", v=settings.focal_px)
        )
    if settings.principal_point is not None and not all(abs(v) <= 1e6 for v in settings.principal_point):
        raise ParamError(
            "principal_point",
            Text("Principal point: {v} px, needs two numbers within ±1000000", v=settings.principal_point),
        )
    if settings.lens not in LENSES:
        raise ParamError("lens", unknown_name(settings.lens, list(LENSES), "lens"))
    if not 0 <= settings.seed < 2**31:
        raise ParamError(
            "seed", Text("Seed: {v}, needs a whole number from 0 to 2147483647", v=settings.seed)
        )
    if settings.distance is not None and not 0 < settings.distance[2] < math.inf:
        raise ParamError("distance", Text("Known distance: {v} m, needs more than 0", v=settings.distance[2]))


def write_settings(folder: Path, settings: Settings) -> None:
    """Write ``project.toml`` atomically."""
    s = settings
    document: dict[str, Any] = {"schema": SCHEMA, "name": s.name, "seed": s.seed, "version": __version__}
    document["photos"] = {"folder": s.photos, "files": list(s.files), "excluded": list(s.excluded)}
    camera = {
        "lens": s.lens if s.lens != "perspective" else None,
        "focal_px": s.focal_px,
        "principal_point": list(s.principal_point) if s.principal_point else None,
    }
    document["camera"] = {k: v for k, v in camera.items() if v is not None}
    known = {
        "control": s.control,
        "distance": list(s.distance) if s.distance else "",
        "reference": s.reference,
        "calibration": s.calibration,
        "orientation": s.orientation,
    }
    document["known"] = {k: v for k, v in known.items() if v}
    write_text(folder / FILE, tomli_w.dumps(document))


def read_settings(folder: Path) -> Settings:
    """Read ``project.toml`` of a folder; see `graphos_core.project.Project.open` for what is raised."""
    try:
        document = tomllib.loads((folder / FILE).read_text("utf-8"))
        if document.get("schema") != SCHEMA:
            raise UserError(
                Text("The project in {folder} was written by another version of the program.", folder=folder),
                Text("This version reads schema {ours}, the project has {theirs}.", ours=SCHEMA,
                     theirs=document.get("schema", "none")),
                "Open it with the version that wrote it, or make a new project from the photos.",
            )  # fmt: skip
        photos, camera, known = document["photos"], document.get("camera", {}), document.get("known", {})
        files = tuple(_plain_name(n) for n in photos.get("files", ()))
        distance = known.get("distance")
        point = camera.get("principal_point")
        found = Settings(
            name=str(document["name"]),
            photos=str(photos["folder"]),
            files=files,
            excluded=tuple(_plain_name(n) for n in photos.get("excluded", ())),
            seed=int(document.get("seed", 0)),
            focal_px=None if camera.get("focal_px") is None else float(camera["focal_px"]),
            principal_point=None if point is None else (float(point[0]), float(point[1])),
            lens=str(camera.get("lens", "perspective")),
            control=str(known.get("control", "")),
            distance=None if not distance else (str(distance[0]), str(distance[1]), float(distance[2])),
            reference=str(known.get("reference", "")),
            calibration=str(known.get("calibration", "")),
            orientation=str(known.get("orientation", "")),
        )
        if "\0" in found.photos + found.control + found.reference + found.calibration:
            raise ValueError("a path has a character that no path can have")
        check_settings(found)
        return found
    except FileNotFoundError as problem:
        raise UserError(
            Text("{folder} is not a GRAPHOS project.", folder=folder),
            "It has no project.toml.",
            "Choose a project folder, or make a new project from a folder of photos.",
        ) from problem
    except (OSError, KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError, RecursionError,
            ParamError) as problem:  # fmt: skip
        raise UserError(
            Text("The project in {folder} cannot be read.", folder=folder),
            Text("project.toml is damaged: {why}.", why=problem),
            "Make a new project from the photos; stored results stay in the folder.",
        ) from problem


def _plain_name(name: Any) -> str:
    """Return a photo name from a project file, refusing one that leaves the photo folder."""
    if not isinstance(name, str) or Path(name).is_absolute() or ".." in Path(name).parts or "\\" in name:
        raise ValueError(f"“{name}” is not the name of a photo")
    return name
