"""What a photo says about itself: the EXIF block, read by Pillow."""

from __future__ import annotations

import math
from typing import Any

from PIL import Image

from graphos_core.data import Exif

_EXIF_BLOCK, _GPS_BLOCK = 0x8769, 0x8825
_MAKE, _MODEL, _ORIENTATION, _DATE = 0x010F, 0x0110, 0x0112, 0x0132
_TAKEN, _FOCAL, _FOCAL_35 = 0x9003, 0x920A, 0xA405


def read_tiff_exif(content: bytes) -> Exif:
    """Return the EXIF entries of a TIFF file's bytes, also of one that Pillow cannot open as a picture."""
    root = Image.Exif()
    try:
        root.load(content)
    except Exception:  # a broken header must not cost the photo
        return Exif()
    return _entries(root)


def read_exif(image: Image.Image) -> Exif:
    """Return the EXIF entries the program uses; a missing or unreadable entry is left out.

    Source: JEITA CP-3451 / CIPA DC-008 (EXIF 2.32), sections 4.6.4 to 4.6.6.

    Parameters
    ----------
    image : PIL image
        Opened, not necessarily loaded.
    """
    try:
        return _entries(image.getexif())
    except Exception:  # a broken EXIF block of a stranger's file must not cost the photo
        return Exif()


def _entries(root: Image.Exif) -> Exif:
    try:
        block, gps = root.get_ifd(_EXIF_BLOCK), root.get_ifd(_GPS_BLOCK)
    except Exception:  # see above
        return Exif()
    orientation = root.get(_ORIENTATION, 1)
    return Exif(
        make=_text(root.get(_MAKE)),
        model=_text(root.get(_MODEL)),
        focal_mm=_positive(block.get(_FOCAL)),
        focal_35mm=_positive(block.get(_FOCAL_35)),
        taken=_text(block.get(_TAKEN)) or _text(root.get(_DATE)),
        latitude_deg=_angle(gps.get(2), gps.get(1), "S", 90.0),
        longitude_deg=_angle(gps.get(4), gps.get(3), "W", 180.0),
        altitude_m=_altitude(gps.get(6), gps.get(5)),
        orientation=orientation if orientation in range(1, 9) else 1,
    )


def _text(value: Any) -> str:
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    if not isinstance(value, str):
        return ""
    return "".join(sign for sign in value.partition("\0")[0] if sign.isprintable()).strip()


def _number(value: Any) -> float | None:
    try:
        number = float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return number if math.isfinite(number) else None


def _positive(value: Any) -> float | None:
    number = _number(value)
    return number if number is not None and number > 0.0 else None


def _angle(parts: Any, reference: Any, negative: str, bound: float) -> float | None:
    """Degrees from (degrees, minutes, seconds) and the letter of the hemisphere."""
    if not isinstance(parts, tuple) or len(parts) != 3 or not _text(reference):
        return None
    numbers = [_number(part) for part in parts]
    degrees = 0.0
    for number, unit in zip(numbers, (1.0, 60.0, 3600.0), strict=True):
        if number is None:
            return None
        degrees += number / unit
    if degrees > bound:
        return None
    return -degrees if _text(reference).upper() == negative else degrees


def _altitude(value: Any, reference: Any) -> float | None:
    """Metres above sea level; the reference byte 1 means below."""
    metres = _number(value)
    if metres is None:
        return None
    return -metres if reference in (1, b"\x01") else metres
