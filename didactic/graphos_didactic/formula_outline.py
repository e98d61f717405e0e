"""Formulas as outlines: mathtext to closed curves that any canvas can fill."""

from __future__ import annotations

import re
import threading
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from graphos_core.data.record import Array

TYPESETTER = threading.Lock()
"""Held by whoever lets matplotlib parse mathtext: its parser is one for the whole process and not made for threads."""
_loaded = threading.Event()
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


def load_typesetter() -> None:
    """Load the typesetter, about a second the first time; may run outside the window's thread."""
    _digits()
    _loaded.set()


def typesetter_loaded() -> bool:
    """Whether `load_typesetter` has finished, so that formulas cost milliseconds."""
    return _loaded.is_set()


Glyph = tuple[str, float, float, float]
"""Name of a shape, where it stands (x, y), and its scale."""
Shape = tuple[Array, Array]
"""Vertices (n, 2) and codes (n,)."""


@lru_cache(maxsize=512)
def formula_outline(tex: str) -> Outline:
    """Return the outline of mathtext (without dollar signs); the first call loads the typesetter.

    All digits are equally wide. So a formula with live numbers is typeset once with zeros in their place, which
    takes milliseconds, and then only the shapes of the digits are exchanged.

    Raises
    ------
    ValueError
        When `tex` is not mathtext.
    """
    glyphs, shapes, rules, width = _typeset(re.sub(r"\d", "0", tex))
    names, digit_shapes = _digits()
    digits = re.findall(r"\d", tex)
    zeros = [i for i, glyph in enumerate(glyphs) if glyph[0] == names["0"]]
    if len(zeros) == len(digits) and not _RAISED_AND_LOWERED.search(tex):
        exchanged = list(glyphs)
        for i, digit in zip(zeros, digits, strict=True):
            exchanged[i] = (names[digit], *glyphs[i][1:])
        glyphs, shapes = exchanged, {**shapes, **digit_shapes}
    else:  # digits that are not drawn, such as the width of a space, or in another order
        glyphs, shapes, rules, width = _typeset(tex)
    parts = [(shapes[name][0] * scale + (x, y), shapes[name][1]) for name, x, y, scale in glyphs] + rules
    vertices = np.concatenate([part[0] for part in parts]) * (SIZE / _FONT) if parts else np.empty((0, 2))
    codes = np.concatenate([part[1] for part in parts]) if parts else np.empty(0)
    top = float(vertices[:, 1].max(initial=0.0))
    bottom = float(vertices[:, 1].min(initial=0.0))
    return Outline(vertices, codes.astype(np.uint8), width * SIZE / _FONT, max(top, 0.0), max(-bottom, 0.0))


_RAISED_AND_LOWERED = re.compile(r"_\{?[^}]*\d\}?\^|\^\{?[^}]*\d\}?_")
"""Indices and exponents of one letter: the typesetter draws them in its own order."""
_FONT = 100.0
"""Font size in which the typesetter works."""


@lru_cache(maxsize=256)
def _typeset(tex: str) -> tuple[list[Glyph], dict[str, Shape], list[Shape], float]:
    """Return glyphs, shapes by name, rules of fractions and roots, and the width, in units of the typesetter."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(family="DejaVu Sans", size=_FONT)
    with TYPESETTER:
        glyphs, shapes, rules = text_to_path.get_glyphs_mathtext(font, f"${tex}$")
        width, _, _ = text_to_path.get_text_width_height_descent(f"${tex}$", font, ismath=True)
    return list(glyphs), {n: _shape(*s) for n, s in shapes.items()}, [_shape(*rule) for rule in rules], width


def _shape(vertices: Any, codes: Any) -> Shape:
    return np.asarray(vertices, dtype=np.float64).reshape(-1, 2), np.asarray(codes, dtype=np.uint8)


@lru_cache(maxsize=1)
def _digits() -> tuple[dict[str, str], dict[str, Shape]]:
    """Return name and shape of each upright digit."""
    found = {digit: _typeset(digit) for digit in "0123456789"}
    names = {digit: glyphs[0][0] for digit, (glyphs, _, _, _) in found.items()}
    return names, {names[digit]: shapes[names[digit]] for digit, (_, shapes, _, _) in found.items()}
