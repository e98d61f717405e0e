"""Coded control targets: a white dot in a black disc with a ring code and its number, painted on a surface."""

from __future__ import annotations

from functools import cache

import numpy as np

from graphos_core.data.record import Array

BITS = 12
DOT, CODE_INNER, CODE_OUTER, MARGIN = 0.34, 0.62, 0.92, 1.25
"""Radii of the parts in units of the disc's radius; the plate is a square of half side `MARGIN`."""
NUMBER_HEIGHT = 0.75
"""Height of the number's strip under the plate, in units of the disc's radius."""


@cache
def ring_codes() -> tuple[int, ...]:
    """Return the ring codes that no rotation turns into another: the smallest of its rotations, aperiodic."""
    codes = []
    for code in range(1, 1 << BITS):
        turned = [((code << k) | (code >> (BITS - k))) & ((1 << BITS) - 1) for k in range(BITS)]
        if code == min(turned) and len(set(turned)) == BITS and 4 <= code.bit_count() <= 7:
            codes.append(code)
    return tuple(codes)


def paint_target(albedo: Array, number: int, s: float, t: float, diameter: float, texel: float) -> None:
    """Paint target `number` with its centre at (s, t) metres over a tile float32 (h, w, 3), antialiased.

    The design follows the circular ring codes of close-range photogrammetry (Schneider and Sinnreich 1992): the
    centre of the white dot is the point.
    """
    radius = diameter / 2
    reach = MARGIN * radius
    h, w = albedo.shape[:2]
    j0, j1 = max(0, int((s - reach) / texel) - 2), min(w, int((s + reach) / texel) + 3)
    low = t - reach - NUMBER_HEIGHT * radius
    i0, i1 = max(0, int(low / texel) - 2), min(h, int((t + reach) / texel) + 3)
    x = ((np.arange(j0, j1) + 0.5) * texel - s)[None, :] / radius
    y = ((np.arange(i0, i1) + 0.5) * texel - t)[:, None] / radius
    soft = texel / radius
    distance = np.hypot(x, y)
    inside = _step(MARGIN - np.abs(x), soft) * _step(MARGIN - y, soft)
    inside = inside * _step(y + MARGIN + NUMBER_HEIGHT, soft)
    white = np.ones_like(distance) * 0.80
    white -= 0.765 * _step(1.0 - distance, soft)
    code = ring_codes()[number % len(ring_codes())]
    sector = np.floor((np.arctan2(x, y) / (2 * np.pi) % 1.0) * BITS).astype(int) % BITS
    lit = ((code >> sector) & 1) * _step(distance - CODE_INNER, soft) * _step(CODE_OUTER - distance, soft)
    white += 0.765 * np.clip(lit + _step(DOT - distance, soft), 0.0, 1.0)
    white -= 0.70 * _number(number, x, y)
    part = albedo[i0:i1, j0:j1]
    part[:] = part * (1.0 - inside[..., None]) + (white * inside)[..., None]


def _step(value: Array, soft: float) -> Array:
    result: Array = np.clip(value / soft + 0.5, 0.0, 1.0)
    return result


def _number(number: int, x: Array, y: Array) -> Array:
    """Share of ink of the printed number at (x, y) in units of the radius."""
    import cv2

    size = 96
    image = np.zeros((size, 3 * size), np.uint8)
    text = f"{number:02d}"
    (width, height), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 2.4, 9)
    cv2.putText(
        image, text, ((3 * size - width) // 2, (size + height) // 2), cv2.FONT_HERSHEY_SIMPLEX, 2.4, 255, 9
    )
    scale = size / NUMBER_HEIGHT
    column = (x * scale + 1.5 * size).astype(np.float32) + np.zeros(y.shape, np.float32)
    row = ((-MARGIN - y) * scale).astype(np.float32) + np.zeros(x.shape, np.float32)
    ink = cv2.remap(image, column, row, cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
    result: Array = np.asarray(ink, dtype=np.float64) / 255.0
    return result
