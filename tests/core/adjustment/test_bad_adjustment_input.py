"""Bad input of the adjustment room: what is wrong is said with its reason, in memory and on the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from graphos_core.adjustment.bundle.schur import adjust
from graphos_core.adjustment.bundle.sheet import BundleParams
from graphos_core.adjustment.georeferencing.similarity import (
    SimilarityParams,
    in_its_frame,
    place_by_similarity,
)
from graphos_core.adjustment.georeferencing.suspicions import name_suspicions
from graphos_core.cameras import pixel_from_ray
from graphos_core.cli import main
from graphos_core.data import Array, Block, Georeference, Known, KnownAttitudes, KnownCentres, KnownDistance
from graphos_core.errors import UserError
from graphos_core.exchange.control import read_control
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.project import Project
from graphos_core.run import Run
from graphos_core.simulation.consistency import Case, simulate

FT, LATITUDE = 0.3048, 48.0


@pytest.fixture(scope="module")
def case() -> Case:
    return simulate("basic", ("control",), 3)


def given(case: Case, xyz: Array) -> Known:
    assert case.known.control is not None
    return replace(case.known, control=replace(case.known.control, xyz=np.asarray(xyz)))


def true_xyz(case: Case) -> Array:
    assert case.known.control is not None
    return np.array(case.known.control.xyz)


def placed(case: Case, known: Known) -> tuple[Block, Georeference, list[str]]:
    run = Run(threads=1)
    block, reference = place_by_similarity(case.truth, known, SimilarityParams(), run=run)
    return block, reference, run.warnings


def degrees(xyz: Array) -> Array:
    east = 9.0 + xyz[:, 0] / (111_320.0 * np.cos(np.radians(LATITUDE)))
    return np.column_stack([east, LATITUDE + xyz[:, 1] / 111_320.0, xyz[:, 2]])


def with_rows(xyz: Array, rows: list[int], factor: float) -> Array:
    out = np.array(xyz)
    out[rows] *= factor
    return out


def with_blunder(xyz: Array) -> Array:
    out = np.array(xyz)
    out[5, 1] += 0.3
    return out


def test_good_control_raises_no_suspicion(case: Case) -> None:
    assert placed(case, case.known)[2] == []
    far = np.array([500_000.0, 5_400_000.0, 300.0])
    assert case.known.control is not None
    assert placed(case, replace(case.known, control=replace(case.known.control, origin=far)))[2] == []


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda xyz: xyz[:, [1, 0, 2]], "mirror image does"),
        (lambda xyz: xyz * [1.0, -1.0, 1.0], "left-handed"),
        (lambda xyz: xyz / [1.0, 1.0, FT], "Z fits the other axes when multiplied by 0.3048, as if it were in ft"),
        (lambda xyz: xyz * [1.0, 100.0, 1.0], "Y fits .* as if it were in cm"),
        (lambda xyz: with_rows(xyz, [2, 7], 1000.0), "units are mixed: .*T2, T7 .* in mm"),
        (lambda xyz: with_rows(xyz, [0, 1, 9], 1.0 / FT), "units are mixed: .*T0, T1, T9 .* in ft"),
        (with_blunder, "T5 misses by 0.(299|3)"),
        (lambda xyz: np.roll(xyz, 3, axis=0), "Names may be mixed up"),
    ],
)  # fmt: skip
def test_the_reason_of_a_misfit_is_said_alone(case: Case, wrong: Callable[[Array], Array], said: str) -> None:
    warnings = placed(case, given(case, wrong(true_xyz(case))))[2]
    assert len(warnings) == 1
    with pytest.raises(UserError, match=said):
        raise UserError(warnings[0])


@pytest.mark.parametrize("count", [3, 5, 8])
@pytest.mark.parametrize("relief", [0.0, 0.02, 1.0])
def test_noise_is_hardly_ever_called_something_else(count: int, relief: float) -> None:
    rng, run = np.random.default_rng(0), Run(threads=1)
    names = [f"T{i}" for i in range(count)]
    for _ in range(40):
        xyz = rng.uniform(-5.0, 5.0, (count, 3)) * [1.0, 1.0, relief]
        name_suspicions(
            names, xyz + rng.normal(0, 0.01, xyz.shape), xyz + rng.normal(0, 0.01, xyz.shape), run
        )
    assert len(run.warnings) <= 1, "expected is one alarm in a thousand tables"


@pytest.mark.parametrize("order", [[0, 1, 2], [1, 0, 2]])
def test_degrees_on_level_ground_are_recognised_by_what_would_fit(case: Case, order: list[int]) -> None:
    model = true_xyz(case) * [1e3, 1e3, 1e-3]
    run = Run(threads=1)
    name_suspicions([f"T{i}" for i in range(12)], model, degrees(model)[:, order], run)
    assert len(run.warnings) == 1 and "degrees beside heights in metres" in run.warnings[0]


def test_exchanged_axes_of_level_ground_show_by_the_cameras_below_it(case: Case) -> None:
    level = true_xyz(case) * [1.0, 1.0, 0.0]
    block = replace(case.truth, oriented=np.ones(len(case.truth.names), dtype=bool))
    known = given(case, level[:, [1, 0, 2]])
    measured = case.known.measured
    assert measured is not None
    photos = [block.names.index(name) for name in measured.photo]
    rays = [
        block.rotations[n] @ (level[p] - block.centres[n])
        for p, n in zip(measured.point, photos, strict=True)
    ]
    flat = replace(measured, xy=pixel_from_ray(block.cameras[0], np.array(rays)))
    warnings = placed(case, replace(known, measured=flat))[2]
    assert len(warnings) == 1 and "below the control points" in warnings[0]


def test_control_in_feet_is_told_by_a_distance_and_by_positions_of_photos(case: Case) -> None:
    xyz = true_xyz(case)
    metres = float(np.linalg.norm(xyz[0] - xyz[5]))
    feet = given(case, xyz / FT)
    (said,) = placed(case, replace(feet, distances=(KnownDistance(a="T0", b="T5", metres=metres),)))[2]
    assert "seem to be in ft, not in m" in said
    centres = KnownCentres(photo=case.truth.names, xyz=case.truth.centres, sigma=np.full((10, 3), 0.05),
                           lever_arm=np.zeros(3))  # fmt: skip
    said_by_positions = placed(case, replace(feet, centres=centres))[2]
    assert "the positions of the photos" in said_by_positions[0] and "in ft" in said_by_positions[0]
    rough = replace(centres, sigma=np.full((10, 3), 5.0))
    assert placed(case, replace(feet, centres=rough))[2] == [], "positions too rough to judge a scale"


def test_positions_and_attitudes_of_another_system_are_said(case: Case) -> None:
    truth = case.truth
    centres = KnownCentres(photo=truth.names, xyz=truth.centres + 400.0, sigma=np.full((10, 3), 3.0),
                           lever_arm=np.zeros(3))  # fmt: skip
    (said,) = placed(case, replace(case.known, centres=centres))[2]
    assert "positions of the photos lie 693 m from" in said
    boresight = matrix_from_vector(np.array([0.1, 0.2, -0.1]))
    attitudes = KnownAttitudes(photo=truth.names, rotations=boresight.T @ truth.rotations, boresight=boresight,
                               sigma=np.full((10, 3), 1e-3))  # fmt: skip
    assert placed(case, replace(case.known, attitudes=attitudes))[2] == []
    (turned,) = placed(case, replace(case.known, attitudes=replace(attitudes, boresight=np.eye(3))))[2]
    miss = float(turned.split("differ by ")[1].split("°")[0])
    assert miss == pytest.approx(np.degrees(np.sqrt(0.06)), abs=0.3)


def test_what_does_not_place_the_block_takes_no_part(case: Case) -> None:
    assert case.known.control is not None
    checks = replace(case.known, control=replace(case.known.control, check=np.ones(12, dtype=bool)))
    _, reference, warnings = placed(case, checks)
    assert reference.method == "none" and "check nothing" in warnings[0]
    inside = in_its_frame(checks, reference)
    assert inside.control is not None and np.isnan(inside.control.xyz).all()
    found = adjust(case.block, inside, BundleParams(calibration="fixed"), run=Run(threads=1))
    assert found.check is None and "control coordinates" not in {group.kind for group in found.groups}


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda xyz: np.where(np.arange(12)[:, None] < 2, xyz, np.nan), "2 control points could be computed, 3"),
        (lambda xyz: np.column_stack([xyz[:, :2], np.full(12, np.nan)]), "needs X, Y and Z; T0, T1"),
        (lambda xyz: xyz[:1] + np.linspace(0, 1, 12)[:, None], "rows are mixed up"),
        (lambda xyz: np.tile(xyz[:1], (12, 1)), "lie on one line"),
        (degrees, "look like degrees"),
        (lambda xyz: degrees(xyz)[:, [1, 0, 2]], "look like degrees"),
        (lambda xyz: xyz * [1.0, 5000.0, 1.0], "an axis may be in another unit"),
    ],
)  # fmt: skip
def test_control_that_cannot_place_a_block_is_refused(
    case: Case, wrong: Callable[[Array], Array], said: str
) -> None:
    with pytest.raises(UserError, match=said) as refused:
        placed(case, given(case, wrong(true_xyz(case))))
    assert refused.value.todo


def test_measurements_in_another_unit_lie_outside_their_photo(case: Case) -> None:
    measured = case.known.measured
    assert measured is not None
    in_mm = replace(measured, xy=(measured.xy - [800.0, 600.0]) * [0.005, -0.005])
    run = Run(threads=1)
    with pytest.raises(UserError):
        place_by_similarity(case.truth, replace(case.known, measured=in_mm), SimilarityParams(), run=run)
    assert "outside their photo" in run.warnings[0] and "px from the top left" in run.warnings[0]


def test_impossible_coordinates_and_degrees_are_refused_when_read(tmp_path: Path) -> None:
    path = tmp_path / "control.csv"
    for text, said in (
        ("name,x,y,z\nA,1e300,2,3\n", "line 2.*larger than 1e"),
        ("# crs: EPSG:4326\nname,x,y,z\nA,500000,5400000,3\nB,500001,5400000,3\n", "no degrees"),
    ):
        path.write_text(text, "utf-8")
        with pytest.raises(UserError, match=said):
            read_control(path)


# ------------------------------------------------------------------------------------------------ command line


def tables(project: Project, folder: Path, change: Callable[[list[str]], list[str]]) -> Path:
    """Write the control points of a project with changed rows, and its measurements."""
    head, *rows = (project.folder / "control.csv").read_text("utf-8").splitlines()
    folder.mkdir(exist_ok=True)
    changed = [change(row.split(",")) for row in rows]
    (folder / "c.csv").write_text("\n".join([head, *(",".join(row) for row in changed if row)]), "utf-8")
    measured = (project.folder / "control_measurements.csv").read_bytes()
    (folder / "c_measurements.csv").write_bytes(measured)
    return folder / "c.csv"


def test_exchanged_axes_lead_the_report_which_has_only_numbers(
    small_project: Project, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    control = tables(small_project, tmp_path / "in", lambda row: [row[0], row[2], row[1], *row[3:]])
    out = tmp_path / "out"
    assert main(["adjust", str(small_project.folder), "--out", str(out), "--control", str(control)]) == 0
    assert "mirror image" in capsys.readouterr().err

    def refuse(word: str) -> float:
        raise AssertionError(f"{word} in report.json")

    report = json.loads((out / "report.json").read_text("utf-8"), parse_constant=refuse)
    first = next(p for p in report["problems"] if p["severity"] == "warning")
    assert "mirror image" in first["what"] and "before it was adjusted" in first["why"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda row: [row[0], "nan", *row[2:]], "c.*line 2.*“nan”, not a number"),
        (lambda row: row if row[0] in ("T01", "T02") else [], "3 are needed"),
        (lambda row: [row[0], row[1], "0", "1", row[4]], "one line"),
    ],
)  # fmt: skip
def test_bad_control_ends_with_a_sentence(
    small_project: Project, tmp_path: Path, capsys: pytest.CaptureFixture[str],
    change: Callable[[list[str]], list[str]], said: str,
) -> None:  # fmt: skip
    control = tables(small_project, tmp_path / "in", change)
    code = main(["adjust", str(small_project.folder), "--out", str(tmp_path / "out"), "--control", str(control)])  # fmt: skip
    told = capsys.readouterr().err
    assert code == 1 and "Traceback" not in told
    with pytest.raises(UserError, match=said):
        raise UserError(told)


def test_check_points_alone_are_compared_with_nothing(small_project: Project, tmp_path: Path) -> None:
    control = tables(small_project, tmp_path / "in", lambda row: [*row[:4], "check"])
    out = tmp_path / "out"
    assert main(["adjust", str(small_project.folder), "--out", str(out), "--control", str(control)]) == 0
    report = json.loads((out / "report.json").read_text("utf-8"))
    assert report["georeferencing"]["check_rms_m"] is None and report["check"] is None
    assert any("check nothing" in p["what"] for p in report["problems"])


def test_what_a_project_knows_goes_with_it_and_nonsense_in_it_is_refused(
    small_project: Project, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "known.toml").write_text("[[distance]]\na = 'T01'\nb = 'T01'\nmetres = 1\n")
    assert main(["adjust", str(small_project.folder), "--out", str(out)]) == 1
    assert "T01 twice" in capsys.readouterr().err
    (out / "known.toml").write_text("[gnss]\nsource = 'tables/g.csv'\n")
    (out / "tables").mkdir()
    (out / "tables" / "g.csv").write_text("photo,x,y,z\nabsent.jpg,1,2,3\n")
    again = tmp_path / "again"
    assert main(["adjust", str(small_project.folder), "--out", str(out)]) == 0
    assert main(["adjust", str(out), "--out", str(again)]) == 0
    assert (again / "known.toml").read_bytes() == (out / "known.toml").read_bytes()
    assert "absent.jpg" in capsys.readouterr().err and (again / "tables" / "g.csv").is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["compare", "runs", "{tmp}/none", "{project}"], "none does not exist"),
        (["compare", "runs", "{tmp}", "{project}"], "is not a run"),
        (["report", "{tmp}/report", "--pdf", "{tmp}/file/r.pdf"], "could not be written"),
        (["report", "{tmp}"], "has no report"),
        (["adjust", "{project}", "--out", "{tmp}/file/out"], "could not be written"),
        (["convert", "camera", "{project}/control.csv", "{tmp}/x", "--to", "opencv"], "not recognised"),
        (["convert", "orientation", "{project}", "{tmp}/x", "--to", "nonsense"], "Unknown orientation format"),
        (["calibrate", "{tmp}/none", "--target", "chessboard", "--columns", "9", "--rows", "6", "--square-mm", "nan",
          "--out", "{tmp}/c"], "nan mm"),
        (["run", "{project}", "--out", "{tmp}/r", "--distance", "T01,T02,nan"], "nan m"),
    ],
)  # fmt: skip
def test_every_word_ends_with_a_sentence(
    small_project: Project, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "report").mkdir()
    for name in ("report.html", "report.json"):
        (tmp_path / "report" / name).write_text("{}")
    filled = [word.format(project=small_project.folder, tmp=tmp_path) for word in words]
    assert main(filled) == 1
    told = capsys.readouterr().err
    assert said in told and "Traceback" not in told
