"""Homographies from files, and changed photos whose homography is checked by where a spot went."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.errors import UserError
from graphos_core.features_comparison.disturbances import DISTURBANCES, LONGEST, changed, small
from graphos_core.features_comparison.truth import check_homography, mapped, read_homography

MATRIX = np.array([[0.76, -0.29, 225.67], [0.33, 1.01, -76.9], [3.4e-4, -1.4e-5, 1.0]])


@pytest.mark.parametrize("name", ["h.xml", "h.yml", "h.json"])
def test_a_homography_is_read_from_a_file_of_opencv(tmp_path: Path, name: str) -> None:
    storage = cv2.FileStorage(str(tmp_path / name), cv2.FILE_STORAGE_WRITE)
    storage.write("note", "of two photos")
    storage.write("H13", MATRIX)
    storage.release()
    assert np.array_equal(read_homography(tmp_path / name), MATRIX)


@pytest.mark.parametrize("separator", [" ", ", ", ";\t"])
def test_a_homography_is_read_from_plain_numbers(tmp_path: Path, separator: str) -> None:
    path = tmp_path / "H1to3p"
    lines = [separator.join(repr(float(v)) for v in row) for row in MATRIX]
    path.write_text("# from photo 1 to photo 3\n" + "\n".join(lines) + "\n")
    assert np.array_equal(read_homography(path), MATRIX)


@pytest.mark.parametrize(("text", "why"), [
    ("1 0 0 0 1 0 0 0", "8 numbers"), ("1 0 0\n0 1 0\n0 0 x", "more than numbers"),
    ("1 2 3 2 4 6 0 0 1", "inverted"), ("1 0 0 0 1 nan 0 0 1", "inverted"),
    ('<?xml version="1.0"?><opencv_storage><a>3</a></opencv_storage>', "no matrix"), ("<broken", "OpenCV"), ("", "0 numbers"),
])  # fmt: skip
def test_a_wrong_homography_is_refused_with_the_reason(tmp_path: Path, text: str, why: str) -> None:
    path = tmp_path / "h.txt"
    path.write_text(text)
    with pytest.raises(UserError, match=why):
        read_homography(path)
    with pytest.raises(UserError, match="No such file"):
        read_homography(tmp_path / "missing.xml")
    (tmp_path / "photo.xml").write_bytes(bytes(range(128, 256)))
    with pytest.raises(UserError, match="no text file"):
        read_homography(tmp_path / "photo.xml")


def test_a_homography_of_other_photos_is_refused() -> None:
    check_homography(MATRIX, (800, 640), (800, 640))
    with pytest.raises(UserError, match="no part of photo 1"):
        check_homography(np.array([[1.0, 0, 5000], [0, 1, 0], [0, 0, 1]]), (800, 640), (800, 640))


def spot(x: float, y: float, size: tuple[int, int] = (300, 200)) -> np.ndarray:
    u, v = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    return np.rint(30 + 200 * np.exp(-((u - x) ** 2 + (v - y) ** 2) / (2 * 6.0**2))).astype(np.uint8)


@pytest.mark.parametrize("name", sorted(DISTURBANCES))
@pytest.mark.parametrize("place", [(150.0, 100.0), (110.4, 81.7)])
def test_a_spot_goes_where_the_homography_says(name: str, place: tuple[float, float]) -> None:
    disturbance = DISTURBANCES[name]
    for level in disturbance.levels[:4]:
        image, homography = disturbance.change(spot(*place), level, np.random.default_rng(1))
        expected, inside = mapped(homography, np.array([place]), (image.shape[1], image.shape[0]))
        assert inside[0]
        weight = np.maximum(image.astype(float) - image.max() * 0.55, 0.0)  # the spot, whatever the noise is
        rows, columns = np.indices(image.shape)
        found = np.array([(weight * columns).sum(), (weight * rows).sum()]) / weight.sum()
        assert np.abs(found - expected[0]).max() < (2.0 if name == "noise" else 0.25), (
            level,
            found,
            expected,
        )


def test_changes_depend_on_the_seed_only_and_every_level_changes_more() -> None:
    photo = cv2.GaussianBlur(
        np.random.default_rng(2).integers(0, 256, (180, 240), dtype=np.uint8), (0, 0), 1.5
    )
    for disturbance in DISTURBANCES.values():
        one, two, other = (changed(photo, disturbance, disturbance.levels[1], seed)[0] for seed in (3, 3, 4))
        assert np.array_equal(one, two)
        assert not np.array_equal(one, other)
    for name in ("blur", "noise", "light"):
        d = DISTURBANCES[name]
        away = [np.abs(changed(photo, d, level, 0)[0].astype(float) - photo).mean() for level in d.levels]
        assert (np.diff(away) > 0).all()


def test_large_photos_are_reduced_and_small_ones_stay() -> None:
    assert max(small(np.zeros((2000, 1500), np.uint8)).shape) == LONGEST
    assert small(np.zeros((200, 150), np.uint8)).shape == (200, 150)
