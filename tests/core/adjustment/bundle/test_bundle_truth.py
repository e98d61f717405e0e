"""Estimates agree with the truth as closely as their own covariance says."""

import numpy as np
import pytest
from scipy.stats import chi2

from graphos_core.adjustment.bundle import datum
from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.bundle.covariance import cofactors
from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.problem import Freedom, make_problem
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.geometry.rotation import vector_from_matrix
from graphos_core.geometry.similarity import estimate_similarity

BASIC = ("focal_px", "x0", "y0", "k1", "k2")


def aligned(adjusted, truth):
    """The adjusted block moved onto the truth by a similarity of the projection centres."""
    move = estimate_similarity(adjusted.centres, truth.centres)
    return move.rotate_camera(adjusted.rotations), move.apply(adjusted.centres), move.apply(adjusted.points)


@pytest.mark.parametrize("noise_px", [0.1, 0.5])
def test_sigma0_agrees_with_the_injected_noise(make_block, noise_px):
    made = make_block(seed=3, noise_px=noise_px, points=400)
    adjusted = adjust_block(made.start, Freedom(interior=(BASIC,)))
    assert adjusted.converged
    assert adjusted.sigma0_px == pytest.approx(noise_px, rel=0.05)


def test_exact_observations_give_back_the_truth(make_block):
    made = make_block(seed=1, noise_px=0.0)
    adjusted = adjust_block(made.start, Freedom(interior=(BASIC,)))
    rotations, centres, points = aligned(adjusted.block, made.truth)
    assert adjusted.rms_px < 1e-9
    assert np.allclose(adjusted.block.cameras[0].values, made.truth.cameras[0].values, rtol=1e-8, atol=1e-8)
    assert np.allclose(rotations, made.truth.rotations, atol=1e-9)
    assert np.allclose(centres, made.truth.centres, atol=1e-8)
    assert np.allclose(points, made.truth.points, atol=1e-8)


def normalised_errors(made, noise_px):
    """χ² of all reduced unknowns and the mean χ² of a point, errors brought into the datum of the covariance."""
    adjusted = adjust_block(made.start, Freedom(interior=(BASIC,))).block
    problem = make_problem(adjusted, Freedom(interior=(BASIC,)))
    system = ReducedSystem(problem, Rules(0, 1.0, True), 1)
    with system.working():
        found = cofactors(system, problem.scene)
    rotations, centres, points = aligned(adjusted, made.truth)
    parts = [
        np.concatenate([vector_from_matrix(r @ t.T), c - d])
        for r, t, c, d in zip(rotations, made.truth.rotations, centres, made.truth.centres, strict=True)
    ]
    error = np.concatenate([*parts, adjusted.cameras[0].values - made.truth.cameras[0].values])
    scale = estimate_similarity(adjusted.centres, made.truth.centres)
    jacobian = np.eye(len(error))  # from the frame of the adjustment to that of the truth
    for n in range(len(parts)):
        jacobian[6 * n + 3 : 6 * n + 6, 6 * n + 3 : 6 * n + 6] = scale.scale * scale.rotation
    # the truth's own datum: errors that obey the inner constraints there
    moved = problem.scene._replace(rotations=rotations, centres=centres, points=points[problem.order])
    null = datum.gauge(problem, moved)
    constraint = jacobian @ found.reduced @ jacobian.T
    weights = datum.datum_weights(problem, moved)
    project = np.eye(len(error)) - null @ np.linalg.solve(null.T * weights @ null, null.T * weights)
    error, cofactor = project @ error, project @ constraint @ project.T
    total = float(error @ np.linalg.pinv(cofactor, rcond=1e-12, hermitian=True) @ error) / noise_px**2
    return total, len(error) - 7


def test_errors_of_orientations_and_camera_fit_their_covariance(make_block):
    totals = [normalised_errors(make_block(seed=seed), 0.3) for seed in range(4)]
    freedom = sum(dof for _, dof in totals)
    low, high = chi2.ppf([0.005, 0.995], freedom)
    assert low < sum(total for total, _ in totals) < high


