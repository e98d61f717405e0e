"""Compiled light: how bright each texel of a patch is.

These kernels run on one thread and release the interpreter lock: patches are baked side by side.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from graphos_core.data.record import Array

SUN = (2.05, 1.92, 1.66)
SKY = (0.50, 0.60, 0.74)
BOUNCE = (0.30, 0.26, 0.22)
"""Irradiance by the sun at right angles, by the open sky, and back from what hides the sky; exposure included."""


@njit(cache=True, nogil=True)
def light_tile(
    albedo: Array,
    relief: Array,
    normals: Array,
    tangents_s: Array,
    tangents_t: Array,
    cell_s: Array,
    cell_t: Array,
    part_s: Array,
    part_t: Array,
    sun_lit: Array,
    sky_seen: Array,
    texel: float,
    sun: Array,
    out: Array,
) -> None:
    """Write the light that leaves each texel, ``reflectance · (sun + sky + bounce)``, in square-root encoding.

    Lambert's cosine law with the relief's own slopes; `normals`, `tangents_s`, `tangents_t` float64 (m, n, 3) on
    the lattice; `cell_*` and `part_*` give each texel its lattice cell and the share within; `sun_lit` and
    `sky_seen` float32 are coarser images over the tile; `out` uint8 (h, w, 3) holds ``255 √light``.
    """
    h, w = relief.shape
    normal = np.empty(3)
    for i in range(h):
        b = part_t[i]
        it = cell_t[i]
        i_low = max(i - 1, 0)
        i_high = min(i + 1, h - 1)
        for j in range(w):
            a = part_s[j]
            js = cell_s[j]
            slope_s = (relief[i, min(j + 1, w - 1)] - relief[i, max(j - 1, 0)]) / (2.0 * texel)
            slope_t = (relief[i_high, j] - relief[i_low, j]) / (2.0 * texel)
            smooth_cosine = 0.0
            for c in range(3):
                n = _mix(normals, it, js, a, b, c)
                smooth_cosine += n * sun[c]
                ds = _mix(tangents_s, it, js, a, b, c)
                dt = _mix(tangents_t, it, js, a, b, c)
                normal[c] = n - slope_s * ds - slope_t * dt
            length = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
            cosine = (normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2]) / max(length, 1e-12)
            lit = _picture(sun_lit, (i + 0.5) / h, (j + 0.5) / w) * max(cosine, 0.0)
            if smooth_cosine <= 0.0:
                lit = 0.0
            sky = _picture(sky_seen, (i + 0.5) / h, (j + 0.5) / w)
            for c in range(3):
                light = SUN[c] * lit + SKY[c] * sky + BOUNCE[c] * (1.0 - sky)
                out[i, j, c] = np.uint8(255.0 * math.sqrt(min(1.0, albedo[i, j, c] * light)) + 0.5)


@njit(cache=True, nogil=True)
def _mix(lattice: Array, i: int, j: int, a: float, b: float, c: int) -> float:
    low = lattice[i, j, c] * (1.0 - a) + lattice[i, j + 1, c] * a
    high = lattice[i + 1, j, c] * (1.0 - a) + lattice[i + 1, j + 1, c] * a
    return low * (1.0 - b) + high * b


@njit(cache=True, nogil=True)
def _picture(image: Array, v: float, u: float) -> float:
    """Bilinear value of a small image at the shares (v, u) of its height and width."""
    h, w = image.shape
    y = min(max(v * h - 0.5, 0.0), h - 1.0)
    x = min(max(u * w - 0.5, 0.0), w - 1.0)
    i = min(int(y), max(h - 2, 0))
    j = min(int(x), max(w - 2, 0))
    i1 = min(i + 1, h - 1)
    j1 = min(j + 1, w - 1)
    b = y - i
    a = x - j
    return (image[i, j] * (1.0 - a) + image[i, j1] * a) * (1.0 - b) + (
        image[i1, j] * (1.0 - a) + image[i1, j1] * a
    ) * b


@njit(cache=True, nogil=True)
def sky_rays(origins: Array, normals: Array, count: int, rays: Array) -> None:
    """Fill `rays` float32 (n·count, 6) with rays over the cosine-weighted hemisphere of each point.

    Malley's method on the R2 sequence (Roberts 2018), turned a little at every point.
    """
    for k in range(origins.shape[0]):
        nx, ny, nz = normals[k, 0], normals[k, 1], normals[k, 2]
        # an orthonormal frame without branches but the sign (Duff et al. 2017)
        sign = 1.0 if nz >= 0.0 else -1.0
        a = -1.0 / (sign + nz)
        b = nx * ny * a
        for j in range(count):
            u = (0.5 + j * 0.7548776662466927) % 1.0
            turn = 2.0 * math.pi * ((j * 0.5698402909980532 + 0.618033988749895 * k) % 1.0)
            x = math.sqrt(u) * math.cos(turn)
            y = math.sqrt(u) * math.sin(turn)
            z = math.sqrt(1.0 - u)
            i = k * count + j
            rays[i, 0] = origins[k, 0]
            rays[i, 1] = origins[k, 1]
            rays[i, 2] = origins[k, 2]
            rays[i, 3] = x * (1.0 + sign * nx * nx * a) + y * b + z * nx
            rays[i, 4] = x * sign * b + y * (sign + ny * ny * a) + z * ny
            rays[i, 5] = -x * sign * nx - y * ny + z * nz
