"""Masks: the parts of photos in which nothing is measured, as polygons and pictures in the project folder.

``masks.toml`` (positions in px of the full upright photo, centre of the top-left pixel (0, 0))::

    schema = 1
    [[photo]]
    name = "IMG_1.jpg"
    picture = "IMG_1.jpg.png"            # optional, in the folder masks: black (0) is excluded
    [[photo.polygon]]
    kind = "excluded"                    # or "kept"
    points = [[10.0, 12.5], [200.0, 14.0], [90.0, 160.0]]

Where there are polygons to keep, only their inside counts; what is excluded by a polygon or the picture never does.
"""

from __future__ import annotations

import hashlib
import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import tomli_w

from graphos_core.data import Array, Photo
from graphos_core.errors import UserError
from graphos_core.photo_decoding import CannotDecode, decode
from graphos_core.project_file import inside
from graphos_core.store import write_text
from graphos_core.text import Text

SCHEMA = 1
FILE = "masks.toml"
FOLDER = "masks"
"""Folder of the project with pictures of masks."""

LEARN = "preprocessing/masks"

PolygonKind = Literal["excluded", "kept"]


@dataclass(frozen=True)
class Polygon:
    """A closed polygon; it may cross itself, then parts that are surrounded twice are outside (even-odd rule).

    Attributes
    ----------
    points : tuple of (x, y)
        px of the full upright photo, three or more; they may lie outside the photo.
    kind : {"excluded", "kept"}
    """

    points: tuple[tuple[float, float], ...]
    kind: PolygonKind = "excluded"


@dataclass(frozen=True)
class PhotoMask:
    """The mask of one photo.

    Attributes
    ----------
    polygons : tuple of Polygon
    picture : str
        File name in the folder ``masks`` of the project, or empty.
    """

    polygons: tuple[Polygon, ...] = ()
    picture: str = ""

    def __bool__(self) -> bool:
        return bool(self.polygons or self.picture)


def read_masks(folder: Path) -> dict[str, PhotoMask]:
    """Read the masks of a project by photo name; none when there is no file.

    Raises
    ------
    UserError
        When the file cannot be read, naming what is wrong.
    """
    path = folder / FILE
    if not path.is_file():
        return {}
    try:
        document = tomllib.loads(path.read_text("utf-8"))
        if document.get("schema") != SCHEMA:
            raise ValueError(f"it has schema {document.get('schema', 'none')}, this version reads {SCHEMA}")
        return {str(entry["name"]): _mask(entry) for entry in document.get("photo", [])}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as problem:
        why = f"“{problem.args[0]}” is missing" if isinstance(problem, KeyError) else str(problem).rstrip(".")
        raise UserError(
            Text("The masks in {name} cannot be read.", name=FILE), Text("{why}.", why=why),
            "Correct the file, or take it away and draw the masks again.", LEARN,
        ) from problem  # fmt: skip


def _mask(entry: Mapping[str, Any]) -> PhotoMask:
    picture = str(entry.get("picture", ""))
    if picture and (Path(picture).name != picture or "\\" in picture):
        raise ValueError(f"“{picture}” is not the name of a file in the folder {FOLDER}")
    return PhotoMask(tuple(_polygon(p) for p in entry.get("polygon", [])), picture)


def _polygon(entry: Mapping[str, Any]) -> Polygon:
    points = tuple((float(x), float(y)) for x, y in entry["points"])
    if len(points) < 3 or not all(math.isfinite(v) and abs(v) < 1e7 for point in points for v in point):
        raise ValueError("a polygon needs three or more points, each of two numbers in px")
    kind = entry.get("kind", "excluded")
    if kind not in ("excluded", "kept"):
        raise ValueError(f"a polygon is “excluded” or “kept”, not “{kind}”")
    return Polygon(points, kind)


def write_masks(folder: Path, masks: Mapping[str, PhotoMask]) -> None:
    """Write the masks of a project atomically; photos without a mask are left out.

    Raises
    ------
    UserError
        When the folder cannot be written.
    """
    entries = []
    for name in sorted(name for name in masks if masks[name]):
        entry: dict[str, Any] = {"name": name}
        if masks[name].picture:
            entry["picture"] = masks[name].picture
        entry["polygon"] = [
            {"kind": p.kind, "points": [[round(float(x), 3), round(float(y), 3)] for x, y in p.points]}
            for p in masks[name].polygons
        ]
        entries.append(entry)
    head = "# Parts of photos in which nothing is measured; px of the full upright photo.\n"
    write_text(folder / FILE, head + tomli_w.dumps({"schema": SCHEMA, "photo": entries}))


