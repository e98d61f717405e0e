"""Calibration with photos of real test fields, against OpenCV with the same observations and the same model."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core import cli
from graphos_core.adjustment.calibration.calibrate import CalibrateParams, Calibration, calibrate_camera
from graphos_core.exchange.calibration_file import read_calibration
from graphos_core.images import read_photo_set
from graphos_core.run import Run

pytestmark = pytest.mark.data


def calibrated(photos: list[Path], **params: object) -> Calibration:
    run = Run(threads=2)
    return calibrate_camera(read_photo_set(photos, run=run), CalibrateParams.from_dict(params), run=run)


def opencv_with_the_same_observations(found: Calibration) -> tuple[np.ndarray, np.ndarray, float]:
    """Values and standard deviations of f (one for both axes), x0, y0, k1, k2, and OpenCV's RMS of 2-D vectors."""
    block = found.adjustment.block
    photos = [block.obs_photo == i for i in np.flatnonzero(block.oriented)]
    board = [block.points[block.obs_point[mine]].astype(np.float32) for mine in photos]
    seen = [block.obs_xy[mine].astype(np.float32).reshape(-1, 1, 2) for mine in photos]
    camera = block.cameras[0]
    matrix = np.array([[700.0, 0, 320], [0, 700.0, 240], [0, 0, 1]])
    rms, matrix, distortion, _, _, sigma, *_ = cv2.calibrateCameraExtended(
        board, seen, (camera.width, camera.height), matrix, np.zeros(5),
        flags=cv2.CALIB_FIX_ASPECT_RATIO | cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K3
        | cv2.CALIB_USE_INTRINSIC_GUESS, criteria=(3, 200, 1e-15),
    )  # fmt: skip
    values = np.array([matrix[1, 1], matrix[0, 2], matrix[1, 2], *distortion.ravel()[:2]])
    return values, sigma.ravel()[[1, 2, 3, 4, 5]], rms


@pytest.fixture(scope="module")
def left(data_dir: Path) -> Calibration:
    return calibrated(
        sorted((data_dir / "calib_opencv").glob("left*.jpg")), columns=9, rows=6, square_mm=25.0
    )


@pytest.fixture(scope="module")
def chess(data_dir: Path) -> Calibration:
    folder = data_dir / "calib_boofcv" / "Sony_DSC-HX5V_Chess"
    return calibrated(sorted(folder.glob("*.jpg")), columns=4, rows=6, square_mm=30.0)


@pytest.mark.parametrize("name", ["left", "chess"])
def test_values_and_sigmas_are_those_of_opencv(name: str, request: pytest.FixtureRequest) -> None:
    found: Calibration = request.getfixturevalue(name)
    camera = found.adjustment.block.cameras[0]
    values, sigmas, rms = opencv_with_the_same_observations(found)
    assert camera.values[:3] == pytest.approx(values[:3], abs=0.01)
    assert camera.values[3:] == pytest.approx(values[3:], abs=1e-4)
    assert camera.sigmas is not None
    assert camera.sigmas[1:] == pytest.approx(
        sigmas[1:], rel=1e-3
    )  # OpenCV has none for two focal lengths tied
    assert np.sqrt(2.0) * found.adjustment.rms_px == pytest.approx(rms, abs=1e-5)


def test_every_photo_is_measured_and_fits_better_than_the_reference(
    left: Calibration, chess: Calibration
) -> None:
    for found in (left, chess):
        assert len(found.observations) == 13 and all(found.observations)
    assert np.sqrt(2.0) * left.adjustment.rms_px < 0.393  # mean reprojection of the reference, calib_opencv
    focal, sigma = chess.adjustment.block.cameras[0].values[0], chess.adjustment.block.cameras[0].sigmas[0]  # type: ignore[index]
    assert abs(focal - 0.5 * (701.012 + 698.654)) < 3.0 * sigma  # intrinsic.yaml of calib_boofcv


def test_both_cameras_of_the_stereo_pair_find_the_same_warped_board(
    left: Calibration, data_dir: Path
) -> None:
    right = calibrated(
        sorted((data_dir / "calib_opencv").glob("right*.jpg")), columns=9, rows=6, square_mm=25.0
    )
    assert left.board is not None and right.board is not None
    assert not left.board.agrees and not right.board.agrees
    a, b = left.board.deviations[:, 2], right.board.deviations[:, 2]
    assert np.corrcoef(a, b)[0, 1] > 0.9
    assert np.sqrt(((a - b) ** 2).mean()) < 0.4 * left.board.flatness_m


def test_hexagonal_circles(data_dir: Path) -> None:
    folder = data_dir / "calib_boofcv" / "Sony_DSC-HX5V_CircleHexagonal"
    found = calibrated(
        sorted(folder.glob("*.jpg"))[::2],
        target="circles",
        layout="hexagonal",
        columns=14,
        rows=24,
        square_mm=12.0,
    )
    assert all(len(o.point) == 14 * 24 for o in found.observations)
    assert found.circle_mm == pytest.approx(10.0, abs=0.3)  # the distance is 1.2 diameters
    assert found.adjustment.rms_px < 0.2  # the sheet is not flat on its clipboard, and f is off for that
    assert found.adjustment.block.cameras[0].values[0] == pytest.approx(700.0, rel=0.03)


def test_the_command_writes_a_calibration_that_is_read_again(
    data_dir: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    photos = [str(p) for p in sorted((data_dir / "calib_opencv").glob("left*.jpg"))[::2]]
    words = [
        "calibrate",
        *photos,
        "--target",
        "chessboard",
        "--columns",
        "9",
        "--rows",
        "6",
        "--square-mm",
        "25",
    ]
    assert cli.main([*words, "--out", str(tmp_path)]) == 0
    assert "Principal distance f               53" in capsys.readouterr().out
    report = json.loads((tmp_path / "report.json").read_text("utf-8"))
    (camera,) = read_calibration(tmp_path / "calibration.toml")
    assert report["cameras"][0]["focal_px"] == camera.focal_px
    assert report["cameras"][0]["parameters"][0]["sigma"] == camera.sigmas[0]  # type: ignore[index]
    assert 0.05 < report["orientation"]["reprojection_rms_px"] < 0.2
    assert (tmp_path / "report.html").stat().st_size > 50_000
    assert {p.name for p in (tmp_path / "pictures").iterdir()} == {"residuals_1.png", "coverage_1.png"}
    lines = (tmp_path / "observations.csv").read_text("utf-8").splitlines()
    assert len(lines) == 1 + report["orientation"]["observations"]
