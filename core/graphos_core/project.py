"""A project: a folder that holds the settings, the recipe, the stored results and the runs; never the photos."""

from __future__ import annotations

import os
import shutil
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomli_w

from graphos_core import __version__
from graphos_core.data import Control, ControlObservations, KnownDistance, PhotoSet
from graphos_core.errors import ParamError, UserError
from graphos_core.run import Run
from graphos_core.store import Store, cannot_write, content_key, write_text
from graphos_core.text import Text

SCHEMA = 1
FILE = "project.toml"


class PhotosMoved(UserError):
    """The photos of a project are not where they were; open it again with their new folder.

    Attributes
    ----------
    expected : Path
        Where they were.
    missing : tuple of str
        Names of the photos that are not there.
    """

    def __init__(self, expected: Path, missing: tuple[str, ...]) -> None:
        super().__init__(
            Text("{count} photos of this project were not found.", count=len(missing)),
            Text("They were in {folder}; the first missing one is {name}.", folder=expected, name=missing[0]),
            "Say where the photos are now.",
        )
        self.expected = expected
        self.missing = missing


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
    control : str
        Control point file inside the project folder, or empty.
    distance : tuple (str, str, float) or None
        Two point names and their distance in metres.
    reference : str
        Reference cloud or mesh for quality control, relative to the project folder, or empty.
    """

    name: str
    photos: str
    files: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()
    seed: int = 0
    focal_px: float | None = None
    principal_point: tuple[float, float] | None = None
    control: str = ""
    distance: tuple[str, str, float] | None = None
    reference: str = ""


class Project:
    """An open project.

    Attributes
    ----------
    folder : Path
    settings : Settings
    photo_set : PhotoSet
        Photos that are used, their cameras, and the files that could not be read.
    store : Store
    """

    def __init__(self, folder: Path, settings: Settings, photo_set: PhotoSet, store: Store) -> None:
        self.folder = folder
        self.settings = settings
        self.photo_set = photo_set
        self.store = store

    @property
    def name(self) -> str:
        """Name for people."""
        return self.settings.name

    @property
    def seed(self) -> int:
        """Seed of the project's random steps."""
        return self.settings.seed

    @property
    def photos_folder(self) -> Path:
        """Folder of the photos."""
        return _resolve(self.folder, self.settings.photos)

    @classmethod
    def create(
        cls, folder: Path, photos: Path, *, name: str | None = None, run: Run | None = None, **settings: Any
    ) -> Project:
        """Make a project in `folder` for the photos in `photos`, or open the one that is there for the same photos.

        Parameters
        ----------
        folder, photos : Path
            Photos are read from where they are; nothing is copied or changed.
        name : str, optional
            Name of the photo folder when missing.
        run : Run, optional
        **settings
            Other fields of `Settings`; ``control`` may be a path anywhere, the file is copied.

        Raises
        ------
        UserError
            When the folder cannot be written or holds a project of other photos, or there is no usable photo.
        """
        folder, photos = folder.absolute(), photos.absolute()
        control = settings.pop("control", None)
        relative = _relative(photos, folder)
        if (folder / FILE).exists():
            found = _read(folder)
            if _resolve(folder, found.photos).resolve() != photos.resolve():
                raise UserError(
                    Text(
                        "{folder} holds the project “{name}” of other photos.", folder=folder, name=found.name
                    ),
                    todo="Choose another output folder; results are never overwritten.",
                )
            made = replace(found, **{k: v for k, v in settings.items() if v is not None})
        else:
            made = Settings(name=name or photos.name, photos=relative, **settings)
        _check(made)
        photo_set = _read_photos(photos, made, Store(folder / "results"), run or Run(), write=False)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as problem:
            raise cannot_write(folder, problem) from problem
        if control is not None:
            made = replace(made, control=_copy_control(Path(control), folder))
        made = replace(made, files=tuple(sorted({p.name for p in photo_set.photos} | set(made.excluded))))
        project = cls(folder, made, photo_set, Store(folder / "results"))
        project.save()
        return project

    @classmethod
    def open(cls, folder: Path, *, photos: Path | None = None, run: Run | None = None) -> Project:
        """Open a project.

        Parameters
        ----------
        folder : Path
            Folder of the project, or its ``project.toml``.
        photos : Path, optional
            Where the photos are now, when they moved.
        run : Run, optional

        Raises
        ------
        PhotosMoved
            When photos are missing.
        UserError
            When it is no project or cannot be read.
        """
        folder = (folder.parent if folder.name == FILE else folder).absolute()
        settings = _read(folder)
        where = photos.absolute() if photos is not None else _resolve(folder, settings.photos)
        missing = tuple(name for name in settings.files if not (where / name).is_file())
        if missing or not where.is_dir():
            raise PhotosMoved(where, missing or ("(folder)",))
        if photos is not None:
            settings = replace(settings, photos=_relative(where, folder))
        store = Store(folder / "results")
        store.sweep()
        project = cls(folder, settings, _read_photos(where, settings, store, run or Run(), write=True), store)
        if photos is not None:
            project.save()
        return project

    def save(self) -> None:
        """Write ``project.toml``."""
        s = self.settings
        document: dict[str, Any] = {"schema": SCHEMA, "name": s.name, "seed": s.seed, "version": __version__}
        document["photos"] = {"folder": s.photos, "files": list(s.files), "excluded": list(s.excluded)}
        camera = {
            "focal_px": s.focal_px,
            "principal_point": list(s.principal_point) if s.principal_point else None,
        }
        document["camera"] = {k: v for k, v in camera.items() if v is not None}
        known = {
            "control": s.control,
            "distance": list(s.distance) if s.distance else "",
            "reference": s.reference,
        }
        document["known"] = {k: v for k, v in known.items() if v}
        write_text(self.folder / FILE, tomli_w.dumps(document))

    def change(self, run: Run | None = None, **settings: Any) -> Project:
        """Return the project with some settings changed, saved; ``control`` may be a path anywhere."""
        if settings.get("control"):
            settings["control"] = _copy_control(Path(settings["control"]), self.folder)
        made = replace(self.settings, **settings)
        _check(made)
        photo_set = _read_photos(self.photos_folder, made, self.store, run or Run(), write=True)
        project = Project(self.folder, made, photo_set, self.store)
        project.save()
        return project

    def control(self) -> tuple[Control | None, ControlObservations | None]:
        """Read the control points and their image measurements; None where there are none."""
        if not self.settings.control:
            return None, None
        from graphos_core.exchange.control import read_control

        return read_control(_inside(self.folder, self.settings.control))

    def known_distance(self) -> KnownDistance | None:
        """Return the known distance, if any."""
        if self.settings.distance is None:
            return None
        a, b, metres = self.settings.distance
        return KnownDistance(a=a, b=b, metres=metres)

    def reference_path(self) -> Path | None:
        """Return the path of the reference cloud or mesh, if any."""
        return _resolve(self.folder, self.settings.reference) if self.settings.reference else None

    def photos_key(self) -> dict[str, Any]:
        """Return what identifies the photos and the given calibration in keys."""
        return {
            "photos": [[p.name, p.digest, p.camera] for p in self.photo_set.photos],
            "cameras": [
                [c.model, c.width, c.height, [float(v) for v in c.values]] for c in self.photo_set.cameras
            ],
        }


