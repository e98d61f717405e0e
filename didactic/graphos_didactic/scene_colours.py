"""Colours by meaning, for light and dark; distinguishable with every common colour vision (Okabe and Ito 2008)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

Theme = Literal["light", "dark"]

PALETTES: Mapping[Theme, Mapping[str, str]] = {
    "light": {
        "background": "#f3f4f6", "surface": "#ffffff", "border": "#c8cdd5", "grid": "#e4e7ec",
        "text": "#1a1e24", "muted": "#525a66", "accent": "#1a5fb4", "truth": "#00694f",
        "estimate": "#0b5cad", "error": "#b3400a", "first": "#0b5cad", "second": "#b3400a",
        "third": "#8a3f7c", "neutral": "#4a525d", "selected": "#f0b400",
    },
    "dark": {
        "background": "#1d2025", "surface": "#15171b", "border": "#434a55", "grid": "#2b3038",
        "text": "#e7e9ec", "muted": "#aab1bc", "accent": "#7fb2ff", "truth": "#3fcfa5",
        "estimate": "#5db2f5", "error": "#ff9a5c", "first": "#5db2f5", "second": "#ff9a5c",
        "third": "#e09ad0", "neutral": "#c2c9d2", "selected": "#ffd24a",
    },
}  # fmt: skip
"""Hexadecimal colour of every role, and of background, surface, border and selection."""


def contrast(a: str, b: str) -> float:
    """Return the contrast ratio of two colours ``#rrggbb``, 1 to 21 (WCAG 2.1, relative luminance)."""
    low, high = sorted((_luminance(a), _luminance(b)))
    return (high + 0.05) / (low + 0.05)


def _luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
