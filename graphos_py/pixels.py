"""Pictures between numpy and Qt."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QImage, QImageReader

from graphos_core.data.record import Array


def to_qimage(pixels: Array) -> QImage:
    """Return a Qt image of uint8 (h, w) or (h, w, 3) RGB pixels; owns its memory."""
    pixels = np.ascontiguousarray(pixels)
    height, width = pixels.shape[:2]
    kind = QImage.Format.Format_Grayscale8 if pixels.ndim == 2 else QImage.Format.Format_RGB888
    return QImage(pixels.data, width, height, pixels.strides[0], kind).copy()


def read_upright(path: Path) -> Array | None:
    """Read a photo as uint8 (h, w, 3) RGB, upright; None when it cannot be read."""
    try:
        data = np.fromfile(path, dtype=np.uint8)
    except OSError:
        return None
    if data.size and path.suffix.lower() in (".tif", ".tiff"):
        return _read_tiff(data.tobytes())
    image = cv2.imdecode(data, cv2.IMREAD_COLOR) if data.size else None
    return None if image is None else cv2.cvtColor(image, cv2.COLOR_BGR2RGB)


def _read_tiff(content: bytes) -> Array | None:
    """Read a TIFF of any kind as uint8 (h, w, 3): stretched, in false colours."""
    from graphos_core.bands import visible
    from graphos_core.photo_decoding import CannotDecode, decode
    from graphos_core.preprocessing.grey import eight_bit

    try:
        pixels = eight_bit(visible(decode(content).pixels))
    except CannotDecode:
        return None
    return pixels if pixels.ndim == 3 else np.repeat(pixels[:, :, None], 3, axis=2)


def read_thumbnail(path: Path, size: int) -> QImage:
    """Read a photo upright and small; JPEG is decoded at reduced size. Null when it cannot be read."""
    reader = QImageReader(str(path))
    reader.setAutoTransform(True)
    tiff = path.suffix.lower() in (".tif", ".tiff")
    full = reader.size()
    if full.isValid():
        reader.setScaledSize(full.scaled(QSize(size, size), Qt.AspectRatioMode.KeepAspectRatio))
    image = QImage() if tiff else reader.read()  # Qt shows measured values black or white
    if image.isNull():
        pixels = read_upright(path)
        if pixels is None:
            return QImage()
        scale = size / max(pixels.shape[:2])
        image = to_qimage(cv2.resize(pixels, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA))
    return image
