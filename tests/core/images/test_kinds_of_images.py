"""Every kind of picture a camera, scanner or geographic program writes: what is read, and what is said about it."""

import hashlib
import io
from pathlib import Path

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image, ImageOps

from graphos_core.bands import visible
from graphos_core.data import Photo
from graphos_core.images import read_photo_set, read_pixels, read_shown
from graphos_core.registry import Algorithm, algorithms
from graphos_core.run import Run

RUN = Run(threads=2)


def smooth(height: int = 48, width: int = 64, seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).normal(size=(height, width, 3))
    blurred = cv2.GaussianBlur(noise, (0, 0), 5)
    return cv2.normalize(blurred, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)  # type: ignore[call-overload]


def only(folder: Path) -> Photo:
    photos = read_photo_set(folder, run=RUN)
    assert not photos.failures, photos.failures
    (photo,) = photos.photos
    return photo


@pytest.mark.parametrize("planar", ["contig", "separate"])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("bands", [2, 4, 5, 10])
def test_multiband_tiff_comes_back_band_by_band(tmp_path: Path, bands: int, dtype: type, planar: str) -> None:
    values = np.random.default_rng(bands).integers(0, np.iinfo(dtype).max, (40, 60, bands)).astype(dtype)
    stored = values if planar == "contig" else np.moveaxis(values, 2, 0)
    tifffile.imwrite(tmp_path / "a.tif", stored, photometric="minisblack", planarconfig=planar, compression="zlib",
                     extrasamples=["unspecified"] * (bands - 1))  # fmt: skip
    photo = only(tmp_path)
    assert (photo.bits, photo.channels, photo.remarks) == (8 * values.itemsize, bands, ())
    assert np.array_equal(read_pixels(photo), values)


def test_separate_planes_of_rgb_are_not_mixed_up(tmp_path: Path) -> None:
    deep = np.random.default_rng(1).integers(0, 65536, (40, 60, 3)).astype(np.uint16)
    tifffile.imwrite(tmp_path / "a.tif", np.moveaxis(deep, 2, 0), photometric="rgb", planarconfig="separate")
    assert np.array_equal(read_pixels(only(tmp_path)), deep)


def test_false_colours_follow_the_documented_rule() -> None:
    image = np.arange(6, dtype=np.uint8) * np.ones((2, 3, 1), np.uint8)
    assert visible(image)[0, 0].tolist() == [2, 1, 0]
    assert visible(image[:, :, :4])[0, 0].tolist() == [0, 1, 2]
    assert visible(image[:, :, :2])[0, 0].tolist() == [0, 1, 1]
    assert visible(image[:, :, 0]).ndim == 2


def test_float_values_are_stretched_linearly_and_nan_is_masked_counted_and_said(tmp_path: Path) -> None:
    celsius = np.linspace(-20.0, 45.0, 48 * 64, dtype=np.float32).reshape(48, 64)
    celsius[3:5, 10:14] = np.nan
    celsius[7, 7] = np.inf
    tifffile.imwrite(tmp_path / "thermal.tif", celsius)
    photo = only(tmp_path)
    pixels, shown = read_pixels(photo), read_shown(photo)
    assert (photo.bits, photo.channels, photo.hidden) == (16, 1, 9)
    assert shown is not None and np.array_equal(shown, np.isfinite(celsius)) and (pixels[~shown] == 0).all()
    slope, start = np.polyfit(celsius[shown].astype(float), pixels[shown].astype(float), 1)
    assert slope == pytest.approx(65534 / 65.0, rel=1e-3) and pixels[shown].min() == 1
    assert np.abs(slope * celsius[shown] + start - pixels[shown]).max() < 0.001 * 65534
    said = " ".join(photo.remarks)
    assert "9 of its pixels have no value" in said and "from -19.99" in said and "to 44.99" in said


def test_signed_counts_and_no_data_of_geographic_programs(tmp_path: Path) -> None:
    heights = np.arange(-600, -600 + 48 * 64, dtype=np.int16).reshape(48, 64)
    heights[0, :5] = -9999
    tifffile.imwrite(tmp_path / "a.tif", heights, extratags=[(42113, "s", 0, "-9999", True)])
    photo = only(tmp_path)
    assert photo.hidden == 5 and "16-bit values" in photo.remarks[-1]
    pixels = read_pixels(photo)
    assert (np.diff(pixels[1:].ravel().astype(int)) >= 0).all() and pixels[-1, -1] == 65535


