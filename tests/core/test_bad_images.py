"""Every kind of bad picture on the command line: one clear sentence each, and the set goes on."""

import re
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image

from graphos_core.cli import main

Folder = Path


@pytest.fixture
def good(small_simulation: Path, tmp_path: Path) -> Folder:
    """A folder with three good photos."""
    folder = tmp_path / "in"
    folder.mkdir()
    for path in sorted((small_simulation / "photos").iterdir())[:3]:
        shutil.copy(path, folder)
    return folder


def run(capsys: pytest.CaptureFixture[str], folder: Folder, *more: object) -> tuple[int, str]:
    out = folder.parent / "out"
    words = ["run", folder, "--out", out, "--until", "adjustment", "--focal-px", 736, *more]
    code = main([str(word) for word in words])
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err and "fault of the program" not in captured.err
    return code, captured.err + captured.out


def pixels(folder: Folder, index: int) -> np.ndarray:
    return np.asarray(Image.open(sorted(folder.iterdir())[index]))


def test_photos_of_one_colour_are_named_and_the_others_are_oriented(
    good: Folder, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.new("RGB", (640, 480), (90, 120, 30)).save(good / "plain.png")
    code, said = run(capsys, good)
    assert code == 0
    assert "No points were found in plain.png: too little texture" in said
    assert "Not oriented: plain.png." in said and "3 of 4" in said


def test_fifty_million_pixels_in_one_set_with_small_photos(
    good: Folder, capsys: pytest.CaptureFixture[str]
) -> None:
    large = np.full((5773, 8661), 77, np.uint8)
    cv2.imwrite(str(good / "large.png"), large, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    code, said = run(capsys, good)
    assert code == 0 and "No points were found in large.png" in said and "3 of 4" in said


def test_other_sizes_and_orientations_in_one_set_are_oriented_with_cameras_of_their_own(
    good: Folder, capsys: pytest.CaptureFixture[str]
) -> None:
    a, b = pixels(good, 0), pixels(good, 1)
    turned = Image.Exif()
    turned[0x0112] = 6
    Image.fromarray(a).resize((320, 240)).save(good / "half.png")
    Image.fromarray(np.rot90(b).copy()).save(good / "turned.jpg", exif=turned, quality=95)
    Image.fromarray(np.rot90(b).copy()).save(good / "upright.png")
    code, said = run(capsys, good)
    assert code == 0 and "6 of 6" in said


def test_all_kinds_of_pictures_make_one_set_and_each_is_told_what_became_of_it(
    good: Folder, capsys: pytest.CaptureFixture[str]
) -> None:
    a, b, c = (pixels(good, i) for i in range(3))
    grey = cv2.cvtColor(c, cv2.COLOR_RGB2GRAY)
    for path in list(good.iterdir()):
        path.unlink()
    opaque = np.full(a.shape[:2], 255, np.uint8)
    opaque[:30] = 0
    Image.fromarray(np.dstack([a, opaque])).save(good / "alpha.png")
    Image.fromarray(b).convert("CMYK").save(good / "cmyk.jpg", quality=95)
    celsius = grey.astype(np.float32) / 10.0
    celsius[:40] = np.nan
    tifffile.imwrite(good / "float.tif", celsius)
    Image.fromarray(a[10:, 10:]).save(good / "pages.tif", save_all=True, append_images=[Image.fromarray(b)])
    bands = np.dstack([b[20:, :, ::-1], b[20:, :, :2]]).astype(np.uint16) * 200
    tifffile.imwrite(good / "bands.tif", bands, photometric="minisblack", planarconfig="contig")
    Image.fromarray(c[5:]).convert("1").save(good / "bit.png")
    Image.fromarray(a[:, :1]).save(good / "line.png")
    Image.fromarray(a).save(good / "moving.gif")
    code, said = run(capsys, good)
    assert code == 0 and "6 of 6" in said
    for sentence in (
        "alpha.png: 19200 of its pixels are fully transparent and are masked.",
        "cmyk.jpg: Its colours are CMYK",
        "float.tif: 25600 of its pixels have no value (NaN or no-data) and are masked.",
        "stretched to 16 bit",
        "pages.tif: It has 2 pages; the first one is used.",
        "line.png is not used: It is too small: 1 × 480 pixels, needs 32 at least.",
        "moving.gif is not used: .gif files are not read",
    ):
        assert sentence in said, sentence


def test_identical_pixels_in_another_file_are_told(good: Folder, capsys: pytest.CaptureFixture[str]) -> None:
    first = sorted(good.iterdir())[0]
    (good / "twin.jpg").write_bytes(first.read_bytes() + b"other bytes")
    code, said = run(capsys, good)
    assert code == 0
    assert f"twin.jpg: It shows exactly the same pixels as {first.name}" in said


def test_no_keypoints_at_all(good: Folder, capsys: pytest.CaptureFixture[str]) -> None:
    code, said = run(capsys, good, "--set", "features.sift.contrast=0.5")
    assert code == 1
    assert "No points were found in" in said and "thresholds of the detector are too strict" in said
    assert "there was no pair with points to verify" in said


def test_fewer_than_five_matches(good: Folder, capsys: pytest.CaptureFixture[str]) -> None:
    for path in sorted(good.iterdir())[1:]:
        blurred = cv2.GaussianBlur(cv2.imread(str(path)), (0, 0), 22)
        cv2.imwrite(str(path), blurred)
    code, said = run(capsys, good)
    assert code == 1
    assert re.search(r"of \d pairs the best one has: only \d+ candidate matches, \d+ needed\.", said)
    assert "overlap" in said


def test_masks_that_cover_everything(good: Folder, capsys: pytest.CaptureFixture[str]) -> None:
    names = [path.stem for path in sorted(good.iterdir())]
    masks = good.parent / "masks of one"
    masks.mkdir()
    cv2.imwrite(str(masks / f"{names[2]}_mask.png"), np.zeros((480, 640), np.uint8))
    code, said = run(capsys, good, "--masks", masks)
    assert code == 0 and "masks for 1 photos" in said
    assert f"The mask of {names[2]}.jpg covers the whole photo" in said and "2 of 3" in said
    cv2.imwrite(str(good.parent / "black.png"), np.zeros((480, 640), np.uint8))
    code, said = run(capsys, good, "--masks", good.parent / "black.png")
    assert code == 1 and f"{names[0]}.jpg, {names[1]}.jpg, {names[2]}.jpg covers the whole photo" in said


def test_masks_of_nothing_and_of_another_size_are_refused_with_the_reason(
    good: Folder, capsys: pytest.CaptureFixture[str]
) -> None:
    code, said = run(capsys, good, "--masks", good.parent / "nowhere")
    assert code == 1 and "do not exist" in said
    cv2.imwrite(str(good.parent / "small.png"), np.zeros((48, 64), np.uint8))
    code, said = run(capsys, good, "--masks", good.parent / "small.png")
    assert code == 0 and "It has 64 × 48 px, the photo 640 × 480 px." in said


def test_undistortion_with_a_calibration_that_does_not_fit(
    good: Folder, capsys: pytest.CaptureFixture[str]
) -> None:
    code, said = run(capsys, good, "--undistort", good.parent / "none.toml")
    assert code == 1 and "none.toml cannot be read" in said
    code, said = run(capsys, good, "--set", "preprocessing.undistortion=calibrated")
    assert code == 1 and "without a calibration" in said
