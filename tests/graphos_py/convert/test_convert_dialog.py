"""The converter dialog: cameras with their cost, orientation tables seen before they are taken."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from graphos_core.cameras import camera_model
from graphos_core.data import Camera
from graphos_core.exchange.camera_formats import read_any_camera, write_camera
from graphos_core.exchange.orientation_formats import ORIENTATION_FORMATS, OrientationOptions
from graphos_py.convert.dialog import ConvertDialog


def camera(name: str, **values: float) -> Camera:
    model = camera_model(name)
    numbers = {"focal_px": 1500.0, "x0": 799.5, "y0": 599.5, **values}
    return Camera(
        model=name, width=1600, height=1200, values=np.array([numbers.get(n, 0.0) for n in model.names]),
        pixel_pitch_mm=0.004,
    )  # fmt: skip


@pytest.fixture
def dialog(qtbot) -> ConvertDialog:
    made = ConvertDialog()
    qtbot.addWidget(made)
    made.show()
    return made


def choose(combo, value: str) -> None:
    combo.setCurrentIndex(combo.findData(value))
    combo.activated.emit(combo.currentIndex())


def test_a_camera_is_converted_exactly_where_the_target_can_and_the_cost_is_said_where_not(
    dialog, tmp_path: Path
) -> None:
    page = dialog.camera
    assert not page.save.isEnabled()
    source = tmp_path / "camera.yaml"
    write_camera(camera("brown", k1=-0.06, k2=0.02, p1=1e-4), source, "opencv")
    page.source.line.setText(str(source))
    choose(page.to, "metashape")
    assert page.converted is not None and page.converted.max_px <= 1e-6 and page.save.isEnabled()
    again = read_any_camera(page.converted.file)
    assert again is not None
    choose(page.to, "bundler")  # no principal point, no decentring
    assert page.converted.max_px > 0.01 and "px" in page.said.text()
    page.source.line.setText(str(tmp_path / "nothing"))
    assert page.converted is None and not page.save.isEnabled()
    (tmp_path / "words.txt").write_text("hello", "utf-8")
    page.source.line.setText(str(tmp_path / "words.txt"))
    assert "not recognised" in page.said.text()


def test_an_orientation_table_is_seen_corrected_and_written_as_another_format(dialog, tmp_path: Path) -> None:
    page = dialog.orientation
    table = tmp_path / "eo.csv"
    table.write_text(
        "photo;X;Y;Z;omega;phi;kappa\na.jpg;1,5;2;3;0;0;100\nb.jpg;2;2;3;0;10;x\nc.jpg;2;5;3;1;10;200\n",
        "utf-8",
    )
    lens = tmp_path / "lens.yaml"
    write_camera(camera("basic", k1=-0.05), lens, "opencv")
    page.source.line.setText(str(table))
    assert not page.table.isHidden() and "Line 3" in page.table.problems.text()
    assert "camera" in page.said.text() and not page.save.isEnabled()
    page.camera.line.setText(str(lens))
    assert page.save.isEnabled() and "2 photos" in page.said.text()
    choose(page.table.angle, "gon")
    turn = page.read().block.rotations[0]
    choose(page.table.angle, "deg")
    other = page.read().block.rotations[0]
    angle = np.degrees(np.arccos((np.trace(turn @ other.T) - 1) / 2))
    assert np.isclose(angle, 10.0)  # 100 gon are 90 degrees
    choose(page.table.columns[1], "y")
    choose(page.table.columns[2], "x")
    assert np.allclose(page.read().block.centres[0], [2, 1.5, 3])
    choose(page.to, "patb")
    target = tmp_path / "eo.ori"
    page.write(target)
    assert "Written" in page.said.text()
    back = ORIENTATION_FORMATS["patb"].read(target, OrientationOptions(camera=page._camera())).block
    assert np.allclose(back.rotations, page.read().block.rotations, atol=1e-7)
    assert np.allclose(back.centres, page.read().block.centres, atol=1e-4)