def _relative(path: Path, start: Path) -> str:
    try:
        return Path(os.path.relpath(path.resolve(), start.resolve())).as_posix()
    except ValueError:  # another drive on Windows
        return path.resolve().as_posix()


def _resolve(folder: Path, relative: str) -> Path:
    return Path(os.path.normpath(folder / relative))


def _inside(folder: Path, name: str) -> Path:
    """Return a path inside the project folder, refusing one that leaves it."""
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise UserError(
            Text("The project names a file outside its folder: {name}.", name=name),
            "A project may come from a stranger, so such paths are refused.",
            "Put the file into the project folder and name it again.",
        )
    return path


def _copy_control(source: Path, folder: Path) -> str:
    if not source.is_file():
        raise UserError(
            Text("The control point file {name} does not exist.", name=source), todo="Check the path."
        )
    pairs = [(source, "control" + source.suffix.lower())]
    beside = source.with_name(f"{source.stem}_measurements{source.suffix}")
    if beside.is_file():
        pairs.append((beside, "control_measurements" + source.suffix.lower()))
    for origin, name in pairs:
        if origin.resolve() != (folder / name).resolve():
            try:
                shutil.copyfile(origin, folder / name)
            except OSError as problem:
                raise cannot_write(folder / name, problem) from problem
    return pairs[0][1]


def _check(settings: Settings) -> None:
    if settings.focal_px is not None and not 1.0 <= settings.focal_px <= 1e6:
        raise ParamError(
            "focal_px", Text("Principal distance: {v} px, needs 1 to 1000000", v=settings.focal_px)
        )
    if not 0 <= settings.seed < 2**31:
        raise ParamError(
            "seed", Text("Seed: {v}, needs a whole number from 0 to 2147483647", v=settings.seed)
        )
    if settings.distance is not None and not settings.distance[2] > 0:
        raise ParamError("distance", Text("Known distance: {v} m, needs more than 0", v=settings.distance[2]))


def _read(folder: Path) -> Settings:
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
        return Settings(
            name=str(document["name"]),
            photos=str(photos["folder"]),
            files=files,
            excluded=tuple(_plain_name(n) for n in photos.get("excluded", ())),
            seed=int(document.get("seed", 0)),
            focal_px=None if camera.get("focal_px") is None else float(camera["focal_px"]),
            principal_point=None if point is None else (float(point[0]), float(point[1])),
            control=str(known.get("control", "")),
            distance=None if not distance else (str(distance[0]), str(distance[1]), float(distance[2])),
            reference=str(known.get("reference", "")),
        )
    except FileNotFoundError as problem:
        raise UserError(
            Text("{folder} is not a GRAPHOS project.", folder=folder),
            "It has no project.toml.",
            "Choose a project folder, or make a new project from a folder of photos.",
        ) from problem
    except (OSError, KeyError, TypeError, ValueError, IndexError) as problem:
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


def _read_photos(folder: Path, settings: Settings, store: Store, run: Run, *, write: bool) -> PhotoSet:
    """Read the photo headers, or take them from the store when no file has changed."""
    from graphos_core.images import read_photo_set

    listing: Mapping[str, Any] = {"version": __version__}
    if folder.is_dir():
        stats = sorted((p.name, p.stat()) for p in folder.iterdir() if p.is_file())
        files = [[name, stat.st_size, stat.st_mtime_ns] for name, stat in stats]
        listing = {
            "version": __version__, "folder": str(folder), "files": files, "excluded": list(settings.excluded),
            "focal_px": settings.focal_px, "principal_point": settings.principal_point,
        }  # fmt: skip
    key = content_key(listing)
    if store.has("photos", key):
        loaded: PhotoSet = store.load("photos", key)
        return loaded
    found = read_photo_set(
        folder, run=run, focal_px=settings.focal_px, principal_point=settings.principal_point
    )
    kept = tuple(p for p in found.photos if p.name not in settings.excluded)
    if not kept:
        raise UserError("No photo is left.", "All photos are switched off.", "Switch at least two photos on.")
    found = replace(found, photos=kept)
    if write:
        store.save("photos", key, found, {"what": "photo headers"})
    return found
