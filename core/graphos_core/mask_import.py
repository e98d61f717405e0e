"""Taking masks into a project: another project's file, or pictures beside the photos under the usual names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from graphos_core.data import Photo
from graphos_core.errors import ItemFailure, UserError
from graphos_core.masks import FILE, FOLDER, LEARN, PhotoMask, picture_mask, read_masks, write_masks
from graphos_core.store import write_bytes
from graphos_core.text import Text

MARKS = (".mask", "_mask", "-mask", "")
"""What stands between the photo's name and ``.png``."""


def is_mask_picture(name: str, names: Sequence[str]) -> bool:
    """Say whether a file beside photos is the mask of one of them: ``NAME_mask.png``, ``NAME.mask.png`` and kin."""
    stem, dot, ending = name.rpartition(".")
    if not dot or ending.lower() != "png":
        return False
    of = next((stem[: -len(mark)] for mark in MARKS if mark and stem.lower().endswith(mark)), "")
    return bool(of) and any(other != name and of in (other, other.rpartition(".")[0]) for other in names)


def import_masks(source: Path, folder: Path, photos: Sequence[Photo]) -> tuple[list[str], list[ItemFailure]]:
    """Take masks into a project; a photo that has some keeps its polygons.

    Parameters
    ----------
    source : Path
        A ``masks.toml``; a project or folder with one; a folder with pictures (``NAME.mask.png``, ``NAME_mask.png``,
        ``NAME.png``, NAME with or without the photo's ending), also in its folder ``masks``; or one picture, which is
        that of the photo of its name, else of all photos: a static frame. Black (0) is excluded.
    folder : Path
        Of the project.
    photos : sequence of Photo

    Returns
    -------
    list of str, list of ItemFailure
        Photos that got a mask; masks that could not be used, with reasons.

    Raises
    ------
    UserError
        When there is no mask for any photo, or something cannot be read or written.
    """
    if not source.exists():
        raise UserError(Text("The masks {name} do not exist.", name=source), todo="Check the path.")
    home = source.parent if source.name == FILE else source
    known = read_masks(folder)
    polygons = read_masks(home) if (home / FILE).is_file() else {}
    pictures = _pictures(home, photos) if home.is_dir() else _picture(home, photos)
    taken, failures = [], []
    for photo in photos:
        before, more = known.get(photo.name, PhotoMask()), polygons.get(photo.name, PhotoMask())
        named = home / FOLDER / more.picture if more.picture else pictures.get(photo.name)
        picture = before.picture
        if named is not None:
            try:
                picture = _copied(named, folder, photo)
            except UserError as problem:
                failures.append(ItemFailure(named.name, str(problem)))
        new = tuple(p for p in more.polygons if p not in before.polygons)
        if new or picture != before.picture or (named is not None and picture):
            known[photo.name] = PhotoMask((*before.polygons, *new), picture)
            taken.append(photo.name)
    if not taken and not failures:
        raise UserError(
            Text("{name} holds no mask for any of the photos.", name=source.name),
            "A mask is a masks.toml, or a picture named like its photo: NAME_mask.png, NAME.mask.png or masks/NAME.png.",
            "Check the names, or draw the masks in the Photos tab.", LEARN,
        )  # fmt: skip
    write_masks(folder, known)
    return taken, failures


def _pictures(home: Path, photos: Sequence[Photo]) -> dict[str, Path]:
    """Return the pictures of a folder and its folder ``masks`` by photo."""
    files = {
        p.name.lower(): p
        for place in (home, home / FOLDER)
        if place.is_dir()
        for p in sorted(place.iterdir())
    }
    found = {}
    for photo in photos:
        stem = photo.name.rpartition(".")[0]
        names = [f"{name}{mark}.png".lower() for name in (photo.name, stem) for mark in MARKS]
        path = next(
            (files[n] for n in names if n in files and files[n].resolve() != photo.file.resolve()), None
        )
        if path is not None:
            found[photo.name] = path
    return found


def _picture(path: Path, photos: Sequence[Photo]) -> dict[str, Path]:
    own = {name: p for name, p in _pictures(path.parent, photos).items() if p == path}
    return own or {photo.name: path for photo in photos}


def _copied(path: Path, folder: Path, photo: Photo) -> str:
    try:
        content = path.read_bytes()
    except OSError as problem:
        raise UserError(Text("The mask {name} cannot be read.", name=path.name),
                        str(problem.strerror or problem), "Check the path.") from problem  # fmt: skip
    free = picture_mask(content, path.name, photo)
    name = f"{photo.name}.png"
    _, encoded = cv2.imencode(".png", free.astype(np.uint8) * 255)
    write_bytes(folder / FOLDER / name, encoded.tobytes())
    return name
