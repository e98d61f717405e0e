"""From the bytes of a photo file to pixels: every kind of picture becomes 1, 3 or n bands of 8 or 16 bit."""

from __future__ import annotations

import io
from dataclasses import dataclass

import cv2
import numpy as np
from PIL import Image, JpegImagePlugin, PngImagePlugin

from graphos_core.data import Array
from graphos_core.errors import GraphosError
from graphos_core.text import Text

FORMATS = tuple(plugin.format for plugin in (JpegImagePlugin.JpegImageFile, PngImagePlugin.PngImageFile))
"""What Pillow opens; naming the plugins also registers them, which must not happen in several threads at once."""

STRETCH = (0.0001, 0.9999)
"""Shares of the known values that become 1 and 65535 where values are no 8- or 16-bit numbers."""

SAMPLED = 1_000_000
"""About so many evenly spaced values decide the range of a stretch."""


class CannotDecode(GraphosError):
    """A picture that cannot be used; its text is the reason in one sentence."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


@dataclass(frozen=True)
class Picture:
    """The decoded pixels of a file.

    Attributes
    ----------
    pixels : uint8 or uint16 (h, w), (h, w, 3) RGB or (h, w, n)
        Bands in the order of the file.
    shown : bool (h, w) or None
        False where the file has no value: fully transparent, NaN, infinite or no-data; None when all have one.
    remarks : tuple of str
        What was done to make it usable, one sentence each.
    """

    pixels: Array
    shown: Array | None = None
    remarks: tuple[str, ...] = ()

    @property
    def channels(self) -> int:
        """Number of bands."""
        return 1 if self.pixels.ndim == 2 else self.pixels.shape[2]

    @property
    def hidden(self) -> int:
        """Number of pixels without a value."""
        return 0 if self.shown is None else int(self.shown.size - np.count_nonzero(self.shown))


def is_tiff(content: bytes) -> bool:
    """Say whether a file is a TIFF or BigTIFF, by its first bytes (TIFF 6.0, section 2)."""
    return content[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")


def decode(content: bytes) -> Picture:
    """Decode a JPEG, PNG or TIFF file.

    Rows as stored in JPEG and PNG; TIFF is turned upright, because its orientation says how its rows are stored.

    Raises
    ------
    CannotDecode
        With the reason.
    """
    if is_tiff(content):
        from graphos_core.photo_tiff import decode_tiff

        return decode_tiff(content)
    try:
        with Image.open(io.BytesIO(content), formats=FORMATS) as image:
            if image.mode == "CMYK":
                return Picture(np.asarray(image.convert("RGB")), remarks=(cmyk_remark(),))
            grey = image.mode in ("LA", "L", "1") or image.mode.startswith("I")
            pages = getattr(image, "n_frames", 1) if image.format == "PNG" else 1
    except (OSError, SyntaxError, ValueError) as problem:
        raise CannotDecode(
            Text("It is damaged or incomplete: {why}.", why=str(problem).rstrip("."))
        ) from problem
    pixels = by_opencv(content)
    remarks = [Text("It is animated; its first picture is used.")] if pages > 1 else []
    shown = None
    if pixels.ndim == 3 and pixels.shape[2] == 4:
        shown = visible_part(pixels[:, :, 3], remarks)
        pixels = pixels[:, :, :3]
    if pixels.ndim == 3:
        pixels = pixels[:, :, 0] if grey else cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB)
    return Picture(np.ascontiguousarray(pixels), shown, tuple(remarks))


def by_opencv(content: bytes) -> Array:
    """Decode by OpenCV: uint8 or uint16, (h, w) or (h, w, 3 or 4) in its order blue, green, red, alpha."""
    flags = cv2.IMREAD_UNCHANGED | cv2.IMREAD_IGNORE_ORIENTATION
    pixels = cv2.imdecode(np.frombuffer(content, dtype=np.uint8), flags)
    if pixels is None or pixels.dtype not in (np.uint8, np.uint16):
        raise CannotDecode(
            Text("It is packed in a way that is not supported; save it again without options.")
        )
    return np.asarray(pixels)


def upright(pixels: Array, orientation: int) -> Array:
    """Undo the EXIF orientation (EXIF 2.32, tag 274): first transpose for 5 to 8, then mirror."""
    if orientation >= 5:
        pixels = pixels.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return pixels


def cmyk_remark() -> Text:
    """Say that the colours of a print picture were converted."""
    return Text("Its colours are CMYK, made for printing; they are converted to RGB.")


def visible_part(alpha: Array, remarks: list[Text]) -> Array | None:
    """Return where alpha is above 0, None where it is everywhere; adds the remark."""
    shown = alpha > 0
    count = int(shown.size - np.count_nonzero(shown))
    if count == 0:
        return None
    remarks.append(Text("{count} of its pixels are fully transparent and are masked.", count=count))
    return shown


def sixteen_bit(values: Array, known: Array) -> tuple[Array, float, float]:
    """Stretch measured values (temperatures, reflectances, counts) linearly to 16 bit.

    ``g = 1 + 65534 (v − low) / (high − low)``, rounded and limited to 1 to 65535; 0 where there is no value. `low`
    and `high` are the 0.01 % and 99.99 % quantiles of all known values of all bands together, so that a few hot
    pixels do not take the contrast away and bands keep their proportions.

    Parameters
    ----------
    values : float or integer (h, w) or (h, w, n)
    known : bool (h, w)

    Returns
    -------
    uint16 of the shape of `values`, low, high
    """
    sample = values[known].ravel()
    sample = sample[:: max(1, sample.size // SAMPLED)].astype(np.float64)
    low, high = (float(q) for q in np.quantile(sample, STRETCH)) if sample.size else (0.0, 0.0)
    if not high > low and sample.size:
        low, high = float(sample.min()), float(sample.max())
    factor = 65534.0 / (high - low) if high > low else 0.0
    mask = known if values.ndim == 2 else known[:, :, None]
    with np.errstate(invalid="ignore", over="ignore"):
        stretched = np.clip(np.rint(1.0 + (np.where(mask, values, low) - low) * factor), 1.0, 65535.0)
    return np.where(mask, stretched, 0.0).astype(np.uint16), low, high
