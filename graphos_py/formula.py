"""Formulas in mathtext, drawn once per text, colour and size."""

from __future__ import annotations

from functools import lru_cache
from io import BytesIO

import numpy as np
from PySide6.QtGui import QImage

from graphos_didactic.formula_outline import TYPESETTER

WIDE, NARROW = 0.35, 0.04
"""Margin with which a formula is drawn and that it keeps, inches."""


@lru_cache(maxsize=128)
def formula_image(mathtext: str, colour: str, points: float, ratio: float = 1.0) -> QImage:
    """Return a transparent picture of a formula; an empty one when the text cannot be set.

    Parameters
    ----------
    mathtext : str
        Without dollar signs; lines separated by a newline.
    colour : str
        ``#rrggbb``.
    points : float
        Size of the text.
    ratio : float
        Device pixels per pixel of the screen.

    Notes
    -----
    Imports matplotlib, slow the first time; may be called outside the window's thread.
    """
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    buffer = BytesIO()
    with TYPESETTER, rc_context({"mathtext.fontset": "stix", "savefig.transparent": True}):
        figure = Figure(figsize=(0.01, 0.01), dpi=96 * ratio)
        FigureCanvasAgg(figure)
        lines = [f"${line}$" for line in mathtext.strip().splitlines() if line.strip()]
        figure.text(0, 0, "\n".join(lines), fontsize=points, color=colour, linespacing=1.7)
        try:
            figure.savefig(buffer, format="png", bbox_inches="tight", pad_inches=WIDE)
        except ValueError:
            return QImage()
    image = _trimmed(QImage.fromData(buffer.getvalue()), round((WIDE - NARROW) * 96 * ratio))
    image.setDevicePixelRatio(ratio)
    return image


def _trimmed(image: QImage, edge: int) -> QImage:
    """Return an image without its outer `edge` px, but with all that is drawn: tall fractions leave the text's box."""
    drawn = image.convertToFormat(QImage.Format.Format_Alpha8)
    flat = np.frombuffer(drawn.constBits(), dtype=np.uint8).reshape(image.height(), drawn.bytesPerLine())
    rows = np.flatnonzero(flat[:, : image.width()].any(axis=1))
    top, bottom = edge, image.height() - edge
    if len(rows):
        top, bottom = min(top, max(int(rows[0]) - 1, 0)), max(bottom, min(int(rows[-1]) + 2, image.height()))
    return image.copy(edge, top, image.width() - 2 * edge, bottom - top)
