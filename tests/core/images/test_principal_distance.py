from pathlib import Path

import pytest

from graphos_core.data import Exif
from graphos_core.images import read_photo_set
from graphos_core.principal_distance import camera_table, principal_distance
from graphos_core.run import Run


def test_a_given_value_comes_before_everything() -> None:
    exif = Exif(make="NIKON CORPORATION", model="NIKON D60", focal_mm=29.0, focal_35mm=43.0)
    found = principal_distance(exif, 1936, 1296, given_px=2435.0)
    assert (found.focal_px, found.estimated) == (2435.0, False)


def test_the_camera_table_comes_before_the_35_mm_equivalent() -> None:
    exif = Exif(make="Nikon Corporation", model="nikon d60", focal_mm=29.0, focal_35mm=43.0)
    found = principal_distance(exif, 1936, 1296)
    assert found.focal_px == pytest.approx(29.0 / 23.6 * 1936)
    assert found.pixel_pitch_mm == pytest.approx(23.6 / 1936)
    assert "camera table" in found.source


def test_a_photo_cropped_along_one_side_keeps_the_pixel_pitch() -> None:
    exif = Exif(make="Canon", model="Canon EOS 5D Mark II", focal_mm=36.0)
    for width, height in ((3600, 2400), (3600, 2025), (3200, 2400), (2400, 3200)):
        assert principal_distance(exif, width, height).focal_px == pytest.approx(3600.0)


def test_the_35_mm_equivalent_compares_diagonals() -> None:
    found = principal_distance(Exif(focal_35mm=43.2666153), 3000, 4000)
    assert found.focal_px == pytest.approx(5000.0)
    assert not found.estimated


def test_a_guess_is_flagged_and_gives_its_reason() -> None:
    nothing = principal_distance(Exif(), 1000, 1500)
    assert (nothing.focal_px, nothing.estimated) == (1800.0, True)
    assert "no EXIF focal length" in nothing.source
    unknown = principal_distance(Exif(make="Acme", model="One", focal_mm=5.0), 1000, 1500)
    assert unknown.estimated
    assert "Acme One" in unknown.source


def test_every_row_of_the_table_has_a_source_and_a_believable_sensor() -> None:
    for width, height, source in camera_table().values():
        assert source
        assert 3.0 < height < width < 60.0
        assert 1.2 < width / height < 1.6


@pytest.mark.data
def test_real_photos_get_a_principal_distance_near_the_reference(data_dir: Path) -> None:
    door = read_photo_set(data_dir / "lund_door" / "images", run=Run())
    assert len(door.photos) == 12
    assert [camera.focal_px for camera in door.cameras] == pytest.approx([2435.38], rel=0.03)
    drone = read_photo_set(data_dir / "brighton_uav6", run=Run())
    assert all(photo.exif.altitude_m is not None for photo in drone.photos)
    assert drone.photos[0].exif.latitude_deg == pytest.approx(46.8427, abs=1e-4)
    assert len(drone.cameras) == len(read_photo_set(data_dir / "banana" / "images", run=Run()).cameras) == 1