def test_a_picture_of_nothing_but_nan_stays_with_everything_masked(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "a.tif", np.full((40, 50), np.nan, np.float64))
    photo = only(tmp_path)
    assert photo.hidden == 2000 and not read_pixels(photo).any()


def test_cmyk_becomes_rgb_and_is_said(tmp_path: Path) -> None:
    colours = smooth()
    for name in ("a.jpg", "b.tif"):
        Image.fromarray(colours).convert("CMYK").save(tmp_path / name, quality=95)
    photos = read_photo_set(tmp_path, run=RUN).photos
    for photo in photos:
        assert photo.channels == 3 and "CMYK" in photo.remarks[0]
        assert np.abs(read_pixels(photo).astype(int) - colours).mean() < 2.0


def test_one_bit_is_black_and_white(tmp_path: Path) -> None:
    dark = smooth()[:, :, 0] > 128
    Image.fromarray(dark).save(tmp_path / "a.png")
    Image.fromarray(~dark).save(tmp_path / "b.tif", compression="group4")
    a, b = read_photo_set(tmp_path, run=RUN).photos
    assert (a.bits, a.channels) == (b.bits, b.channels) == (8, 1)
    assert np.array_equal(read_pixels(a), dark * np.uint8(255))
    assert np.array_equal(read_pixels(b), ~dark * np.uint8(255))


@pytest.mark.parametrize("ending", ["png", "tif"])
def test_alpha_is_dropped_and_transparent_pixels_are_masked(tmp_path: Path, ending: str) -> None:
    colours = smooth()
    alpha = np.where(colours[:, :, 0] > 99, 255, 0).astype(np.uint8)
    Image.fromarray(np.dstack([colours, alpha])).save(tmp_path / f"a.{ending}")
    Image.fromarray(np.dstack([colours[:, :, 1], alpha]), "LA").save(tmp_path / f"b.{ending}")
    a, b = read_photo_set(tmp_path, run=RUN).photos
    assert (a.channels, b.channels) == (3, 1)
    assert np.array_equal(read_pixels(a), colours) and np.array_equal(read_pixels(b), colours[:, :, 1])
    for photo in (a, b):
        assert np.array_equal(read_shown(photo), alpha > 0)
        assert f"{int((alpha == 0).sum())} of its pixels are fully transparent" in photo.remarks[0]


def test_palette_and_opaque_alpha_need_no_remark(tmp_path: Path) -> None:
    palette = Image.fromarray(smooth()).quantize(32)
    for name in ("a.png", "b.tif"):
        palette.save(tmp_path / name)
    Image.fromarray(np.dstack([smooth(seed=2), np.full((48, 64), 255, np.uint8)])).save(tmp_path / "c.png")
    photos = read_photo_set(tmp_path, run=RUN).photos
    assert [p.channels for p in photos] == [3, 3, 3] and photos[2].remarks == photos[0].remarks == ()
    assert np.array_equal(read_pixels(photos[0]), np.asarray(palette.convert("RGB")))
    assert "same pixels as a.png" in photos[1].remarks[0] and read_shown(photos[2]) is None


def test_the_first_page_and_the_first_picture_of_an_animation_are_used(tmp_path: Path) -> None:
    first, second = Image.fromarray(smooth()), Image.fromarray(smooth(seed=1))
    for name in ("a.tif", "b.png"):
        first.save(tmp_path / name, save_all=True, append_images=[second, second])
    a, b = read_photo_set(tmp_path, run=RUN).photos
    assert "3 pages" in a.remarks[0] and "animated" in b.remarks[0]
    assert np.array_equal(read_pixels(a), np.asarray(first)) and np.array_equal(
        read_pixels(b), np.asarray(first)
    )


@pytest.mark.parametrize("orientation", range(1, 9))
def test_every_orientation_of_a_tiff_with_alpha_is_turned_upright(tmp_path: Path, orientation: int) -> None:
    colours = np.dstack([smooth(), np.where(np.arange(64) < 9, 0, 255) * np.ones((48, 1))]).astype(np.uint8)
    exif = Image.Exif()
    exif[0x0112] = orientation
    Image.fromarray(colours).save(tmp_path / "a.tif", exif=exif)
    photo = only(tmp_path)
    with Image.open(
        io.BytesIO((tmp_path / "a.tif").read_bytes())
    ) as image:  # by its path Pillow turns it twice
        expected = np.asarray(ImageOps.exif_transpose(image))
    assert (photo.width, photo.height, photo.exif.orientation) == (*expected.shape[1::-1], 1)
    assert np.array_equal(read_pixels(photo), expected[:, :, :3])
    assert np.array_equal(read_shown(photo), expected[:, :, 3] > 0)


