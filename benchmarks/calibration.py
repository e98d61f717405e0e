"""Calibration with real photos of test fields, beside OpenCV with the same observations and the same model.

    python benchmarks/calibration.py

Needs the shared photos (GRAPHOS_DATA). OpenCV: one focal length, k1, k2, no tangential distortion.
"""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from graphos_core.adjustment.calibration.calibrate import CalibrateParams, Calibration, calibrate_camera
from graphos_core.images import read_photo_set
from graphos_core.run import Run

SETS: dict[str, tuple[str, dict[str, Any]]] = {
    "calib_opencv left": ("calib_opencv/left*.jpg", {"columns": 9, "rows": 6, "square_mm": 25.0}),
    "calib_opencv right": ("calib_opencv/right*.jpg", {"columns": 9, "rows": 6, "square_mm": 25.0}),
    "calib_boofcv chessboard": ("calib_boofcv/*Chess/*.jpg", {"columns": 4, "rows": 6, "square_mm": 30.0}),
    "calib_boofcv hexagonal": (
        "calib_boofcv/*Hexagonal/*.jpg",
        {"target": "circles", "layout": "hexagonal", "columns": 14, "rows": 24, "square_mm": 12.0},
    ),
}


def opencv(found: Calibration) -> tuple[np.ndarray, float]:
    """Values f, x0, y0, k1, k2 of OpenCV with the observations of `found`, and its seconds."""
    block = found.adjustment.block
    photos = [block.obs_photo == i for i in np.flatnonzero(block.oriented)]
    board = [block.points[block.obs_point[mine]].astype(np.float32) for mine in photos]
    seen = [block.obs_xy[mine].astype(np.float32).reshape(-1, 1, 2) for mine in photos]
    camera = block.cameras[0]
    matrix = np.array([[700.0, 0, 320], [0, 700.0, 240], [0, 0, 1]])
    flags = cv2.CALIB_FIX_ASPECT_RATIO | cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K3
    started = time.perf_counter()
    _, matrix, distortion, *_ = cv2.calibrateCamera(
        board, seen, (camera.width, camera.height), matrix, np.zeros(5),
        flags=flags | cv2.CALIB_USE_INTRINSIC_GUESS, criteria=(3, 200, 1e-15),
    )  # fmt: skip
    seconds = time.perf_counter() - started
    return np.array([matrix[1, 1], matrix[0, 2], matrix[1, 2], *distortion.ravel()[:2]]), seconds


def main() -> None:
    """Print one row per set."""
    data = Path(os.environ["GRAPHOS_DATA"])
    for name, (pattern, params) in SETS.items():
        run = Run(threads=2)
        photos = read_photo_set(sorted(data.glob(pattern)), run=run)
        sheet = CalibrateParams.from_dict(params)
        calibrate_camera(photos, sheet, run=Run(threads=2))  # kernels are compiled now
        started = time.perf_counter()
        found = calibrate_camera(photos, sheet, run=run)
        seconds = time.perf_counter() - started
        values, theirs = opencv(found)
        camera = found.adjustment.block.cameras[0]
        assert camera.sigmas is not None
        board = (
            "–"
            if found.board is None
            else f"{1000 * found.board.flatness_m:.3f} mm, F {found.board.statistic:.1f}"
        )
        measured = sum(bool(o) for o in found.observations)
        print(
            f"| {name} | {measured} of {len(photos.photos)} | {camera.focal_px:.2f} ± {camera.sigmas[0]:.2f} | "
            f"{np.abs(camera.values - values)[0]:.1e} | {found.adjustment.rms_px:.3f} | {board} | {seconds:.1f} | {theirs:.2f} |"
        )


if __name__ == "__main__":
    main()
