"""DBAT scripts, PhotoModeler exports and reports: what is read must reproduce the printed numbers."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.errors import UserError
from graphos_core.exchange.dbat import read_photomodeler_case
from graphos_core.exchange.dbat_report import read_report
from graphos_core.exchange.dbat_script import read_script
from graphos_core.geometry.rotation import angle_between, matrix_from_opk
from graphos_core.geometry.triangulation import triangulate

pytestmark = pytest.mark.data


def photomodeler(data_dir, stub):
    folder = data_dir / "dbat" / "prague2016_sxb"
    control = "fixed" if stub.startswith("f") else "weighted"
    case = read_photomodeler_case(folder / "pmexports" / f"{stub}-pmexport.txt", folder / "ref" / f"ctrlpts-{control}.txt")  # fmt: skip
    return case, read_report(folder / "dbatexports" / f"{stub}-dbatreport.txt")


def script(data_dir, name):
    folder = data_dir / "dbat" / name
    return read_script(folder / f"{name}.xml"), read_report(folder / "result" / "report.txt")


def counts(case):
    """Return observations and unknowns of a case as DBAT counts them."""
    held = np.flatnonzero((case.control_point >= 0) & ~case.control.check)
    fixed = (case.control_sigma[held] == 0).all(axis=1)
    weighted = 3 * int((~fixed).sum())
    points = 3 * (len(case.block.points) - int(fixed.sum()))
    return 2 * len(case.block.obs_xy) + weighted, len(case.estimated) + 6 * len(case.block.names) + points


@pytest.mark.parametrize("name", ["f-op0-no-orient", "w-op0-with-orient", "w-op1-no-orient", "wsmart-no-orient",
                                  "sxb", "camcaldemo"])  # fmt: skip
def test_observations_and_unknowns_are_those_of_the_report(data_dir, name):
    case, report = photomodeler(data_dir, name) if "orient" in name else script(data_dir, name)
    observations, unknowns = counts(case)
    assert (observations, unknowns) == (report.observations["all"], report.unknowns["all"])
    assert observations - unknowns == report.redundancy
    case.block.check_arrays()
    assert [station.photo for station in report.stations] == list(case.block.names)
    pairs = list(zip(case.block.obs_point.tolist(), case.block.obs_photo.tolist(), strict=True))
    assert pairs == sorted(pairs)


def test_camera_calibration_reproduces_sigma0_from_its_printed_orientation(data_dir):
    """Interior and exterior as printed, object points intersected: vᵀv / r proves origin, units, signs and aspect."""
    case, report = script(data_dir, "camcaldemo")
    printed = {name: item.value for name, item in report.interior[0].items()}
    camera = replace(
        case.camera, constant_mm=printed["cc"], principal_mm=np.array([printed["px"], printed["py"]]),
        k=np.array([printed["K1"], printed["K2"], printed["K3"]]), p=np.array([printed["P1"], printed["P2"]]),
        aspect=printed["as"],
    )  # fmt: skip
    block = case.block
    rotations = np.array([matrix_from_opk(*station.opk) for station in report.stations])
    centres = np.array([station.centre for station in report.stations])
    rays = camera.ideal_mm(block.obs_xy) / camera.constant_mm
    focal = np.full(21, camera.constant_mm / camera.pitch_mm)
    bounds = np.searchsorted(block.obs_point, np.arange(len(block.points) + 1))
    points = triangulate(bounds, block.obs_photo, rays, focal, rotations, centres).points.copy()
    points[case.control_point] = case.control.xyz
    p = np.einsum(
        "nij,nj->ni", rotations[block.obs_photo], points[block.obs_point] - centres[block.obs_photo]
    )
    residuals = (p[:, :2] / p[:, 2:] - rays) * focal[0]
    assert np.sqrt((residuals**2).sum() / report.redundancy) == pytest.approx(report.sigma0_px, abs=2e-5)
    assert case.estimated == ("cc", "px", "py", "as", "K1", "K2", "K3", "P1", "P2")
    assert np.all(case.obs_sigma_px == 0.1)


def test_smart_points_project_with_the_printed_rms(data_dir):
    case, report = photomodeler(data_dir, "wsmart-no-orient")
    block = case.block
    p = np.einsum("nij,nj->ni", block.rotations[block.obs_photo],
                  block.points[block.obs_point] - block.centres[block.obs_photo])  # fmt: skip
    residuals = pixel_from_ray(block.cameras[0], p) - block.obs_xy
    rms = np.sqrt((residuals**2).sum(axis=1).mean())
    assert rms == pytest.approx(
        report.point_rms_px, rel=0.35
    )  # control starts at its given, not adjusted position
    assert np.median(np.abs(residuals)) < 1.0
    assert np.allclose(case.control_sigma, [0.02, 0.02, 0.04])


def test_script_starts_near_the_adjusted_orientation(data_dir):
    case, report = script(data_dir, "sxb")
    for i, station in enumerate(report.stations):
        assert np.degrees(angle_between(matrix_from_opk(*station.opk), case.block.rotations[i])) < 3.0
        distance = np.linalg.norm(case.block.centres[i] + case.control.origin - station.centre)
        assert distance < 0.03 * station.centre[2]
    assert sorted(case.control.names[i] for i in np.flatnonzero(case.control.check)) == ["351", "410"]
    assert case.labels[case.control.names.index("607")] == "B5.212"
    assert set(np.unique(case.obs_sigma_px)) == {0.5, 1.0}


def test_report_values_units_and_correlations(data_dir):
    _, report = script(data_dir, "camcaldemo")
    k2 = report.interior[0]["K2"]
    assert (k2.value, k2.sigma) == (-4.51351e-05, 2.65e-06)
    assert k2.correlations == pytest.approx({"K3": -0.979})
    assert report.interior[0]["cc"].unit == "mm"
    sxb = read_report(data_dir / "dbat/sxb/result/report.txt")
    assert (sxb.sigma0, sxb.sigma0_px, sxb.control_rms, sxb.check_rms) == (1.1786, 0.589299, 0.035, 0.421)


@pytest.fixture
def copied(data_dir, tmp_path):
    shutil.copytree(data_dir / "dbat" / "sxb", tmp_path / "sxb")
    return tmp_path / "sxb"


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        ("measurements/markpts.txt", "7275.6667", "nan", "markpts.txt, line 2"),
        ("measurements/markpts.txt", "7275.6667", "7275;6667 x", "line 2"),
        ("reference/sxb-control.txt", ", 0.02, 0.02, 0.04", "", "line 2"),
        ("sxb.xml", ">keep<", ">perhaps<", "neither keep nor remove"),
        ("sxb.xml", ">images/images.txt<", ">../../secret.txt<", "outside its own folder"),
        ("sxb.xml", "<cameras>", "<kameras>", "not plain XML"),
        ("sxb.xml", '<?xml version="1.0" encoding="UTF-8"?>',
         '<!DOCTYPE x [<!ENTITY a "aaaa">]>', "not a DBAT script"),
        ("images/images.txt", "1, data", "9, data", "could not be read"),
        ("sxb.xml", "<model>3</model>", "<model>5</model>", "lens model 5"),
    ],
)  # fmt: skip
def test_damaged_scripts_are_refused_with_a_sentence(copied, file, old, new, said):
    path = copied / file
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(UserError, match=said):
        read_script(copied / "sxb.xml")


def test_what_is_no_report_or_export_is_refused(tmp_path):
    path = tmp_path / "report.txt"
    path.write_text("Sigma0: many\n")
    with pytest.raises(UserError, match="sigma0"):
        read_report(path)
    with pytest.raises(UserError, match="cannot be read"):
        read_photomodeler_case(path, path)
    with pytest.raises(UserError, match="could not be read"):
        read_report(tmp_path / "absent.txt")
