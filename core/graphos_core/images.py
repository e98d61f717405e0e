"""Reading photos: which files of a folder are usable, their cameras, and their pixels. Photos are never changed."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, JpegImagePlugin, PngImagePlugin, TiffImagePlugin, UnidentifiedImageError

from graphos_core.data import Array, Camera, Exif, Photo, PhotoSet
from graphos_core.errors import ItemFailure, UserError
from graphos_core.exif import read_exif
from graphos_core.principal_distance import principal_distance
from graphos_core.run import Run, map_items
from graphos_core.text import Text

PHOTO_ENDINGS = (".jpg", ".jpeg", ".png", ".tif", ".tiff")
OTHER_PICTURES = (".bmp", ".gif", ".webp", ".heic", ".heif", ".jp2", ".dng", ".nef", ".cr2", ".cr3", ".arw",
                  ".orf", ".rw2", ".raf", ".avif")  # fmt: skip
MAX_PIXELS = 250_000_000
"""Largest photo that is opened; a small file can claim any size (decompression bomb)."""
MIN_SIDE = 32

_FORMATS = tuple(
    plugin.format
    for plugin in (
        JpegImagePlugin.JpegImageFile,
        PngImagePlugin.PngImageFile,
        TiffImagePlugin.TiffImageFile,
    )
)
"""What is opened; naming the plugins also registers them, which must not happen in several threads at once."""

_GREY_MODES = ("L", "LA", "I;16", "I;16B", "I;16L", "I")
_COLOUR_MODES = ("RGB", "RGBA", "P")

# Pillow refuses twice this number while it opens a file, before memory is taken; the sentence comes from here.
Image.MAX_IMAGE_PIXELS = MAX_PIXELS


@dataclass(frozen=True)
class _Found:
    """A usable file before cameras are known."""

    path: Path
    digest: str
    width: int
    height: int
    bits: int
    channels: int
    exif: Exif


def read_photo_set(
    source: str | Path | Sequence[str | Path],
    *,
    run: Run,
    focal_px: float | None = None,
    principal_point: tuple[float, float] | None = None,
) -> PhotoSet:
    """Read the headers of all photos and group them into cameras.

    Every file is decoded once, so that a truncated photo is found now and not in the middle of the work.

    Parameters
    ----------
    source : folder, or list of files
        Of a folder the photos directly in it, sorted by name; hidden files and files that are no pictures are
        passed over. Of a list every file counts.
    run : Run
    focal_px : float, optional
        Principal distance for all cameras, px; otherwise see `graphos_core.principal_distance`.
    principal_point : (float, float), optional
        For all cameras, px; otherwise the middle ((w − 1)/2, (h − 1)/2).

    Returns
    -------
    PhotoSet
        Photos of one maker, model, focal length and upright size share a camera of model ``"basic"`` without
        distortion. Unusable files and repeated ones are listed in ``failures``.

    Raises
    ------
    UserError
        When the folder does not exist, has no photos, or none of them is usable.
    """
    paths = _list_files(source)
    inspected = map_items(run, _inspect, paths, "photos")
    failures: list[ItemFailure] = []
    found: list[_Found] = []
    twins: dict[str, str] = {}
    for item in inspected:
        if isinstance(item, ItemFailure):
            failures.append(item)
        elif item.digest in twins:
            reason = Text("It is the same file as {twin}; the second is left out.", twin=twins[item.digest])
            failures.append(ItemFailure(item.path.name, reason))
        else:
            twins[item.digest] = item.path.name
            found.append(item)
    if not found:
        raise UserError(
            Text("None of the {count} files can be used as a photo.", count=len(paths)),
            f"{failures[0].item}: {failures[0].reason}",
            Text("Give photos as JPEG, PNG or TIFF."),
        )
    return _group(found, tuple(failures), focal_px, principal_point)


def read_pixels(photo: Photo, *, grey: bool = False) -> Array:
    """Read the pixels of a photo, upright.

    Parameters
    ----------
    photo : Photo
    grey : bool
        Return luma ``0.299 R + 0.587 G + 0.114 B`` (ITU-R BT.601) instead of colour.

    Returns
    -------
    uint8 or uint16 (h, w) or (h, w, 3)
        As stored: grey photos stay grey, 16 bit stays 16 bit; colour is RGB; transparency is dropped.

    Raises
    ------
    UserError
        When the file is gone, cannot be decoded, or is another than when the photo was added.
    """
    try:
        pixels = _decode(np.fromfile(photo.path, dtype=np.uint8))
    except OSError as problem:
        raise _changed(photo, str(problem.strerror or problem)) from problem
    if pixels is None:
        raise _changed(photo, Text("The file cannot be decoded."))
    pixels = _upright(pixels, photo.exif.orientation)
    if pixels.shape[:2] != (photo.height, photo.width):
        raise _changed(photo, Text("It has another size than when it was added."))
    if grey and pixels.ndim == 3:
        pixels = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY)
    return np.ascontiguousarray(pixels)


def _changed(photo: Photo, why: str) -> UserError:
    return UserError(
        Text("The photo {name} cannot be read.", name=photo.name),
        why,
        Text("Put the photo back in its place, or add the photos again."),
    )


def _decode(content: Array) -> Array | None:
    if content.size == 0:
        return None
    pixels = cv2.imdecode(content, cv2.IMREAD_UNCHANGED | cv2.IMREAD_IGNORE_ORIENTATION)
    if pixels is None or pixels.dtype not in (np.uint8, np.uint16):
        return None
    if pixels.ndim == 2:
        return pixels
    if pixels.shape[2] == 2:
        return pixels[:, :, 0]
    if pixels.shape[2] == 4:
        return cv2.cvtColor(pixels, cv2.COLOR_BGRA2RGB)
    return cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB)


def _upright(pixels: Array, orientation: int) -> Array:
    """Undo the EXIF orientation (EXIF 2.32, tag 274): first transpose for 5 to 8, then mirror."""
    if orientation >= 5:
        pixels = pixels.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return pixels


def _list_files(source: str | Path | Sequence[str | Path]) -> list[Path]:
    todo = Text("Choose a folder with photos as JPEG, PNG or TIFF.")
    if not isinstance(source, (str, Path)):
        paths = [Path(item) for item in source]
        if not paths:
            raise UserError(Text("There are no photos."), Text("The list of files is empty."), todo)
        repeated = {path.name for path in paths if sum(path.name == other.name for other in paths) > 1}
        if repeated:
            names = ", ".join(sorted(repeated))
            why = Text("A photo is known by its name, and these names occur twice: {names}.", names=names)
            raise UserError(Text("Two photos have the same name."), why, Text("Rename one of them."))
        return sorted(paths, key=lambda path: path.name)
    folder = Path(source)
    if not folder.exists():
        raise UserError(Text("The folder {folder} does not exist.", folder=folder), todo=todo)
    if not folder.is_dir():
        return [folder]
    try:
        entries = sorted(folder.iterdir(), key=lambda path: path.name)
    except OSError as problem:
        what = Text("The folder {folder} cannot be read.", folder=folder)
        raise UserError(what, str(problem.strerror or problem), todo) from problem
    endings = PHOTO_ENDINGS + OTHER_PICTURES
    files = [p for p in entries if p.suffix.lower() in endings and not p.name.startswith(".") and p.is_file()]
    if not files:
        why = (
            Text("It holds {count} other files or folders.", count=len(entries))
            if entries
            else Text("It is empty.")
        )
        raise UserError(Text("There are no photos in the folder {folder}.", folder=folder), why, todo)
    return files


def _inspect(path: Path) -> _Found | ItemFailure:
    fail = partial(ItemFailure, path.name)
    if path.suffix.lower() in OTHER_PICTURES:
        ending = path.suffix.lower()
        return fail(Text("{ending} files are not read; export it as JPEG, PNG or TIFF.", ending=ending))
    try:
        content = path.read_bytes()
    except OSError as problem:
        return fail(Text("It cannot be read: {why}.", why=problem.strerror or problem))
    if not content:
        return fail(Text("The file is empty (zero bytes)."))
    try:
        with Image.open(io.BytesIO(content), formats=_FORMATS) as image:
            return _look(path, content, image)
    except Image.DecompressionBombError:
        return fail(_too_large())
    except UnidentifiedImageError:
        return fail(Text("It is no JPEG, PNG or TIFF picture, whatever its name says."))
    except Exception as problem:  # decoders answer broken files with many kinds of exception
        return fail(Text("It is damaged or incomplete: {why}.", why=str(problem).rstrip(".")))


def _too_large() -> Text:
    return Text("It claims more than {limit:g} million pixels and is not opened.", limit=MAX_PIXELS / 1e6)


def _look(path: Path, content: bytes, image: Image.Image) -> _Found | ItemFailure:
    fail = partial(ItemFailure, path.name)
    width, height = image.size
    if width * height > MAX_PIXELS:
        return fail(_too_large())
    if min(width, height) < MIN_SIDE:
        size = f"{width} × {height}"
        return fail(
            Text("It is too small: {size} pixels, needs {least} at least.", size=size, least=MIN_SIDE)
        )
    if image.mode not in _GREY_MODES + _COLOUR_MODES:
        return fail(Text("Its pixels are of the kind {mode}; grey or RGB is needed.", mode=image.mode))
    exif = read_exif(image)
    bits = _bits(content, image)
    if bits not in (8, 16):
        return fail(Text("It has {bits} bits per channel; 8 or 16 are needed.", bits=bits))
    channels = 1 if image.mode in _GREY_MODES else 3
    if image.format in ("JPEG", "MPO"):
        image.draft(image.mode, (max(1, width // 8), max(1, height // 8)))  # reads all data, computes little
        image.load()
    else:
        image.load()
        if _decode(np.frombuffer(content, dtype=np.uint8)) is None:
            return fail(Text("It is packed in a way that is not supported; save it again without options."))
    if exif.orientation >= 5:
        width, height = height, width
    digest = hashlib.sha256(content).hexdigest()
    return _Found(path, digest, width, height, bits, channels, exif)


def _bits(content: bytes, image: Image.Image) -> int:
    """Bits per channel as stored: Pillow's mode hides 16-bit colour."""
    if image.format == "PNG":
        return 8 if image.mode == "P" or content[24] < 8 else content[24]  # bit depth of the IHDR chunk
    if image.format == "TIFF":
        stored = image.tag_v2.get(258, (8,))  # type: ignore[attr-defined]  # BitsPerSample
        return int(stored[0] if isinstance(stored, tuple) else stored)
    return 8


