"""Every kind of bad picture in the window: a sentence in the messages, never a bug dialog, and the set goes on."""

import re

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image
from PySide6.QtWidgets import QToolButton

from graphos_core.masks import PhotoMask, Polygon, write_masks
from graphos_didactic.lessons import lessons


def make(qtbot, window, photos, out):
    window.engine_loaded([])
    window.session.bug.connect(lambda problem: pytest.fail(repr(problem)))
    window.session.create(out, photos)
    qtbot.waitUntil(lambda: not window.jobs.running, timeout=20000)


def run(qtbot, window, stage):
    window.session.run(stage)
    qtbot.waitUntil(lambda: window.session.running is None and not window.jobs.running, timeout=60000)


def test_what_became_of_each_file_is_told_when_a_project_is_made(qtbot, window, photo_folder, tmp_path):
    photo = cv2.cvtColor(cv2.imread(str(photo_folder / "p0.png")), cv2.COLOR_BGR2RGB)
    Image.fromarray(photo[:, ::-1].copy()).convert("CMYK").save(photo_folder / "cmyk.jpg")
    warm = photo[:, :, 1].astype(np.float32)
    warm[:4] = np.nan
    tifffile.imwrite(photo_folder / "warm.tif", warm)
    Image.fromarray(photo[::-1].copy()).save(
        photo_folder / "pages.tif", save_all=True, append_images=[Image.fromarray(photo)]
    )
    bands = np.dstack([photo, photo[:, :, :2]])
    tifffile.imwrite(photo_folder / "bands.tif", bands, photometric="minisblack", planarconfig="contig")
    Image.fromarray(photo).save(photo_folder / "twin.tif")
    Image.fromarray(photo[:, :1]).save(photo_folder / "line.png")
    Image.fromarray(photo).save(photo_folder / "moving.gif")
    make(qtbot, window, photo_folder, tmp_path / "out")
    told = "\n".join(window.messages.texts("warning"))
    for sentence in ("cmyk.jpg: Its colours are CMYK", "warm.tif: 640 of its pixels have no value", "stretched to 16 bit",
                     "pages.tif: It has 2 pages", "twin.tif: It shows exactly the same pixels as p0.png",
                     "line.png: It is too small: 1 × 120 pixels", "moving.gif: .gif files are not read"):  # fmt: skip
        assert sentence in told, sentence
    names = [p.name for p in window.session.project.photo_set.photos]
    assert names == [
        "bands.tif",
        "cmyk.jpg",
        "p0.png",
        "p1.png",
        "p2.png",
        "pages.tif",
        "twin.tif",
        "warm.tif",
    ]
    window.show()
    window.show_tab("images")
    tab = window.tabs["images"]
    qtbot.waitUntil(lambda: not window.jobs.running, timeout=30000)
    assert tab.image.canvas.array.shape == (120, 160, 3)  # five bands in false colours
    assert "5 bands" in tab.facts.text()
    window.session.select_photo(7)
    qtbot.waitUntil(lambda: not window.jobs.running, timeout=30000)
    assert tab.image.canvas.array.shape == (120, 160) and tab.image.canvas.array.dtype == np.uint8
    assert "640 of its pixels have no value" in tab.facts.text()
    wanted = []
    tab.lesson.connect(wanted.append)
    tab.facts.linkActivated.emit(re.search("href='(.+?)'", tab.facts.text())[1])
    tab.masks.findChildren(QToolButton)[-1].click()
    assert wanted == ["preprocessing/kinds-of-images", "preprocessing/masks"]
    assert set(wanted) <= set(lessons())


def test_photos_without_points_and_covered_ones_are_named_and_the_set_goes_on(
    qtbot, window, photo_folder, tmp_path
):
    Image.new("RGB", (160, 120), (9, 99, 9)).save(photo_folder / "plain.png")
    make(qtbot, window, photo_folder, tmp_path / "out")
    everything = Polygon(((-1, -1), (999, -1), (999, 999), (-1, 999)))
    write_masks(window.session.project.folder, {"p1.png": PhotoMask((everything,))})
    window.session.masks_changed()
    run(qtbot, window, "features")
    told = "\n".join(window.messages.texts("warning"))
    assert "No points were found in plain.png" in told
    assert "The mask of p1.png covers the whole photo" in told
    assert window.ribbon.step("features").state.status == "done"


def test_undistortion_without_a_calibration_is_a_sentence_in_the_ribbon(
    qtbot, window, photo_folder, tmp_path
):
    make(qtbot, window, photo_folder, tmp_path / "out")
    window.session.choose("preprocessing", "undistortion", ["calibrated"])
    run(qtbot, window, "features")
    assert window.ribbon.step("preprocessing").state.status == "failed"
    assert any("without a calibration" in text for text in window.messages.texts("error"))
    window.session.choose("preprocessing", "undistortion", ["as_taken"])
    run(qtbot, window, "preprocessing")
    assert window.ribbon.step("preprocessing").state.status == "done"
