"""Orientations of other programs: what comes back, and what each program itself would compute from our files."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import reprojection_px
from graphos_core.exchange.bundler import read_bundler, write_bundler
from graphos_core.exchange.colmap import read_colmap, write_colmap
from graphos_core.exchange.colmap_binary import read_colmap_binary, write_colmap_binary
from graphos_core.exchange.dbat_report import read_report
from graphos_core.exchange.metashape import read_metashape, write_metashape
from graphos_core.exchange.micmac import read_micmac, write_micmac
from graphos_core.exchange.nvm import read_nvm, write_nvm
from graphos_core.exchange.orientation_formats import (
    ORIENTATION_FORMATS,
    OrientationOptions,
    guess_orientation_format,
    orientation_format,
)

FISHEYE = Camera(
    model="fisheye_equidistant", width=801, height=801,
    values=np.array([260.0, 402.0, 399.0, 0.01, -0.002, 0, 0, 0, 0, 0, 0]),
)  # fmt: skip
BROWN = Camera(
    model="brown", width=801, height=601,
    values=np.array([900.0, 404.0, 297.0, -0.08, 0.03, 0.002, 0, 3e-4, -2e-4, 1e-3, 0.0]),
)  # fmt: skip


def same_poses(back, block, atol=1e-9):
    for i in np.flatnonzero(block.oriented):
        j = back.names.index(block.names[i])
        assert back.oriented[j]
        np.testing.assert_allclose(back.rotations[j], block.rotations[i], atol=atol)
        np.testing.assert_allclose(back.centres[j], block.centres[i], atol=atol)


def test_colmap_binary_is_what_pycolmap_reads_and_comes_back(tmp_path, block_of):
    pycolmap = pytest.importorskip("pycolmap")
    block = block_of((BROWN, FISHEYE))
    written = write_colmap_binary(block, tmp_path / "bin")
    assert written.max_px < 1e-6 and not written.remarks
    model = pycolmap.Reconstruction(str(tmp_path / "bin"))
    assert {c.model.name for c in model.cameras.values()} == {"RADIAL_FISHEYE", "FULL_OPENCV"}
    assert model.num_points3D() == 30 and model.num_reg_images() == 3
    model.update_point_3d_errors()
    assert max(point.error for point in model.points3D.values()) < 1e-6
    back = read_colmap_binary(tmp_path / "bin")
    same_poses(back.block, block)
    assert np.nanmax(np.abs(reprojection_px(back.block))) < 1e-6
    write_colmap(block, tmp_path / "text")
    text = read_colmap(tmp_path / "text")
    np.testing.assert_allclose(text.obs_xy, back.block.obs_xy, atol=1e-9)
    assert [c.model for c in text.cameras] == [c.model for c in back.block.cameras]


def test_panoramas_are_left_out_of_a_model_and_refused_by_the_converter(tmp_path, block_of):
    panorama = Camera(model="spherical", width=801, height=401, values=np.array([127.0, 400.0, 200.0]))
    block = block_of((block_of().cameras[0], panorama))
    write_colmap(block, tmp_path)
    assert read_colmap(tmp_path).names == ("a.jpg",)
    for write in (write_colmap_binary, write_bundler, write_nvm, write_micmac, write_metashape):
        with pytest.raises(UserError):
            write(block, tmp_path / "out")


def test_colmap_binary_written_by_pycolmap_is_read(tmp_path, block_of):
    pycolmap = pytest.importorskip("pycolmap")
    block = replace(
        block_of(), names=("a.jpg", "b.jpg", "c.jpg", "d.jpg")
    )  # its text reader cuts names at blanks
    write_colmap(block, tmp_path / "text")
    (tmp_path / "theirs").mkdir()
    pycolmap.Reconstruction(str(tmp_path / "text")).write_binary(str(tmp_path / "theirs"))
    back = read_colmap_binary(tmp_path / "theirs").block
    same_poses(back, block)
    assert np.nanmax(np.abs(reprojection_px(back))) < 1e-9


def test_bundler_formula_of_its_manual_reproduces_the_observations(tmp_path, block_of):
    block = block_of()
    written = write_bundler(block, tmp_path / "bundle.out")
    assert "no principal point" in " ".join(written.remarks)
    words = np.array((tmp_path / "bundle.out").read_text().split("\n", 1)[1].split(), dtype=float)
    cameras = words[2:47].reshape(3, 15)
    rest = words[47:]
    for _ in range(30):
        x, views = rest[:3], int(rest[6])
        for photo, _, u, v in rest[7 : 7 + 4 * views].reshape(-1, 4):
            f, k1, k2 = cameras[int(photo), :3]
            p = cameras[int(photo), 3:12].reshape(3, 3) @ x + cameras[int(photo), 12:]
            q = -p[:2] / p[2]
            r2 = q @ q
            np.testing.assert_allclose(f * (1 + k1 * r2 + k2 * r2 * r2) * q, [u, v], atol=1e-9)
        rest = rest[7 + 4 * views :]
    back = read_bundler(tmp_path / "bundle.out")
    same_poses(back.block, block)
    assert np.nanmax(np.abs(reprojection_px(back.block))) < 1e-9
    assert any("extent of the image points" in remark for remark in back.remarks)


def test_bundler_finds_the_format_in_the_photos(tmp_path, block_of):
    block = block_of((block_of().cameras[0],))
    write_bundler(block, tmp_path / "bundle.out")
    for name in block.names:
        Image.new("L", (801, 601)).save(tmp_path / name)
    back = read_bundler(tmp_path / "bundle.out")
    assert not back.remarks
    np.testing.assert_allclose(back.block.cameras[0].values, block.cameras[0].values, atol=1e-12)
    np.testing.assert_allclose(
        np.sort(back.block.obs_xy, axis=0), np.sort(block.obs_xy, axis=0), atol=1e-9
    )  # the same pixels: the half pixel of the image centre is right


def test_nvm_distortion_goes_from_measured_to_ideal(tmp_path, block_of):
    camera = Camera(model="basic", width=801, height=601, values=np.array([900.0, 400.0, 300.0, -0.02, 0.0]))
    block = block_of((camera,))
    written = write_nvm(block, tmp_path / "model.nvm")
    lines = (tmp_path / "model.nvm").read_text().splitlines()
    photos = [line.split("\t") for line in lines[3:6]]
    assert photos[1][0] == 'b"b.jpg'
    worst = 0.0
    for line in lines[8:38]:
        words = np.array(line.split(), dtype=float)
        for photo, _, u, v in words[7:].reshape(-1, 4):
            f, *rest = np.array(photos[int(photo)][1].split(), dtype=float)
            q, c, r = rest[:4], np.array(rest[4:7]), rest[7]
            w, x, y, z = q
            rotation = np.array([
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ])  # fmt: skip
            p = rotation @ (words[:3] - c)
            m = np.array([u, v]) / f
            worst = max(worst, np.abs(m * (1 + r * m @ m) - p[:2] / p[2]).max() * f)
    assert worst < written.max_px + 1e-6
    assert 0 < written.max_px < 0.05  # one backward coefficient against one forward coefficient
    back = read_nvm(tmp_path / "model.nvm")
    same_poses(back.block, block)
    assert np.nanmax(np.abs(reprojection_px(back.block))) < written.max_px + 1e-3


def test_micmac_matrix_leads_from_camera_to_world(tmp_path, block_of):
    block = block_of((BROWN, FISHEYE))
    written = write_micmac(block, tmp_path / "Ori-Test")
    text = (tmp_path / "Ori-Test" / "Orientation-b b.jpg.xml").read_text()
    rows = [np.array(text.split(f"<L{i}>")[1].split("<")[0].split(), dtype=float) for i in (1, 2, 3)]
    centre = np.array(text.split("<Centre>")[1].split("<")[0].split(), dtype=float)
    in_camera = np.array([0.1, -0.2, 3.0])
    world = np.array(rows) @ in_camera + centre  # X = R P + C
    np.testing.assert_allclose((world - block.centres[1]) @ block.rotations[1].T, in_camera, atol=1e-12)
    back = read_micmac(tmp_path / "Ori-Test")
    same_poses(back.block, block)
    for i in np.flatnonzero(block.oriented):
        mine = block.obs_photo == i
        j = back.block.names.index(block.names[i])
        rays = (block.points[block.obs_point[mine]] - back.block.centres[j]) @ back.block.rotations[j].T
        pixels = pixel_from_ray(back.block.cameras[back.block.camera_of_photo[j]], rays)
        assert np.abs(pixels - block.obs_xy[mine]).max() < written.max_px + 1e-5


def test_metashape_cameras_come_back_and_a_chunk_transform_is_applied(tmp_path, block_of):
    block = block_of((BROWN, FISHEYE))
    path = tmp_path / "cameras.xml"
    written = write_metashape(block, path)
    assert written.max_px < 1e-6
    back = read_metashape(path)
    same_poses(back.block, block)
    assert not back.block.oriented[back.block.names.index("c.jpg")]
    assert back.block.unit == "model units"
    moved = "<transform><rotation>0 -1 0 1 0 0 0 0 1</rotation><translation>10 20 30</translation><scale>2</scale></transform>"
    path.write_text(path.read_text().replace("  </chunk>", f"  {moved}</chunk>"))
    world = read_metashape(path).block
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    i = world.names.index("a.jpg")
    np.testing.assert_allclose(world.centres[i], 2 * turn @ block.centres[0] + [10, 20, 30], atol=1e-9)
    point = 2 * turn @ block.points[0] + [10, 20, 30]
    ray = world.rotations[i] @ (point - world.centres[i])
    np.testing.assert_allclose(pixel_from_ray(block.cameras[0], ray[None])[0], block.obs_xy[0], atol=1e-6)
    assert world.unit == "m"


@pytest.mark.parametrize(
    ("write", "read", "old", "new", "said"),
    [
        (write_bundler, read_bundler, "900.0 -0.08 0.03", "900.0 nan 0.03", "Line 3"),
        (write_bundler, read_bundler, "900.0 -0.08 0.03", "900.0", "Line 3"),
        (write_nvm, read_nvm, "NVM_V3 ", "NVM_V2 ", "NVM_V3"),
        (write_nvm, read_nvm, "a.jpg\t", "a.jpg\tx", "Line 4"),
        (write_metashape, read_metashape, "<f>", "<g>", "not plain XML"),
        (write_metashape, read_metashape, "<transform>", "<transform>nan ", "numbers"),
        (write_metashape, read_metashape, '<?xml version="1.0" encoding="UTF-8"?>',
         '<!DOCTYPE l [<!ENTITY x "x">]>', "not plain XML"),
        (write_metashape, read_metashape, '<calibration type="frame"', '<calibration type="rpc"', "rpc"),
    ],
)  # fmt: skip
def test_damaged_files_are_refused_with_a_sentence(tmp_path, block_of, write, read, old, new, said):
    path = tmp_path / "file.x"
    write(block_of(), path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(UserError, match=said):
        read(path)


def test_damaged_binary_models_and_folders_are_refused(tmp_path, block_of):
    write_colmap_binary(block_of(), tmp_path)
    whole = (tmp_path / "images.bin").read_bytes()
    for cut in (0, 8, 50, len(whole) - 9):
        (tmp_path / "images.bin").write_bytes(whole[:cut])
        with pytest.raises(UserError, match=r"images\.bin"):
            read_colmap_binary(tmp_path)
    (tmp_path / "images.bin").write_bytes(b"\xff" * 200)
    with pytest.raises(UserError, match=r"images\.bin"):
        read_colmap_binary(tmp_path)
    with pytest.raises(UserError, match="no orientation of MicMac"):
        read_micmac(tmp_path)


@pytest.mark.data
def test_an_export_of_photomodeler_projects_as_its_report_says(data_dir):
    folder = data_dir / "dbat" / "prague2016_sxb"
    path = folder / "pmexports" / "w-op1-no-orient-pmexport.txt"
    assert guess_orientation_format(path) == "photomodeler"
    block = orientation_format("photomodeler").read(path, OrientationOptions()).block
    assert (len(block.names), len(block.points), len(block.obs_xy)) == (5, 17, 51)
    printed = read_report(folder / "dbatexports" / "w-op1-no-orient-dbatreport.txt").point_rms_px
    rms = np.sqrt((reprojection_px(block) ** 2).sum(axis=1).mean())
    assert rms == pytest.approx(printed, abs=0.15)  # the export prints angles to 0.001°: 0.2 px here
    with pytest.raises(UserError, match="only read"):
        orientation_format("photomodeler").write(block, path, OrientationOptions())


@pytest.mark.parametrize("name", sorted(ORIENTATION_FORMATS))
def test_written_orientations_are_recognised(tmp_path, block_of, name):
    kind = ORIENTATION_FORMATS[name]
    if not kind.written:
        return
    path = tmp_path / {"patb": "b.ori", "table": "eo.csv", "micmac": "Ori-x"}.get(name, "there")
    options = OrientationOptions(camera=block_of().cameras[0])
    written = kind.write(block_of(), path, options)
    assert all(file.is_file() for file in written.files)
    assert guess_orientation_format(path) == name
    back = kind.read(path, options).block
    assert back.oriented.sum() == 3 and bool(len(back.points)) == kind.points
