"""The small pictures that the thumbnails have read, for views that show photos in space."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtGui import QImage

from graphos_core.data import Array

_known: dict[str, Array] = {}


def remember(name: str, image: QImage) -> None:
    """Keep a photo's small picture as uint8 (h, w, 3) RGB."""
    if image.isNull():
        return
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    _known[name] = rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).copy()


def forget() -> None:
    """Forget all, when another project is opened."""
    _known.clear()


def thumbnail_arrays(names: Sequence[str]) -> list[Array] | None:
    """Return the small pictures of photos in order; None while one is missing."""
    return [_known[name] for name in names] if all(name in _known for name in names) else None
