"""Control points in the bundle adjustment stage: weights, blunders, check points, what cannot be determined."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.bundle.schur import adjust
from graphos_core.adjustment.bundle.sheet import BundleParams
from graphos_core.data import Adjustment, Finding, Known, KnownDistance
from graphos_core.errors import UserError
from graphos_core.run import Run
from graphos_core.simulation.consistency import SIGMA_M, Case, simulate

FIXED = BundleParams(calibration="fixed", measured_sigma_px=0.3)


@pytest.fixture(scope="module")
def case() -> Case:
    return simulate("basic", ("control",), 1)


def checks(known: Known, names: tuple[str, ...]) -> Known:
    assert known.control is not None
    check = np.array([name in names for name in known.control.names])
    return replace(known, control=replace(known.control, check=check))


def run(case: Case, known: Known, params: BundleParams = FIXED) -> tuple[Adjustment, list[str]]:
    heard = Run(threads=1)
    found = adjust(replace(case.block, obs_sigma_px=None), known, params, run=heard)
    return found, heard.warnings


def lessons(findings: tuple[Finding, ...]) -> list[str]:
    return [finding.learn for finding in findings]


def test_control_and_check_points_are_told_apart_and_weights_come_out_right(case: Case) -> None:
    found, warnings = run(case, checks(case.known, ("T2", "T6")))
    assert found.sigma0 == pytest.approx(1.0, rel=0.05) and found.prior_px == pytest.approx(0.3, rel=0.1)
    groups = {group.kind: group for group in found.groups}
    assert groups["control coordinates"].count == 30
    assert groups["control coordinates"].sigma0 == pytest.approx(1.0, abs=0.35)
    assert found.check is not None and found.check.names == ("T2", "T6")
    limit = 4 * np.hypot(found.check.sigmas, SIGMA_M)
    assert (np.abs(found.check.residuals) < limit).all()
    assert {name for name in found.point_names if name} == {f"T{i}" for i in range(12)}
    assert not warnings and found.datum == "control coordinates"


def test_a_blunder_in_control_is_named_and_only_that_one(case: Case) -> None:
    control = case.known.control
    xyz = np.array(control.xyz)
    xyz[3, 2] += 25 * SIGMA_M
    found, warnings = run(case, replace(case.known, control=replace(control, xyz=xyz)))
    named = [f for f in found.findings if f.learn == "adjustment/data-snooping" and "T3 Z" in f.what]
    assert len(named) == 1 and named[0].items[0] == "T3 Z"
    assert any("T3 Z" in warning for warning in warnings)


def test_wrong_a_priori_precision_is_said_and_variance_components_mend_it(case: Case) -> None:
    control = case.known.control
    wrong = replace(case.known, control=replace(control, sigma=np.full((12, 3), SIGMA_M / 4)))
    found, _ = run(case, wrong)
    assert "adjustment/variance-components" in lessons(found.findings)
    mended, _ = run(case, wrong, replace(FIXED, variance_components=True))
    factor = next(g.factor for g in mended.groups if g.kind == "control coordinates")
    assert factor == pytest.approx(4.0, rel=0.35)
    assert all(abs(g.sigma0 - 1.0) < 0.05 for g in mended.groups if g.redundancy > 2)


def test_control_that_only_checks_bends_nothing(case: Case) -> None:
    free, _ = run(case, replace(case.known, control=None, measured=None))
    checked, _ = run(case, case.known, replace(FIXED, control="check"))
    assert checked.check is not None and len(checked.check.names) == 12
    assert "free network" in checked.datum
    np.testing.assert_allclose(checked.block.centres, free.block.centres, atol=2e-3)


def test_a_check_distance_is_compared_and_takes_no_part(case: Case) -> None:
    distance = KnownDistance(a="T0", b="T5", metres=5.0, check=True)
    found, _ = run(case, replace(case.known, distances=(distance,)))
    assert "distances" not in {group.kind for group in found.groups}
    assert any("Check distance T0–T5" in finding.what for finding in found.findings)


def test_a_block_without_scale_is_not_compared_in_metres(case: Case) -> None:
    assert case.known.control is not None
    known = checks(case.known, case.known.control.names)
    known = replace(known, distances=(KnownDistance(a="T0", b="T5", metres=5.0, check=True),))
    found, _ = run(replace(case, block=replace(case.block, unit="model units")), known)
    assert found.check is None
    assert any("Check distance T0–T5 cannot be compared" in finding.what for finding in found.findings)
    assert not any(" m" in finding.what and "computed" in finding.what for finding in found.findings)


def test_scale_without_anything_known_is_said_with_a_remedy(case: Case) -> None:
    found, _ = run(case, Known())
    scale = next(finding for finding in found.findings if finding.learn == "adjustment/datum")
    assert "cale" in scale.what and "give one distance" in scale.todo


def test_single_parameters_are_set_and_unknown_ones_refused(case: Case) -> None:
    held, _ = run(
        case, case.known, BundleParams(parameters="k2=fixed, x0=free, y0=free", measured_sigma_px=0.3)
    )
    sigmas = dict(zip(("f", "x0", "y0", "k1", "k2"), held.block.cameras[0].sigmas, strict=True))
    assert sigmas["k2"] == 0.0 and min(sigmas[n] for n in ("f", "x0", "y0", "k1")) > 0.0
    prior, _ = run(case, case.known, BundleParams(parameters="focal_px=0.01", measured_sigma_px=0.3))
    assert 0 < prior.block.cameras[0].sigmas[0] <= 0.011
    assert "camera" in {group.kind for group in prior.groups}
    for text, said in (("k9=free", "k9"), ("k1:free", "not a setting"), ("k1=maybe", "not a setting")):
        with pytest.raises(UserError, match=said):
            run(case, case.known, BundleParams(parameters=text))


@pytest.mark.parametrize("strategy", ["interior later", "step by step"])
def test_every_order_of_unknowns_ends_at_the_same_place(case: Case, strategy: str) -> None:
    together, _ = run(case, case.known, BundleParams(measured_sigma_px=0.3))
    other, _ = run(case, case.known, BundleParams(measured_sigma_px=0.3, strategy=strategy))
    np.testing.assert_allclose(other.block.cameras[0].values, together.block.cameras[0].values, atol=0.05)
