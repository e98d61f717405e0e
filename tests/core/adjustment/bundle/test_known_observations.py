"""Observations beside image points: every derivative against the numerical one, and what they do to a block."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.datum import gauge
from graphos_core.adjustment.bundle.known import assembly
from graphos_core.adjustment.bundle.known.build import Defaults, join_measured, named_points, observe
from graphos_core.adjustment.bundle.known.photos import CameraValues
from graphos_core.adjustment.bundle.problem import Freedom, make_problem
from graphos_core.adjustment.bundle.step_kernels import move_photos
from graphos_core.cameras import pixel_from_ray
from graphos_core.data import (
    Block,
    Control,
    ControlObservations,
    Known,
    KnownAttitudes,
    KnownCentres,
    KnownDistance,
    KnownRig,
    KnownShape,
)
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.run import Run

ROUGH = Defaults(threshold_px=300.0)
"""The start of the block is rough: measured points intersect badly there."""
ARM = np.array([0.05, -0.1, 0.02])
TURN = matrix_from_vector(np.array([0.01, -0.02, 0.015]))


def measured_points(truth: Block, seed: int = 3) -> tuple[Control, ControlObservations]:
    """Twelve measured points: a floor, a wall, a vertical pole, and loose ones."""
    rng = np.random.default_rng(seed)
    xyz = rng.uniform(-1.5, 1.5, (12, 3))
    xyz[:4, 2] = -0.8
    xyz[4:8] = xyz[4:8] - (xyz[4:8] @ [0.6, 0.8, 0.0])[:, None] * [0.6, 0.8, 0.0] + [0.3, 0.4, 0.0]
    xyz[9:11, :2] = xyz[8, :2]
    point, photo, xy = [], [], []
    for n, name in enumerate(truth.names):
        pixels = pixel_from_ray(truth.cameras[0], (xyz - truth.centres[n]) @ truth.rotations[n].T)
        point += list(range(12))
        photo += [name] * 12
        xy += list(pixels)
    control = Control(
        names=tuple(f"T{i}" for i in range(12)), xyz=xyz, check=np.zeros(12, dtype=bool), origin=np.zeros(3)
    )
    return control, ControlObservations(point=np.array(point, np.int32), photo=tuple(photo), xy=np.array(xy))


def known_of(truth: Block) -> Known:
    control, measured = measured_points(truth)
    antenna = truth.centres + np.einsum("nji,j->ni", truth.rotations, ARM)
    k = len(truth.names)
    return Known(
        control=control, measured=measured,
        distances=(KnownDistance(a="T0", b="T5", metres=float(np.linalg.norm(control.xyz[0] - control.xyz[5]))),
                   KnownDistance(a=truth.names[0], b=truth.names[3], metres=float(np.linalg.norm(
                       truth.centres[0] - truth.centres[3])))),
        centres=KnownCentres(photo=truth.names, xyz=antenna, sigma=np.full((k, 3), 0.01), lever_arm=np.zeros(3),
                             lever_arm_free=True),
        attitudes=KnownAttitudes(photo=truth.names, rotations=TURN.T @ truth.rotations, sigma=np.full((k, 3), 1e-4),
                                 boresight=np.eye(3), boresight_free=True),
        shapes=(KnownShape(kind="horizontal plane", points=("T0", "T1", "T2", "T3"), sigma=0.001, name="floor"),
                KnownShape(kind="plane", points=("T4", "T5", "T6", "T7"), sigma=0.001, name="wall"),
                KnownShape(kind="vertical line", points=("T8", "T9", "T10"), sigma=0.001, name="pole"),
                KnownShape(kind="line", points=("T8", "T9", "T10"), sigma=0.001, name="edge"),
                KnownShape(kind="z axis", points=("T8", "T9"), sigma=0.001)),
        rigs=(KnownRig(photos=((truth.names[0], truth.names[1]), (truth.names[0], truth.names[2])),
                       rotations=np.stack([np.eye(3), truth.rotations[1] @ truth.rotations[0].T]),
                       centres=np.stack([np.zeros(3), truth.rotations[0] @ (truth.centres[1] - truth.centres[0])]),
                       sigma_rotation=1e-3, sigma_centre=1e-2),),
    )  # fmt: skip


def test_every_derivative_is_the_numerical_one(make_block) -> None:
    made = make_block(points=20)
    known = known_of(made.truth)
    block = join_measured(made.start, known, ROUGH)
    groups = observe(block, known, ROUGH, Run()).groups
    priors = CameraValues(
        np.array([0, 0]), np.array([0, 3]), np.array([1500.0, 0.0]), np.array([1.0, 0.1]), ["f", "k1"]
    )
    problem = make_problem(block, Freedom(interior=(("focal_px", "k1"),)), (*groups, priors))
    kinds = {g.kind for g in problem.groups}
    assert kinds == {"control coordinates", "distances", "planes", "lines", "axes", "projection centres",
                     "attitudes", "rig", "camera"}  # fmt: skip
    rng = np.random.default_rng(0)
    scene = problem.scene._replace(extra=rng.normal(0, 0.02, len(problem.scene.extra)))
    found = assembly.linearise(problem, scene)
    assert found is not None
    jacobian = found.jacobian.toarray()
    numeric = np.empty_like(jacobian)
    for column in range(problem.unknowns):
        sides = []
        for sign in (-1.0, 1.0):
            step = np.zeros(problem.unknowns)
            step[column] = sign * 1e-6
            moved = type(scene)(*(np.array(part) for part in scene))
            move_photos(scene, problem.layout, step, moved, np.zeros((len(problem.layout.pose), 3)))
            kept = problem.layout.point_column >= 0
            moved.points[kept] += step[problem.layout.point_column[kept][:, None] + np.arange(3)]
            moved.extra[:] += step[problem.unknowns - len(scene.extra) :]
            sides.append(assembly.linearise(problem, moved).residuals)
        numeric[:, column] = (sides[1] - sides[0]) / 2e-6
    np.testing.assert_allclose(jacobian, numeric, atol=2e-7)
    assert (np.abs(jacobian).sum(axis=1) > 0).all()


def adjusted_with(made, known: Known, noise: bool = False):
    block = join_measured(made.start, known, Defaults(measured_px=0.3, threshold_px=300.0))
    observed = observe(block, known, Defaults(measured_px=0.3, threshold_px=300.0), Run())
    weighted = replace(observed.block, obs_sigma_px=np.full(len(observed.block.obs_xy), 0.3))
    freedom = Freedom(fixed_points=observed.fixed_points)
    return adjust_block(
        replace(weighted, cameras=made.truth.cameras),
        freedom,
        Options(reliability=True, tolerance=1e-12),
        observed.groups,
    )


def test_lever_arm_boresight_and_plane_are_found(make_block) -> None:
    made = make_block(points=150)
    found = adjusted_with(made, replace(known_of(made.truth), rigs=()))
    extras = {extra.name: extra for extra in found.extras}
    arm = np.array([extras[f"lever arm {a}"].value for a in "xyz"])
    sigma = np.array([extras[f"lever arm {a}"].sigma for a in "xyz"])
    assert (np.abs(arm - ARM) < 5 * sigma).all() and (sigma < 0.02).all()
    beta = np.array([extras[f"boresight about {a}"].value for a in "xyz"])
    np.testing.assert_allclose(matrix_from_vector(beta), TURN, atol=3e-4)
    floor = {name: e for name, e in extras.items() if name.startswith("floor")}
    assert len(floor) == 1
    assert sum(group.redundancy for group in found.groups) == pytest.approx(found.redundancy, abs=1e-6)


@pytest.mark.parametrize(
    ("take", "defect"),
    [
        ({}, 7),
        ({"distances"}, 6),
        ({"shapes"}, 4),  # the scale is held, or residuals of planes would shrink the block
        ({"shapes", "distances"}, 4),
        ({"centres"}, 0),
        ({"attitudes"}, 4),
        ({"control"}, 0),
    ],
)
def test_the_datum_defect_is_what_the_observations_leave_free(make_block, take, defect) -> None:
    made = make_block(points=60)
    whole = known_of(made.truth)
    shapes = tuple(s for s in whole.shapes if s.kind == "horizontal plane") if "shapes" in take else ()
    known = Known(
        control=whole.control if "control" in take else replace(whole.control, xyz=np.full((12, 3), np.nan)),
        measured=whole.measured, distances=whole.distances[:1] if "distances" in take else (), shapes=shapes,
        centres=whole.centres if "centres" in take else None,
        attitudes=whole.attitudes if "attitudes" in take else None,
    )  # fmt: skip
    block = join_measured(made.start, known, ROUGH)
    groups = observe(block, known, ROUGH, Run()).groups
    problem = make_problem(block, Freedom(), groups)
    null = gauge(problem, problem.scene)
    assert null.shape[1] == defect
    found = assembly.linearise(problem, problem.scene)
    if found is not None and defect:
        assert np.abs(found.jacobian @ null).max() < 1e-6 * np.abs(null).max()
    adjusted = adjust_block(replace(block, cameras=made.truth.cameras), Freedom(), Options(), groups)
    expected = adjusted.observations - adjusted.unknowns + defect
    assert adjusted.redundancy == expected and np.isfinite(adjusted.sigma_points).all()


def test_measured_points_keep_their_names(make_block) -> None:
    made = make_block(points=30)
    known = known_of(made.truth)
    block = join_measured(made.truth, known, ROUGH)
    named = named_points(block, known)
    assert list(named) == list(known.control.names)
    np.testing.assert_allclose(block.points[list(named.values())], known.control.xyz, atol=1e-6)
    off = replace(known.control, off=np.arange(12) == 4)
    assert "T4" not in named_points(join_measured(made.truth, replace(known, control=off), ROUGH), known)
