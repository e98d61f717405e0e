import hashlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageOps

from graphos_core.errors import UserError
from graphos_core.images import read_photo_set, read_pixels
from graphos_core.run import Run

RUN = Run(threads=2)


def picture(height: int = 48, width: int = 64, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.integers(0, 256, (height, width, 3), dtype=np.uint8)


def save(path: Path, pixels: np.ndarray, **options: object) -> Path:
    Image.fromarray(pixels).save(path, **options)
    return path


def exif_bytes(orientation: int = 1, **more: object) -> Image.Exif:
    exif = Image.Exif()
    exif[0x0112] = orientation
    exif[0x010F], exif[0x0110] = "NIKON CORPORATION\0\0", "NIKON D60"
    block = exif.get_ifd(0x8769)
    block[0x920A], block[0xA405] = more.get("focal", 29.0), 43
    gps = exif.get_ifd(0x8825)
    gps[1], gps[2], gps[3], gps[4] = "S", (46.0, 30.0, 36.0), "W", (91.0, 15.0, 0.0)
    gps[5], gps[6] = b"\x00", 198.5
    return exif


def test_pixels_come_back_as_stored_in_every_depth_and_channel_count(tmp_path: Path) -> None:
    import cv2

    rgb = picture()
    deep = np.random.default_rng(1).integers(0, 65536, (48, 64, 3)).astype(np.uint16)
    save(tmp_path / "rgb.png", rgb)
    save(tmp_path / "grey.tif", rgb[:, :, 0])
    save(tmp_path / "alpha.png", np.dstack([rgb[::-1], rgb[:, :, 0]]))
    save(tmp_path / "deep grey.png", deep[:, :, 0])
    for name in ("deep.tif", "deep.png"):
        (tmp_path / name).write_bytes(cv2.imencode(name[4:], deep[:, :, ::-1])[1].tobytes() + name.encode())
    found = {photo.name: photo for photo in read_photo_set(tmp_path, run=RUN).photos}
    assert {name: (p.bits, p.channels) for name, p in found.items()} == {
        "rgb.png": (8, 3),
        "grey.tif": (8, 1),
        "alpha.png": (8, 3),
        "deep grey.png": (16, 1),
        "deep.tif": (16, 3),
        "deep.png": (16, 3),
    }
    assert np.array_equal(read_pixels(found["rgb.png"]), rgb)
    assert np.array_equal(read_pixels(found["grey.tif"]), rgb[:, :, 0])
    assert np.array_equal(read_pixels(found["alpha.png"]), rgb[::-1])
    assert np.array_equal(read_pixels(found["deep grey.png"]), deep[:, :, 0])
    assert np.array_equal(read_pixels(found["deep.tif"]), deep)
    assert np.array_equal(read_pixels(found["deep.png"]), deep)
    luma = rgb @ np.array([0.299, 0.587, 0.114])
    assert np.abs(read_pixels(found["rgb.png"], grey=True) - luma).max() <= 0.51
    assert read_pixels(found["deep.png"], grey=True).dtype == np.uint16


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("ending", ["tif", "png"])
def test_every_orientation_flag_is_respected_in_tiff_and_png(
    tmp_path: Path, orientation: int, ending: str
) -> None:
    path = tmp_path / f"a.{ending}"
    save(path, picture(), exif=exif_bytes(orientation))
    (photo,) = read_photo_set(tmp_path, run=RUN).photos
    with Image.open(path) as image:
        upright = np.asarray(ImageOps.exif_transpose(image))
    assert (photo.height, photo.width) == upright.shape[:2]
    assert np.array_equal(read_pixels(photo), upright)


@pytest.mark.parametrize("orientation", range(1, 9))
def test_every_orientation_flag_gives_the_upright_photo(tmp_path: Path, orientation: int) -> None:
    upright = np.zeros((40, 60, 3), np.uint8)
    upright[:10, :20] = 255  # bright in the upper left
    upright[30:, :20] = 128
    undo = {2: Image.Transpose.FLIP_LEFT_RIGHT, 3: Image.Transpose.ROTATE_180, 4: Image.Transpose.FLIP_TOP_BOTTOM,
            5: Image.Transpose.TRANSPOSE, 6: Image.Transpose.ROTATE_90, 7: Image.Transpose.TRANSVERSE,
            8: Image.Transpose.ROTATE_270}  # fmt: skip
    stored = Image.fromarray(upright)
    if orientation > 1:
        stored = stored.transpose(undo[orientation])
    stored.save(tmp_path / "a.jpg", exif=exif_bytes(orientation), quality=95)
    (photo,) = read_photo_set(tmp_path, run=RUN).photos
    assert (photo.width, photo.height, photo.exif.orientation) == (60, 40, orientation)
    assert np.abs(read_pixels(photo).astype(int) - upright).max() < 20


def test_exif_gives_maker_focal_length_and_position(tmp_path: Path) -> None:
    Image.fromarray(picture()).save(tmp_path / "a.jpg", exif=exif_bytes())
    photos = read_photo_set(tmp_path, run=RUN)
    exif = photos.photos[0].exif
    assert (exif.make, exif.model, exif.focal_mm, exif.focal_35mm) == (
        "NIKON CORPORATION",
        "NIKON D60",
        29,
        43,
    )
    assert exif.latitude_deg == pytest.approx(-46.51)
    assert exif.longitude_deg == pytest.approx(-91.25)
    assert exif.altitude_m == 198.5
    assert photos.cameras[0].label == "NIKON D60, 29 mm"


def test_photos_of_one_camera_and_size_share_a_camera(tmp_path: Path) -> None:
    for name, focal, seed in (("a.jpg", 29.0, 0), ("b.jpg", 29.0, 1), ("c.jpg", 35.0, 2)):
        Image.fromarray(picture(seed=seed)).save(tmp_path / name, exif=exif_bytes(focal=focal))
    Image.fromarray(picture(64, 48)).save(tmp_path / "d.jpg", exif=exif_bytes())
    photos = read_photo_set(tmp_path, run=RUN)
    assert [photo.camera for photo in photos.photos] == [0, 0, 1, 2]
    assert len({camera.label for camera in photos.cameras}) == 3
    assert np.array_equal(photos.cameras[0].values[1:], [31.5, 23.5, 0, 0])


def test_bad_files_are_named_with_a_reason_and_the_good_ones_are_kept(tmp_path: Path) -> None:
    good = save(tmp_path / "Straße 1 ß.jpg", picture(), quality=90)
    before = hashlib.sha256(good.read_bytes()).hexdigest()
    content = save(tmp_path / "large.jpg", picture(400, 400, seed=3)).read_bytes()
    (tmp_path / "truncated.jpg").write_bytes(content[: len(content) // 2])
    (tmp_path / "truncated.png").write_bytes(save(tmp_path / "p.png", picture(seed=4)).read_bytes()[:2000])
    (tmp_path / "text.jpg").write_text("this is a text")
    (tmp_path / "empty.jpg").write_bytes(b"")
    (tmp_path / "twin.jpg").write_bytes(good.read_bytes())
    (tmp_path / "raw.NEF").write_bytes(b"II*\0")
    (tmp_path / ".hidden.jpg").write_bytes(b"")
    (tmp_path / "notes.txt").write_text("passed over")
    Image.fromarray(picture(64, 64)).convert("LAB").save(tmp_path / "lab.tif")
    Image.new("RGB", (64, 8)).save(tmp_path / "strip.png")
    (tmp_path / "sub").mkdir()
    save(tmp_path / "sub" / "below.jpg", picture(seed=9))
    photos = read_photo_set(tmp_path, run=RUN)
    assert [photo.name for photo in photos.photos] == ["Straße 1 ß.jpg", "large.jpg", "p.png"]
    assert photos.photos[0].digest == before == hashlib.sha256(good.read_bytes()).hexdigest()
    reasons = {failure.item: failure.reason for failure in photos.failures}
    expected = {"truncated.jpg": "incomplete", "truncated.png": "incomplete", "text.jpg": "no JPEG",
                "empty.jpg": "zero bytes", "twin.jpg": "same file as Straße 1 ß.jpg", "raw.NEF": ".nef files",
                "lab.tif": "CIELAB", "strip.png": "too small"}  # fmt: skip
    assert reasons.keys() == expected.keys()
    for name, words in expected.items():
        assert words in reasons[name], (name, reasons[name])


def test_a_file_that_claims_a_huge_size_is_not_opened(tmp_path: Path) -> None:
    import struct
    import zlib

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    for name, side in (("bomb.png", 60_000), ("big.png", 17_000)):
        header = chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0))
        body = header + chunk(b"IDAT", zlib.compress(bytes(1000))) + chunk(b"IEND", b"")
        (tmp_path / name).write_bytes(b"\x89PNG\r\n\x1a\n" + body)
    save(tmp_path / "good.png", picture())
    with pytest.warns(Image.DecompressionBombWarning):
        photos = read_photo_set(tmp_path, run=RUN)
    assert [failure.item for failure in photos.failures] == ["big.png", "bomb.png"]
    assert all("250 million pixels" in failure.reason for failure in photos.failures)


def test_folders_without_photos_are_refused_with_what_why_and_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="does not exist"):
        read_photo_set(tmp_path / "nowhere", run=RUN)
    with pytest.raises(UserError, match=r"no photos in the folder.*empty.*Choose a folder"):
        read_photo_set(tmp_path, run=RUN)
    (tmp_path / "readme.md").write_text("x")
    with pytest.raises(UserError, match=r"no photos in the folder.*1 other"):
        read_photo_set(tmp_path, run=RUN)
    (tmp_path / "a.jpg").write_text("x")
    with pytest.raises(UserError, match=r"None of the 1 files.*a\.jpg"):
        read_photo_set(tmp_path, run=RUN)
    with pytest.raises(UserError, match="no photos"):
        read_photo_set([], run=RUN)


