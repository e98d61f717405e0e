"""Compiled drawing: splats into a depth-and-index buffer, shading, photo quads and smooth lines.

Every pixel has one 64-bit key, ``depth bits << 32 | index``: positive float32 bits sort like the floats, so the
smaller key is the nearer point and, at equal depth, the lower index. The minimum does not depend on the order in
which points are drawn, so any number of threads gives the same picture. The kernels are serial and release the GIL;
`graphos_core.rendering.render` spreads them over threads.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from graphos_core.data.record import Array

EMPTY = np.uint64(0xFFFFFFFFFFFFFFFF)
LOW = np.uint64(0xFFFFFFFF)
SHIFT = np.uint64(32)
MAX_SPLAT = 24
EDGE_GAIN = np.float32(22.0)
DARKEST = np.float32(0.3)


@njit(cache=True, nogil=True)
def clear(keys: Array) -> None:
    """Empty a buffer of keys uint64 (h, w)."""
    for y in range(keys.shape[0]):
        for x in range(keys.shape[1]):
            keys[y, x] = EMPTY


@njit(cache=True, nogil=True, fastmath={"contract"})
def splat(
    points: Array,
    start: int,
    stop: int,
    step: int,
    pose: Array,
    optics: Array,
    sizes: Array,
    keys: Array,
) -> None:
    """Draw points[start:stop:step] into `keys`.

    Parameters
    ----------
    points : float32 (n, 3)
    pose : float32 (3, 4)
        Camera frame from the points' frame, ``[R | t]``.
    optics : float32 (4,)
        Principal distance in px, principal point x and y in px, nearest depth.
    sizes : float32 (2,)
        Smallest side of a splat in px, and side in the unit of the points (0: all splats have the smallest).
    keys : uint64 (h, w)
    """
    height, width = keys.shape
    f, cx, cy, near = optics[0], optics[1], optics[2], optics[3]
    half = np.float32(0.5)
    for i in range(start, stop, step):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        depth = pose[2, 0] * x + pose[2, 1] * y + pose[2, 2] * z + pose[2, 3]
        if not depth > near:
            continue
        g = f / depth
        u = g * (pose[0, 0] * x + pose[0, 1] * y + pose[0, 2] * z + pose[0, 3]) + cx
        v = g * (pose[1, 0] * x + pose[1, 1] * y + pose[1, 2] * z + pose[1, 3]) + cy
        if not (u > -MAX_SPLAT and v > -MAX_SPLAT and u < width + MAX_SPLAT and v < height + MAX_SPLAT):
            continue
        side = sizes[0]
        wide = sizes[1] * g
        if wide > side:
            side = min(wide, np.float32(MAX_SPLAT))
        s = int(side + half)
        offset = half - half * np.float32(s - 1)
        left = int(np.floor(u + offset))
        top = int(np.floor(v + offset))
        key = (np.uint64(np.float32(depth).view(np.uint32)) << SHIFT) | np.uint64(i)
        if s <= 3:
            for yy in range(max(top, 0), min(top + s, height)):
                for xx in range(max(left, 0), min(left + s, width)):
                    if key < keys[yy, xx]:
                        keys[yy, xx] = key
        else:
            middle = half * np.float32(s - 1)
            reach = half * half * np.float32(s * s)
            for yy in range(max(top, 0), min(top + s, height)):
                dy = np.float32(yy - top) - middle
                for xx in range(max(left, 0), min(left + s, width)):
                    dx = np.float32(xx - left) - middle
                    if dx * dx + dy * dy <= reach and key < keys[yy, xx]:
                        keys[yy, xx] = key


@njit(cache=True, nogil=True)
def merge(buffers: Array, out: Array, first: int, last: int) -> None:
    """Write the smallest key of buffers uint64 (c, h, w) to out (h, w), rows first to last."""
    for y in range(first, last):
        for x in range(out.shape[1]):
            key = buffers[0, y, x]
            for c in range(1, buffers.shape[0]):
                key = min(key, buffers[c, y, x])
            out[y, x] = key


@njit(cache=True, nogil=True)
def _depth(key: Any) -> Any:
    return np.uint32(np.uint64(key) >> SHIFT).view(np.float32)


@njit(cache=True, nogil=True)
def shade(
    keys: Array, colours: Array, background: int, strength: float, out: Array, first: int, last: int
) -> None:
    """Colour the pixels of rows first to last, darker where a neighbour is nearer.

    Eye-dome lighting (Boucheny 2009), with relative depth differences in place of their logarithm;
    with d = gain · strength · Σ max(0, z − zₙ)/z over four neighbours at one and four at two px, the light is
    ``exp(−d)``, to second order ``1/(1 + d + d²/2)``, and not below `DARKEST`.

    Parameters
    ----------
    keys : uint64 (h, w)
    colours : uint32 (n,)
        ``0xFFRRGGBB`` of every index.
    background : uint32
    strength : float
        0 for plain colours.
    out : uint32 (h, w)
    """
    height, width = keys.shape
    for y in range(first, last):
        for x in range(width):
            key = keys[y, x]
            if key == EMPTY:
                out[y, x] = background
                continue
            colour = colours[key & LOW]
            if strength > 0.0:
                z = _depth(key)
                fall = np.float32(0.0)
                for r in range(1, 3):
                    if y >= r:
                        fall += max(np.float32(0.0), z - _depth(keys[y - r, x]))
                    if y + r < height:
                        fall += max(np.float32(0.0), z - _depth(keys[y + r, x]))
                    if x >= r:
                        fall += max(np.float32(0.0), z - _depth(keys[y, x - r]))
                    if x + r < width:
                        fall += max(np.float32(0.0), z - _depth(keys[y, x + r]))
                drop = fall / z * np.float32(strength) * EDGE_GAIN
                light = np.float32(1.0) / (np.float32(1.0) + drop + np.float32(0.5) * drop * drop)
                k = np.uint32(max(light, DARKEST) * np.float32(256.0))
                red = ((colour >> np.uint32(16)) & np.uint32(255)) * k >> np.uint32(8)
                green = ((colour >> np.uint32(8)) & np.uint32(255)) * k >> np.uint32(8)
                blue = (colour & np.uint32(255)) * k >> np.uint32(8)
                colour = np.uint32(0xFF000000) | (red << np.uint32(16)) | (green << np.uint32(8)) | blue
            out[y, x] = colour


@njit(cache=True, nogil=True)
def _mix(old: Any, red: float, green: float, blue: float, share: float) -> Any:
    r = (old >> np.uint32(16)) & np.uint32(255)
    g = (old >> np.uint32(8)) & np.uint32(255)
    b = old & np.uint32(255)
    nr = np.uint32(r + (red - r) * share + 0.5)
    ng = np.uint32(g + (green - g) * share + 0.5)
    nb = np.uint32(b + (blue - b) * share + 0.5)
    return np.uint32(0xFF000000) | (nr << np.uint32(16)) | (ng << np.uint32(8)) | nb


@njit(cache=True, nogil=True)
def quad(
    corners: Array, texture: Array, opacity: float, index: int, optics: Array, keys: Array, out: Array
) -> None:
    """Draw a photo on a parallelogram, right in perspective, and enter it in `keys`.

    Parameters
    ----------
    corners : float64 (3, 3)
        Top-left corner, edge to the right, edge down, in the camera frame.
    texture : uint8 (th, tw, 3)
        RGB.
    opacity : float
        0 to 1.
    index : int
        Written to `keys`.
    optics : float64 (4,)
        As in `splat`.
    """
    height, width = keys.shape
    f, cx, cy, near = optics[0], optics[1], optics[2], optics[3]
    o, a, b = corners[0], corners[1], corners[2]
    n = np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
    distance = n[0] * o[0] + n[1] * o[1] + n[2] * o[2]
    aa = a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
    bb = b[0] * b[0] + b[1] * b[1] + b[2] * b[2]
    x0, x1, y0, y1 = 1e9, -1e9, 1e9, -1e9
    for k in range(4):
        s = 1.0 if k in (1, 2) else 0.0
        t = 1.0 if k >= 2 else 0.0
        z = o[2] + s * a[2] + t * b[2]
        if z <= near:
            return
        u = f * (o[0] + s * a[0] + t * b[0]) / z + cx
        v = f * (o[1] + s * a[1] + t * b[1]) / z + cy
        x0, x1, y0, y1 = min(x0, u), max(x1, u), min(y0, v), max(y1, v)
    th, tw = texture.shape[0], texture.shape[1]
    for y in range(max(0, int(np.ceil(y0))), min(height - 1, int(np.floor(y1))) + 1):
        dy = (y - cy) / f
        for x in range(max(0, int(np.ceil(x0))), min(width - 1, int(np.floor(x1))) + 1):
            dx = (x - cx) / f
            slope = n[0] * dx + n[1] * dy + n[2]
            if abs(slope) < 1e-15:
                continue
            z = distance / slope
            px, py, pz = dx * z - o[0], dy * z - o[1], z - o[2]
            s = (px * a[0] + py * a[1] + pz * a[2]) / aa
            t = (px * b[0] + py * b[1] + pz * b[2]) / bb
            if s < 0.0 or t < 0.0 or s >= 1.0 or t >= 1.0:
                continue
            key = (np.uint64(np.float32(z).view(np.uint32)) << SHIFT) | np.uint64(index)
            if key < keys[y, x]:
                keys[y, x] = key
                row, column = int(t * th), int(s * tw)
                red, green, blue = texture[row, column, 0], texture[row, column, 1], texture[row, column, 2]
                out[y, x] = _mix(out[y, x], float(red), float(green), float(blue), opacity)


@njit(cache=True, nogil=True)
def lines(
    starts: Array,
    ends: Array,
    colours: Array,
    line_width: float,
    on_top: bool,
    optics: Array,
    keys: Array,
    out: Array,
) -> None:
    """Draw smooth lines from starts to ends float64 (k, 3), camera frame, hidden where something is nearer.

    Coverage falls linearly over one px at both edges of a line of `line_width` px; `colours` is uint8 (k, 3).
    """
    height, width = keys.shape
    f, cx, cy, near = optics[0], optics[1], optics[2], optics[3]
    for k in range(starts.shape[0]):
        p = starts[k].copy()
        q = ends[k].copy()
        if p[2] < near and q[2] < near:
            continue
        if p[2] < near:
            p += (q - p) * ((near - p[2]) / (q[2] - p[2]))
        if q[2] < near:
            q += (p - q) * ((near - q[2]) / (p[2] - q[2]))
        ua, va, ia = f * p[0] / p[2] + cx, f * p[1] / p[2] + cy, 1.0 / p[2]
        ub, vb, ib = f * q[0] / q[2] + cx, f * q[1] / q[2] + cy, 1.0 / q[2]
        steep = abs(vb - va) > abs(ub - ua)
        if steep:
            ua, va, ub, vb = va, ua, vb, ub
        if ua > ub:
            ua, va, ia, ub, vb, ib = ub, vb, ib, ua, va, ia
        length = ub - ua
        slope = (vb - va) / length if length > 1e-9 else 0.0
        lean = 1.0 / np.sqrt(1.0 + slope * slope)
        reach = (0.5 * line_width + 0.5) / lean
        limit_major = height if steep else width
        limit_minor = width if steep else height
        red, green, blue = float(colours[k, 0]), float(colours[k, 1]), float(colours[k, 2])
        for major in range(
            max(0, int(np.floor(ua + 0.5))), min(limit_major - 1, int(np.floor(ub + 0.5))) + 1
        ):
            share = min(max((major - ua) / length, 0.0), 1.0) if length > 1e-9 else 0.0
            middle = va + share * (vb - va)
            z = 0.998 / (ia + share * (ib - ia))
            if not abs(middle) < 1e8:
                continue
            for minor in range(
                max(0, int(np.ceil(middle - reach))), min(limit_minor - 1, int(middle + reach)) + 1
            ):
                cover = min(0.5 * line_width + 0.5 - abs(minor - middle) * lean, 1.0)
                if cover <= 0.0:
                    continue
                y, x = (major, minor) if steep else (minor, major)
                key = keys[y, x]
                if on_top or key == EMPTY or z < _depth(key):
                    out[y, x] = _mix(out[y, x], red, green, blue, cover)
