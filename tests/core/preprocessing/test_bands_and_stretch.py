"""Band choice and radiometric stretch, with second views made by a known homography and fresh noise."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.errors import UserError
from graphos_core.preprocessing.bands import BandsParams, bands
from graphos_core.preprocessing.grey import eight_bit, luma
from graphos_core.preprocessing.noise import noise_level
from graphos_core.preprocessing.stretch import StretchParams, stretch, stretch_choice
from graphos_core.registry import find
from graphos_core.run import Run

RUN = Run()
H = np.array([[1.02, 0.14, -30.0], [-0.12, 1.05, 25.0], [5e-5, -4e-5, 1.0]])


def test_each_choice_of_bands_gives_what_it_says() -> None:
    image = np.random.default_rng(0).integers(0, 256, (30, 40, 5), dtype=np.uint8)
    assert np.array_equal(bands(image, BandsParams(choice="first"), run=RUN), image[:, :, 0])
    assert np.array_equal(bands(image, BandsParams(choice="number", number=4), run=RUN), image[:, :, 3])
    mean = bands(image, BandsParams(choice="mean"), run=RUN)
    assert np.abs(mean - image.astype(float).mean(axis=2)).max() <= 0.51
    index = bands(image, BandsParams(choice="index", infrared=5, red=2), run=RUN).astype(float)
    a, b = image[:, :, 4].astype(float), image[:, :, 1].astype(float)
    assert np.abs(index - 127.5 * (1 + (a - b) / np.maximum(a + b, 1))).max() <= 0.51
    assert bands(image, BandsParams(), run=RUN).shape == (30, 40)
    with pytest.raises(UserError, match="Band 6 was asked for, but the photo has 5"):
        bands(image, BandsParams(choice="number", number=6), run=RUN)


def infrared(seed: int = 0) -> np.ndarray:
    """16 bit: weak texture over slow changes, one hot spot, noise of 9 values."""
    rng = np.random.default_rng(seed)
    small = rng.normal(0, 60, (64, 80))
    texture = cv2.resize(small, (320, 256), interpolation=cv2.INTER_CUBIC)
    slow = 1500 * np.sin(np.linspace(0, 3, 320))[None] + 800 * np.cos(np.linspace(0, 2, 256))[:, None]
    values = 16000 + slow + texture
    values[20:40, 30:50] += 9000
    return values


def views(scene: np.ndarray, noise: float, kind: type = np.uint16) -> tuple[np.ndarray, np.ndarray]:
    """Two photos of a scene with noise of their own; the second through H."""
    rng = np.random.default_rng(5)
    size = (scene.shape[1], scene.shape[0])
    second = cv2.warpPerspective(scene, H, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    top = np.iinfo(kind).max
    one, two = (
        np.clip(np.rint(v + rng.normal(0, noise, v.shape)), 0, top).astype(kind) for v in (scene, second)
    )
    return one, two


def right_matches(a: np.ndarray, b: np.ndarray) -> tuple[int, int]:
    """Candidate matches of the default SIFT, and those within 3 px of the true homography."""
    sift, mutual = find("features", "sift"), find("features", "mutual")
    found = [sift.function(v, v, sift.params(), run=RUN) for v in (a, b)]
    made = mutual.function(*found, mutual.params(), run=RUN)
    matches = made.matches
    if not len(matches):
        return 0, 0
    xy = cv2.perspectiveTransform(found[0].xy[matches[:, 0]][None].astype(np.float64), H)[0]
    return len(matches), int((np.linalg.norm(xy - found[1].xy[matches[:, 1]], axis=1) < 3).sum())


def test_weak_texture_under_a_hot_spot_gives_many_times_the_matches_and_they_are_right() -> None:
    a, b = views(infrared(), 9.0)
    _, plain = right_matches(eight_bit(a), eight_bit(b))
    total, made = right_matches(*(stretch(v, StretchParams(), run=RUN) for v in (a, b)))
    assert made >= 4 * max(plain, 20)
    assert made >= 0.95 * total


def test_the_choice_follows_from_noise_and_texture_and_says_so() -> None:
    quiet, loud = (stretch_choice(views(infrared(), s)[0], StretchParams()) for s in (3.0, 60.0))
    scale = 255.0 / (quiet.high - quiet.low)
    assert quiet.noise == pytest.approx(3.0 * scale, rel=0.2)
    assert quiet.blur == 0.0 < loud.blur and loud.gain < quiet.gain
    assert quiet.window and "weak" in quiet.reason and f"{quiet.noise:.2f}" in quiet.reason
    strong = np.random.default_rng(0).integers(0, 2, (40, 50)).repeat(6, 0).repeat(6, 1) * 200
    assert stretch_choice(strong.astype(np.uint8), StretchParams()).window == 0


def test_photos_that_are_nearly_alike_are_treated_nearly_alike() -> None:
    choices = [stretch_choice(views(infrared(), s)[0], StretchParams()) for s in np.linspace(3, 60, 12)]
    blur = np.array([c.blur for c in choices])
    assert blur[0] == 0 and blur[-1] > 0.5 and np.diff(blur).max() < 0.35


def test_a_stretch_without_local_equalisation_is_linear_between_its_ends() -> None:
    ramp = np.tile(np.linspace(3000, 5000, 201).astype(np.uint16), (50, 1))
    made = stretch(ramp, StretchParams(clip=0.0, local="no", smooth="no"), run=RUN)
    assert np.abs(made[0] - np.linspace(0, 255, 201)).max() <= 0.51
    assert np.ptp(stretch(np.full((40, 40), 9, np.uint16), StretchParams(), run=RUN)) == 0


def radiometric(path: Path) -> np.ndarray:
    """The sensor's values of a thermal JPEG, kept in its APP3 segments, uint16 (512, 640)."""
    data, at, kept = path.read_bytes(), 2, b""
    while data[at] == 0xFF and data[at + 1] != 0xDA:
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if data[at + 1] == 0xE3:
            kept += data[at + 4 : at + 2 + length]
        at += 2 + length
    return np.frombuffer(kept, "<u2").reshape(512, 640)


