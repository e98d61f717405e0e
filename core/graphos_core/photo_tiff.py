"""TIFF files: what cameras, scanners and geographic programs put into them, from one bit to many bands of floats.

Ordinary pictures (grey or RGB of 1, 8 or 16 bit, and palettes) are decoded by OpenCV, which knows most ways of packing.
It turns two or four bands, signed numbers and separate planes into something else without a word, so those are read by
tifffile, which knows uncompressed, deflate, LZMA, Zstandard and PackBits files.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import tifffile
from PIL import Image, TiffImagePlugin

from graphos_core.data import Array
from graphos_core.photo_decoding import (
    CannotDecode,
    Picture,
    by_opencv,
    cmyk_remark,
    sixteen_bit,
    upright,
    visible_part,
)
from graphos_core.text import Text

GREY, COLOUR, INKS, LAB = (0, 1), (2, 3, 6), 5, (8, 9, 10)
"""Values of PhotometricInterpretation (TIFF 6.0, section 8): grey; RGB, palette, YCbCr; CMYK; CIELAB and kin."""

UNSIGNED, ALPHAS = 1, (1, 2)
ORIENTATION = 274
PICTURES = (TiffImagePlugin.TiffImageFile.format,)


@dataclass(frozen=True)
class TiffHeader:
    """What the first page of a TIFF says about itself.

    Attributes
    ----------
    width, height : int
        As stored, before it is turned upright.
    samples : int
        Values per pixel, transparency included.
    bits : int
    pages : int
        Pictures in the file, reduced copies left out.
    """

    width: int
    height: int
    samples: int
    bits: int
    pages: int


def read_tiff_header(content: bytes) -> TiffHeader:
    """Read the header of a TIFF file.

    Raises
    ------
    CannotDecode
        When it is no whole TIFF.
    """
    with _opened(content) as file:
        page = _first(file)
        pages = sum(1 for p in file.pages if not p.is_reduced)
        return TiffHeader(page.imagewidth, page.imagelength, page.samplesperpixel, _bits(page), pages)


def decode_tiff(content: bytes) -> Picture:
    """Decode the first page of a TIFF file and turn it upright.

    Raises
    ------
    CannotDecode
        With the reason.
    """
    with _opened(content) as file:
        page = _first(file)
        pages = sum(1 for p in file.pages if not p.is_reduced)
        remarks = [Text("It has {count} pages; the first one is used.", count=pages)] if pages > 1 else []
        _check(page, len(content))
        if _ordinary(page):
            pixels = by_opencv(content)  # upright already
            if pixels.ndim == 3:
                pixels = cv2.cvtColor(pixels[:, :, :3], cv2.COLOR_BGR2RGB)
            return Picture(pixels, _no_data(page, pixels, remarks), tuple(remarks))
        if page.photometric == INKS:
            rgb = _by_pillow(content, page).convert("RGB")
            return Picture(np.asarray(rgb), None, (*remarks, cmyk_remark()))
        return _measured(content, page, remarks)


def _opened(content: bytes) -> tifffile.TiffFile:
    try:
        return tifffile.TiffFile(io.BytesIO(content))
    except Exception as problem:  # a stranger's file is answered with many kinds of exception
        raise _damaged(problem) from problem


def _first(file: tifffile.TiffFile) -> Any:
    try:
        page = file.pages.first
        if page.imagewidth < 1 or page.imagelength < 1 or page.samplesperpixel < 1:
            raise ValueError("it has no pixels")
        return page
    except CannotDecode:
        raise
    except Exception as problem:
        raise _damaged(problem) from problem


def _damaged(problem: BaseException) -> CannotDecode:
    return CannotDecode(
        Text("It is damaged or incomplete: {why}.", why=str(problem).rstrip(".") or "no picture")
    )


def _bits(page: Any) -> int:
    bits = page.bitspersample
    return int(bits[0] if isinstance(bits, tuple) else bits)


def _check(page: Any, size: int) -> None:
    """Refuse what cannot be read, before memory is taken."""
    if page.photometric in LAB:
        raise CannotDecode(Text("Its colours are stored as CIELAB; grey or RGB is needed."))
    if _bits(page) not in (1, 8, 16, 32, 64) or (_bits(page) == 1 and page.samplesperpixel > 1):
        raise CannotDecode(Text("It has {bits} bits per channel; 8, 16 or 32 are needed.", bits=_bits(page)))
    ends = [o + n for o, n in zip(page.dataoffsets, page.databytecounts, strict=False)]
    if not ends or max(ends) > size:
        raise CannotDecode(Text("It is damaged or incomplete: {why}.", why="image file is truncated"))


def _ordinary(page: Any) -> bool:
    grey = page.samplesperpixel == 1 and page.photometric in (*GREY, 3)
    colour = page.samplesperpixel == 3 and page.photometric in COLOUR and page.planarconfig == 1
    unsigned = page.sampleformat == UNSIGNED or _bits(page) == 1
    return (grey or colour) and unsigned and _bits(page) in (1, 8, 16)


def _by_pillow(content: bytes, page: Any) -> Image.Image:
    """Return the picture upright: Pillow turns TIFF while it reads."""
    try:
        with Image.open(io.BytesIO(content), formats=PICTURES) as image:
            image.load()
            return image.copy()
    except Exception as problem:
        raise CannotDecode(_packing(page)) from problem


def _packing(page: Any) -> Text:
    return Text(
        "Its {count} bands are packed by {name}, which is not read; save it uncompressed or with deflate.",
        count=page.samplesperpixel, name=getattr(page.compression, "name", page.compression),
    )  # fmt: skip


def _measured(content: bytes, page: Any, remarks: list[Text]) -> Picture:
    """Decode bands of any number: transparency apart, values without a number masked, others than 8/16 bit stretched."""
    values = _values(content, page)
    shown: Array | None = None
    alpha = [page.samplesperpixel - len(page.extrasamples) + i for i, kind in enumerate(page.extrasamples)
             if kind in ALPHAS]  # fmt: skip
    if alpha and values.ndim == 3:
        shown = visible_part(values[:, :, alpha[0]], remarks)
        values = np.delete(values, alpha, axis=2)
    if values.ndim == 3 and values.shape[2] == 1:
        values = values[:, :, 0]
    known = _no_data(page, values, remarks)
    if known is not None:
        shown = known if shown is None else shown & known
    if values.dtype not in (np.uint8, np.uint16):
        everywhere = np.ones(values.shape[:2], bool) if shown is None else shown
        kind = Text("floating-point") if values.dtype.kind == "f" else f"{_bits(page)}-bit"
        values, low, high = sixteen_bit(values, everywhere)
        remarks.append(Text("Its {kind} values from {low:.6g} to {high:.6g} are stretched to 16 bit.",
                            kind=kind, low=low, high=high))  # fmt: skip
    return Picture(np.ascontiguousarray(values), shown, tuple(remarks))


def _values(content: bytes, page: Any) -> Array:
    """Return the numbers of a page, upright, as (h, w) or (h, w, n)."""
    try:
        values = np.asarray(page.asarray())
    except ValueError:  # a packing that tifffile does not know by itself
        image = _by_pillow(content, page)
        if image.mode not in ("LA", "RGBA"):
            raise CannotDecode(_packing(page)) from None
        return np.asarray(image)
    except Exception as problem:
        raise _damaged(problem) from problem
    if values.ndim == 3 and values.shape[0] == page.samplesperpixel and page.planarconfig == 2:
        values = np.moveaxis(values, 0, 2)
    if values.shape[:2] != (page.imagelength, page.imagewidth) or values.dtype.kind not in "uif":
        raise CannotDecode(Text("It is a volume or has complex numbers; a flat picture is needed."))
    if page.photometric == 0 and values.dtype.kind == "u":
        values = np.iinfo(values.dtype).max - values
    tag = page.tags.get(ORIENTATION)
    return upright(values, int(tag.value) if tag is not None and tag.value in range(1, 9) else 1)


def _no_data(page: Any, values: Array, remarks: list[Text]) -> Array | None:
    """Return where all bands have a number, None if everywhere; NaN, infinity and GDAL's no-data value are none."""
    marked: Array = np.zeros(values.shape[:2], bool)
    if 42113 in page.tags:
        same = np.asarray(values == np.asarray(page.nodata).astype(values.dtype))
        marked |= same if same.ndim == 2 else same.all(axis=2)
    if values.dtype.kind == "f":
        lost = ~np.isfinite(values)
        marked |= lost if lost.ndim == 2 else lost.any(axis=2)
    count = int(np.count_nonzero(marked))
    if count == 0:
        return None
    remarks.append(Text("{count} of its pixels have no value (NaN or no-data) and are masked.", count=count))
    return ~marked
