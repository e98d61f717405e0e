"""Compiled matching cost: ZNCC and census of several neighbours along inverse depth, relative to a surface.

The sweep follows a surface given as inverse depth w₀(x, y) instead of a plane: hypothesis k of a pixel is
``w₀ + (first + k)·step``. A pixel (x, y) of the reference picture is found in neighbour n at
``A_n (x, y, 1)ᵀ + w b_n`` (homogeneous) with ``A_n = K_n R_n Rᵀ K⁻¹``, ``b_n = K_n R_n (C − C_n)``.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data.record import Array

HIDDEN = np.float32(1e9)
"""Value of a sample that the neighbour does not show; makes every window sum with it huge."""

COST_UNIT = 1000.0
"""Stored cost of a matching cost of 1."""


@njit(cache=True, nogil=True, fastmath=True)
def warp_rows(
    image: Array, a: Array, b: Array, surface: Array, offset: float, top: int, rows: int, out: Array
) -> None:
    """Sample a neighbour where it shows rows of the reference, bilinearly, less 128.

    Parameters
    ----------
    image : uint8 (h, w)
        Neighbour; 0 is hidden.
    a, b : float64 (3, 3), (3,)
    surface : float32 (h, w)
        Inverse depth of the sweep surface.
    offset : float
        Inverse depth added to the surface.
    top, rows : int
        First row of the reference and how many; rows outside the picture are hidden.
    out : float32 (≥ rows, w)
    """
    height, width = surface.shape
    lim_x = image.shape[1] - 1.001
    lim_y = image.shape[0] - 1.001
    half = np.float32(128.0)
    for i in range(rows):
        y = top + i
        if y < 0 or y >= height:
            for x in range(width):
                out[i, x] = HIDDEN
            continue
        px0 = a[0, 1] * y + a[0, 2]
        py0 = a[1, 1] * y + a[1, 2]
        pz0 = a[2, 1] * y + a[2, 2]
        for x in range(width):
            w = surface[y, x] + offset
            pz = pz0 + a[2, 0] * x + w * b[2]
            value = HIDDEN
            if pz > 1e-6 and w > 0.0:
                u = (px0 + a[0, 0] * x + w * b[0]) / pz
                v = (py0 + a[1, 0] * x + w * b[1]) / pz
                if u >= 0.0 and v >= 0.0 and u < lim_x and v < lim_y:
                    iu = int(u)
                    iv = int(v)
                    p00 = image[iv, iu]
                    p01 = image[iv, iu + 1]
                    p10 = image[iv + 1, iu]
                    p11 = image[iv + 1, iu + 1]
                    if p00 > 0 and p01 > 0 and p10 > 0 and p11 > 0:
                        fu = np.float32(u - iu)
                        fv = np.float32(v - iv)
                        upper = np.float32(p00) + fu * (np.float32(p01) - np.float32(p00))
                        lower = np.float32(p10) + fu * (np.float32(p11) - np.float32(p10))
                        value = upper + fv * (lower - upper) - half
            out[i, x] = value


@njit(cache=True, nogil=True, fastmath=True)
def zncc_row(
    reference: Array, ref_mean: Array, ref_inv: Array, warped: Array, y: int, i: int, r: int, noise: float,
    sums: Array, out: Array,
) -> None:  # fmt: skip
    """Normalised cross-correlation of one row; NaN-free: −2 where it cannot be had.

    Parameters
    ----------
    reference : float32 (h, w)
        Grey − 128.
    ref_mean, ref_inv : float32 (h, w)
        Mean over the window; 1/√(variance + noise); 0 where hidden.
    warped : float32 (rows, w)
        Row ``i + r`` is row y of the reference.
    y, i, r : int
        Row, its index in the band, half window.
    noise : float
        Variance added to both windows, grey², so that noise does not look like texture.
    sums : float32 (6, w)
        Scratch.
    out : float32 (w,)
    """
    width = warped.shape[1]
    inner = width - 2 * r
    side = 2 * r + 1
    for c in range(6):
        for x in range(width):
            sums[c, x] = np.float32(0.0)
    for j in range(side):
        yy = y + j - r
        for x in range(width):
            value = warped[i + j, x]
            sums[0, x] += value
            sums[1, x] += value * value
            sums[2, x] += value * reference[yy, x]
    for c in range(3):
        for j in range(side):
            for x in range(inner):
                sums[c + 3, x] += sums[c, x + j]
    scale = np.float32(1.0 / (side * side))
    add = np.float32(noise)
    none = np.float32(-2.0)
    for x in range(r):
        out[x] = none
        out[width - 1 - x] = none
    for x in range(inner):
        mean = sums[3, x] * scale
        variance = max(sums[4, x] * scale - mean * mean, np.float32(0.0))
        covariance = sums[5, x] * scale - mean * ref_mean[y, x + r]
        score = covariance * ref_inv[y, x + r] / np.sqrt(variance + add)
        hidden = sums[4, x] > np.float32(1e12) or ref_inv[y, x + r] <= np.float32(0.0)
        out[x + r] = none if hidden else score


@njit(cache=True, nogil=True)
def census_row(
    reference: Array, ref_inv: Array, warped: Array, y: int, i: int, r: int, tie: float, out: Array
) -> None:
    """Census agreement of one row as a score −1 to 1: 1 − 2·(differing comparisons / comparisons).

    Zabih and Woodfill 1994. Every pixel of the window is compared with the centre in both pictures; `tie` grey
    levels count as equal, which makes three outcomes. Arguments as in `zncc_row`.
    """
    width = warped.shape[1]
    for x in range(width):
        out[x] = np.float32(-2.0)
    comparisons = (2 * r + 1) * (2 * r + 1) - 1
    for x in range(r, width - r):
        centre = warped[i + r, x]
        if ref_inv[y, x] <= 0.0 or centre > 1e6:
            continue
        middle = reference[y, x]
        differ = 0
        hidden = False
        for j in range(2 * r + 1):
            for k in range(-r, r + 1):
                other = warped[i + j, x + k]
                if other > 1e6:
                    hidden = True
                d_ref = reference[y + j - r, x + k] - middle
                d_war = other - centre
                s_ref = (1 if d_ref > tie else 0) - (1 if d_ref < -tie else 0)
                s_war = (1 if d_war > tie else 0) - (1 if d_war < -tie else 0)
                differ += 1 if s_ref != s_war else 0
        if not hidden:
            out[x] = np.float32(1.0 - 2.0 * differ / comparisons)


@njit(cache=True, nogil=True, fastmath=True)
def best_half(scores: Array, i: int, half: Array, out: Array) -> None:
    """Write the mean of the better half (rounded up) of ``scores[:, i]`` to `out`; scores of −2 do not count.

    The better half is robust against neighbours in which the point is hidden by something else. The scores of the
    row are sorted on the way, the best first.

    Parameters
    ----------
    scores : float32 (n, rows, w)
    i : int
    half : float32 (w,)
        Scratch: how many scores are averaged.
    out : float32 (w,)
        −2 where no score counts.
    """
    n, _, width = scores.shape
    for x in range(width):
        half[x] = np.float32(0.5)  # half a score for rounding up
        out[x] = np.float32(0.0)
    for m in range(n):
        for x in range(width):
            half[x] += np.float32(0.5) if scores[m, i, x] > np.float32(-1.5) else np.float32(0.0)
    for m in range((n + 1) // 2):
        for low in range(n - 1, m, -1):
            for x in range(width):
                upper = scores[low - 1, i, x]
                lower = scores[low, i, x]
                scores[low - 1, i, x] = max(upper, lower)
                scores[low, i, x] = min(upper, lower)
        for x in range(width):
            out[x] += scores[m, i, x] if np.float32(m + 1) <= half[x] else np.float32(0.0)
    for x in range(width):
        used = np.floor(half[x])
        out[x] = out[x] / used if used > np.float32(0.5) else np.float32(-2.0)


@njit(cache=True, nogil=True)
def sweep_band(
    reference: Array, ref_mean: Array, ref_inv: Array, images: Array, sizes: Array, a: Array, b: Array,
    surface: Array, first: int, step: float, r: int, noise: float, census: bool, top: int, bottom: int,
    cost: Array,
) -> None:  # fmt: skip
    """Write the matching cost of rows top to bottom (excluded) for every hypothesis.

    Parameters
    ----------
    reference, ref_mean, ref_inv : float32 (h, w)
        See `zncc_row`.
    images : uint8 (n, H, W)
        Neighbours, padded to one size; `sizes` int64 (n, 2) says how many rows and columns count.
    a, b : float64 (n, 3, 3), (n, 3)
    surface : float32 (h, w)
        Inverse depth of hypothesis index 0 when first = 0.
    first, step : int, float
        Offset of hypothesis k is ``(first + k)·step``.
    r, noise : int, float
        Half window; variance (ZNCC) added, and its root the tie (census).
    census : bool
    top, bottom : int
    cost : uint16 (h, w, d)
        ``1000·(1 − max(score, 0))``; 1000 where nothing can be said.
    """
    height, width = surface.shape
    n = a.shape[0]
    rows = bottom - top
    warped = np.empty((rows + 2 * r, width), np.float32)
    sums = np.empty((6, width), np.float32)
    scores = np.empty((n, rows, width), np.float32)
    row = np.empty(width, np.float32)
    half = np.empty(width, np.float32)
    for k in range(cost.shape[2]):
        offset = (first + k) * step
        for m in range(n):
            image = images[m, : sizes[m, 0], : sizes[m, 1]]
            warp_rows(image, a[m], b[m], surface, offset, top - r, rows + 2 * r, warped)
            for i in range(rows):
                y = top + i
                if y < r or y >= height - r:
                    scores[m, i, :] = -2.0
                elif census:
                    census_row(reference, ref_inv, warped, y, i, r, np.sqrt(noise), scores[m, i])
                else:
                    zncc_row(reference, ref_mean, ref_inv, warped, y, i, r, noise, sums, scores[m, i])
        for i in range(rows):
            best_half(scores, i, half, row)
            for x in range(width):
                score = min(max(row[x], np.float32(0.0)), np.float32(1.0))
                cost[top + i, x, k] = np.uint16(np.float32(1000.5) - np.float32(1000.0) * score)


@njit(cache=True, nogil=True)
def winners(
    total: Array,
    cost: Array,
    surface: Array,
    first: int,
    step: float,
    depth: Array,
    score: Array,
    edge: Array,
) -> None:
    """Choose the hypothesis with the smallest aggregated cost, to a fraction of the step by a parabola.

    Parameters
    ----------
    total : float32 (h, w, d)
        Aggregated cost.
    cost : uint16 (h, w, d)
        Matching cost.
    surface, first, step
        As in `sweep_band`.
    depth : float32 (h, w)
        Out: inverse depth.
    score : float32 (h, w)
        Out: matching score 0 to 1 of the winner.
    edge : bool (h, w)
        Out: the winner is the first or last hypothesis, so the true one may lie outside.
    """
    height, width, count = total.shape
    for y in range(height):
        for x in range(width):
            best = 0
            for k in range(1, count):
                if total[y, x, k] < total[y, x, best]:
                    best = k
            shift = 0.0
            if 0 < best < count - 1:
                before = total[y, x, best - 1]
                after = total[y, x, best + 1]
                bend = before + after - 2.0 * total[y, x, best]
                if bend > 0.0:
                    shift = 0.5 * (before - after) / bend
            depth[y, x] = surface[y, x] + (first + best + shift) * step
            score[y, x] = 1.0 - cost[y, x, best] / 1000.0
            edge[y, x] = best == 0 or best == count - 1


@njit(cache=True, nogil=True)
def smooth_surface(depth: Array, reach: float, r: int, out: Array) -> None:
    """Average each inverse depth with those of its window that differ by at most `reach`; float32 (h, w)."""
    height, width = depth.shape
    for y in range(height):
        for x in range(width):
            centre = depth[y, x]
            total = 0.0
            count = 0
            for j in range(-r, r + 1):
                for i in range(-r, r + 1):  # both or none of an opposite pair: no bias on slanted surfaces
                    y1, x1, y2, x2 = y + j, x + i, y - j, x - i
                    if min(y1, y2, x1, x2) < 0 or max(y1, y2) >= height or max(x1, x2) >= width:
                        continue
                    if abs(depth[y1, x1] - centre) <= reach and abs(depth[y2, x2] - centre) <= reach:
                        total += depth[y1, x1]
                        count += 1
            out[y, x] = total / count if count > 0 else centre
