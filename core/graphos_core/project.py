"""A project: a folder that holds the settings, the recipe, the stored results and the runs; never the photos."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from graphos_core import __version__
from graphos_core.cameras.lens import with_lens
from graphos_core.data import Block, Control, ControlObservations, Known, KnownDistance, PhotoSet
from graphos_core.errors import UserError
from graphos_core.project_file import (
    FILE,
    KNOWN,
    Settings,
    check_settings,
    copy_calibration,
    copy_control,
    inside,
    read_settings,
    relative_path,
    resolved,
    write_settings,
)
from graphos_core.run import Run
from graphos_core.store import Store, cannot_write, content_key
from graphos_core.text import Text

GIVEN = "given"
"""Folder of the store with given orientations."""

READER = 2
"""Raised when headers are read in another way, so that stored ones are not used again."""


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
        return resolved(self.folder, self.settings.photos)

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
            Other fields of `Settings`; ``control`` and ``calibration`` may be paths anywhere, the files are copied.

        Raises
        ------
        UserError
            When the folder cannot be written or holds a project of other photos, or there is no usable photo.
        """
        folder, photos = folder.absolute(), photos.absolute()
        control, calibration = settings.pop("control", None), settings.pop("calibration", None)
        relative = relative_path(photos, folder)
        if (folder / FILE).exists():
            found = read_settings(folder)
            if resolved(folder, found.photos).resolve() != photos.resolve():
                raise UserError(
                    Text(
                        "{folder} holds the project “{name}” of other photos.", folder=folder, name=found.name
                    ),
                    todo="Choose another output folder; results are never overwritten.",
                )
            made = replace(found, **{k: v for k, v in settings.items() if v is not None})
        else:
            made = Settings(name=name or photos.name, photos=relative, **settings)
        check_settings(made)
        photo_set = _read_photos(
            photos, made, Store(folder / "results"), run or Run(), write=False,
            calibration=Path(calibration) if calibration is not None else _calibration_of(folder, made),
        )  # fmt: skip
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as problem:
            raise cannot_write(folder, problem) from problem
        if calibration is not None:
            made = replace(made, calibration=copy_calibration(Path(calibration), folder))
        if control is not None:
            made = replace(made, control=copy_control(Path(control), folder))
        made = replace(made, files=tuple(sorted({p.name for p in photo_set.photos} | set(made.excluded))))
        store = Store(folder / "results")
        store.sweep()
        project = cls(folder, made, photo_set, store)
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
        settings = read_settings(folder)
        where = photos.absolute() if photos is not None else resolved(folder, settings.photos)
        missing = tuple(name for name in settings.files if not (where / name).is_file())
        if missing or not where.is_dir():
            raise PhotosMoved(where, missing or ("(folder)",))
        if photos is not None:
            settings = replace(settings, photos=relative_path(where, folder))
        store = Store(folder / "results")
        store.sweep()
        photo_set = _read_photos(
            where, settings, store, run or Run(), write=True, calibration=_calibration_of(folder, settings)
        )
        project = cls(folder, settings, photo_set, store)
        if photos is not None:
            project.save()
        return project

    def save(self) -> None:
        """Write ``project.toml``."""
        write_settings(self.folder, self.settings)

    def change(self, run: Run | None = None, **settings: Any) -> Project:
        """Return the project with some settings changed, saved; control and calibration may be paths anywhere."""
        if settings.get("control"):
            from graphos_core.exchange.control_writing import keep_version

            keep_version(self.folder)  # edited points are not lost to a file that is taken instead
            settings["control"] = copy_control(Path(settings["control"]), self.folder)
        given = settings.pop("calibration", None)
        made = replace(self.settings, **settings)
        if given == "":
            made = replace(made, calibration="")
        check_settings(made)
        photo_set = _read_photos(
            self.photos_folder, made, self.store, run or Run(), write=True,
            calibration=Path(given) if given else _calibration_of(self.folder, made),
        )  # fmt: skip
        if given:
            made = replace(made, calibration=copy_calibration(Path(given), self.folder))
        project = Project(self.folder, made, photo_set, self.store)
        project.save()
        return project

    def with_control(self, name: str) -> Project:
        """Return the project with another control point file inside its folder, saved; photos are not read again."""
        project = Project(self.folder, replace(self.settings, control=name), self.photo_set, self.store)
        project.save()
        return project

    def with_orientation(self, block: Block, about: str) -> Project:
        """Return the project with a given orientation to start from, kept in its store and saved.

        Parameters
        ----------
        block : Block
            Of an earlier run, or read by `graphos_core.exchange.orientation_formats`.
        about : str
            Where it comes from, in words.
        """
        key = orientation_key(block)
        if not self.store.has(GIVEN, key):
            self.store.save(
                GIVEN, key, replace(block, others=()), {"what": "given orientation", "from": about}
            )
        project = Project(self.folder, replace(self.settings, orientation=key), self.photo_set, self.store)
        project.save()
        return project

    def given_orientation(self) -> Block | None:
        """Return the given orientation, if any."""
        if not self.settings.orientation:
            return None
        block: Block = self.store.load(GIVEN, self.settings.orientation)
        return block

    def control(self) -> tuple[Control | None, ControlObservations | None]:
        """Read the control points and their image measurements; None where there are none."""
        if not self.settings.control:
            return None, None
        from graphos_core.exchange.control import read_control

        return read_control(inside(self.folder, self.settings.control))

    def known_distances(self) -> tuple[KnownDistance, ...]:
        """Return all known distances: that of the settings, and those of the table beside the control points."""
        from graphos_core.exchange.distance_table import FILE as TABLE
        from graphos_core.exchange.distance_table import read_distances

        own: tuple[KnownDistance, ...] = ()
        if self.settings.distance is not None:
            a, b, metres = self.settings.distance
            own = (KnownDistance(a=a, b=b, metres=metres),)
        return (*own, *read_distances(self.folder / TABLE))

    def known(self) -> Known:
        """Return everything known about the object: control points, distances, positions of photos, shapes, rigs."""
        from graphos_core.exchange.known import read_known

        control, measured = self.control()
        first = Known(control=control, measured=measured, distances=self.known_distances())
        return read_known(self.folder / KNOWN, first, self.photo_set)

    def reference_path(self) -> Path | None:
        """Return the path of the reference cloud or mesh, if any."""
        return resolved(self.folder, self.settings.reference) if self.settings.reference else None

    def photos_key(self) -> dict[str, Any]:
        """Return what identifies the photos and the given calibration in keys."""
        return {
            "photos": [[p.name, p.digest, p.camera] for p in self.photo_set.photos],
            "cameras": [
                [c.model, c.width, c.height, [float(v) for v in c.values]] for c in self.photo_set.cameras
            ],
        }


