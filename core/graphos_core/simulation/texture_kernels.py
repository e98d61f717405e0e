"""Compiled noise and materials: the reflectance and the relief of every texel of a patch.

These kernels run on one thread and release the interpreter lock: patches are baked side by side.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from graphos_core.data.record import Array

BRICK, ASHLAR, STONE, WOOD, GLASS, PAVING, GROUND, PLASTER, STATUE = range(9)
"""Materials, by the number that compiled code knows them by."""

Tone = tuple[float, float, float]


@njit(cache=True, nogil=True)
def hash_unit(i: int, j: int, seed: int) -> float:
    """Return a reproducible number in [0, 1) for the lattice point (i, j)."""
    h = (i * 374761393 + j * 668265263 + seed * 1442695041) & 0xFFFFFFFF
    h = ((h ^ (h >> 15)) * 1274126177) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 1103515245) & 0xFFFFFFFF
    return (h >> 8) / 16777216.0


@njit(cache=True, nogil=True)
def value_noise(x: float, y: float, seed: int) -> float:
    """Smoothly interpolated lattice noise in [−1, 1], one cell per unit."""
    fx = math.floor(x)
    fy = math.floor(y)
    i = int(fx)
    j = int(fy)
    u = x - fx
    v = y - fy
    u = u * u * (3.0 - 2.0 * u)
    v = v * v * (3.0 - 2.0 * v)
    low = hash_unit(i, j, seed) * (1.0 - u) + hash_unit(i + 1, j, seed) * u
    high = hash_unit(i, j + 1, seed) * (1.0 - u) + hash_unit(i + 1, j + 1, seed) * u
    return 2.0 * (low * (1.0 - v) + high * v) - 1.0


@njit(cache=True, nogil=True)
def octaves(x: float, y: float, seed: int, count: int, gain: float) -> float:
    """Sum `count` octaves of noise, each twice as fine, turned, and `gain` times as strong; about [−1, 1]."""
    total = 0.0
    weight = 1.0
    norm = 0.0
    for k in range(count):
        total += weight * value_noise(x, y, seed + 101 * k)
        norm += weight * weight
        weight *= gain
        x, y = 1.6 * x + 1.2 * y + 17.3, -1.2 * x + 1.6 * y + 5.1
    return total / math.sqrt(norm)


@njit(cache=True, nogil=True)
def _smooth(low: float, high: float, x: float) -> float:
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3.0 - 2.0 * t)


@njit(cache=True, nogil=True)
def _blocks(
    s: float, t: float, seed: int, width: float, height: float, joint: float, rough: float
) -> tuple[float, float, float, float]:
    """Masonry: 1 inside a block and 0 in the joint, and three random numbers of the block."""
    wobble_s = rough * octaves(9.0 * s, 9.0 * t, seed + 1, 2, 0.6)
    wobble_t = rough * octaves(9.0 * s, 9.0 * t, seed + 2, 2, 0.6)
    row = math.floor((t + wobble_t) / height)
    shift = 0.5 * (row % 2) + 0.18 * hash_unit(int(row), 3, seed)
    column = math.floor((s + wobble_s) / width + shift)
    a = (s + wobble_s) / width + shift - column
    b = (t + wobble_t) / height - row
    edge = min(min(a, 1.0 - a) * width, min(b, 1.0 - b) * height)
    i = int(column)
    j = int(row)
    inside = _smooth(0.4 * joint, 0.75 * joint, edge)
    return inside, hash_unit(i, j, seed + 5), hash_unit(i, j, seed + 6), hash_unit(i, j, seed + 7)


@njit(cache=True, nogil=True)
def _brick(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    inside, a, b, c = _blocks(s, t, seed, 0.25, 0.083, 0.014, 0.004)
    grain = octaves(14.0 * s, 14.0 * t, seed + 11, 5, 0.75)
    fine = octaves(60.0 * s, 60.0 * t, seed + 12, 3, 0.8)
    tone = 0.55 + 0.75 * a + 0.20 * grain
    if b > 0.86:
        tone *= 0.55  # burnt bricks
    r = (0.250 + 0.09 * c) * tone + 0.025 * fine
    g = (0.112 + 0.045 * b) * tone + 0.020 * fine
    k = (0.068 + 0.025 * a) * tone + 0.015 * fine
    mortar = 0.30 + 0.06 * grain + 0.05 * fine
    r = inside * r + (1.0 - inside) * mortar
    g = inside * g + (1.0 - inside) * mortar * 0.94
    k = inside * k + (1.0 - inside) * mortar * 0.84
    return r, g, k, 0.007 * inside + 0.0016 * grain + 0.0006 * fine


@njit(cache=True, nogil=True)
def _stone(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    broad = octaves(1.7 * s, 1.7 * t, seed + 21, 4, 0.7)
    grain = octaves(13.0 * s, 13.0 * t, seed + 22, 5, 0.8)
    pits = _smooth(0.55, 1.1, octaves(24.0 * s, 33.0 * t, seed + 23, 3, 0.7))
    lichen = _smooth(0.65, 1.1, octaves(4.0 * s, 4.0 * t, seed + 24, 5, 0.7))
    tone = 1.0 + 0.20 * broad + 0.19 * grain - 0.5 * pits
    warm = 0.03 * broad
    r = (0.43 + warm) * tone * (1.0 - 0.42 * lichen)
    g = 0.375 * tone * (1.0 - 0.34 * lichen)
    b = (0.285 - warm) * tone * (1.0 - 0.42 * lichen)
    return r, g, b, 0.0015 * grain - 0.004 * pits


@njit(cache=True, nogil=True)
def _ashlar(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    inside, a, b, c = _blocks(s, t, seed, 0.62, 0.30, 0.016, 0.004)
    r, g, k, height = _stone(s + 3.7 * a, t + 5.9 * b, seed + int(50 * c))
    tone = (0.74 + 0.46 * a) * (0.35 + 0.65 * inside)
    return (
        r * tone * (0.96 + 0.08 * b),
        g * tone,
        k * tone * (0.9 + 0.2 * c),
        height + 0.009 * inside,
    )


@njit(cache=True, nogil=True)
def _wood(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    plank = math.floor(s / 0.16)
    a = hash_unit(int(plank), 1, seed)
    edge = abs(s / 0.16 - plank - 0.5)
    gap = _smooth(0.5, 0.46, edge)
    grain = octaves(55.0 * s, 3.0 * t + 9.0 * a, seed + 31, 5, 0.8)
    knots = octaves(9.0 * s, 5.0 * t, seed + 32, 4, 0.7)
    wear = octaves(26.0 * s, 26.0 * t, seed + 33, 4, 0.85)
    tone = (0.75 + 0.5 * a + 0.30 * grain + 0.18 * knots + 0.16 * wear) * (0.25 + 0.75 * gap)
    return 0.26 * tone, 0.155 * tone, 0.085 * tone, 0.004 * gap + 0.0012 * grain


@njit(cache=True, nogil=True)
def _glass(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    i = math.floor((s + t) / 0.21)
    j = math.floor((s - t) / 0.21)
    a = abs((s + t) / 0.21 - i - 0.5)
    b = abs((s - t) / 0.21 - j - 0.5)
    lead = _smooth(0.40, 0.45, max(a, b))
    tone = 0.05 + 0.09 * hash_unit(int(i), int(j), seed)
    dirt = 0.03 * octaves(18.0 * s, 18.0 * t, seed + 41, 5, 0.8) + 0.02
    grey = 0.16 + 1.5 * dirt
    r = (1.0 - lead) * (0.75 * tone + dirt) + lead * grey
    g = (1.0 - lead) * (0.95 * tone + dirt) + lead * grey
    k = (1.0 - lead) * (1.10 * tone + dirt) + lead * grey * 1.05
    return r, g, k, 0.006 * lead


@njit(cache=True, nogil=True)
def _paving(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    inside, a, b, _ = _blocks(s, t, seed, 0.55, 0.42, 0.02, 0.006)
    grain = octaves(11.0 * s, 11.0 * t, seed + 51, 6, 0.85)
    broad = octaves(0.9 * s, 0.9 * t, seed + 52, 4, 0.7)
    tone = (0.70 + 0.5 * a + 0.20 * grain + 0.14 * broad) * (0.35 + 0.65 * inside)
    return 0.31 * tone, (0.285 + 0.02 * b) * tone, 0.25 * tone, 0.006 * inside + 0.001 * grain


@njit(cache=True, nogil=True)
def _ground(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    broad = octaves(0.5 * s, 0.5 * t, seed + 61, 5, 0.7)
    fine = octaves(9.0 * s, 9.0 * t, seed + 62, 6, 0.9)
    grass = _smooth(-0.25, 0.35, broad)
    tone = 1.0 + 0.33 * fine
    r = (0.30 * (1.0 - grass) + 0.11 * grass) * tone
    g = (0.26 * (1.0 - grass) + 0.16 * grass) * tone
    k = (0.20 * (1.0 - grass) + 0.06 * grass) * tone
    return r, g, k, 0.004 * fine


@njit(cache=True, nogil=True)
def _plaster(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    broad = octaves(1.1 * s, 1.1 * t, seed + 71, 5, 0.75)
    fine = octaves(21.0 * s, 21.0 * t, seed + 72, 5, 0.85)
    crack = abs(octaves(2.3 * s, 2.3 * t, seed + 73, 4, 0.6))
    line = _smooth(0.03, 0.0, crack)
    tone = 1.0 + 0.15 * broad + 0.14 * fine - 0.5 * line
    return 0.47 * tone, 0.37 * tone, 0.235 * tone, 0.0014 * fine - 0.003 * line


@njit(cache=True, nogil=True)
def _statue(s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    broad = octaves(2.1 * s, 2.1 * t, seed + 81, 5, 0.75)
    fine = octaves(27.0 * s, 27.0 * t, seed + 82, 6, 0.9)
    vein = _smooth(0.09, 0.0, abs(octaves(3.0 * s, 3.0 * t, seed + 83, 5, 0.6)))
    spots = _smooth(0.35, 0.75, octaves(16.0 * s, 16.0 * t, seed + 84, 3, 0.7))
    tone = 1.0 + 0.28 * broad + 0.24 * fine - 0.5 * vein - 0.4 * spots
    return (
        (0.34 + 0.04 * broad) * tone,
        0.30 * tone,
        (0.25 - 0.03 * broad) * tone,
        0.0015 * fine - 0.002 * vein,
    )


@njit(cache=True, nogil=True)
def surface(material: int, s: float, t: float, seed: int) -> tuple[float, float, float, float]:
    """Reflectance (r, g, b) and relief in metres of `material` at (s, t) metres."""
    if material == BRICK:
        return _brick(s, t, seed)
    if material == ASHLAR:
        return _ashlar(s, t, seed)
    if material == WOOD:
        return _wood(s, t, seed)
    if material == GLASS:
        return _glass(s, t, seed)
    if material == PAVING:
        return _paving(s, t, seed)
    if material == GROUND:
        return _ground(s, t, seed)
    if material == PLASTER:
        return _plaster(s, t, seed)
    if material == STATUE:
        return _statue(s, t, seed)
    return _stone(s, t, seed)


WEATHER_STEP = 4
"""Texels between the lattice points of the weathering, which has no finer detail."""


@njit(cache=True, nogil=True)
def weathering(seed: int, s0: float, t0: float, step: float, strength: float, out: Array) -> None:
    """Fill `out` float32 (h, w) with the factor of broad stains and rain streaks at every `step` metres."""
    for i in range(out.shape[0]):
        t = t0 + i * step
        for j in range(out.shape[1]):
            s = s0 + j * step
            stain = octaves(0.6 * s, 0.45 * t, seed + 91, 5, 0.7)
            streak = octaves(5.5 * s, 0.35 * t, seed + 92, 3, 0.7)
            out[i, j] = 1.0 + strength * (0.24 * stain - 0.40 * _smooth(0.10, 1.0, streak))


@njit(cache=True, nogil=True)
def paint_material(
    material: int, seed: int, s0: float, t0: float, texel: float, tones: Array, albedo: Array, relief: Array
) -> None:
    """Fill a tile: `albedo` float32 (h, w, 3) in 0 to 1 and `relief` float32 (h, w) in metres.

    Texel (row i, column j) is at ``s = s0 + (j + ½) texel``, ``t = t0 + (i + ½) texel``. `tones` float32 holds the
    factor of `weathering` at every `WEATHER_STEP` texels.
    """
    h, w = relief.shape
    for i in range(h):
        t = t0 + (i + 0.5) * texel
        y = i // WEATHER_STEP
        v = (i % WEATHER_STEP + 0.5) / WEATHER_STEP
        for j in range(w):
            s = s0 + (j + 0.5) * texel
            x = j // WEATHER_STEP
            u = (j % WEATHER_STEP + 0.5) / WEATHER_STEP
            low = tones[y, x] * (1.0 - u) + tones[y, x + 1] * u
            tone = low * (1.0 - v) + (tones[y + 1, x] * (1.0 - u) + tones[y + 1, x + 1] * u) * v
            r, g, b, height = surface(material, s, t, seed)
            albedo[i, j, 0] = min(0.95, max(0.012, r * tone))
            albedo[i, j, 1] = min(0.95, max(0.012, g * tone))
            albedo[i, j, 2] = min(0.95, max(0.012, b * tone))
            relief[i, j] = height


@njit(cache=True, nogil=True)
def lattice_points(
    lattice: Array, cell_s: Array, cell_t: Array, part_s: Array, part_t: Array, out: Array
) -> None:
    """Fill `out` float64 (h, w, 3) with the bilinear values of a lattice float64 (m, n, 3)."""
    for i in range(len(cell_t)):
        y = cell_t[i]
        v = part_t[i]
        for j in range(len(cell_s)):
            x = cell_s[j]
            u = part_s[j]
            for c in range(3):
                low = lattice[y, x, c] * (1.0 - u) + lattice[y, x + 1, c] * u
                high = lattice[y + 1, x, c] * (1.0 - u) + lattice[y + 1, x + 1, c] * u
                out[i, j, c] = low * (1.0 - v) + high * v


@njit(cache=True, nogil=True)
def halve(tile: Array) -> Array:
    """Return the next coarser level of a tile uint8 (h, w, 3) in square-root encoding: the mean of 2 × 2."""
    h, w = tile.shape[:2]
    out = np.empty(((h + 1) // 2, (w + 1) // 2, 3), np.uint8)
    for i in range(out.shape[0]):
        i1 = min(2 * i + 1, h - 1)
        for j in range(out.shape[1]):
            j1 = min(2 * j + 1, w - 1)
            for c in range(3):
                a = float(tile[2 * i, 2 * j, c])
                b = float(tile[i1, 2 * j, c])
                d = float(tile[2 * i, j1, c])
                e = float(tile[i1, j1, c])
                out[i, j, c] = np.uint8(math.sqrt(0.25 * (a * a + b * b + d * d + e * e)) + 0.5)
    return out