@pytest.mark.data
@pytest.mark.parametrize("name", ["DJI_0002_R.JPG", "DJI_0003_R.JPG"])
def test_real_thermal_photos_give_four_times_the_matches(data_dir: Path, name: str) -> None:
    """A second view by a known homography: the scene smoothed, both views with fresh noise as strong as measured."""
    values = radiometric(data_dir / "thermal" / name)
    scene = cv2.GaussianBlur(values.astype(np.float32), (0, 0), 1.0)
    a, b = views(scene, noise_level(values))
    _, plain = right_matches(eight_bit(a), eight_bit(b))
    total, made = right_matches(*(stretch(v, StretchParams(), run=RUN) for v in (a, b)))
    assert made >= 4 * plain and made >= 0.98 * total


@pytest.mark.data
def test_the_four_thermal_photos_show_four_places_and_the_program_says_so(data_dir: Path) -> None:
    from itertools import combinations

    from graphos_core.images import read_photo_set, read_pixels

    photos = read_photo_set(data_dir / "thermal", run=RUN)
    sift, mutual, usac = (find("features", n) for n in ("sift", "mutual", "usac"))
    for make in (
        lambda image: eight_bit(luma(image)),
        lambda image: stretch(image, StretchParams(), run=RUN),
    ):
        features = [
            sift.function(grey, grey, sift.params(), run=RUN)
            for grey in (make(read_pixels(photo)) for photo in photos.photos)
        ]
        for i, j in combinations(range(4), 2):
            candidates = mutual.function(features[i], features[j], mutual.params(), run=RUN)
            pair = usac.function(
                (i, j), features[i], features[j], candidates, (photos.cameras[0],) * 2, usac.params(), run=RUN
            )
            assert len(pair.matches) == 0 and "matches" in pair.reason
