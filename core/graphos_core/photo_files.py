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
from PIL import Image, JpegImagePlugin, PngImagePlugin, TiffImagePlugin, UnidentifiedImageError

from graphos_core.data import Array, Exif
from graphos_core.errors import ItemFailure, UserError
from graphos_core.exif import read_exif
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
class PhotoFile:
    """A usable photo file, before cameras are known; attributes as in `graphos_core.data.Photo`."""

    path: Path
    digest: str
    width: int
    height: int
    bits: int
    channels: int
    exif: Exif


def list_photo_files(source: str | Path | Sequence[str | Path]) -> list[Path]:
    """Return the files of a folder that are pictures by their names, or the files of a list; sorted by name.

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


def _look(path: Path, content: bytes, image: Image.Image) -> PhotoFile | ItemFailure:
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
        pixels = decode(np.frombuffer(content, dtype=np.uint8))
        if pixels is None:
            return fail(Text("It is packed in a way that is not supported; save it again without options."))
        height, width = pixels.shape[:2]
    if image.format == "TIFF":  # `decode` gives it upright: TIFF's orientation says how its rows are stored
        exif = replace(exif, orientation=1)
    if exif.orientation >= 5:
        width, height = height, width
    digest = hashlib.sha256(content).hexdigest()
    return PhotoFile(path, digest, width, height, bits, channels, exif)


def _bits(content: bytes, image: Image.Image) -> int:
    """Bits per channel as stored: Pillow's mode hides 16-bit colour."""
    if image.format == "PNG":
        return 8 if image.mode == "P" or content[24] < 8 else content[24]  # bit depth of the IHDR chunk
    if image.format == "TIFF":
        stored = image.tag_v2.get(258, (8,))  # type: ignore[attr-defined]  # BitsPerSample
        return int(stored[0] if isinstance(stored, tuple) else stored)
    return 8


def decode(content: Array) -> Array | None:
    """Return the pixels of a file's bytes, uint8 or uint16 (h, w) or (h, w, 3) RGB; None if impossible.

    Rows as stored in JPEG and PNG; OpenCV always turns TIFF upright.
    """
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
