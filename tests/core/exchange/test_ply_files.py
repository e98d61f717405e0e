"""PLY: what is written is read again, by us and by others; damaged files are refused in sentences."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from graphos_core.data import Cloud, Mesh
from graphos_core.errors import UserError
from graphos_core.exchange.ply import read_ply, write_ply_cloud, write_ply_mesh

RNG = np.random.default_rng(0)
POINTS = RNG.normal(size=(50, 3)) + np.array([500000.0, 4500000.0, 100.0])
COLOURS = RNG.integers(0, 256, (50, 3)).astype(np.uint8)
NORMALS = RNG.normal(size=(50, 3)).astype(np.float32)


def test_a_cloud_comes_back_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "größe der wolke.ply"
    write_ply_cloud(path, POINTS, COLOURS, NORMALS, unit="m", comments=["origin 0 0 0"])
    cloud = read_ply(path)
    assert isinstance(cloud, Cloud) and cloud.unit == "m"
    for written, read in ((POINTS, cloud.points), (COLOURS, cloud.colours), (NORMALS, cloud.normals)):
        assert np.array_equal(written, read)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_an_independent_reader_reads_the_same_cloud(tmp_path: Path) -> None:
    open3d = pytest.importorskip("open3d")
    write_ply_cloud(tmp_path / "c.ply", POINTS, COLOURS, NORMALS)
    read = open3d.io.read_point_cloud(str(tmp_path / "c.ply"))
    np.testing.assert_allclose(np.asarray(read.points), POINTS)
    np.testing.assert_allclose(np.asarray(read.colors) * 255, COLOURS, atol=1e-9)
    np.testing.assert_allclose(np.asarray(read.normals), NORMALS)


def test_a_mesh_comes_back(tmp_path: Path) -> None:
    triangles = RNG.integers(0, 50, (30, 3)).astype(np.int32)
    write_ply_mesh(tmp_path / "m.ply", Mesh(vertices=POINTS, triangles=triangles, unit="m"))
    mesh = read_ply(tmp_path / "m.ply")
    assert isinstance(mesh, Mesh) and mesh.unit == "m"
    assert np.array_equal(mesh.vertices, POINTS) and np.array_equal(mesh.triangles, triangles)


def test_text_with_polygons_and_foreign_properties_is_read(tmp_path: Path) -> None:
    (tmp_path / "t.ply").write_text(
        "ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\n"
        "property float z\r\nproperty float quality\r\nelement face 2\r\nproperty list uchar int vertex_index\r\n"
        "end_header\r\n0 0 0 1\r\n1 0 0 1\r\n1 1 0 1\r\n0 1 0 1\r\n4 0 1 2 3\r\n3 0 1 2\r\n"
    )
    mesh = read_ply(tmp_path / "t.ply")
    assert isinstance(mesh, Mesh)
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 2]]


def test_big_endian_and_mixed_polygons_are_read(tmp_path: Path) -> None:
    head = (
        "ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    )
    body = np.arange(12, dtype=">f4").tobytes()
    body += (
        b"\x04" + np.arange(4, dtype=">i4").tobytes() + b"\x03" + np.array([3, 2, 1], dtype=">i4").tobytes()
    )
    (tmp_path / "b.ply").write_bytes(head.encode() + body)
    mesh = read_ply(tmp_path / "b.ply")
    assert isinstance(mesh, Mesh)
    assert mesh.vertices[3].tolist() == [9, 10, 11]
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 1]]


HEAD = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ("", "begin with"),
        ("solid cube", "begin with"),
        ("ply\nformat ascii 1.0\nelement vertex 1\n", "no end"),
        ("ply\nformat martian 1.0\nend_header\n", "martian"),
        ("ply\nelement vertex 1\nproperty float x\nend_header\n", "no format"),
        ("ply\nformat ascii 1.0\nelement vertex -4\nproperty float x\nend_header\n", "line 3"),
        ("ply\nformat ascii 1.0\nelement vertex many\nend_header\n", "line 3"),
        ("ply\nformat ascii 1.0\nproperty float x\nend_header\n", "line 3"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty quaternion x\nend_header\n", "line 4"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "x, y and z"),
        (HEAD + "property float x\nend_header\n0 0 0 0\n", "occurs twice"),
        (HEAD + "end_header\n", "ends before"),
        (HEAD + "end_header\n1 2\n", "not made of numbers"),
        (HEAD + "end_header\n1 2 three\n", "not made of numbers"),
        (HEAD.replace("ascii", "binary_little_endian").replace("vertex 1", "vertex 1999999999") + "end_header\n", "ends before"),
        (HEAD + "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n3 0 0 7\n", "does not exist"),
        (HEAD + "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n9 0 0 0\n", "not made of numbers"),
        (HEAD + "element face 1\nproperty list uchar float vertex_indices\nend_header\n1 2 3\n3 nan nan nan\n", "does not exist"),
        (HEAD + "property uchar red\nend_header\n1 2 3 300\n", "not made of numbers"),
    ],
)  # fmt: skip
def test_a_damaged_file_is_refused_with_the_reason(tmp_path: Path, content: str, why: str) -> None:
    (tmp_path / "bad.ply").write_text(content)
    with pytest.raises(UserError, match=why) as refused:
        read_ply(tmp_path / "bad.ply")
    assert refused.value.what and refused.value.why and refused.value.todo


def test_a_truncated_mesh_is_refused(tmp_path: Path) -> None:
    triangles = RNG.integers(0, 50, (30, 3)).astype(np.int32)
    write_ply_mesh(tmp_path / "m.ply", Mesh(vertices=POINTS, triangles=triangles))
    whole = (tmp_path / "m.ply").read_bytes()
    for length in range(200, len(whole), 97):
        (tmp_path / "cut.ply").write_bytes(whole[:length])
        with pytest.raises(UserError):
            read_ply(tmp_path / "cut.ply")


def test_a_missing_file_and_a_folder_in_the_way_are_said(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="could not be read"):
        read_ply(tmp_path / "absent.ply")
    (tmp_path / "folder.ply").mkdir()
    with pytest.raises(UserError, match="could not be written"):
        write_ply_cloud(tmp_path / "folder.ply", POINTS)
