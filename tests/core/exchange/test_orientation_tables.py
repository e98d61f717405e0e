"""Tables of orientations: angle orders by what they mean, guessed formats, PAT-B."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.exchange.attitudes import ORDERS, angles_from_rotation, rotation_from_angles
from graphos_core.exchange.dbat_report import read_stations
from graphos_core.exchange.orientation_table import (
    guess_orientations,
    preview,
    read_orientation_table,
    write_orientation_table,
)
from graphos_core.exchange.patb import read_patb, write_patb

CAMERA = Camera(model="pinhole", width=100, height=80, values=np.array([120.0, 49.5, 39.5]))


@pytest.mark.parametrize("order", sorted(ORDERS))
def test_angles_come_back(order):
    rng = np.random.default_rng(1)
    for _ in range(20):
        angles = rng.uniform([-3, -1.5, -3], [3, 1.5, 3])
        rotation = rotation_from_angles(*angles, order)
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(rotation) > 0
        again = angles_from_rotation(rotation, order)
        np.testing.assert_allclose(rotation_from_angles(*again, order), rotation, atol=1e-12)


def test_a_level_flight_looks_down_and_yaw_turns_clockwise():
    level = rotation_from_angles(0.0, 0.0, 0.0, "yaw pitch roll")
    np.testing.assert_allclose(level.T @ [0, 0, 1], [0, 0, -1], atol=1e-12)  # axis down
    np.testing.assert_allclose(level.T @ [0, -1, 0], [0, 1, 0], atol=1e-12)  # top of the image north
    east = rotation_from_angles(np.pi / 2, 0.0, 0.0, "yaw pitch roll")
    np.testing.assert_allclose(east.T @ [0, -1, 0], [1, 0, 0], atol=1e-12)  # flying east
    nose_up = rotation_from_angles(0.0, 0.2, 0.0, "yaw pitch roll").T @ [0, 0, 1]
    assert nose_up[1] > 0  # a raised nose makes the camera look ahead, to the north
    right_wing_down = rotation_from_angles(0.0, 0.0, 0.2, "yaw pitch roll").T @ [0, 0, 1]
    assert right_wing_down[0] < 0  # and a lowered right wing makes it look to the left
    np.testing.assert_allclose(level, rotation_from_angles(0, 0, 0, "omega phi kappa"), atol=1e-12)


def test_phi_first_tilts_about_the_fixed_y_axis():
    phi, omega = 0.3, 0.2
    axis = rotation_from_angles(phi, omega, 0.0, "phi omega kappa").T @ [0, 0, 1]
    # y of the axis depends on omega alone, because phi turns about y after it
    np.testing.assert_allclose(axis[1], np.sin(omega), atol=1e-12)
    other = rotation_from_angles(omega, phi, 0.0, "omega phi kappa").T @ [0, 0, 1]
    np.testing.assert_allclose(other[0], -np.sin(phi), atol=1e-12)


TABLES = {
    "header with units": ("Photo;X [m];Y [m];Z [m];Omega [gon];Phi [gon];Kappa [gon]\na.tif;1,5;2;3;10;20;-100\n", "gon", "omega phi kappa"),
    "phi first": ("photo,east,north,height,phi_deg,omega_deg,kappa_deg\na.tif,1.5,2,3,18,9,-90\n", "deg", "phi omega kappa"),
    "yaw": ("#Label,X/East,Y/North,Z/Altitude,Yaw,Pitch,Roll\na.tif,1.5,2,3,350,9,-9\n", "deg", "yaw pitch roll"),
    "no header": ("a.tif 1.5 2 3 0.15 0.3 -1.5\nb.tif 2 3 4 0.1 0.2 3.1\n", "rad", "omega phi kappa"),
    "gon by size": ("a.tif\t1.5\t2\t3\t0.1\t0.2\t399.2\n", "gon", "omega phi kappa"),
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(TABLES))
def test_formats_are_guessed_with_reasons(name):
    text, unit, order = TABLES[name]
    form = guess_orientations(text)
    assert (form.angle_unit, form.order) == (unit, order)
    assert set(form.reasons) == {"delimiter", "columns", "order", "angle_unit", "unit"}
    seen = preview(text, form)
    assert not seen.bad and seen.rows[0].name == "a.tif"
    np.testing.assert_allclose(seen.rows[0].xyz, [1.5, 2, 3])


def test_a_bad_line_is_named_and_the_rest_read(tmp_path):
    path = tmp_path / "eo.csv"
    path.write_text(
        "photo,x,y,z,omega,phi,kappa\na,1,2,3,4,5,90\nb,1,2,nan,4,5,6\nc,1,2,3,4,five,6\nd,1,2,3,4,5,6\na,0,0,0,0,0,0\n"
    )
    found = read_orientation_table(path, CAMERA)
    assert found.block.names == ("a", "d")
    said = " ".join(found.remarks)
    assert "Line 3" in said and "Line 4" in said and "Line 6" in said and "twice" in said
    path.write_text("nothing here\n")
    with pytest.raises(UserError, match="holds no orientations"):
        read_orientation_table(path, CAMERA)


@pytest.mark.parametrize("order", sorted(ORDERS))
@pytest.mark.parametrize("unit", ["deg", "gon", "rad"])
def test_tables_come_back(tmp_path, block_of, order, unit):
    block = block_of()
    path = tmp_path / "eo.csv"
    write_orientation_table(block, path, order=order, angle_unit=unit)
    form = guess_orientations(path.read_text())
    assert (form.order, form.angle_unit) == (order, unit)
    back = read_orientation_table(path, CAMERA).block
    assert back.names == ("a.jpg", "b b.jpg", "d.jpg")
    np.testing.assert_allclose(back.rotations, block.rotations[block.oriented], atol=1e-12)
    np.testing.assert_allclose(back.centres, block.centres[block.oriented], atol=1e-12)


@pytest.mark.data
def test_angles_of_another_program_are_read_as_it_means_them(data_dir, tmp_path):
    """DBAT's table of stations against its report: the same photos, the angles in degrees."""
    folder = data_dir / "dbat" / "camcaldemo" / "result"
    rows = [
        line.split(",")
        for line in (folder / "camera_stations.txt").read_text().splitlines()
        if line[0] != "#"
    ]
    lines = ["photo,x,y,z,omega,phi,kappa", *(",".join([row[-1].strip(), *row[2:8]]) for row in rows)]
    path = tmp_path / "stations.csv"
    path.write_text("\n".join(lines))
    block = read_orientation_table(path, CAMERA).block
    stations = read_stations(folder / "report.txt")
    assert len(stations) == 21 == len(block.names)
    for i, station in enumerate(stations):
        np.testing.assert_allclose(
            block.rotations[i], rotation_from_angles(*station.opk, "omega phi kappa"), atol=1e-6
        )
        np.testing.assert_allclose(block.centres[i], station.centre, atol=1e-5)


def test_patb_has_three_records_per_photo(tmp_path, block_of):
    block = block_of()
    path = tmp_path / "block.ori"
    write_patb(block, path)
    lines = path.read_text().splitlines()
    assert [len(line.split()) for line in lines] == [4, 5, 4] * 3
    a = np.array([*lines[1].split(), *lines[2].split()], dtype=float).reshape(3, 3)
    image = np.array([0.1, 0.2, -1.0])  # x right, y up, z backward
    np.testing.assert_allclose(a @ image, block.rotations[0].T @ [0.1, -0.2, 1.0], atol=1e-9)
    back = read_patb(path, CAMERA, transposed=False)
    np.testing.assert_allclose(back.block.rotations, block.rotations[block.oriented], atol=1e-9)
    np.testing.assert_allclose(back.block.centres, block.centres[block.oriented], atol=1e-5)
    path.write_text(path.read_text().replace(lines[1].split()[0], "7.0"))
    with pytest.raises(UserError, match="rotation matrix"):
        read_patb(path, CAMERA)
