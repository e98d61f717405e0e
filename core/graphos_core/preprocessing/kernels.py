"""Per-pixel arithmetic in one pass over memory."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data import Array


@njit(cache=True, nogil=True)
def wallis_gain(variance: float, targets: Array) -> float:
    """Return the factor by which the Wallis filter lifts the contrast of a window; arguments as in `wallis_value`."""
    one = np.float32(1.0)
    spread = max(np.sqrt(max(variance, np.float32(0.0))), one)  # type: ignore[call-overload]
    return targets[2] * targets[1] / (targets[2] * spread + (one - targets[2]) * targets[1])


@njit(cache=True, nogil=True)
def wallis_value(value: float, mean: float, variance: float, targets: Array) -> float:
    """Return the Wallis filter's value of one pixel, the gain not limited.

    Parameters
    ----------
    value, mean, variance : float
        Grey value of the pixel, mean and variance of its window.
    targets : float32 (6,)
        Target mean, target standard deviation, contrast weight c, brightness weight b, and the limits of the gain,
        which only `node_values` keeps: here, with them or with the gain in a function of its own, the loop over all
        pixels is not vectorised and takes three times as long.
    """
    one = np.float32(1.0)
    spread = max(np.sqrt(max(variance, np.float32(0.0))), one)  # type: ignore[call-overload]
    gain = targets[2] * targets[1] / (targets[2] * spread + (one - targets[2]) * targets[1])
    return gain * (value - mean) + targets[3] * targets[0] + (one - targets[3]) * mean


@njit(cache=True, nogil=True)
def node_values(mean: Array, variance: Array, targets: Array) -> tuple[Array, Array]:
    """Return gain and shift of ``g' = gain · g + shift`` at nodes, float32 (r, c), from their windows' statistics."""
    gain = np.empty_like(mean)
    shift = np.empty_like(mean)
    one = np.float32(1.0)
    for i in range(mean.shape[0]):
        for j in range(mean.shape[1]):
            gain[i, j] = min(max(wallis_gain(variance[i, j], targets), targets[4]), targets[5])
            shift[i, j] = targets[3] * targets[0] + (one - targets[3] - gain[i, j]) * mean[i, j]
    return gain, shift


@njit(cache=True, nogil=True)
def wallis_nodes(
    image: Array,
    gain: Array,
    shift: Array,
    first_row: Array,
    row_weight: Array,
    first_column: Array,
    column_weight: Array,
    low: float,
    scale: float,
) -> Array:
    """Filter an image with gain and shift interpolated bilinearly between nodes: ``g' = gain · g + shift``.

    Parameters
    ----------
    image : uint8 or uint16 (h, w)
    gain, shift : float32 (r, c)
        At the nodes.
    first_row, first_column : int64 (h,), (w,)
        Node above or left of each pixel; the next node is the other.
    row_weight, column_weight : float32 (h,), (w,)
        Weight of the other node.
    low, scale : float32
        Grey level is ``(value − low) · scale``.
    """
    height, width = image.shape
    out = np.empty((height, width), np.uint8)
    one = np.float32(1.0)
    half = np.float32(0.5)
    for i in range(height):
        r, v = first_row[i], row_weight[i]
        s = min(r + 1, gain.shape[0] - 1)
        for j in range(width):
            c, u = first_column[j], column_weight[j]
            d = min(c + 1, gain.shape[1] - 1)
            g = (gain[r, c] * (one - u) + gain[r, d] * u) * (one - v) + (
                gain[s, c] * (one - u) + gain[s, d] * u
            ) * v
            b = (shift[r, c] * (one - u) + shift[r, d] * u) * (one - v) + (
                shift[s, c] * (one - u) + shift[s, d] * u
            ) * v
            value = g * ((np.float32(image[i, j]) - low) * scale) + b + half
            out[i, j] = np.uint8(min(max(value, np.float32(0.0)), np.float32(255.0)))
    return out


@njit(cache=True, nogil=True)
def wallis_rows(image: Array, rows: Array, columns: Array, low: float, scale: float, targets: Array) -> Array:
    """Filter an image, uint8 (h, w), from running sums of its rows and columns; no other image is kept.

    Parameters
    ----------
    image : uint8 or uint16 (h, w)
    rows : int64 (h + side,), columns : int64 (w + side,)
        Index of the row or column that stands for each row of the mirrored border, starting half a window above
        or left of the image; the last is never used.
    low, scale : float32
        Grey level is ``(value − low) · scale``.
    targets : float32 (6,)
        As in `wallis_value`.
    """
    height, width = image.shape
    mean = np.empty(width, np.float32)
    variance = np.empty(width, np.float32)
    sums, squares = start_sums(image, rows)
    out = np.empty((height, width), np.uint8)
    half = np.float32(0.5)
    for i in range(height):
        row_statistics(sums, squares, columns, np.float32(scale), np.float32(low), mean, variance)
        for j in range(width):
            value = (np.float32(image[i, j]) - low) * scale
            value = wallis_value(value, mean[j], variance[j], targets) + half
            out[i, j] = np.uint8(min(max(value, np.float32(0.0)), np.float32(255.0)))
        advance_sums(image, rows, i, sums, squares)
    return out


@njit(cache=True, nogil=True)
def statistics_rows(
    image: Array, rows: Array, columns: Array, low: float, scale: float
) -> tuple[Array, Array]:
    """Return the local mean and variance of an image, float32 (h, w); arguments as in `wallis_rows`."""
    height, width = image.shape
    mean = np.empty((height, width), np.float32)
    variance = np.empty((height, width), np.float32)
    sums, squares = start_sums(image, rows)
    for i in range(height):
        row_statistics(sums, squares, columns, scale, low, mean[i], variance[i])
        advance_sums(image, rows, i, sums, squares)
    return mean, variance


@njit(cache=True, nogil=True)
def start_sums(image: Array, rows: Array) -> tuple[Array, Array]:
    """Return sums of values and of their squares over the window's rows of the first row, int64 (w,)."""
    height, width = image.shape
    sums = np.zeros(width, np.int64)
    squares = np.zeros(width, np.int64)
    for k in range(len(rows) - height):
        row = image[rows[k]]
        for j in range(width):
            value = np.int64(row[j])
            sums[j] += value
            squares[j] += value * value
    return sums, squares


