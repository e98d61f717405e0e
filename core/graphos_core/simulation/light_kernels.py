"""Compiled light: where the lattice of a patch lies, how bright each texel is, and what a ray sees."""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

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


@njit(cache=True, nogil=True)
def _texel_light(
    texels: Array, table: Array, patch: int, level: int, s: float, t: float, out: Array, weight: float
) -> None:
    """Add `weight` × the bilinear light of one level at (s, t), in shares of the tile, to `out` (3,)."""
    offset = table[patch, level, 0]
    h = table[patch, level, 1]
    w = table[patch, level, 2]
    y = min(max(t * h - 0.5, 0.0), h - 1.0)
    x = min(max(s * w - 0.5, 0.0), w - 1.0)
    i = int(y)
    j = int(x)
    i1 = min(i + 1, h - 1)
    j1 = min(j + 1, w - 1)
    b = y - i
    a = x - j
    for c in range(3):
        p = float(texels[offset + (i * w + j) * 3 + c])
        q = float(texels[offset + (i * w + j1) * 3 + c])
        r = float(texels[offset + (i1 * w + j) * 3 + c])
        u = float(texels[offset + (i1 * w + j1) * 3 + c])
        out[c] += (
            weight * ((p * p * (1 - a) + q * q * a) * (1 - b) + (r * r * (1 - a) + u * u * a) * b) / 65025.0
        )


@njit(cache=True, nogil=True)
def _sky_light(x: float, y: float, z: float, out: Array) -> None:
    """Blue sky that pales towards the horizon, and haze below it."""
    height = z / math.sqrt(x * x + y * y + z * z)
    pale = math.exp(-5.0 * max(height, 0.0))
    out[0] += 0.20 + 0.48 * pale
    out[1] += 0.38 + 0.36 * pale
    out[2] += 0.72 + 0.14 * pale


@njit(cache=True, nogil=True, parallel=True)
def make_rays(local: Array, rotation: Array, centre: Array, rays: Array) -> None:
    """Fill `rays` float32 (h·w, 6) with origin and direction in the world frame of `local` float64 (h, w, 3)."""
    h, w = local.shape[:2]
    for i in prange(h):
        for j in range(w):
            k = i * w + j
            for c in range(3):
                rays[k, c] = centre[c]
                rays[k, 3 + c] = (
                    rotation[0, c] * local[i, j, 0]
                    + rotation[1, c] * local[i, j, 1]
                    + rotation[2, c] * local[i, j, 2]
                )


@njit(cache=True, nogil=True, parallel=True)
def shade_rays(
    rays: Array,
    spacing: float,
    t_hit: Array,
    primitive: Array,
    uv: Array,
    normals: Array,
    corner_st: Array,
    patch_of_triangle: Array,
    texels: Array,
    table: Array,
    texel_of_patch: Array,
    side: int,
    width: int,
    out: Array,
) -> None:
    """Mean light of the `side` × `side` rays of each pixel.

    Parameters
    ----------
    rays : float32 (r, 6)
        Origin and direction in the world frame; z = 1 in the camera frame; rows of subpixels one after the other.
    spacing : float
        Distance between neighbouring rays at z = 1.
    t_hit, primitive, uv, normals : float32 (r,), uint32 (r,), float32 (r, 2), float32 (r, 3)
        What `RaycastingScene.cast_rays` says of each ray.
    corner_st : float32 (f, 3, 2)
        Shares (0 to 1) of the tile of the corners of each triangle.
    patch_of_triangle : int32 (f,)
    texels, table : uint8 (…), int64 (p, levels, 3)
        Tiles of all patches one after the other, and (offset, height, width) of each level.
    texel_of_patch : float64 (p,)
        Size of a texel, m.
    side, width : int
    out : float32 (rows, width, 3)
        Linear light, mean over the subpixels.
    """
    levels = table.shape[1]
    columns = width * side
    for row in prange(out.shape[0]):
        light = np.empty(3)
        for column in range(width):
            light[:] = 0.0
            for k in range(side * side):
                ray = (row * side + k // side) * columns + column * side + k % side
                dx = float(rays[ray, 3])
                dy = float(rays[ray, 4])
                dz = float(rays[ray, 5])
                if not math.isfinite(t_hit[ray]):
                    _sky_light(dx, dy, dz, light)
                    continue
                f = primitive[ray]
                patch = patch_of_triangle[f]
                u = float(uv[ray, 0])
                v = float(uv[ray, 1])
                w = 1.0 - u - v
                s = w * corner_st[f, 0, 0] + u * corner_st[f, 1, 0] + v * corner_st[f, 2, 0]
                t = w * corner_st[f, 0, 1] + u * corner_st[f, 1, 1] + v * corner_st[f, 2, 1]
                dot = dx * normals[ray, 0] + dy * normals[ray, 1] + dz * normals[ray, 2]
                cosine = abs(dot) / math.sqrt(dx * dx + dy * dy + dz * dz)
                foot = spacing * float(t_hit[ray]) / math.sqrt(max(cosine, 0.02))
                level = min(max(math.log2(foot / texel_of_patch[patch]), 0.0), levels - 1.001)
                low = int(level)
                share = level - low
                _texel_light(texels, table, patch, low, s, t, light, 1.0 - share)
                if share > 0.0:
                    _texel_light(texels, table, patch, low + 1, s, t, light, share)
            for c in range(3):
                out[row, column, c] = light[c] / (side * side)


@njit(cache=True, nogil=True, parallel=True)
def expose_light(
    light: Array, rays: Array, noise: Array, vignetting: float, read: float, shot: float, out: Array
) -> None:
    """Fill `out` uint8 (h, w, 3): vignetting, sRGB curve (IEC 61966-2-1), noise, rounding.

    `light` float32 (h, w, 3) linear, `rays` float64 (h, w, 3) with z = 1, `noise` float32 (h, w, 3) standard normal,
    `read` and `shot` in grey levels.
    """
    h, w = light.shape[:2]
    for i in prange(h):
        for j in range(w):
            square = rays[i, j, 0] ** 2 + rays[i, j, 1] ** 2
            fall_off = 1.0 - vignetting * (1.0 - 1.0 / (1.0 + square) ** 2)
            for c in range(3):
                value = min(1.0, max(0.0, light[i, j, c] * fall_off))
                grey = 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1.0 / 2.4) - 0.055
                grey *= 255.0
                grey += noise[i, j, c] * math.sqrt(read * read + shot * shot * grey / 255.0)
                out[i, j, c] = np.uint8(min(255.0, max(0.0, math.floor(grey + 0.5))))
