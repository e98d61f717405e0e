"""Files that may be photos: which ones a folder holds, whether each is usable, and its pixels as stored."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, UnidentifiedImageError

from graphos_core.data import Array, Exif
from graphos_core.errors import ItemFailure, UserError
from graphos_core.exif import read_exif, read_tiff_exif
from graphos_core.photo_decoding import FORMATS, CannotDecode, Picture, cmyk_remark, decode, is_tiff
from graphos_core.text import Text

PHOTO_ENDINGS = (".jpg", ".jpeg", ".png", ".tif", ".tiff")
OTHER_PICTURES = (".bmp", ".gif", ".webp", ".heic", ".heif", ".jp2", ".dng", ".nef", ".cr2", ".cr3", ".arw",
                  ".orf", ".rw2", ".raf", ".avif")  # fmt: skip
MAX_PIXELS = 250_000_000
"""Largest photo that is opened; a small file can claim any size (decompression bomb)."""
MIN_SIDE = 32

_MODES = ("1", "L", "LA", "I;16", "I;16B", "I;16L", "I", "RGB", "RGBA", "P", "CMYK")

FINGERPRINT_SIDE = 16
"""Photos are compared by their mean grey values in so many times so many parts."""

# Pillow refuses twice this number while it opens a file, before memory is taken; the sentence comes from here.
Image.MAX_IMAGE_PIXELS = MAX_PIXELS


@dataclass(frozen=True)
class PhotoFile:
    """A usable photo file, before cameras are known; attributes as in `graphos_core.data.Photo`.

    Attributes
    ----------
    fingerprint : uint8 (s, s)
        Mean grey values of the parts of the stored picture, for finding pictures that are there twice.
    """

    path: Path
    digest: str
    width: int
    height: int
    bits: int
    channels: int
    exif: Exif
    hidden: int
    remarks: tuple[str, ...]
    fingerprint: Array


def list_photo_files(source: str | Path | Sequence[str | Path]) -> list[Path]:
    """Return the files of a folder that are pictures by their names, or the files of a list; sorted by name.

    Pictures of masks beside their photos (``NAME_mask.png``) are passed over.

    Raises
    ------
    UserError
        When there are none, the folder cannot be read, or two files of a list have the same name.
    """
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
    from graphos_core.mask_import import is_mask_picture

    listed = [path.name for path in files]
    files = [path for path in files if not is_mask_picture(path.name, listed)]
    if not files:
        why = (
            Text("It holds {count} other files or folders.", count=len(entries))
            if entries
            else Text("It is empty.")
        )
        raise UserError(Text("There are no photos in the folder {folder}.", folder=folder), why, todo)
    return files


def inspect_photo(path: Path) -> PhotoFile | ItemFailure:
    """Read and decode one file; the reason where it cannot be used."""
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
        if is_tiff(content):
            return _look_at_tiff(path, content)
        with Image.open(io.BytesIO(content), formats=FORMATS) as image:
            return _look(path, content, image)
    except CannotDecode as problem:
        return fail(problem.reason)
    except Image.DecompressionBombError:
        return fail(_too_large())
    except UnidentifiedImageError:
        return fail(Text("It is no JPEG, PNG or TIFF picture, whatever its name says."))
    except Exception as problem:  # decoders answer broken files with many kinds of exception
        return fail(Text("It is damaged or incomplete: {why}.", why=str(problem).rstrip(".")))


def _too_large() -> Text:
    return Text("It claims more than {limit:g} million pixels and is not opened.", limit=MAX_PIXELS / 1e6)


def _check_size(width: int, height: int) -> None:
    if width * height > MAX_PIXELS:
        raise CannotDecode(_too_large())
    if min(width, height) < MIN_SIDE:
        size = f"{width} × {height}"
        raise CannotDecode(
            Text("It is too small: {size} pixels, needs {least} at least.", size=size, least=MIN_SIDE)
        )


def _look_at_tiff(path: Path, content: bytes) -> PhotoFile:
    from graphos_core.photo_tiff import read_tiff_header

    header = read_tiff_header(content)
    _check_size(header.width, header.height)
    picture = decode(content)
    exif = replace(read_tiff_exif(content), orientation=1)  # `decode` gives it upright
    return _photo_file(path, content, picture, exif)


def _look(path: Path, content: bytes, image: Image.Image) -> PhotoFile:
    _check_size(*image.size)
    if image.mode not in _MODES:
        raise CannotDecode(Text("Its pixels are of the kind {mode}; grey or RGB is needed.", mode=image.mode))
    exif = read_exif(image)
    if image.format == "PNG":
        image.load()
        return _photo_file(path, content, decode(content), exif)
    width, height = image.size
    image.draft(image.mode, (max(64, width // 8), max(64, height // 8)))  # reads all data, computes little
    image.load()
    remarks = (cmyk_remark(),) if image.mode == "CMYK" else ()
    small = np.asarray(image if image.mode == "L" else image.convert("RGB"))
    found = _photo_file(path, content, Picture(small, None, remarks), exif)
    if exif.orientation >= 5:
        width, height = height, width
    return replace(found, width=width, height=height)


def _photo_file(path: Path, content: bytes, picture: Picture, exif: Exif) -> PhotoFile:
    height, width = picture.pixels.shape[:2]
    if exif.orientation >= 5:
        width, height = height, width
    return PhotoFile(
        path=path, digest=hashlib.sha256(content).hexdigest(), width=width, height=height,
        bits=8 * picture.pixels.dtype.itemsize, channels=picture.channels, exif=exif, hidden=picture.hidden,
        remarks=picture.remarks, fingerprint=_fingerprint(picture.pixels),
    )  # fmt: skip


def _fingerprint(pixels: Array) -> Array:
    side = (FINGERPRINT_SIDE, FINGERPRINT_SIDE)
    bands = pixels[:, :, None] if pixels.ndim == 2 else pixels
    small = [cv2.resize(np.ascontiguousarray(bands[:, :, i]), side, interpolation=cv2.INTER_AREA)
             for i in range(min(3, bands.shape[2]))]  # fmt: skip
    mean = np.mean(small, axis=0)
    return (mean if pixels.dtype == np.uint8 else mean / 256.0).astype(np.uint8)
