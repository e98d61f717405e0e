"""Several groups of one kind, groups that lose members, cameras that take no part: counts and weights stay right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.known.build import Defaults, join_measured, observe
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.adjustment.bundle.rejection import chosen
from graphos_core.adjustment.bundle.schur import adjust
from graphos_core.adjustment.bundle.self_calibration import Calibrated
from graphos_core.adjustment.bundle.sheet import BundleParams
from graphos_core.adjustment.statistics.diagnosis import diagnosed
from graphos_core.data import Known, KnownDistance, KnownShape
from graphos_core.run import Run
from graphos_core.simulation.consistency import SIGMA_PX, simulate

DEFAULTS = Defaults(measured_px=0.3, threshold_px=300.0)


def test_an_observation_behind_its_camera_leaves_the_groups_as_they_are() -> None:
    case = simulate("basic", ("control", "positions", "planes"), 1)
    joined = join_measured(case.block, case.known, DEFAULTS)
    observed = observe(joined, case.known, DEFAULTS, Run())
    keep = (joined.obs_point != 0) | (joined.obs_photo == joined.obs_photo[0])
    points = np.array(joined.points)
    centre = joined.centres[joined.obs_photo[0]]
    points[0] = centre + 0.5 * (centre - case.truth.points.mean(axis=0))
    hidden = replace(chosen(joined, keep), points=points)
    fixed = np.arange(len(points)) == 0
    found = adjust_block(hidden, Freedom(fixed_points=fixed), Options(), observed.groups)
    assert len(found.block.obs_xy) == keep.sum() - 1 and len(found.block.points) == len(points) - 1
    assert [group.kind for group in found.groups[2:]] == [group.kind for group in observed.groups]
    assert [group.count for group in found.groups[2:]] == [len(group.sigma) for group in observed.groups]
    arm = {extra.name: extra for extra in found.extras if extra.name in case.extras}
    assert len(arm) == 3  # kept as adjusted, not started again
    assert all(abs(extra.value - case.extras[name]) < 4 * extra.sigma for name, extra in arm.items())


def test_a_rig_with_a_given_base_gives_the_scale_and_no_direction() -> None:
    case = simulate("basic", ("control", "rig"), 1)
    (rig,) = case.known.rigs
    truth, known = case.truth, Known(rigs=(replace(rig, free=False),))
    twice = replace(truth, centres=2.0 * truth.centres, points=2.0 * truth.points)
    groups = observe(twice, known, DEFAULTS, Run()).groups
    assert [group.kind for group in groups] == ["rig"]
    found = adjust_block(twice, Freedom(), Options(max_iterations=100), groups)
    base = np.linalg.norm(found.block.centres[1] - found.block.centres[0])
    assert base == pytest.approx(np.linalg.norm(rig.centres[1]), rel=1e-6)
    assert "6 conditions" in found.datum and found.datum.startswith("rig")


def test_the_heights_of_two_planes_give_the_scale() -> None:
    case = simulate("basic", ("control",), 1)
    assert case.known.control is not None
    places = case.known.control.xyz
    high = f"T{int(np.argmax(places[:, 2]))}"
    planes = tuple(
        KnownShape(
            kind="horizontal plane", points=points, sigma=0.001, value=float(places[int(points[0][1:]), 2])
        )
        for points in (("T0", "T1", "T2", "T3"), (high,))
    )
    control = replace(case.known.control, xyz=np.full(places.shape, np.nan))
    known = Known(control=control, measured=case.known.measured, shapes=planes)
    larger = replace(case.block, centres=1.05 * case.block.centres, points=1.05 * case.block.points)
    observed = observe(join_measured(larger, known, DEFAULTS), known, DEFAULTS, Run())
    found = adjust_block(observed.block, Freedom(), Options(), observed.groups)
    base, true = (np.linalg.norm(block.centres[5] - block.centres[0]) for block in (found.block, case.truth))
    assert base == pytest.approx(true, rel=0.01)
    assert "scale at its start" not in found.datum and "3 conditions" in found.datum


def test_what_is_named_twice_or_never_photographed_brings_no_unknowns() -> None:
    case = simulate("basic", ("control", "rig"), 1)
    (rig,) = case.known.rigs
    three = replace(
        rig, photos=tuple((a, "", b) for a, b in rig.photos), rotations=rig.rotations[[0, 0, 1]],
        centres=rig.centres[[0, 0, 1]],
    )  # fmt: skip
    twice = KnownShape(kind="line", points=("T1", "T1", "T1"), sigma=0.01)
    itself = KnownDistance(a="T0", b="T0", metres=1.0)
    heard = Run()
    known = replace(case.known, rigs=(three,), shapes=(twice,), distances=(itself,))
    observed = observe(join_measured(case.block, known, DEFAULTS), known, DEFAULTS, heard)
    assert [group.kind for group in observed.groups] == ["control coordinates", "rig"]
    assert [extra.name for extra in observed.groups[1].extras][:1] == ["rig, camera 3: rotation about x"]
    assert len(observed.groups[1].extras) == 6
    assert any("to itself" in w for w in heard.warnings) and any(
        "1 of its points" in w for w in heard.warnings
    )
    found = adjust_block(observed.block, Freedom(), Options(), observed.groups)
    centre = [e.value for e in found.extras if "centre" in e.name]
    np.testing.assert_allclose(centre, rig.centres[1], atol=0.01)


def test_the_prior_of_a_camera_without_photos_is_no_observation(make_block) -> None:
    truth = make_block(points=40).truth
    block = replace(truth, cameras=truth.cameras * 2)
    free = (("focal_px",), ("focal_px",))
    calibrated = Calibrated(free, ((0, "focal_px", 1.0), (1, "focal_px", 1.0)))
    found = adjust_block(block, Freedom(interior=free), Options(), calibrated.prior_group(block))
    assert found.observations == 2 * len(found.block.obs_xy) + 1


def test_check_points_do_not_pass_for_tie_points() -> None:
    case = simulate("basic", ("control",), 1)
    params = BundleParams(calibration="fixed", control="check", measured_sigma_px=5.0)
    found = adjust(replace(case.block, obs_sigma_px=None), case.known, params, run=Run(threads=1))
    counts = {group.kind: group.count for group in found.groups}
    assert counts["tie points"] == 2 * len(case.block.obs_xy)
    assert found.prior_px == pytest.approx(SIGMA_PX, rel=0.02)


def test_variance_components_pool_the_groups_of_one_kind() -> None:
    case = simulate("basic", ("control",), 2)
    rng, truth = np.random.default_rng(4), case.truth
    control = case.known.control
    assert control is not None
    given, noise = 0.001, 0.006
    pairs = [(f"T{i}", f"T{i + 6}") for i in range(6)]
    photos = [(truth.names[i], truth.names[i + 5]) for i in range(5)] + [(truth.names[0], truth.names[3])]
    place = dict(zip(control.names, simulate("basic", ("control",), 0).known.control.xyz, strict=True))
    place = {**place, **dict(zip(truth.names, truth.centres, strict=True))}
    distances = tuple(
        KnownDistance(
            a=a, b=b, metres=float(np.linalg.norm(place[a] - place[b]) + rng.normal(0, noise)), sigma=given
        )
        for a, b in (*pairs, *photos)
    )
    params = BundleParams(calibration="fixed", measured_sigma_px=0.3, variance_components=True)
    known = replace(case.known, distances=distances)
    found = adjust(replace(case.block, obs_sigma_px=None), known, params, run=Run(threads=1))
    parts = [group for group in found.groups if group.kind == "distances"]
    assert len(parts) == 2 and all(group.redundancy > 2 for group in parts)
    pooled = sum(g.squares for g in parts) / sum(g.redundancy for g in parts)
    assert pooled == pytest.approx(1.0, abs=0.1)
    assert parts[0].factor == pytest.approx(noise / given, rel=0.6)


def test_a_single_free_parameter_is_correlated_with_nothing(make_block) -> None:
    made = make_block(points=60)
    found = adjust_block(made.start, Freedom(interior=(("focal_px",),)), Options(reliability=True))
    told = diagnosed(found, Known(), [], 0.001, Run())
    (tested,) = told.significance
    assert tested.parameter == "focal_px" and tested.correlation == 0.0 and tested.correlated_with == ""
    assert not any("correlated" in finding.what for finding in told.findings)


@pytest.mark.parametrize("robust", ["huber", "l1", "cauchy", "geman-mcclure", "tukey", "danish"])
def test_every_robust_function_finds_the_noise_and_few_false_alarms(robust: str) -> None:
    case = simulate("basic", ("control",), 1)
    params = BundleParams(calibration="fixed", measured_sigma_px=SIGMA_PX, robust=robust)
    found = adjust(replace(case.block, obs_sigma_px=None), case.known, params, run=Run(threads=1))
    assert found.prior_px == pytest.approx(SIGMA_PX, rel=0.06)
    assert found.sigma0 == pytest.approx(1.0, abs=0.03)
    assert found.reliability is not None
    alarms = int((np.abs(found.reliability.standardised) > found.reliability.critical).sum())
    assert alarms < 5 + 3 * found.reliability.alpha * found.reliability.standardised.size