def masks_key(folder: Path, names: Iterable[str]) -> Any:
    """Return what identifies the masks of the named photos in keys; None where none of them has one."""
    masks = read_masks(folder)
    return [
        [name, [[p.kind, p.points] for p in masks[name].polygons], _digest(folder, masks[name].picture)]
        for name in names
        if masks.get(name)
    ] or None


def _digest(folder: Path, picture: str) -> str:
    return hashlib.sha256(_content(folder, picture)).hexdigest() if picture else ""


def _content(folder: Path, picture: str) -> bytes:
    try:
        return inside(folder / FOLDER, picture).read_bytes()
    except OSError as problem:
        raise UserError(
            Text("The mask {name} cannot be read.", name=picture), str(problem.strerror or problem),
            Text("Put it back into the folder {folder}, or delete the mask of the photo.", folder=FOLDER), LEARN,
        ) from problem  # fmt: skip


def photo_mask(folder: Path, mask: PhotoMask, photo: Photo) -> Array:
    """Return where a mask lets something be measured.

    Parameters
    ----------
    folder : Path
        Of the project.
    mask : PhotoMask
    photo : Photo

    Returns
    -------
    bool (h, w)
        True where points may be, of the full upright photo.

    Raises
    ------
    UserError
        When the picture of the mask is gone, damaged, or has another size.
    """
    free = rasterised(mask.polygons, photo.width, photo.height)
    if mask.picture:
        free &= picture_mask(_content(folder, mask.picture), mask.picture, photo)
    return free


def rasterised(polygons: Iterable[Polygon], width: int, height: int) -> Array:
    """Return where polygons let something be measured; bool (height, width)."""
    listed = list(polygons)
    keeps = [p for p in listed if p.kind == "kept"]
    free = np.full((height, width), not keeps)
    for polygon in keeps:
        free |= polygon_inside(polygon.points, width, height)
    for polygon in listed:
        if polygon.kind == "excluded":
            free &= ~polygon_inside(polygon.points, width, height)
    return free


def polygon_inside(points: Iterable[tuple[float, float]], width: int, height: int) -> Array:
    """Return which pixel centres lie inside a polygon, by the even-odd rule; bool (height, width).

    Every edge changes inside and outside to the right of where it crosses a row; a row through a corner belongs to the
    edge below it (half-open), so that every crossing counts once.
    """
    corners = np.array(list(points), float)
    changes = np.zeros((height, width + 1), bool)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        first, last = math.ceil(min(y0, y1)), math.ceil(max(y0, y1))
        rows = np.arange(max(first, 0), min(last, height))
        if rows.size:
            columns = np.ceil(x0 + (rows - y0) * ((x1 - x0) / (y1 - y0)))
            changes[rows, np.clip(columns, 0, width).astype(np.intp)] ^= True
    return np.logical_xor.accumulate(changes[:, :width], axis=1)


def picture_mask(content: bytes, name: str, photo: Photo) -> Array:
    """Return where the picture of a mask is not black; bool (h, w) of the upright photo.

    Raises
    ------
    UserError
        When it cannot be decoded or has another size than the photo.
    """
    from graphos_core.photo_decoding import upright

    what = Text("The mask {name} cannot be used for {photo}.", name=name, photo=photo.name)
    try:
        pixels = decode(content).pixels
    except CannotDecode as problem:
        raise UserError(
            what, problem.reason, "Save it as PNG, black where nothing is measured.", LEARN
        ) from problem
    free = pixels > 0 if pixels.ndim == 2 else (pixels > 0).any(axis=2)
    stored = (photo.width, photo.height) if photo.exif.orientation >= 5 else (0, 0)
    if free.shape != (photo.height, photo.width) and free.shape == stored:
        free = upright(free, photo.exif.orientation)
    if free.shape != (photo.height, photo.width):
        why = Text("It has {a} × {b} px, the photo {c} × {d} px.", a=free.shape[1], b=free.shape[0], c=photo.width,
                   d=photo.height)  # fmt: skip
        raise UserError(what, why, "Make the mask in the size of the photo.", LEARN)
    return np.ascontiguousarray(free)