def test_a_list_of_files_is_taken_from_several_folders_but_names_must_differ(tmp_path: Path) -> None:
    (tmp_path / "x").mkdir()
    files = [save(tmp_path / "x" / "b.png", picture()), save(tmp_path / "a.png", picture(seed=1))]
    assert [photo.name for photo in read_photo_set(files, run=RUN).photos] == ["a.png", "b.png"]
    with pytest.raises(UserError, match="same name"):
        read_photo_set([*files, save(tmp_path / "b.png", picture(seed=2))], run=RUN)


def test_a_photo_that_vanished_or_changed_is_said_so(tmp_path: Path) -> None:
    path = save(tmp_path / "a.png", picture())
    (photo,) = read_photo_set(tmp_path, run=RUN).photos
    save(path, picture(50, 64))
    with pytest.raises(UserError, match="another size"):
        read_pixels(photo)
    path.unlink()
    with pytest.raises(UserError, match=r"a\.png cannot be read"):
        read_pixels(photo)


def test_the_result_does_not_depend_on_the_number_of_threads(tmp_path: Path) -> None:
    for seed in range(6):
        save(tmp_path / f"{seed}.png", picture(seed=seed % 4))
    one, two = (read_photo_set(tmp_path, run=Run(threads=threads)) for threads in (1, 2))
    assert [photo.digest for photo in one.photos] == [photo.digest for photo in two.photos]
    assert one.failures == two.failures
