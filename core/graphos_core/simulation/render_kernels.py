"""Compiled rendering: rays, what they see, and what the sensor makes of it.

Pixels are independent of each other, so results do not depend on the number of threads.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

from graphos_core.data.record import Array

SEVERAL, SURFACE, SKY = 0, 1, 2
"""What a pixel sees: several surfaces, one continuous surface, the sky alone."""


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


@njit(cache=True, nogil=True)
def _surface_light(
    s: float,
    t: float,
    foot: float,
    cosine: float,
    patch: int,
    texels: Array,
    table: Array,
    texel: float,
    out: Array,
) -> None:
    """Add the light at (s, t), in shares of the tile, seen with a footprint of `foot` m at right angles."""
    levels = table.shape[1]
    level = math.log2(foot / math.sqrt(max(cosine, 0.02)) / texel)
    level = min(max(level, 0.0), levels - 1.001)
    low = int(level)
    share = level - low
    _texel_light(texels, table, patch, low, s, t, out, 1.0 - share)
    if share > 0.0:
        _texel_light(texels, table, patch, low + 1, s, t, out, share)


@njit(cache=True, nogil=True)
def _plane_depth(plane: Array, centre: Array, dx: float, dy: float, dz: float) -> float:
    """Where a ray meets the plane (nx, ny, nz, offset) of a triangle, in lengths of its direction."""
    along = plane[0] * dx + plane[1] * dy + plane[2] * dz
    if abs(along) < 1e-12:
        return np.inf
    return (plane[3] - plane[0] * centre[0] - plane[1] * centre[1] - plane[2] * centre[2]) / along


@njit(cache=True, nogil=True, parallel=True)
def classify(
    local: Array,
    rotation: Array,
    centre: Array,
    depth: Array,
    primitive: Array,
    planes: Array,
    patch_of_triangle: Array,
    pixel: float,
    out: Array,
) -> None:
    """Say of each pixel whether it sees `SEVERAL` surfaces, one `SURFACE`, or the `SKY` alone.

    One surface: the pixel and its eight neighbours hit the same patch, and the neighbours' depths (`depth` float32
    (h, w), inf for the sky) lie within one footprint of the plane of the pixel's triangle. `local` float64 (h, w, 3)
    are the rays of the pixel centres, `planes` float64 (f, 4) the planes of the triangles, `pixel` the size of a
    pixel at depth 1, `out` uint8 (h, w).
    """
    h, w = depth.shape
    for i in prange(h):
        for j in range(w):
            sky = not math.isfinite(depth[i, j])
            kind = SKY if sky else SURFACE
            f = primitive[i, j]
            for a in range(max(i - 1, 0), min(i + 2, h)):
                for b in range(max(j - 1, 0), min(j + 2, w)):
                    if math.isfinite(depth[a, b]) == sky:
                        kind = SEVERAL
                        break
                    if sky or primitive[a, b] == f:
                        continue
                    if patch_of_triangle[primitive[a, b]] != patch_of_triangle[f]:
                        kind = SEVERAL
                        break
                    x, y, z = local[a, b, 0], local[a, b, 1], local[a, b, 2]
                    dx = rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0] * z
                    dy = rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1] * z
                    dz = rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2] * z
                    if abs(_plane_depth(planes[f], centre, dx, dy, dz) - depth[a, b]) > pixel * depth[a, b]:
                        kind = SEVERAL
                        break
                if kind == SEVERAL:
                    break
            out[i, j] = kind


@njit(cache=True, nogil=True, parallel=True)
def shade_plain(
    fine: Array,
    rotation: Array,
    centre: Array,
    kind: Array,
    primitive: Array,
    planes: Array,
    gradients: Array,
    patch_of_triangle: Array,
    texels: Array,
    table: Array,
    texel_of_patch: Array,
    pixel: float,
    out: Array,
) -> None:
    """Fill the pixels of one surface or sky: each subpixel ray meets the plane of the pixel's own triangle.

    `fine` float64 (h·side, w·side, 3) are the subpixel rays in the camera frame, `gradients` float64 (f, 2, 4) give
    the shares (s, t) of the tile as affine functions of the point, `out` float32 (h, w, 3) linear light.
    """
    h, w = kind.shape
    side = fine.shape[0] // h
    for i in prange(h):
        light = np.empty(3)
        for j in range(w):
            if kind[i, j] == SEVERAL:
                continue
            light[:] = 0.0
            f = primitive[i, j]
            for k in range(side * side):
                ray = fine[i * side + k // side, j * side + k % side]
                dx = rotation[0, 0] * ray[0] + rotation[1, 0] * ray[1] + rotation[2, 0] * ray[2]
                dy = rotation[0, 1] * ray[0] + rotation[1, 1] * ray[1] + rotation[2, 1] * ray[2]
                dz = rotation[0, 2] * ray[0] + rotation[1, 2] * ray[1] + rotation[2, 2] * ray[2]
                if kind[i, j] == SKY:
                    _sky_light(dx, dy, dz, light)
                    continue
                depth = _plane_depth(planes[f], centre, dx, dy, dz)
                x = centre[0] + depth * dx
                y = centre[1] + depth * dy
                z = centre[2] + depth * dz
                g = gradients[f]
                s = g[0, 0] * x + g[0, 1] * y + g[0, 2] * z + g[0, 3]
                t = g[1, 0] * x + g[1, 1] * y + g[1, 2] * z + g[1, 3]
                dot = planes[f, 0] * dx + planes[f, 1] * dy + planes[f, 2] * dz
                cosine = abs(dot) / math.sqrt(dx * dx + dy * dy + dz * dz)
                patch = patch_of_triangle[f]
                foot = pixel / side * depth
                _surface_light(s, t, foot, cosine, patch, texels, table, texel_of_patch[patch], light)
            for c in range(3):
                out[i, j, c] = light[c] / (side * side)


@njit(cache=True, nogil=True, parallel=True)
def fine_rays(fine: Array, rotation: Array, centre: Array, where: Array, rays: Array) -> None:
    """Fill `rays` float32 (k·side², 6) with the subpixel rays of the pixels `where` int64 (k, 2), row and column."""
    side = int(math.sqrt(rays.shape[0] // max(where.shape[0], 1)) + 0.5)
    for n in prange(where.shape[0]):
        for k in range(side * side):
            ray = fine[where[n, 0] * side + k // side, where[n, 1] * side + k % side]
            for c in range(3):
                rays[n * side * side + k, c] = centre[c]
                rays[n * side * side + k, 3 + c] = (
                    rotation[0, c] * ray[0] + rotation[1, c] * ray[1] + rotation[2, c] * ray[2]
                )


@njit(cache=True, nogil=True, parallel=True)
def shade_rays(
    rays: Array,
    t_hit: Array,
    primitive: Array,
    uv: Array,
    normals: Array,
    where: Array,
    corner_st: Array,
    patch_of_triangle: Array,
    texels: Array,
    table: Array,
    texel_of_patch: Array,
    pixel: float,
    out: Array,
) -> None:
    """Fill the pixels `where` with the mean light of their rays, as `RaycastingScene.cast_rays` reports them."""
    count = rays.shape[0] // max(where.shape[0], 1)
    side = math.sqrt(count)
    for n in prange(where.shape[0]):
        light = np.zeros(3)
        for ray in range(n * count, (n + 1) * count):
            dx, dy, dz = float(rays[ray, 3]), float(rays[ray, 4]), float(rays[ray, 5])
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
            foot = pixel / side * float(t_hit[ray])
            _surface_light(s, t, foot, cosine, patch, texels, table, texel_of_patch[patch], light)
        for c in range(3):
            out[where[n, 0], where[n, 1], c] = light[c] / count


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