def _group(
    found: list[_Found],
    failures: tuple[ItemFailure, ...],
    focal_px: float | None,
    principal_point: tuple[float, float] | None,
) -> PhotoSet:
    cameras: dict[tuple[str, str, float | None, float | None, int, int], Camera] = {}
    photos = []
    for item in found:
        exif = item.exif
        key = (exif.make, exif.model, exif.focal_mm, exif.focal_35mm, item.width, item.height)
        if key not in cameras:
            cameras[key] = _first_camera(item, focal_px, principal_point)
        photos.append(
            Photo(
                name=item.path.name,
                path=str(item.path.resolve()),
                width=item.width,
                height=item.height,
                bits=item.bits,
                channels=item.channels,
                camera=list(cameras).index(key),
                digest=item.digest,
                exif=exif,
            )
        )
    return PhotoSet(photos=tuple(photos), cameras=_distinct_labels(list(cameras.values())), failures=failures)


def _first_camera(
    item: _Found, focal_px: float | None, principal_point: tuple[float, float] | None
) -> Camera:
    distance = principal_distance(item.exif, item.width, item.height, focal_px)
    x0, y0 = principal_point or ((item.width - 1) / 2, (item.height - 1) / 2)
    return Camera(
        model="basic",
        width=item.width,
        height=item.height,
        values=np.array([distance.focal_px, x0, y0, 0.0, 0.0]),
        label=_label(item.exif),
        pixel_pitch_mm=distance.pixel_pitch_mm,
        focal_estimated=distance.estimated,
        focal_source=distance.source,
    )


def _label(exif: Exif) -> str:
    maker = exif.make.partition(" ")[0]
    name = exif.model if exif.model.lower().startswith(maker.lower()) else f"{maker} {exif.model}".strip()
    if not name:
        name = Text("Unknown camera")
    return f"{name}, {exif.focal_mm:g} mm" if exif.focal_mm else name


def _distinct_labels(cameras: list[Camera]) -> tuple[Camera, ...]:
    labels = [camera.label for camera in cameras]
    return tuple(
        replace(camera, label=f"{camera.label}, {camera.width} × {camera.height}")
        if labels.count(camera.label) > 1
        else camera
        for camera in cameras
    )
