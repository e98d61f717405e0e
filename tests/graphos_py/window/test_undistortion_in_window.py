"""With undistortion every view shows the photo that fits what is drawn on it."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from PySide6.QtWidgets import QFileDialog, QToolButton

from graphos_core.exchange.calibration_file import write_calibration
from graphos_core.images import read_pixels
from graphos_core.preprocessing.undistortion import CalibratedParams
from graphos_core.seen_photos import filter_input
from graphos_core.simulation.photo_block import demo_camera
from graphos_py.fields import make_field


def wait(qtbot, window):
    qtbot.waitUntil(lambda: window.session.running is None and not window.jobs.running, timeout=60000)


def test_the_calibration_is_chosen_as_a_file(qtbot, monkeypatch):
    field = make_field(CalibratedParams.declarations()["calibration"])
    qtbot.addWidget(field.widget)
    told = []
    field.edited.connect(lambda: told.append(field.value()))
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: ("/some/calibration.toml", ""))
    field.widget.findChild(QToolButton).click()
    assert told == ["/some/calibration.toml"]
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: ("", ""))
    field.widget.findChild(QToolButton).click()
    assert told == ["/some/calibration.toml"] == [field.text()]


def test_preview_results_and_photos_as_taken(qtbot, window, photo_folder, tmp_path):
    strong = replace(demo_camera(160, 120), values=np.array([184.0, 81.0, 59.0, -0.25, 0.05]))
    write_calibration(tmp_path / "c.toml", [strong])
    window.resize(1300, 850)
    window.show()
    window.engine_loaded([])
    window.session.bug.connect(lambda problem: pytest.fail(repr(problem)))
    window.session.create(tmp_path / "out", photo_folder, calibration=tmp_path / "c.toml")
    wait(qtbot, window)
    session = window.session
    raw = session.project.photo_set.photos[0]
    before = cv2.cvtColor(cv2.imread(str(photo_folder / raw.name)), cv2.COLOR_BGR2RGB)
    window.show_tab("preprocessing")
    tab = window.tabs["preprocessing"]
    qtbot.waitUntil(lambda: tab._made and tab.live.preview is not None and not tab.live.busy, timeout=20000)
    assert np.array_equal(tab.live.preview.pixels, before)
    session.choose("preprocessing", "undistortion", ["calibrated"])
    qtbot.waitUntil(
        lambda: (
            tab.live.preview is not None
            and not tab.live.busy
            and not np.array_equal(tab.live.preview.pixels, before)
        ),
        timeout=20000,
    )
    undistorted = filter_input(session.pipeline, 0)
    assert np.array_equal(tab.live.preview.pixels, undistorted) and not np.array_equal(undistorted, before)
    assert session.seen(raw) is raw  # not made yet
    session.run("features")
    wait(qtbot, window)
    assert np.array_equal(read_pixels(session.seen(raw)), undistorted)
    assert session.seen_cameras()[0].values[3] == 0.0
    window.show_tab("images")
    images = window.tabs["images"]
    qtbot.waitUntil(lambda: images._made and images.image.canvas.array is not None, timeout=20000)
    wait(qtbot, window)
    assert np.array_equal(images.image.canvas.array, before)
    window.show_tab("features")
    shown = []
    window.tabs["features"].keypoints._pixels.read(0, lambda index, pixels: shown.append(pixels))
    wait(qtbot, window)
    assert np.array_equal(shown[-1], undistorted)
