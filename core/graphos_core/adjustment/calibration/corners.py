"""Corners to a fraction of a pixel, with their standard deviation."""

from __future__ import annotations

import cv2
import numpy as np

from graphos_core.data.record import Array

LEAST_HALF, MOST_HALF = 2, 15
"""Half side of the window round a corner, px."""
WINDOW_SHARE = 0.35
"""Half side of the window in shares of the distance of neighbouring corners."""
LEAST_SIGMA = 0.005
"""Smallest standard deviation that is believed, px: below it the model of an ideal corner ends."""


def refine_corners(grey: Array, corners: Array, spacing: Array) -> tuple[Array, Array]:
    """Return corners to a fraction of a pixel and the standard deviation of a coordinate.

    Every edge pixel of the window says that its gradient g is perpendicular to the way from the corner p to the pixel
    q: ``gᵀ (q − p) = 0``. Least squares give ``N p = Σ w g gᵀ q`` with ``N = Σ w g gᵀ``, solved by OpenCV's
    `cornerSubPix` with a Gaussian w; the residuals give the variance and ``σ² N⁻¹`` the covariance of the corner
    (Förstner and Gülch 1987, A fast operator for detection and precise location of distinct points).

    Parameters
    ----------
    grey : uint8 (h, w)
    corners : float64 (m, 2)
        Good to about a pixel.
    spacing : float64 (m,)
        Distance to the nearest neighbour, px; the window takes a part of it.

    Returns
    -------
    xy : float64 (m, 2)
        Corners that ran away stay where they were.
    sigma : float64 (m,)
        Mean over x and y; infinite where the corner ran away or has no gradients.
    """
    xy = np.array(corners, dtype=np.float32).reshape(-1, 1, 2)
    half = np.clip(np.round(WINDOW_SHARE * np.asarray(spacing)), LEAST_HALF, MOST_HALF).astype(int)
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 60, 1e-4)
    for size in np.unique(half):
        mine = np.flatnonzero(half == size)
        xy[mine] = cv2.cornerSubPix(
            grey, np.ascontiguousarray(xy[mine]), (int(size), int(size)), (-1, -1), stop
        )
    found = xy.reshape(-1, 2).astype(np.float64)
    sigma = np.array([_sigma(grey, p, int(h)) for p, h in zip(found, half, strict=True)])
    lost = np.hypot(*(found - corners).T) > half
    found[lost] = np.asarray(corners)[lost]
    sigma[lost] = np.inf
    return found, sigma


def _sigma(grey: Array, corner: Array, half: int) -> float:
    """Return the standard deviation of one corner, px, from the gradients in its window."""
    side = 2 * half + 3
    window = cv2.getRectSubPix(grey.astype(np.float32, copy=False), (side, side), tuple(map(float, corner)))
    gx = 0.5 * (window[1:-1, 2:] - window[1:-1, :-2])
    gy = 0.5 * (window[2:, 1:-1] - window[:-2, 1:-1])
    offset = np.arange(-half, half + 1, dtype=np.float64)
    weight = np.exp(-((offset / half) ** 2))
    weight = weight[:, None] * weight
    normal = np.array([
        [(weight * gx * gx).sum(), (weight * gx * gy).sum()], [(weight * gx * gy).sum(), (weight * gy * gy).sum()],
    ])  # fmt: skip
    if np.linalg.det(normal) <= 1e-6 * np.trace(normal) ** 2:
        return float("inf")
    residual = gx * offset[None, :] + gy * offset[:, None]
    variance = float((weight * residual**2).sum()) / (weight.sum() - 2.0)
    cofactor = np.linalg.inv(normal)
    spread = cofactor @ np.array([
        [(weight**2 * gx * gx).sum(), (weight**2 * gx * gy).sum()],
        [(weight**2 * gx * gy).sum(), (weight**2 * gy * gy).sum()],
    ]) @ cofactor  # fmt: skip
    return max(float(np.sqrt(0.5 * variance * np.trace(spread))), LEAST_SIGMA)


def neighbour_distance(xy: Array) -> Array:
    """Return the distance (m,) of each point (m, 2) to its nearest neighbour."""
    difference = xy[:, None, :] - xy[None, :, :]
    distance = np.hypot(difference[..., 0], difference[..., 1])
    np.fill_diagonal(distance, np.inf)
    result: Array = distance.min(axis=1)
    return result
