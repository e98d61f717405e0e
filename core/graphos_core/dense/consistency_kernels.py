"""Compiled comparison of depth maps: agreement between maps, speckles, fusion of a map with others."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data.record import Array


@njit(cache=True, nogil=True)
def sample_inverse_depth(depth: Array, height: int, width: int, u: float, v: float, reach: float) -> float:
    """Return the inverse depth at (u, v), bilinear where the four pixels belong together, else the nearest.

    0 where unknown or outside. `depth` is float32 (≥ height, ≥ width), 0 where unknown; pixels belong together when
    they differ by at most `reach`.
    """
    if not (u > -0.5 and v > -0.5 and u < width - 0.5 and v < height - 0.5):
        return 0.0
    near = depth[int(v + 0.5), int(u + 0.5)]
    if near <= 0.0:
        return 0.0
    iu = int(u)
    iv = int(v)
    if u < 0.0 or v < 0.0 or iu + 1 >= width or iv + 1 >= height:
        return near
    fu = u - iu
    fv = v - iv
    total = 0.0
    for j in range(2):
        for i in range(2):
            value = depth[iv + j, iu + i]
            if value <= 0.0 or abs(value - near) > reach:
                return near
            total += value * (fu if i == 1 else 1.0 - fu) * (fv if j == 1 else 1.0 - fv)
    return total


@njit(cache=True, nogil=True)
def seen_by_other(
    x: float,
    y: float,
    w: float,
    a: Array,
    b: Array,
    back_a: Array,
    back_b: Array,
    depth: Array,
    height: int,
    width: int,
    reach: float,
    place: Array,
) -> float:
    """Return the inverse depth that another map gives to the point (x, y, w) of this map, in this camera; 0 if none.

    `a`, `b` lead from this picture to the other, `back_a`, `back_b` back (see `graphos_core.dense.kernels`).
    `place` (2,) receives the position in the other picture.
    """
    pz = a[2, 0] * x + a[2, 1] * y + a[2, 2] + w * b[2]
    if pz <= 1e-9:
        return 0.0
    u = (a[0, 0] * x + a[0, 1] * y + a[0, 2] + w * b[0]) / pz
    v = (a[1, 0] * x + a[1, 1] * y + a[1, 2] + w * b[1]) / pz
    place[0] = u
    place[1] = v
    theirs = sample_inverse_depth(depth, height, width, u, v, reach)
    if theirs <= 0.0:
        return 0.0
    qz = back_a[2, 0] * u + back_a[2, 1] * v + back_a[2, 2] + theirs * back_b[2]
    if qz <= 1e-9:
        return 0.0
    return theirs / qz


@njit(cache=True, nogil=True)
def count_consistent(
    own: Array, top: int, bottom: int, a: Array, b: Array, back_a: Array, back_b: Array, depths: Array,
    sizes: Array, reaches: Array, tolerance: float, count: Array,
) -> None:  # fmt: skip
    """Count for rows top to bottom in how many other maps a pixel has the same depth.

    Parameters
    ----------
    own : float32 (h, w)
        Inverse depth, 0 where unknown.
    top, bottom : int
    a, b, back_a, back_b : float64 (n, 3, 3), (n, 3), (n, 3, 3), (n, 3)
    depths : float32 (n, H, W)
        Inverse depths of the other maps, padded; `sizes` int64 (n, 2).
    reaches : float64 (n,)
        Differences of inverse depth within one surface of the other maps.
    tolerance : float
        Largest difference of inverse depth in this camera that counts as the same.
    count : uint8 (h, w)
        Out.
    """
    place = np.empty(2)
    for y in range(top, bottom):
        for x in range(own.shape[1]):
            w = own[y, x]
            agreeing = 0
            if w > 0.0:
                for n in range(a.shape[0]):
                    theirs = seen_by_other(
                        x, y, w, a[n], b[n], back_a[n], back_b[n], depths[n], sizes[n, 0], sizes[n, 1],
                        reaches[n], place,
                    )  # fmt: skip
                    if theirs > 0.0 and abs(theirs - w) <= tolerance:
                        agreeing += 1
            count[y, x] = min(agreeing, 255)


@njit(cache=True, nogil=True)
def fuse_rows(
    own: Array, done: Array, top: int, bottom: int, a: Array, b: Array, back_a: Array, back_b: Array,
    depths: Array, others_done: Array, sizes: Array, reaches: Array, tolerance: float, least: int,
    merged: Array, views: Array,
) -> None:  # fmt: skip
    """Merge every pixel of some rows with the same point in the other maps, and mark it there as done.

    Parameters
    ----------
    own, top, bottom, a, b, back_a, back_b, depths, sizes, reaches, tolerance
        See `count_consistent`.
    done : bool (h, w)
        Pixels that are part of a point already.
    others_done : bool (n, H, W)
        The same for the other maps; written to.
    least : int
        Smallest number of maps, this one included.
    merged : float32 (h, w)
        Out: mean inverse depth in this camera; 0 where no point is made.
    views : uint8 (h, w)
        Out: number of maps, this one included.
    """
    count = a.shape[0]
    place = np.empty(2)
    where = np.empty((count, 2), np.int64)
    for y in range(top, bottom):
        for x in range(own.shape[1]):
            merged[y, x] = 0.0
            views[y, x] = 0
            w = own[y, x]
            if w <= 0.0 or done[y, x]:
                continue
            total = float(w)
            agreeing = 1
            for n in range(count):
                where[n, 0] = -1
                theirs = seen_by_other(
                    x, y, w, a[n], b[n], back_a[n], back_b[n], depths[n], sizes[n, 0], sizes[n, 1],
                    reaches[n], place,
                )  # fmt: skip
                if theirs > 0.0 and abs(theirs - w) <= tolerance:
                    total += theirs
                    agreeing += 1
                    where[n, 0] = int(place[1] + 0.5)
                    where[n, 1] = int(place[0] + 0.5)
            if agreeing < least:
                continue
            merged[y, x] = total / agreeing
            views[y, x] = min(agreeing, 255)
            for n in range(count):
                if where[n, 0] >= 0:
                    others_done[n, where[n, 0], where[n, 1]] = True


@njit(cache=True, nogil=True)
def remove_speckles(depth: Array, reach: float, least: int) -> int:
    """Set connected parts of fewer than `least` pixels to 0; return how many pixels were removed.

    Neighbours (left, right, up, down) are connected when their inverse depths differ by at most `reach`.
    """
    height, width = depth.shape
    seen = np.zeros((height, width), np.bool_)
    stack = np.empty(height * width, np.int64)
    removed = 0
    for start in range(height * width):
        if seen[start // width, start % width] or depth[start // width, start % width] <= 0.0:
            continue
        stack[0] = start
        seen[start // width, start % width] = True
        found = 1
        next_one = 0
        while next_one < found:
            y, x = stack[next_one] // width, stack[next_one] % width
            next_one += 1
            for side in range(4):
                yy = y + (1 if side == 0 else 0) - (1 if side == 1 else 0)
                xx = x + (1 if side == 2 else 0) - (1 if side == 3 else 0)
                if yy < 0 or yy >= height or xx < 0 or xx >= width or seen[yy, xx]:
                    continue
                if depth[yy, xx] > 0.0 and abs(depth[yy, xx] - depth[y, x]) <= reach:
                    seen[yy, xx] = True
                    stack[found] = yy * width + xx
                    found += 1
        if found < least:
            for i in range(found):
                depth[stack[i] // width, stack[i] % width] = 0.0
            removed += found
    return removed


@njit(cache=True, nogil=True)
def plane_rows(depth: Array, top: int, bottom: int, r: int, reach: float, plane: Array) -> None:
    """Fit ``w = a (x − x₀) + b (y − y₀) + c`` to the inverse depths round each pixel of some rows.

    Inverse depth is linear in the pixels of a plane, so the fit is exact for planes seen obliquely.

    Parameters
    ----------
    depth : float32 (h, w)
        Inverse depth, 0 where unknown.
    top, bottom, r : int
        Rows; half window.
    reach : float
        Pixels that differ more from the centre take no part.
    plane : float64 (h, w, 3)
        Out: a, b, c; zeros where fewer than 6 pixels take part or all lie on a line.
    """
    height, width = depth.shape
    for y in range(top, bottom):
        for x in range(width):
            plane[y, x, :] = 0.0
            centre = depth[y, x]
            if centre <= 0.0:
                continue
            n = sx = sy = sxx = sxy = syy = sw = sxw = syw = 0.0
            for j in range(max(-r, -y), min(r, height - 1 - y) + 1):
                for i in range(max(-r, -x), min(r, width - 1 - x) + 1):
                    w = depth[y + j, x + i]
                    if w <= 0.0 or abs(w - centre) > reach:
                        continue
                    d = w - centre
                    n += 1.0
                    sx += i
                    sy += j
                    sxx += i * i
                    sxy += i * j
                    syy += j * j
                    sw += d
                    sxw += i * d
                    syw += j * d
            if n < 6.0:
                continue
            cxx = sxx - sx * sx / n
            cxy = sxy - sx * sy / n
            cyy = syy - sy * sy / n
            cxw = sxw - sx * sw / n
            cyw = syw - sy * sw / n
            det = cxx * cyy - cxy * cxy
            if det < 1e-3 * n * n:
                continue
            slope_x = (cyy * cxw - cxy * cyw) / det
            slope_y = (cxx * cyw - cxy * cxw) / det
            plane[y, x, 0] = slope_x
            plane[y, x, 1] = slope_y
            plane[y, x, 2] = centre + (sw - slope_x * sx - slope_y * sy) / n
