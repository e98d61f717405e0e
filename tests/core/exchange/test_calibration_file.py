"""The program's own calibration file: written, read again, given to a project, refused with the reason."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from graphos_core.errors import UserError
from graphos_core.exchange.calibration_file import read_calibration, with_calibration, write_calibration
from graphos_core.exchange.graphos_camera import read_camera
from graphos_core.images import read_photo_set
from graphos_core.project import Project
from graphos_core.run import Run
from graphos_core.simulation.photo_block import demo_camera

SIGMAS = np.array([0.4, 0.5, 0.6, 1e-3, 2e-3])


def test_cameras_come_back_as_they_were(tmp_path: Path) -> None:
    cameras = [replace(demo_camera(640, 480), sigmas=SIGMAS), demo_camera(800, 600)]
    write_calibration(tmp_path / "c.toml", cameras)
    for wrote, read in zip(cameras, read_calibration(tmp_path / "c.toml"), strict=True):
        assert np.array_equal(wrote.values, read.values)
        assert (wrote.model, wrote.width, wrote.height, wrote.label) == (
            read.model,
            read.width,
            read.height,
            read.label,
        )
        assert (wrote.sigmas is None) == (read.sigmas is None)
    assert np.array_equal(
        read_camera(tmp_path / "c.toml").values, cameras[0].values
    )  # graphos convert camera


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (('model = "basic"', 'model = "basis"'), "Did you mean “basic”"),
        (("k1 = ", "k7 = "), "k7"),
        (("width = 640", 'width = "wide"'), "width"),
        (("schema = 1", "schema = 9"), "schema 9"),
        (("focal_px = 736", "focal_px = nan  # 736"), "focal_px"),
        (("[[camera]]", "[[camera"), "line"),
    ],
)
def test_a_damaged_file_is_refused_with_the_reason(
    change: tuple[str, str], says: str, tmp_path: Path
) -> None:
    path = tmp_path / "c.toml"
    write_calibration(path, [demo_camera(640, 480)])
    text = path.read_text("utf-8")
    assert change[0] in text
    path.write_text(text.replace(*change, 1), "utf-8")
    with pytest.raises(UserError) as refused:
        read_calibration(path)
    assert says in str(refused.value)


def test_a_project_takes_a_given_calibration_and_keeps_it(small_simulation: Path, tmp_path: Path) -> None:
    given = replace(demo_camera(640, 480), values=np.array([700.0, 320.0, 240.0, -0.05, 0.01]), sigmas=SIGMAS)
    write_calibration(tmp_path / "given.toml", [given])
    made = Project.create(tmp_path / "p", small_simulation / "photos", calibration=tmp_path / "given.toml")
    for project in (made, Project.open(tmp_path / "p")):
        camera = project.photo_set.cameras[0]
        assert np.array_equal(camera.values, given.values)
        assert not camera.focal_estimated
        assert "given.toml" in camera.focal_source or "calibration.toml" in camera.focal_source
    without = made.change(calibration="")
    assert without.photo_set.cameras[0].focal_px != 700.0


def test_a_calibration_of_other_photos_is_refused(small_simulation: Path) -> None:
    photos = read_photo_set(small_simulation / "photos", run=Run())
    with pytest.raises(UserError, match="800 × 600"):
        with_calibration(photos, [demo_camera(800, 600)])
