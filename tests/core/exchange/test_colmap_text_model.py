"""COLMAP's text model: round trip, the half pixel, and what an independent reader makes of our files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.colmap import read_colmap, write_colmap
from graphos_core.geometry.rotation import look_at

CAMERAS = (
    Camera(model="basic", width=800, height=600, values=np.array([900.0, 401.5, 297.25, -0.08, 0.03])),
    Camera(model="pinhole", width=640, height=480, values=np.array([700.0, 319.5, 239.5])),
)


def small_block(noise_px: float = 0.3) -> Block:
    """Four photos by two cameras, the third photo not oriented."""
    rng = np.random.default_rng(5)
    points = rng.uniform(-1, 1, (40, 3))
    centres = np.array([[-2.0, -6, 0], [0, -6.5, 0.5], [0, 0, 0], [2, -6, -0.4]])
    rotations = np.stack([look_at(c, np.zeros(3)) if i != 2 else np.eye(3) for i, c in enumerate(centres)])
    camera_of_photo = np.array([0, 1, 0, 1], dtype=np.int32)
    photo, point, xy = [], [], []
    for p in range(40):
        for i in (0, 1, 3):
            exact = pixel_from_ray(CAMERAS[camera_of_photo[i]], (points[p] - centres[i]) @ rotations[i].T)[0]
            photo.append(i)
            point.append(p)
            xy.append(exact + rng.normal(0, noise_px, 2))
    return Block(
        cameras=CAMERAS,
        names=("a.jpg", "sub/ü b.jpg", "c.jpg", "d.jpg"),
        camera_of_photo=camera_of_photo,
        oriented=np.array([True, True, False, True]),
        rotations=rotations,
        centres=centres,
        points=points,
        colours=rng.integers(0, 256, (40, 3)).astype(np.uint8),
        point_track=np.arange(40, dtype=np.int32),
        obs_photo=np.array(photo, dtype=np.int32),
        obs_point=np.array(point, dtype=np.int32),
        obs_xy=np.array(xy),
    )


def test_a_block_comes_back_from_its_export(tmp_path: Path) -> None:
    block = small_block()
    write_colmap(block, tmp_path / "colmap")
    back = read_colmap(tmp_path / "colmap")
    order = [back.names.index(name) for name in ("a.jpg", "sub/ü b.jpg", "d.jpg")]
    assert len(back.names) == 3
    np.testing.assert_allclose(back.centres[order], block.centres[block.oriented], atol=1e-12)
    np.testing.assert_allclose(back.rotations[order], block.rotations[block.oriented], atol=1e-12)
    assert np.array_equal(back.points, block.points) and np.array_equal(back.colours, block.colours)
    for camera, written in zip(back.cameras, CAMERAS, strict=True):
        assert (camera.model, camera.width, camera.height) == (written.model, written.width, written.height)
        np.testing.assert_allclose(camera.values, written.values, rtol=0, atol=1e-9)
    theirs = {
        (back.names[i], p): xy
        for i, p, xy in zip(back.obs_photo, back.obs_point, back.obs_xy.tolist(), strict=True)
    }
    for i, p, xy in zip(block.obs_photo, block.obs_point, block.obs_xy, strict=True):
        np.testing.assert_allclose(theirs[block.names[i], p], xy, atol=1e-9)
    key = back.obs_point.astype(int) * 10 + back.obs_photo
    assert (np.diff(key) > 0).all()


def test_a_pixel_grid_is_half_a_pixel_further_in_the_file(tmp_path: Path) -> None:
    block = small_block()
    grid = np.stack(np.meshgrid(np.arange(0, 800, 100.0), np.arange(0, 500, 100.0)), axis=-1).reshape(-1, 2)
    one = replace(
        block, obs_photo=np.zeros(40, np.int32), obs_point=np.arange(40, dtype=np.int32), obs_xy=grid
    )
    write_colmap(one, tmp_path)
    line = next(t for t in (tmp_path / "images.txt").read_text().splitlines() if t.startswith("0.5 0.5 "))
    np.testing.assert_array_equal(np.array(line.split(), dtype=float).reshape(-1, 3)[:, :2], grid + 0.5)
    camera = (tmp_path / "cameras.txt").read_text().splitlines()[2].split()
    assert camera == ["1", "RADIAL", "800", "600", "900.0", "402.0", "297.75", "-0.08", "0.03"]


def test_an_independent_reader_finds_the_same_reprojection_errors(tmp_path: Path) -> None:
    pycolmap = pytest.importorskip("pycolmap")
    block = small_block()
    write_colmap(block, tmp_path)
    model = pycolmap.Reconstruction(str(tmp_path))
    assert model.num_reg_images() == 3 and model.num_points3D() == 40
    written = {n: point.error for n, point in model.points3D.items()}
    model.update_point_3d_errors()
    for number, point in model.points3D.items():
        own = []
        for k in np.flatnonzero(block.obs_point == number - 1):
            i = block.obs_photo[k]
            camera = (block.points[number - 1] - block.centres[i]) @ block.rotations[i].T
            own.append(
                np.linalg.norm(pixel_from_ray(CAMERAS[block.camera_of_photo[i]], camera)[0] - block.obs_xy[k])
            )
        assert written[number] == pytest.approx(np.mean(own), abs=1e-9)
        assert point.error == pytest.approx(np.mean(own), abs=1e-6)


@pytest.mark.parametrize(
    ("model", "numbers", "values"),
    [
        ("SIMPLE_RADIAL", "500 320 240 0.1", [500, 319.5, 239.5, 0.1, 0]),
        ("PINHOLE", "500 500 320 240", [500, 319.5, 239.5]),
        ("SIMPLE_PINHOLE", "500 320 240", [500, 319.5, 239.5]),
    ],
)
def test_other_models_are_read(tmp_path: Path, model: str, numbers: str, values: list[float]) -> None:
    write_colmap(small_block(), tmp_path)
    (tmp_path / "cameras.txt").write_text(f"# c\n1 {model} 640 480 {numbers}\n2 {model} 640 480 {numbers}\n")
    assert read_colmap(tmp_path).cameras[0].values.tolist() == values


def test_two_principal_distances_are_read_exactly(tmp_path: Path) -> None:
    write_colmap(small_block(), tmp_path)
    (tmp_path / "cameras.txt").write_text(
        "1 PINHOLE 640 480 500 520 320 240\n2 PINHOLE 640 480 500 520 320 240\n"
    )
    ray = np.array([[0.2, -0.3, 2.0]])
    np.testing.assert_allclose(
        pixel_from_ray(read_colmap(tmp_path).cameras[0], ray)[0], [369.5, 161.5], atol=1e-7
    )


def test_a_second_observation_of_a_point_in_a_photo_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "cameras.txt").write_text("1 SIMPLE_PINHOLE 640 480 500 320 240\n")
    (tmp_path / "images.txt").write_text(
        "1 1 0 0 0 0 0 0 1 a.jpg\n10 20 7 30 40 7 50 60 -1\n2 1 0 0 0 1 0 0 1 b.jpg\n\n"
    )
    (tmp_path / "points3D.txt").write_text("7 0 0 5 1 2 3 0.5 1 0 1 1\n")
    block = read_colmap(tmp_path)
    assert block.names == ("a.jpg", "b.jpg")
    assert block.obs_xy.tolist() == [[9.5, 19.5]]
    assert block.centres[1].tolist() == [-1, 0, 0]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("cameras.txt", "1 EUCM 640 480 1 2 3\n", "EUCM is not supported"),
        ("cameras.txt", "1 RADIAL 640 480 500 320 240\n", "Line 1"),
        ("images.txt", "# i\n1 1 0 0 0 0 0 zero 1 a.jpg\n\n", "Line 2"),
        ("images.txt", "1 1 0 0 0 0 0 0 9 a.jpg\n\n", "Line 1"),
        ("images.txt", "1 1 0 0 0 0 0 0 1 a.jpg\n1 2\n", "Line 1"),
        ("points3D.txt", "1 0 0 inf 0 0 0 0\n", "Line 1"),
        ("points3D.txt", "1 0 0 0 0 0 300 0\n", "Line 1"),
    ],
)  # fmt: skip
def test_a_damaged_model_is_refused(tmp_path: Path, name: str, text: str, said: str) -> None:
    write_colmap(small_block(), tmp_path)
    (tmp_path / name).write_text(text)
    with pytest.raises(UserError, match=said):
        read_colmap(tmp_path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cameras\.txt"):
        read_colmap(tmp_path)
