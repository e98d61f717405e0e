"""Formulas as outlines: mathtext to closed curves that any canvas can fill."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from graphos_core.data.record import Array

SIZE = 100.0
"""Font size of the outlines, in their own unit; the canvas scales."""


@dataclass(frozen=True, eq=False)
class Outline:
    """Curves of a typeset formula.

    Attributes
    ----------
    vertices : float64 (n, 2)
        x right, y **up** from the baseline, for a font size of `SIZE`.
    codes : uint8 (n,)
        1 move, 2 line, 3 quadratic curve (two vertices), 4 cubic curve (three vertices), 79 close.
    width, ascent, descent : float
        Extent to the right, above and below the baseline, ≥ 0.
    """

    vertices: Array
    codes: Array
    width: float
    ascent: float
    descent: float


@lru_cache(maxsize=512)
def formula_outline(tex: str) -> Outline:
    """Return the outline of mathtext (without dollar signs); the first call loads the typesetter.

    Raises
    ------
    ValueError
        When `tex` is not mathtext.
    """
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(family="DejaVu Sans", size=SIZE)
    width, _, _ = text_to_path.get_text_width_height_descent(f"${tex}$", font, ismath=True)
    vertices, codes = text_to_path.get_text_path(font, f"${tex}$", ismath=True)
    vertices = np.asarray(vertices, dtype=np.float64).reshape(-1, 2)
    top = float(vertices[:, 1].max(initial=0.0))
    bottom = float(vertices[:, 1].min(initial=0.0))
    return Outline(
        vertices, np.asarray(codes, dtype=np.uint8), float(width), max(top, 0.0), max(-bottom, 0.0)
    )