def test_the_camera_of_a_multiband_tiff_is_known_from_its_header(tmp_path: Path) -> None:
    values = np.zeros((40, 60, 5), np.uint16)
    values[::2] = 9
    tags = [(271, "s", 0, "MicaSense", True), (272, "s", 0, "RedEdge-M", True)]
    tifffile.imwrite(
        tmp_path / "a.tif", values, photometric="minisblack", planarconfig="contig", extratags=tags
    )
    assert (only(tmp_path).exif.make, only(tmp_path).exif.model) == ("MicaSense", "RedEdge-M")


def test_the_same_pixels_in_other_bytes_are_told_and_others_are_not(tmp_path: Path) -> None:
    colours = smooth(96, 128)
    Image.fromarray(colours).save(tmp_path / "a.jpg", quality=90)
    (tmp_path / "b.jpg").write_bytes((tmp_path / "a.jpg").read_bytes() + b"more")
    cv2.imwrite(str(tmp_path / "c.png"), cv2.imread(str(tmp_path / "a.jpg")))
    near = np.asarray(Image.open(tmp_path / "c.png")).copy()
    near[50, 60] ^= 1
    Image.fromarray(near).save(tmp_path / "d.png")
    photos = {p.name: " ".join(p.remarks) for p in read_photo_set(tmp_path, run=RUN).photos}
    assert photos["a.jpg"] == photos["d.png"] == ""
    assert "same pixels as a.jpg" in photos["b.jpg"] and "same pixels as a.jpg" in photos["c.png"]


def test_what_cannot_be_used_is_said_in_one_sentence_and_the_set_goes_on(tmp_path: Path) -> None:
    Image.fromarray(smooth()).save(tmp_path / "good.png")
    Image.fromarray(smooth()[:, :1]).save(tmp_path / "line.png")
    tifffile.imwrite(tmp_path / "line.tif", np.zeros((400, 1), np.uint8))
    tifffile.imwrite(tmp_path / "complex.tif", np.zeros((40, 50), np.complex64))
    Image.fromarray(smooth()).convert("LAB").save(tmp_path / "lab.tif")
    whole = tmp_path / "whole.tif"
    tifffile.imwrite(whole, np.random.default_rng(0).random((60, 70)).astype(np.float32))
    (tmp_path / "cut.tif").write_bytes(whole.read_bytes()[:9000])
    (tmp_path / "cut header.tif").write_bytes(whole.read_bytes()[:6])
    whole.unlink()
    Image.fromarray(smooth()).save(tmp_path / "moving.gif")
    photos = read_photo_set(tmp_path, run=RUN)
    assert [p.name for p in photos.photos] == ["good.png"]
    reasons = {f.item: f.reason for f in photos.failures}
    expected = {"line.png": "1 × 48 pixels, needs 32", "line.tif": "1 × 400 pixels, needs 32",
                "complex.tif": "complex numbers", "lab.tif": "CIELAB", "cut.tif": "truncated",
                "cut header.tif": "damaged", "moving.gif": ".gif files"}  # fmt: skip
    assert reasons.keys() == expected.keys()
    for name, words in expected.items():
        assert words in reasons[name] and reasons[name].count(".") <= 3, (name, reasons[name])


def test_fifty_million_pixels_of_one_colour_are_read(tmp_path: Path) -> None:
    cv2.imwrite(
        str(tmp_path / "large.png"), np.full((5773, 8661), 77, np.uint8), [cv2.IMWRITE_PNG_COMPRESSION, 1]
    )
    before = hashlib.sha256((tmp_path / "large.png").read_bytes()).digest()
    photo = only(tmp_path)
    pixels = read_pixels(photo)
    assert pixels.shape == (5773, 8661) and pixels.min() == pixels.max() == 77
    assert hashlib.sha256((tmp_path / "large.png").read_bytes()).digest() == before


@pytest.mark.parametrize("algorithm", algorithms("preprocessing", "filter"), ids=lambda a: a.name)
def test_every_filter_takes_any_number_of_bands_and_gives_grey_or_rgb(algorithm: Algorithm) -> None:
    rng = np.random.default_rng(0)
    for bands in (0, 2, 3, 4, 5):
        for dtype in (np.uint8, np.uint16):
            shape = (40, 56, bands) if bands else (40, 56)
            image = rng.integers(0, np.iinfo(dtype).max, shape).astype(dtype)
            found = algorithm.function(image, algorithm.params(), run=RUN)
            assert found.dtype == np.uint8 and found.shape in ((40, 56), (40, 56, 3)), (bands, dtype)
