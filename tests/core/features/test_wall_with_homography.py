"""Two real views of a wall with a known homography: what affine simulation is for, and that SIFT is OpenCV's."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.data import Features
from graphos_core.features.detectors.asift import AsiftParams, asift
from graphos_core.features.detectors.sift import SiftParams, sift
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.run import Run

RUN = Run(seed=0)
RIGHT_PX, CELL_PX = 3.0, 2.0


def wall(data_dir: Path) -> tuple[list[np.ndarray], np.ndarray]:
    folder = data_dir / "features"
    grey = [cv2.imread(str(folder / name), cv2.IMREAD_GRAYSCALE) for name in ("graf1.png", "graf3.png")]
    storage = cv2.FileStorage(str(folder / "H1to3p.xml"), cv2.FILE_STORAGE_READ)
    return grey, storage.getFirstTopLevelNode().mat()


def right_cells(a: Features, b: Features, homography: np.ndarray) -> int:
    """Matches within 3 px of the homography, counted once per 2 px cell of the first photo."""
    matches = mutual(a, b, MutualParams(), run=RUN).matches
    xy = a.xy[matches[:, 0]].astype(np.float64)
    mapped = cv2.perspectiveTransform(xy[None], homography)[0]
    right = np.linalg.norm(mapped - b.xy[matches[:, 1]], axis=1) < RIGHT_PX
    return len(np.unique(np.floor(xy[right] / CELL_PX), axis=0))


@pytest.mark.data
def test_sift_is_opencvs_point_by_point(data_dir: Path) -> None:
    grey, _ = wall(data_dir)
    params = SiftParams(maximum=100_000, hellinger=False)
    found = sift(grey[0], grey[0], params, run=RUN)
    detector = cv2.SIFT_create(0, params.layers, params.contrast, params.edge, params.sigma, cv2.CV_8U, True)
    points, descriptors = detector.detectAndCompute(grey[0], None)
    theirs = np.array([(*p.pt, p.size, p.response) for p in points])
    order = np.lexsort((theirs[:, 0], theirs[:, 1], -theirs[:, 2]))
    ours = np.column_stack([found.xy, found.scale, found.response])
    back = np.lexsort((ours[:, 0], ours[:, 1], -ours[:, 2]))
    assert len(ours) == len(theirs) > 2000
    assert np.allclose(ours[back], theirs[order], atol=1e-3)
    ours_sorted, theirs_sorted = (
        np.sort(d.astype(np.int64).sum(axis=1)) for d in (found.descriptors, descriptors)
    )
    assert np.array_equal(ours_sorted, theirs_sorted)


@pytest.mark.data
def test_simulated_tilts_find_three_times_as_much_of_the_wall(data_dir: Path) -> None:
    grey, homography = wall(data_dir)
    plain = right_cells(*(sift(g, g, SiftParams(), run=RUN) for g in grey), homography)
    tilted = right_cells(*(asift(g, g, AsiftParams(), run=RUN) for g in grey), homography)
    assert plain > 300
    assert tilted >= 3 * plain