def orientation_key(block: Block) -> str:
    """Return the key of a given orientation: what a start from it depends on."""
    digest = hashlib.sha256()
    for array in (block.oriented, block.rotations, block.centres, block.camera_of_photo):
        digest.update(np.ascontiguousarray(array).tobytes())
    cameras = [[c.model, c.width, c.height, [float(v) for v in c.values]] for c in block.cameras]
    return content_key({"poses": digest.hexdigest(), "names": list(block.names), "cameras": cameras})


def _calibration_of(folder: Path, settings: Settings) -> Path | None:
    return inside(folder, settings.calibration) if settings.calibration else None


def _read_photos(
    folder: Path, settings: Settings, store: Store, run: Run, *, write: bool, calibration: Path | None = None
) -> PhotoSet:
    """Read the photo headers, or take them from the store when no file has changed; give the cameras their values."""
    found = _read_headers(folder, settings, store, run, write=write)
    if calibration is None:
        return found
    from graphos_core.exchange.calibration_file import read_calibration, with_calibration

    return with_calibration(found, read_calibration(calibration))


def _read_headers(folder: Path, settings: Settings, store: Store, run: Run, *, write: bool) -> PhotoSet:
    from graphos_core.images import read_photo_set

    listing: Mapping[str, Any] = {"version": __version__, "reader": READER}
    if folder.is_dir():
        stats = sorted((p.name, p.stat()) for p in folder.iterdir() if p.is_file())
        files = [[name, stat.st_size, stat.st_mtime_ns] for name, stat in stats]
        listing = {
            "version": __version__, "reader": READER, "folder": str(folder), "files": files, "excluded": list(settings.excluded),
            "focal_px": settings.focal_px, "principal_point": settings.principal_point,
            "lens": settings.lens,
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
    found = replace(
        found, photos=kept, cameras=tuple(with_lens(camera, settings.lens) for camera in found.cameras)
    )
    if write:
        store.save("photos", key, found, {"what": "photo headers"})
    return found