@njit(cache=True, nogil=True)
def advance_sums(image: Array, rows: Array, i: int, sums: Array, squares: Array) -> None:
    """Move the column sums from row i to the next."""
    side = len(rows) - image.shape[0]
    leaving = image[rows[i]]
    entering = image[rows[i + side]]
    for j in range(len(sums)):
        new = np.int64(entering[j])
        old = np.int64(leaving[j])
        sums[j] += new - old
        squares[j] += new * new - old * old


@njit(cache=True, nogil=True)
def row_statistics(
    sums: Array, squares: Array, columns: Array, scale: float, low: float, mean: Array, variance: Array
) -> None:
    """Write mean and variance of the windows of one row from its column sums; the sums are exact integers."""
    width = len(sums)
    length = len(columns)
    side = length - width
    running = np.zeros(length + 1, np.int64)
    running_square = np.zeros(length + 1, np.int64)
    for k in range(length):
        running[k + 1] = running[k] + sums[columns[k]]
        running_square[k + 1] = running_square[k] + squares[columns[k]]
    share = 1.0 / (side * side)
    upper, upper_square = running[side:], running_square[side:]
    for j in range(width):
        average = (upper[j] - running[j]) * share
        mean[j] = (average - low) * scale
        variance[j] = ((upper_square[j] - running_square[j]) * share - average * average) * (scale * scale)


@njit(cache=True, nogil=True)
def polynomial_grey(image: Array, weights: Array) -> Array:
    """Return the polynomial of second degree of r, g, b for every pixel, float32 (h, w).

    Parameters
    ----------
    image : uint8 (h, w, 3)
    weights : float32 (9,)
        Of r, g, b, rg, rb, gb, r², g², b², with r, g, b from 0 to 1.
    """
    height, width, _ = image.shape
    out = np.empty((height, width), np.float32)
    scale = np.float32(1.0 / 255.0)
    for i in range(height):
        for j in range(width):
            r = np.float32(image[i, j, 0]) * scale
            g = np.float32(image[i, j, 1]) * scale
            b = np.float32(image[i, j, 2]) * scale
            out[i, j] = (
                r * (weights[0] + weights[3] * g + weights[4] * b + weights[6] * r)
                + g * (weights[1] + weights[5] * b + weights[7] * g)
                + b * (weights[2] + weights[8] * b)
            )
    return out


@njit(cache=True, nogil=True)
def normal_matrix(slopes: Array) -> Array:
    """Return ``Σ l lᵀ`` (9, 9) of the rows l of float64 (p, 9), added in order."""
    out = np.zeros((9, 9))
    for p in range(slopes.shape[0]):
        for i in range(9):
            for j in range(9):
                out[i, j] += slopes[p, i] * slopes[p, j]
    return out


@njit(cache=True, nogil=True)
def signed_sum(slopes: Array, target: Array, known: Array, weights: Array, sigma: float) -> Array:
    """Return ``Σ l (2β − 1) δ`` (9,), β the probability that the sign of δ is positive, added in order.

    Parameters
    ----------
    slopes : float64 (p, 9)
        Differences l of the monomials.
    target : float64 (p,)
        Colour differences δ.
    known : bool (p,)
        Whether the sign of δ is known (β = 1).
    weights : float64 (9,)
        Present weights ω.
    sigma : float
    """
    out = np.zeros(9)
    factor = 1.0 / (sigma * sigma)
    for p in range(slopes.shape[0]):
        pull = target[p]
        if not known[p]:
            grey = 0.0
            for i in range(9):
                grey += slopes[p, i] * weights[i]
            pull *= np.tanh(grey * target[p] * factor)  # 2β − 1 = tanh(l·ω δ / σ²)
        for i in range(9):
            out[i] += slopes[p, i] * pull
    return out
