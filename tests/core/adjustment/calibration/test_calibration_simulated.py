"""Targets of every kind, photographed with a known camera: measured, calibrated, and compared with the truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from graphos_core.adjustment.calibration.calibrate import CalibrateParams, Calibration, calibrate_camera
from graphos_core.adjustment.calibration.drawing import draw_target, target_svg
from graphos_core.adjustment.calibration.eccentricity import eccentricity
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.errors import ParamError, UserError
from graphos_core.images import read_photo_set
from graphos_core.run import Run
from graphos_core.simulation.photo_block import demo_camera
from graphos_core.simulation.target_photos import TargetPhotos, exact_observations, simulate_target_photos

CAMERA = demo_camera(480, 360)
TARGETS: dict[str, dict[str, Any]] = {
    "chessboard": {"columns": 8, "rows": 5},
    "symmetric circles": {"target": "circles", "columns": 7, "rows": 5},
    "asymmetric circles": {
        "target": "circles",
        "layout": "asymmetric",
        "columns": 4,
        "rows": 9,
        "square_mm": 15.0,
    },
    "hexagonal circles": {"target": "circles", "layout": "hexagonal", "columns": 7, "rows": 6},
    "ChArUco": {"target": "aruco", "columns": 6, "rows": 4, "square_mm": 40.0},
    "AprilTags": {
        "target": "aruco",
        "columns": 5,
        "rows": 4,
        "markers_only": True,
        "dictionary": "DICT_APRILTAG_16H5",
    },
}
PRECISION_PX = {"AprilTags": 0.12}
"""Root mean square error of a measured coordinate that is demanded, px; 0.08 of the others."""


@pytest.fixture(scope="module")
def chessboard(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three photos of the chessboard."""
    folder = tmp_path_factory.mktemp("chessboard")
    photographed(folder, "chessboard", photos=3)
    return folder


def photographed(folder: Path, name: str, **more: Any) -> TargetPhotos:
    given = {k: v for k, v in more.items() if k in ("names", "photos", "warp_mm", "seed")}
    return simulate_target_photos(
        TargetParams.from_dict(TARGETS[name]),
        folder,
        CAMERA,
        **({"photos": 7, "seed": 5} | given),
        run=Run(threads=2),
    )


def calibrated(folder: Path, name: str, **more: Any) -> Calibration:
    run = Run(threads=2)
    given = {k: v for k, v in TARGETS[name].items() if k != "dictionary"}  # that is recognised
    photos = read_photo_set(folder / "photos", run=run)
    return calibrate_camera(photos, CalibrateParams.from_dict(given | more), run=run)


@pytest.mark.parametrize("name", TARGETS)
def test_measured_points_and_calibration_agree_with_the_truth(name: str, tmp_path: Path) -> None:
    truth = photographed(tmp_path, name)
    found = calibrated(tmp_path, name)
    block = found.adjustment.block
    assert sum(bool(o) for o in found.observations) >= 6
    errors = []
    for i, observed in enumerate(found.observations):
        if not observed:
            continue
        exact = exact_observations(truth, i)[observed.point]
        if TARGETS[name].get("target") == "circles":
            pose = (truth.rotations[i], truth.centres[i])
            exact += eccentricity(CAMERA, pose, truth.board[observed.point], 1e-3 * found.circle_mm)
        errors.append(observed.xy - exact)
    assert np.sqrt((np.concatenate(errors) ** 2).mean()) < PRECISION_PX.get(name, 0.08)
    camera = block.cameras[0]
    assert camera.sigmas is not None
    normalised = (camera.values - CAMERA.values) / camera.sigmas
    assert np.abs(normalised).max() < 4.0
    assert camera.sigmas[0] < 0.01 * CAMERA.focal_px
    if name == "AprilTags":
        assert found.dictionary == "DICT_APRILTAG_16H5"


def test_a_warped_board_is_found_and_its_shape_is_right(tmp_path: Path) -> None:
    truth = photographed(tmp_path, "chessboard", warp_mm=1.5, photos=10)
    found = calibrated(tmp_path, "chessboard")
    assert found.board is not None
    assert not found.board.agrees
    assert any("differs from its drawing" in line for line in found.findings)
    bulge = truth.board[:, 2] - truth.board[:, 2].mean()
    assert np.corrcoef(found.board.deviations[:, 2], bulge)[0, 1] > 0.99
    freed = calibrated(tmp_path, "chessboard", free_board=True)
    held, free = found.adjustment.block.cameras[0], freed.adjustment.block.cameras[0]
    assert abs(free.values[0] - CAMERA.focal_px) < 4.0 * free.sigmas[0]  # type: ignore[index]
    assert abs(free.values[0] - CAMERA.focal_px) < abs(held.values[0] - CAMERA.focal_px)
    assert freed.adjustment.sigma0_px < 0.8 * found.adjustment.sigma0_px


def test_photos_that_face_the_board_do_not_separate_focal_length_and_distance(tmp_path: Path) -> None:
    photographed(tmp_path, "chessboard", names=("facing",), photos=4)
    found = calibrated(tmp_path, "chessboard")
    sigma = found.adjustment.block.cameras[0].sigmas
    assert sigma is not None
    assert sigma[0] > 0.005 * CAMERA.focal_px
    assert any("hardly determined" in line for line in found.findings)


def test_a_board_that_looks_alike_after_half_a_turn_cannot_be_free(tmp_path: Path) -> None:
    photographed(tmp_path, "symmetric circles", photos=5)
    with pytest.raises(UserError, match="half a turn"):
        calibrated(tmp_path, "symmetric circles", free_board=True)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"columns": 7, "rows": 4}, "8 × 5 inner corners"),
        ({"columns": 11, "rows": 7}, "8 × 5 inner corners"),
        ({"target": "circles"}, "No grid of circles"),
        ({"target": "aruco"}, "markers"),
        ({"calibration": "no such model"}, "camera model"),
        ({"fix": "k9"}, "k9"),
    ],
)
def test_a_wrong_description_is_refused_with_what_was_found(
    given: dict[str, Any], says: str, chessboard: Path
) -> None:
    with pytest.raises(UserError) as refused:
        calibrated(chessboard, "chessboard", **given)
    assert says in str(refused.value)


def test_too_few_photos_are_refused(tmp_path: Path) -> None:
    photographed(tmp_path, "chessboard", photos=2)
    with pytest.raises(UserError, match="too few photos"):
        calibrated(tmp_path, "chessboard")


def test_a_target_sheet_is_drawn_in_true_scale_with_all_its_dark_squares() -> None:
    drawing = draw_target(TargetParams(columns=9, rows=6, square_mm=25.0))
    root = ElementTree.fromstring(target_svg(drawing))  # our own text
    assert root.attrib["width"] == "300.000mm"
    assert root.attrib["viewBox"].split()[2] == "300.000"
    assert len(drawing.dark) == 10 * 7 / 2
    assert np.allclose(drawing.dark[:, 2:] - drawing.dark[:, :2], 25.0)


def test_circles_that_touch_and_boards_without_enough_markers_are_refused() -> None:
    with pytest.raises(ParamError, match="touch"):
        draw_target(TargetParams(target="circles", circle_mm=25.0))
    with pytest.raises(UserError, match="markers"):
        draw_target(TargetParams(target="aruco", columns=60, rows=60))
