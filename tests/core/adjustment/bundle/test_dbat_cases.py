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
        assert np.allclose(opk_from_matrix(adjusted.block.rotations[n]), station.opk, atol=np.radians(2e-5))
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