def test_errors_of_points_fit_their_standard_deviations_when_the_photos_hold_the_datum(make_block):
    made = make_block(seed=5, points=300)
    start = made.truth.__class__(**{**vars(made.start), "rotations": made.truth.rotations,
                                    "centres": made.truth.centres, "cameras": made.truth.cameras})  # fmt: skip
    adjusted = adjust_block(start, Freedom(fixed_photos=np.ones(8, dtype=bool)))
    normalised = (adjusted.block.points - made.truth.points) / adjusted.sigma_points
    assert adjusted.datum == "8 fixed photos"
    assert np.mean(normalised**2) == pytest.approx(1.0, abs=0.15)


def test_standard_deviations_of_a_free_network_are_those_of_the_errors(make_block):
    made = [make_block(seed=seed) for seed in range(6)]
    adjusted = [adjust_block(m.start, Freedom(interior=(BASIC,))) for m in made]
    focal = [(a.block.cameras[0].values - m.truth.cameras[0].values) / a.block.cameras[0].sigmas
             for a, m in zip(adjusted, made, strict=True)]  # fmt: skip
    assert np.mean(np.square(focal)) == pytest.approx(1.0, abs=0.8)
    assert adjusted[0].datum.startswith("free network")


@pytest.mark.parametrize("kept", [("focal_px",), ("x0", "y0"), ("k2",), BASIC])
def test_a_frozen_parameter_stays_and_has_no_standard_deviation(make_block, kept):
    made = make_block()
    free = tuple(name for name in BASIC if name not in kept)
    camera = adjust_block(made.start, Freedom(interior=(free,))).block.cameras[0]
    before = made.start.cameras[0].values
    for i, name in enumerate(BASIC):
        assert (camera.values[i] == before[i]) == (name in kept)
        assert (camera.sigmas[i] == 0.0) == (name in kept)


def test_redundancy_counts_observations_unknowns_and_datum(make_block):
    made = make_block()
    free = adjust_block(made.start, Freedom(interior=(BASIC,)))
    m, p = len(made.start.obs_xy), len(free.block.points)
    assert (free.observations, free.unknowns) == (2 * m, 8 * 6 + 5 + 3 * p)
    assert free.redundancy == 2 * m - free.unknowns + 7
    held = np.zeros(8, dtype=bool)
    held[0] = True
    one_photo = adjust_block(made.start, Freedom(fixed_photos=held))
    assert one_photo.redundancy == one_photo.observations - one_photo.unknowns + 1  # the scale stays free
    control = np.zeros(p, dtype=bool)
    control[:3] = True
    fixed = adjust_block(made.start, Freedom(fixed_points=control))
    assert fixed.unknowns == 8 * 6 + 3 * (p - 3)
    assert fixed.redundancy == fixed.observations - fixed.unknowns


def test_each_photo_can_have_a_camera_of_its_own(make_block):
    made = make_block(cameras=8, points=300, noise_px=0.1)
    adjusted = adjust_block(made.start, Freedom(interior=(BASIC,) * 8))
    assert adjusted.unknowns == 8 * 11 + 3 * len(adjusted.block.points)
    assert adjusted.sigma0_px == pytest.approx(0.1, rel=0.05)
    for camera in adjusted.block.cameras:
        error = camera.values - made.truth.cameras[0].values
        assert np.all(np.abs(error) < 4.5 * camera.sigmas)


def test_two_cameras_in_one_block_are_calibrated_separately(make_block):
    made = make_block(cameras=2, points=300, noise_px=0.1)
    adjusted = adjust_block(made.start, Freedom(interior=(BASIC, ("focal_px",))))
    assert np.array_equal(adjusted.block.cameras[1].values[1:], made.start.cameras[1].values[1:])
    error = adjusted.block.cameras[0].values[0] - 1500.0
    assert adjusted.unknowns == 48 + 6 + 3 * len(adjusted.block.points)
    assert abs(error) < 50.0
