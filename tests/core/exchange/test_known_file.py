"""``known.toml``: distances, positions, attitudes, shapes, rigs; and the coordinate systems behind positions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from graphos_core.data import Control, Exif, Known, Photo, PhotoSet
from graphos_core.errors import UserError
from graphos_core.exchange.control import read_control
from graphos_core.exchange.coordinates import local_tangent_frame, metric_coordinates
from graphos_core.exchange.known import __doc__ as documentation
from graphos_core.exchange.known import known_tables, read_known
from graphos_core.geometry.rotation import opk_from_matrix

ORIGIN = np.array([500000.0, 5800000.0, 0.0])
NOBODY = PhotoSet(photos=(), cameras=())


def first() -> Known:
    control = Control(names=("S1",), xyz=np.zeros((1, 3)), check=np.zeros(1, dtype=bool), origin=ORIGIN)
    return Known(control=control)


def photo(name: str, latitude: float, longitude: float, height: float) -> Photo:
    exif = Exif(latitude_deg=latitude, longitude_deg=longitude, altitude_m=height)
    return Photo(
        name=name, path=name, width=10, height=10, bits=8, channels=3, camera=0, digest=name, exif=exif
    )


def test_the_documented_file_is_read_as_it_says(tmp_path: Path) -> None:
    assert documentation is not None
    example = documentation.partition("::\n")[2].replace('source = "photos"', 'source = "gnss.csv"')
    (tmp_path / "known.toml").write_text("\n".join(line[4:] for line in example.splitlines()))
    (tmp_path / "gnss.csv").write_text("photo,x,y,z,sx,sy,sz\na.jpg,500001,5800002,3,0.1,0.1,\n")
    (tmp_path / "ins.csv").write_text("photo;omega;phi;kappa\na.jpg;1,5;-2;90\n")
    known = read_known(tmp_path / "known.toml", first(), NOBODY)
    (distance,) = known.distances
    assert (distance.a, distance.metres, distance.sigma, distance.check) == ("S1", 1.2345, 0.0005, False)
    assert known.centres is not None and known.attitudes is not None
    np.testing.assert_allclose(known.centres.xyz, [[1.0, 2.0, 3.0]])
    np.testing.assert_allclose(known.centres.sigma, [[0.1, 0.1, 5.0]])
    np.testing.assert_allclose(np.degrees(opk_from_matrix(known.attitudes.rotations[0])), [1.5, -2.0, 90.0])
    assert known.shapes[0].value == 12.5 and known.shapes[0].points == ("T1", "T2", "T3")
    assert known.rigs[0].photos[1] == ("l2.jpg", "r2.jpg")
    np.testing.assert_allclose(known.rigs[0].centres[1], [0.2, 0.0, 0.0])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("distance = 3", "distance|int"),
        ("[[distance]]\na='A'\nb='B'\n", "metres.* is missing"),
        ("[[distance]]\na='A'\nb='B'\nmetres=-1\n", "needs a number above 0"),
        ("[[shapes]]\n", "“shapes” is no section"),
        ("[gnss]\nsource='absent.csv'\n", "could not be read"),
        ("[gnss]\nsource='../../outside.csv'\n", "outside"),
        ("[gnss]\nlever_arm='maybe'\n", "given"),
        ("gnss = 3", "cannot be used"),
        ("[gnss]\nsigma_m=[0.0, 1.0, 1.0]\n", "above 0"),
        ("[[rig]]\nphotos=[['a','b']]\ncentres=[[0,0,0]]\n", "2 cameras needs 2 centres"),
        ("not toml", "could not be read"),
        ("gnss = 3", "write .gnss. above"),
        ("shape = ['x']", "write ..shape.. above"),
        ("[[distance]]\na='A'\nb='A'\nmetres=1\n", "A twice"),
        ("[[distance]]\na='A'\nb='B'\nmetres=nan\n", "metres is nan"),
        ("[[distance]]\na='A'\nb='B'\nmetres='much'\n", "metres is much"),
        ("[[distance]]\na='A'\nb='B'\nmetres=1\nsgima=3\n", "“sgima” is nothing.*sigma"),
        ("[[shape]]\nkind='circle'\npoints=['A']\n", "kind is circle, needs one of: horizontal plane"),
        ("[[shape]]\nkind='plane'\npoints='ABCD'\n", "needs a list of names"),
        ("[[shape]]\nkind='horizontal plane'\npoints=['A','B']\nvalue=nan\n", "value is nan"),
        ("[gnss]\nsigma_m=[0,1,1]\n", "sigma_m is 0.0, needs a number above 0"),
        ("[gnss]\nsource='wrong.csv'\n", "standard deviation of a is not above 0"),
        ("[gnss]\nsource='twice.csv'\n", "line 3.*a occurs twice"),
        ("[attitudes]\nsource='ins.csv'\nboresight_deg=[inf,0,0]\n", "boresight_deg is inf"),
        ("[[rig]]\nphotos=['a','b']\n", "needs a list of names"),
        ("[[rig]]\nphotos=[['a','a']]\n", "a twice"),
        ("[[rig]]\nphotos=[['a','b']]\nfree='no'\n", "true or false"),
    ],
)
def test_what_makes_no_sense_is_refused_with_a_sentence(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "known.toml").write_text(text)
    (tmp_path / "wrong.csv").write_text("photo,x,y,z,sx,sy,sz\na,1,2,3,-1,1,1\n")
    (tmp_path / "twice.csv").write_text("photo,x,y,z\na,1,2,3\na,4,5,6\n")
    (tmp_path / "ins.csv").write_text("photo,omega,phi,kappa\na,1,2,3\n")
    photos = PhotoSet(photos=(photo("a", 50.0, 8.0, 100.0),), cameras=())
    with pytest.raises(UserError, match=said):
        read_known(tmp_path / "known.toml", first(), photos)


def test_a_given_boresight_turns_the_photos_against_the_body(tmp_path: Path) -> None:
    (tmp_path / "known.toml").write_text("[attitudes]\nsource='ins.csv'\nboresight_deg=[0, 0, 90]\n")
    (tmp_path / "ins.csv").write_text("photo,omega,phi,kappa\na.jpg,1,-2,30\n")
    given = read_known(tmp_path / "known.toml", first(), NOBODY).attitudes
    assert given is not None
    np.testing.assert_allclose(np.degrees(opk_from_matrix(given.rotations[0])), [1.0, -2.0, 30.0])
    photo = given.boresight @ given.rotations[0]  # what the adjustment expects of the photo
    turned = photo @ given.rotations[0].T
    np.testing.assert_allclose(turned, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-12)


def test_the_tables_a_file_names_are_known_to_the_store(tmp_path: Path) -> None:
    (tmp_path / "known.toml").write_text("[gnss]\nsource='gnss.csv'\n[attitudes]\nsource='ins.csv'\n")
    assert [path.name for path in known_tables(tmp_path / "known.toml")] == ["gnss.csv", "ins.csv"]
    (tmp_path / "known.toml").write_text("[gnss]\nsource='photos'\n")
    assert known_tables(tmp_path / "known.toml") == () == known_tables(tmp_path / "absent.toml")


def test_a_bad_line_of_a_table_is_named(tmp_path: Path) -> None:
    (tmp_path / "known.toml").write_text("[gnss]\nsource='gnss.csv'\n")
    (tmp_path / "gnss.csv").write_text("photo,x,y,z\na.jpg,1,2,3\nb.jpg,1,two,3\n")
    with pytest.raises(UserError, match=r"line 3.*“two”"):
        read_known(tmp_path / "known.toml", first(), NOBODY)


def test_positions_of_the_photos_become_east_north_up(tmp_path: Path) -> None:
    (tmp_path / "known.toml").write_text("[gnss]\n")
    photos = PhotoSet(
        photos=(photo("south", 49.9995, 8.0, 100.0), photo("north", 50.0005, 8.0, 110.0)), cameras=()
    )
    known = read_known(tmp_path / "known.toml", Known(), photos)
    assert known.centres is not None
    apart = known.centres.xyz[1] - known.centres.xyz[0]
    np.testing.assert_allclose(apart, [0.0, 111.2, 10.0], atol=0.2)  # a thousandth of a degree of latitude
    frame = local_tangent_frame(np.array([50.0, 8.0, 100.0]))
    places = np.array([[50.001, 8.002, 130.0], [49.998, 7.999, 90.0]])
    np.testing.assert_allclose(frame.to_geographic(frame.from_geographic(places)), places, atol=1e-9)


def test_control_in_degrees_and_in_feet(tmp_path: Path) -> None:
    path = tmp_path / "control.csv"
    path.write_text("# crs: EPSG:4326\nname,x,y,z\nA,8.0,49.9995,100\nB,8.0,50.0005,100\n")
    control, _ = read_control(path)
    assert control is not None
    assert np.linalg.norm(control.xyz[1] - control.xyz[0]) == pytest.approx(111.2, abs=0.2)
    with pytest.raises(UserError, match="not known"):
        metric_coordinates(np.zeros((1, 3)), "EPSG:1")
    with pytest.raises(UserError, match="US survey foot"):
        metric_coordinates(np.zeros((1, 3)), "EPSG:2225")


def test_standard_deviations_roles_and_unknown_heights_of_control(tmp_path: Path) -> None:
    path = tmp_path / "control.csv"
    path.write_text(
        "name,x,y,z,sx [mm],sy [mm],sz [mm],role\nA,1,2,3,5,5,10,control\nB,1,2,,0,0,0,check\nC,1,2,3,,,,off\n"
    )
    control, _ = read_control(path)
    assert control is not None and control.sigma is not None and control.off is not None
    np.testing.assert_allclose(control.sigma[0], [0.005, 0.005, 0.01])
    assert np.isnan(control.sigma[2]).all() and np.isnan(control.xyz[1, 2])
    assert control.check.tolist() == [False, True, False] and control.off.tolist() == [False, False, True]
    path.write_text("name,x,y,z,sigma\nA,1,2,3,-1\n")
    with pytest.raises(UserError, match=r"line 2.*negative"):
        read_control(path)


def test_photos_whose_position_is_no_number_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "known.toml").write_text("[gnss]\n")
    photos = PhotoSet(photos=(photo("a", 50.0, 8.0, 100.0), photo("b", 50.0, 8.0, float("nan"))), cameras=())
    known = read_known(tmp_path / "known.toml", Known(), photos)
    assert known.centres is not None and known.centres.photo == ("a",)
    assert np.isfinite(known.centres.xyz).all()
