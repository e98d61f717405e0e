"""Published adjustments with weighted control points: DBAT's cases, against what its reports print."""

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.known.points import Coordinates
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.exchange.dbat import read_photomodeler_case
from graphos_core.exchange.dbat_report import read_report
from graphos_core.exchange.dbat_script import read_script
from graphos_core.geometry.rotation import opk_from_matrix

pytestmark = pytest.mark.data


def control_of(case):
    """Coordinates of the measured control points as weighted observations."""
    rows = [
        (
            case.control_point[i],
            axis,
            case.control.xyz[i, axis],
            case.control_sigma[i, axis],
            f"{name} {'XYZ'[axis]}",
        )
        for i, name in enumerate(case.control.names)
        if case.control_point[i] >= 0 and not case.control.check[i]
        for axis in range(3)
    ]
    point, axis, xyz, sigma, labels = zip(*rows, strict=True)
    return Coordinates(np.array(point), np.array(axis), np.array(xyz), np.array(sigma), labels)


def adjusted_of(case):
    block = replace(case.block, obs_sigma_px=case.obs_sigma_px)
    return adjust_block(block, Freedom(), Options(reliability=True, tolerance=1e-14), [control_of(case)])


def assert_stations_agree(adjusted, report):
    for n, station in enumerate(report.stations):
        turned = np.subtract(opk_from_matrix(adjusted.block.rotations[n]), station.opk)
        turned = np.mod(turned + np.pi, 2 * np.pi) - np.pi
        assert np.abs(turned).max() < np.radians(2e-5)
        assert np.allclose(adjusted.block.centres[n], station.centre, atol=2e-3)
        assert np.allclose(adjusted.sigma_centres[n], station.sigma_centre, rtol=5e-3)


@pytest.mark.parametrize(
    ("name", "sigma0", "redundancy", "unknowns", "observations"),
    [("w-op0-with-orient", 0.984904, 64, 78, 142), ("wsmart-with-orient", 1.07447, 1267, 1173, 2440)],
)
def test_weighted_control_of_strasbourg(data_dir, name, sigma0, redundancy, unknowns, observations):
    folder = data_dir / "dbat" / "prague2016_sxb"
    case = read_photomodeler_case(
        folder / "pmexports" / f"{name}-pmexport.txt", folder / "ref" / "ctrlpts-weighted.txt"
    )
    adjusted = adjusted_of(case)
    assert (adjusted.redundancy, adjusted.unknowns, adjusted.observations) == (
        redundancy,
        unknowns,
        observations,
    )
    assert adjusted.sigma0 == pytest.approx(sigma0, rel=1e-5)
    assert_stations_agree(adjusted, read_report(folder / "dbatexports" / f"{name}-dbatreport.txt"))
    assert sum(group.redundancy for group in adjusted.groups) == pytest.approx(redundancy, abs=1e-5)
    assert adjusted.reliability.redundancy.min() >= 0.0


def test_script_with_check_points(data_dir):
    folder = data_dir / "dbat" / "sxb"
    case = read_script(folder / "sxb.xml")
    adjusted = adjusted_of(case)
    assert adjusted.redundancy == 1261
    assert adjusted.sigma0_px == pytest.approx(0.589299, abs=1e-6)
    assert adjusted.prior_px == 0.5
    points = adjusted.block.point_track.tolist()
    check = [i for i, is_check in enumerate(case.control.check) if is_check]
    misses = np.array([
        adjusted.block.points[points.index(int(case.control.names[i]))] - case.control.xyz[i] for i in check
    ])  # fmt: skip
    assert np.sqrt((misses**2).sum() / len(misses)) == pytest.approx(0.421, abs=5e-4)


def test_self_calibration_of_the_camera_calibration_demo(data_dir):
    """Every interior parameter within 0.05 of its standard deviation, every standard deviation within 1 %."""
    folder = data_dir / "dbat" / "camcaldemo"
    case, report = read_script(folder / "camcaldemo.xml"), read_report(folder / "result" / "report.txt")
    pinhole, pitch = case.block.cameras[0], case.camera.pitch_mm
    values = np.concatenate([pinhole.values, np.zeros(7)])
    camera = replace(pinhole, model="brown_backward", values=values)
    fixed = np.zeros(len(case.block.points), dtype=bool)
    fixed[case.control_point] = True
    block = replace(case.block, cameras=(camera,), obs_sigma_px=case.obs_sigma_px)
    freedom = Freedom(
        interior=(("focal_px", "x0", "y0", "k1", "k2", "k3", "p1", "p2", "b1"),), fixed_points=fixed
    )
    adjusted = adjust_block(block, freedom, Options(tolerance=1e-15, reliability=True))
    assert (adjusted.redundancy, adjusted.unknowns, adjusted.observations) == (3725, 423, 4148)
    assert adjusted.sigma0_px == pytest.approx(0.16148, abs=5e-6)
    assert_stations_agree(adjusted, report)
    found = adjusted.block.cameras[0].values
    covariance = adjusted.covariance.cameras[0]
    f = found[0] * pitch
    printed = report.interior[0]
    scales = {"cc": pitch, "px": pitch, "py": pitch, "K1": f**-2, "K2": f**-4, "K3": f**-6, "P1": 1 / f, "P2": -1 / f,
              "as": 1.0}  # fmt: skip
    powers = {"K1": -2, "K2": -4, "K3": -6, "P1": -1, "P2": -1}
    slopes = {}
    for name, place in zip(("cc", "px", "py", "K1", "K2", "K3", "P1", "P2", "as"), range(9), strict=True):
        value = found[place] + (0.5 if name in ("px", "py") else 0.0)
        slope = np.zeros(10)  # to mm: the coefficients of normalised units change with the camera constant
        slope[place] = scales[name]
        slope[0] += powers.get(name, 0) * value * scales[name] / found[0]
        slopes[name] = slope
        spread = np.sqrt(slope @ covariance @ slope)
        assert abs(value * scales[name] - printed[name].value) <= 0.05 * printed[name].sigma, name
        assert spread == pytest.approx(printed[name].sigma, rel=0.01), name
    shared = slopes["K2"] @ covariance @ slopes["K3"]
    correlation = shared / np.sqrt(np.prod([slopes[k] @ covariance @ slopes[k] for k in ("K2", "K3")]))
    assert correlation == pytest.approx(printed["K2"].correlations["K3"], abs=2e-3)
