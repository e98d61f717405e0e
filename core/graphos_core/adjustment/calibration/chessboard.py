"""Chessboards: inner corners found by OpenCV on a small picture, measured in the full one."""

from __future__ import annotations

import cv2
import numpy as np

from graphos_core.adjustment.calibration.corners import neighbour_distance, refine_corners
from graphos_core.data.record import Array

SEARCH_SIDE = 1600
"""Longer side of the picture in which the board is searched, px."""
LEAST_OTHER = 3
"""Smallest number of corners per side of a board of unknown size."""


def find_chessboard(grey: Array, columns: int, rows: int) -> tuple[Array, Array, Array] | None:
    """Find all inner corners of a chessboard.

    The search by edges of dark squares (OpenCV `findChessboardCorners`, Vezhnevets) comes first because it is fast,
    then the search by saddle points in the Radon transform (`findChessboardCornersSB`; Duda and Frese 2018, Accurate
    detection and localization of checkerboard corners for calibration).

    Parameters
    ----------
    grey : uint8 (h, w)
    columns, rows : int
        Inner corners.

    Returns
    -------
    (point int32 (m,), xy float64 (m, 2), sigma float64 (m,)) or None
        Points row by row; the numbering starts where a dark square stands before the first corner, if the board
        tells its ends apart.
    """
    scale = max(1.0, max(grey.shape) / SEARCH_SIDE)
    small = _smaller(grey, scale)
    found, corners = cv2.findChessboardCorners(
        small, (columns, rows), flags=cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_FAST_CHECK
    )  # fmt: skip
    if not found:
        found, corners = cv2.findChessboardCornersSB(
            small, (columns, rows), flags=cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE
        )
    if not found or corners is None:
        return None
    rough = (corners.reshape(-1, 2).astype(np.float64) + 0.5) * scale - 0.5
    if len(rough) != columns * rows:
        return None
    xy, sigma = refine_corners(grey, rough, neighbour_distance(rough))
    order = _numbering(grey, xy, columns, rows)
    keep = np.isfinite(sigma[order])
    return np.flatnonzero(keep).astype(np.int32), xy[order][keep], sigma[order][keep]


def size_of_chessboard(grey: Array) -> tuple[int, int] | None:
    """Return columns and rows of inner corners of whatever chessboard the photo shows, the larger number first."""
    small = _smaller(grey, max(1.0, max(grey.shape) / SEARCH_SIDE))
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_LARGER
    found, _, meta = cv2.findChessboardCornersSBWithMeta(small, (LEAST_OTHER, LEAST_OTHER), flags)
    if not found or meta is None:
        return None
    rows, columns = meta.shape[:2]
    return max(rows, columns), min(rows, columns)


def _smaller(grey: Array, scale: float) -> Array:
    if scale <= 1.0:
        return grey
    height, width = grey.shape
    return cv2.resize(grey, (round(width / scale), round(height / scale)), interpolation=cv2.INTER_AREA)


def _numbering(grey: Array, xy: Array, columns: int, rows: int) -> Array:
    """Return the order (m,) that numbers corners row by row, unmirrored, from the end with the dark square."""
    grid = np.arange(columns * rows).reshape(rows, columns)
    ends = xy[[grid[0, 0], grid[0, -1], grid[-1, 0]]]
    along, down = ends[1] - ends[0], ends[2] - ends[0]
    if along[0] * down[1] - along[1] * down[0] < 0:  # numbered as seen from behind
        grid = grid[:, ::-1]
    if (columns + rows) % 2:  # turned by 180° dark and light change places
        a, b, c = xy[grid[0, 0]], xy[grid[0, 1]], xy[grid[1, 0]]
        before, after = a - 0.5 * (b - a) - 0.5 * (c - a), a + 0.5 * (b - a) - 0.5 * (c - a)
        if _brightness(grey, before) > _brightness(grey, after):
            grid = grid[::-1, ::-1]
    return grid.ravel()


def _brightness(grey: Array, place: Array) -> float:
    window = cv2.getRectSubPix(grey, (3, 3), (float(place[0]), float(place[1])))
    return float(window.mean())
