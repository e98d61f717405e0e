"""Control point files: what people write is read, and what cannot be read is named by its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from graphos_core.errors import UserError
from graphos_core.exchange.control import read_control


def write(folder: Path, text: str, name: str = "control.csv") -> Path:
    path = folder / name
    path.write_text(text, "utf-8")
    return path


def test_control_and_the_measurements_beside_it(tmp_path: Path) -> None:
    path = write(tmp_path, "name,x,y,z,role\nA,1,2,3,control\nB,4,5,6,check\nC,7,8,9,\n")
    write(
        tmp_path, "photo,name,x,y\na.jpg,A,10.5,20\nb.jpg,A,11,21\nb.jpg,D,5,6\n", "control_measurements.csv"
    )
    control, measured = read_control(path)
    assert control is not None and measured is not None
    assert control.names == ("A", "B", "C", "D")
    assert control.xyz[:3].tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert np.isnan(control.xyz[3]).all()
    assert control.check.tolist() == [False, True, False, True]
    assert measured.point.tolist() == [0, 0, 3]
    assert measured.photo == ("a.jpg", "b.jpg", "b.jpg")
    assert measured.xy.tolist() == [[10.5, 20], [11, 21], [5, 6]]


def test_semicolons_decimal_commas_synonyms_units_and_comments(tmp_path: Path) -> None:
    text = "\ufeff# surveyed 2024\nPoint;Easting [mm];Northing [mm];Height [mm];Type\n\nMarké 1;1500,5;2000;0;GCP # edge\n"
    control, measured = read_control(write(tmp_path, text))
    assert control is not None and measured is None
    assert control.names == ("Marké 1",)
    np.testing.assert_allclose(control.xyz, [[1.5005, 2.0, 0.0]])


def test_units_in_a_row_and_both_tables_in_one_file(tmp_path: Path) -> None:
    text = "id\tx\ty\tz\n-\tcm\tcm\tcm\nP\t100\t200\t300\nphoto\tid\tu\tv\np.jpg\tP\t1\t2\n"
    control, measured = read_control(write(tmp_path, text, "c.txt"))
    assert control is not None and measured is not None
    np.testing.assert_allclose(control.xyz, [[1.0, 2.0, 3.0]])
    assert measured.xy.tolist() == [[1, 2]]


def test_large_coordinates_get_a_local_origin_that_loses_nothing(tmp_path: Path) -> None:
    text = "name,x,y,z\nA,500123.456,5812345.678,34.5\nB,500223.456,5812445.678,35.5\n"
    control, _ = read_control(write(tmp_path, text))
    assert control is not None
    assert control.origin.tolist() == [500200.0, 5812400.0, 0.0]
    assert np.abs(control.xyz).max() < 200
    np.testing.assert_allclose(
        control.xyz + control.origin, [[500123.456, 5812345.678, 34.5], [500223.456, 5812445.678, 35.5]]
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("A,1,2,3\n", "Line 1 is not a header"),
        ("name,x,y\nA,1,2\n", "line 1.*no column z"),
        ("name,x,y,z\nA,1,2,3\n\nB,1,two,3\n", "line 4.*y is “two”"),
        ("name,x,y,z\nA,1,2\n", "line 2.*z is missing"),
        ("name,x,y,z\nA,1,2,nan\n", "line 2.*not a number"),
        ("name,x,y,z\nA,1,2,3\nA,1,2,3\n", "line 3.*twice"),
        ("name,x,y,z\n,1,2,3\n", "line 2.*name of the point is missing"),
        ("name,x,y,z,role\nA,1,2,3,hero\n", "line 2.*neither control, check nor off"),
        ("photo,name,x,y\na.jpg,A,1,2\na.jpg,A,1,2\n", "line 3.*measured twice"),
        ("photo,name,x,y\n,A,1,2\n", "line 2.*photo is missing"),
        ("name,x [ft],y [ft],z [ft]\nA,1,2,3\n", "line 1.*unit of x is “ft”"),
        ("name,x,y,z [px]\nA,1,2,3\n", "line 1.*unit of z is “px”"),
        ("photo,name,x [mm],y [mm]\na.jpg,A,1,2\n", "line 1.*unit of x is “mm”"),
        ("photo,name,x,y\n-,-,mm,mm\na.jpg,A,1,2\n", "line 2.*x is “mm”, not a number"),
    ],
)
def test_a_bad_line_is_named(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(UserError, match=said):
        read_control(write(tmp_path, text))


def test_a_missing_and_an_empty_file(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="could not be read"):
        read_control(tmp_path / "absent.csv")
    assert read_control(write(tmp_path, "# nothing\n")) == (None, None)
